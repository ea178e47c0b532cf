/* SPDX-License-Identifier: MIT
 *
 * Robot files: their text as a dict of numbers, and back.
 */
#include "native.h"

#include <string.h>

#include "roburoc4_robot_file.h"

PyObject *robot_file_read(const char *text) {
    roburoc4_robot_file file;
    const char *remedy = NULL;
    uint32_t line = 0;
    if (roburoc4_robot_file_read(&file, text, strlen(text), &line, &remedy) < 0) {
        return PyErr_Format(PyExc_ValueError, "line %u: %s", (unsigned)line, remedy);
    }
    PyObject *values = PyDict_New();
    const char *name;
    float value;
    for (uint32_t i = 0; values != NULL && (name = roburoc4_robot_file_name(i)) != NULL; i++) {
        if (roburoc4_robot_file_get(&file, name, &value) == ROBUROC4_OK) {
            PyObject *number = PyFloat_FromDouble(shortest(value));
            if (number == NULL || PyDict_SetItemString(values, name, number) < 0) {
                Py_CLEAR(values);
            }
            Py_XDECREF(number);
        }
    }
    return values;
}

/* False, with an exception, if a value cannot be in a file. */
static int take_values(PyObject *values, roburoc4_robot_file *file) {
    PyObject *key, *number;
    Py_ssize_t at = 0;
    memset(file, 0, sizeof *file);
    if (!PyDict_Check(values)) {
        PyErr_SetString(PyExc_TypeError, "give a dict of numbers");
        return 0;
    }
    while (PyDict_Next(values, &at, &key, &number)) {
        const char *name;
        float value;
        if (take_text(key, &name) < 0 || take_float(number, &value) < 0) {
            return 0;
        }
        const roburoc4_result result = roburoc4_robot_file_set(file, name, value);
        if (result < 0) {
            PyErr_Format(PyExc_ValueError, "%s: %s", name,
                         result == ROBUROC4_ERR_INDEX ? "no robot file has this name"
                                                      : "not in its range");
            return 0;
        }
    }
    return 1;
}

PyObject *robot_file_write(PyObject *values) {
    roburoc4_robot_file file;
    char text[ROBUROC4_ROBOT_FILE_SIZE];
    if (!take_values(values, &file)) {
        return NULL;
    }
    const roburoc4_result length = roburoc4_robot_file_write(&file, text, sizeof text);
    return length < 0 ? raise_result(length) : PyUnicode_FromStringAndSize(text, length);
}

PyObject *robot_file_config(PyObject *values, roburoc4_config *config) {
    roburoc4_robot_file file;
    if (!take_values(values, &file)) {
        return NULL;
    }
    roburoc4_robot_file_config(&file, config);
    Py_RETURN_NONE;
}

PyObject *robot_file_sim_config(PyObject *values, roburoc4_sim_config *config) {
    roburoc4_robot_file file;
    if (!take_values(values, &file)) {
        return NULL;
    }
    roburoc4_sim_config_robot_file(config, &file);
    Py_RETURN_NONE;
}
