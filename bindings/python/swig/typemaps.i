/* SPDX-License-Identifier: MIT
 *
 * How the header's idioms look in Python: a result below 0 raises, an output struct is returned as
 * a typed record, a datagram is bytes.
 */

/* ---- results ---- */
%typemap(out) roburoc4_result {
    if ($1 < 0) {
        (void)raise_result($1);
        SWIG_fail;
    }
    $result = PyLong_FromLong($1);
}
/* These tell by their result what became of a datagram. */
%typemap(out) roburoc4_result roburoc4_client_receive, roburoc4_result raw {
    $result = PyLong_FromLong($1);
}
%typemap(out) PyObject * {
    $result = $1;
}
%typemap(in) PyObject * {
    $1 = $input;
}

/* ---- output structs ---- */
%define ROBUROC4_OUTPUT(TYPE, PREPARE, RECORD)
%typemap(in, numinputs=0) TYPE *out (TYPE value), TYPE *facts (TYPE value), TYPE *link (TYPE value),
    TYPE *state (TYPE value) {
    memset(&value, 0, sizeof value);
    PREPARE;
    $1 = &value;
}
%typemap(argout) TYPE *out, TYPE *facts, TYPE *link, TYPE *state {
    Py_XDECREF($result);
    $result = RECORD;
}
%enddef

%define ROBUROC4_STATUS(TYPE, RECORD)
%typemap(in, numinputs=0) (TYPE *out, uint64_t *host_us) (TYPE value, uint64_t host) {
    $1 = &value;
    $2 = &host;
}
%typemap(argout) (TYPE *out, uint64_t *host_us) {
    Py_XDECREF($result);
    $result = RECORD($1, *$2);
}
%enddef

ROBUROC4_STATUS(roburoc4_inputs, record_of_inputs)
ROBUROC4_STATUS(roburoc4_distances, record_of_distances)
ROBUROC4_STATUS(roburoc4_battery_status, record_of_battery)
ROBUROC4_STATUS(roburoc4_localization_status, record_of_localization)
ROBUROC4_STATUS(roburoc4_differential_status, record_of_differential)

ROBUROC4_OUTPUT(roburoc4_directory_entry, (void)0, record_of_directory_entry($1))
ROBUROC4_OUTPUT(roburoc4_iocard_properties, (void)0, record_of_iocard_properties($1))
ROBUROC4_OUTPUT(roburoc4_telemeter, (void)0, record_of_telemeter($1))
ROBUROC4_OUTPUT(roburoc4_battery_properties, (void)0, record_of_battery_properties($1))
ROBUROC4_OUTPUT(roburoc4_localization_properties, (void)0, record_of_localization_properties($1))
ROBUROC4_OUTPUT(roburoc4_differential_properties, (void)0, record_of_differential_properties($1))
ROBUROC4_OUTPUT(roburoc4_facts, value.size = sizeof value, record_of_facts($1))
ROBUROC4_OUTPUT(roburoc4_link, value.size = sizeof value, record_of_link($1))
ROBUROC4_OUTPUT(roburoc4_service_link, value.size = sizeof value, record_of_service_link($1))
ROBUROC4_OUTPUT(roburoc4_sim_state, value.size = sizeof value, record_of_sim_state($1))

%typemap(in, numinputs=0) uint64_t *host_us (uint64_t value) {
    $1 = &value;
}
%typemap(argout) uint64_t *host_us {
    Py_XDECREF($result);
    $result = PyLong_FromUnsignedLongLong(*$1);
}

/* ---- datagrams ---- */
%typemap(in) (const uint8_t *datagram, size_t size) (Py_buffer view, int held),
    (const uint8_t *data, size_t size) (Py_buffer view, int held) {
    held = PyObject_GetBuffer($input, &view, PyBUF_SIMPLE) == 0;
    if (!held) {
        SWIG_fail;
    }
    $1 = ($1_ltype)view.buf;
    $2 = (size_t)view.len;
}
%typemap(freearg) (const uint8_t *datagram, size_t size), (const uint8_t *data, size_t size) {
    if (held$argnum) {
        PyBuffer_Release(&view$argnum);
    }
}
%typemap(arginit) (const uint8_t *datagram, size_t size), (const uint8_t *data, size_t size) {
    held$argnum = 0;
}
/* The datagram, or None where there is none. */
%typemap(in, numinputs=0) (uint8_t *buffer, size_t capacity) (uint8_t space[2048]) {
    $1 = space;
    $2 = sizeof space;
}
%typemap(argout) (uint8_t *buffer, size_t capacity) {
    Py_XDECREF($result);
    if (result > 0) {
        $result = PyBytes_FromStringAndSize((const char *)$1, result);
    } else {
        $result = Py_None;
        Py_INCREF(Py_None);
    }
}
/* The peer and the datagram, or None. */
%typemap(in, numinputs=0) (uint64_t *peer, uint8_t *buffer, size_t capacity)
    (uint64_t peer, uint8_t space[2048]) {
    $1 = &peer;
    $2 = space;
    $3 = sizeof space;
}
%typemap(argout) (uint64_t *peer, uint8_t *buffer, size_t capacity) {
    Py_XDECREF($result);
    if (result > 0) {
        $result = Py_BuildValue("(Ky#)", (unsigned long long)*$1, (const char *)$2,
                                (Py_ssize_t)result);
    } else {
        $result = Py_None;
        Py_INCREF(Py_None);
    }
}
/* A text of unknown character set. */
%typemap(in, numinputs=0) (char *buffer, size_t capacity) (char space[2048]) {
    $1 = space;
    $2 = sizeof space;
}
%typemap(argout) (char *buffer, size_t capacity) {
    Py_XDECREF($result);
    $result = PyBytes_FromStringAndSize($1, result);
}

/* ---- why something was not made ---- */
%typemap(in, numinputs=0) roburoc4_result *result (roburoc4_result why) {
    why = 0;
    $1 = &why;
}
%typemap(argout) roburoc4_result *result {
    if (*$1 < 0) {
        Py_CLEAR($result);
        (void)raise_result(*$1);
        SWIG_fail;
    }
}
%typemap(in, numinputs=0) int *error (int why) {
    why = 0;
    $1 = &why;
}
%typemap(argout) int *error {
    if (*$1 != 0) {
        Py_CLEAR($result);
        errno = *$1;
        (void)PyErr_SetFromErrno(PyExc_OSError);
        SWIG_fail;
    }
}

/* ---- pointers ---- */
%typemap(check) SWIGTYPE *NOT_NULL {
    if ($1 == NULL) {
        PyErr_SetString(PyExc_ValueError, "$symname: an object is missing");
        SWIG_fail;
    }
}
%apply SWIGTYPE *NOT_NULL {
    roburoc4_address *, roburoc4_config *config, roburoc4_client *, roburoc4_udp *,
    roburoc4_pump *, roburoc4_pump_reader *, roburoc4_sim *, roburoc4_sim_config *,
    roburoc4_sim_faults *, roburoc4_sim_channel *, sim_host *
}
