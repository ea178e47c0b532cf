/* SPDX-License-Identifier: MIT
 *
 * raise.h - results below 0 to the exceptions of roburoc4/errors.py.
 */
#ifndef ROBUROC4_PY_RAISE_H
#define ROBUROC4_PY_RAISE_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "roburoc4.h"

/* Learn the function that makes an exception of a result. */
PyObject *raise_register(PyObject *make);
/* Set the exception of a result; always NULL. */
PyObject *raise_result(roburoc4_result result);

#endif
