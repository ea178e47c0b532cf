/* SPDX-License-Identifier: MIT
 *
 * decode.h - one datagram to one typed record.
 */
#ifndef ROBUROC4_PY_DECODE_H
#define ROBUROC4_PY_DECODE_H

#include "records.h"

/* decode(data, layout, from_client): layout is None or the tuple of nine integers of Layout in
 * roburoc4/codec.py. For METH_FASTCALL. */
PyObject *decode_telegram(PyObject *self, PyObject *const *arguments, Py_ssize_t count);

#endif
