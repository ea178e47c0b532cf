/* SPDX-License-Identifier: MIT
 *
 * batch.h - many statuses of one service to rows of a table.
 */
#ifndef ROBUROC4_PY_BATCH_H
#define ROBUROC4_PY_BATCH_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "roburoc4.h"

/* What all statuses of a batch have in common. */
typedef struct batch_shape {
    uint32_t service; /* ROBUROC4_SERVICE_* */
    uint32_t id;      /* its id on the wire */
    uint32_t analog;  /* of the IO card: its counts; telemeters: their number */
    uint32_t digital;
    size_t row; /* bytes of a row */
} batch_shape;

/* Write a row for each good status of `source` into `rows`, without gaps, and return the list of
 * the indices of the bad ones. source: a sequence of bytes-like objects where size is 0, else one
 * bytes-like object of statuses of that size, one after the other. */
PyObject *batch_decode(PyObject *source, size_t size, uint32_t service, uint32_t id,
                       uint32_t analog, uint32_t digital, PyObject *rows, size_t row);

#endif
