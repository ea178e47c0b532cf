/* SPDX-License-Identifier: MIT
 *
 * Which exception a result is, is decided in Python.
 */
#include "raise.h"

static PyObject *make_exception;

PyObject *raise_register(PyObject *make) {
    Py_XDECREF(make_exception);
    Py_INCREF(make);
    make_exception = make;
    Py_RETURN_NONE;
}

PyObject *raise_result(roburoc4_result result) {
    PyObject *exception = PyObject_CallFunction(make_exception, "i", (int)result);
    if (exception != NULL) {
        PyErr_SetObject((PyObject *)Py_TYPE(exception), exception);
        Py_DECREF(exception);
    }
    return NULL;
}
