/* SPDX-License-Identifier: MIT
 *
 * How C looks in Python: a result below 0 raises, an output struct is returned as a typed record,
 * a datagram is bytes, and a pointer is a capsule that frees what it owns.
 */

/* ---- results ---- */
%typemap(out) roburoc4_result {
    if ($1 < 0) {
        (void)raise_result($1);
        SWIG_fail;
    }
    $result = PyLong_FromLong($1);
}
%typemap(out) PyObject * {
    $result = $1;
}
%typemap(in) PyObject * {
    $1 = $input;
}

/* ---- numbers ---- */
%typemap(in) double {
    if (take_double($input, &$1) < 0) {
        SWIG_fail;
    }
}
%typemap(in) float {
    if (take_float($input, &$1) < 0) {
        SWIG_fail;
    }
}
%define ROBUROC4_WHOLE(TYPE, LOW, HIGH)
%typemap(in) TYPE {
    long long whole;
    if (take_whole($input, LOW, HIGH, &whole) < 0) {
        SWIG_fail;
    }
    $1 = (TYPE)whole;
}
%enddef
ROBUROC4_WHOLE(uint16_t, 0, UINT16_MAX)
ROBUROC4_WHOLE(int16_t, INT16_MIN, INT16_MAX)
ROBUROC4_WHOLE(uint32_t, 0, UINT32_MAX)
ROBUROC4_WHOLE(int32_t, INT32_MIN, INT32_MAX)
ROBUROC4_WHOLE(enum gate_verdict, 0, GATE_VERDICTS - 1)
%typemap(in) uint64_t {
    if (take_uint64($input, &$1) < 0) {
        SWIG_fail;
    }
}

/* ---- texts ---- */
%typemap(in) const char * (const char *text) {
    if (take_text($input, &text) < 0) {
        SWIG_fail;
    }
    $1 = (char *)text;
}
/* A text or None. */
%typemap(in) const char *robot (const char *text), const char *record (const char *text) {
    text = NULL;
    if ($input != Py_None && take_text($input, &text) < 0) {
        SWIG_fail;
    }
    $1 = (char *)text;
}
%typemap(freearg) const char * "";

%typemap(out) float {
    $result = PyFloat_FromDouble(shortest($1));
}
%typemap(out) int64_t[ANY] {
    $result = PyTuple_New($1_dim0);
    for (int i = 0; i < $1_dim0; i++) {
        $result = put_item($result, i, PyLong_FromLongLong($1[i]));
    }
}

/* ---- output structs ---- */
%define ROBUROC4_OUTPUT(TYPE, PREPARE)
%typemap(in, numinputs=0) TYPE * (TYPE value) {
    memset(&value, 0, sizeof value);
    PREPARE;
    $1 = &value;
}
%typemap(argout) TYPE * {
    Py_XDECREF($result);
    $result = record_of(#TYPE, $1);
}
%enddef

ROBUROC4_OUTPUT(roburoc4_request, )
ROBUROC4_OUTPUT(roburoc4_differential_command, )
ROBUROC4_OUTPUT(roburoc4_directory_entry, )
ROBUROC4_OUTPUT(roburoc4_iocard_properties, )
ROBUROC4_OUTPUT(roburoc4_telemeter, )
ROBUROC4_OUTPUT(roburoc4_battery_properties, )
ROBUROC4_OUTPUT(roburoc4_localization_properties, )
ROBUROC4_OUTPUT(roburoc4_differential_properties, )
ROBUROC4_OUTPUT(roburoc4_facts, value.size = sizeof value)
ROBUROC4_OUTPUT(roburoc4_link, value.size = sizeof value)
ROBUROC4_OUTPUT(roburoc4_service_link, value.size = sizeof value)
ROBUROC4_OUTPUT(roburoc4_sim_state, value.size = sizeof value)

%typemap(in, numinputs=0) uint64_t *host_us (uint64_t value) {
    $1 = &value;
}
%typemap(argout) uint64_t *host_us {
    Py_XDECREF($result);
    $result = PyLong_FromUnsignedLongLong(*$1);
}

%typemap(in, numinputs=0) double *out (double value) {
    $1 = &value;
}
%typemap(argout) double *out {
    Py_XDECREF($result);
    $result = PyFloat_FromDouble(*$1);
}

/* ---- datagrams ---- */
%typemap(in) (const uint8_t *data, size_t size) (Py_buffer view = {0}) {
    if (PyObject_GetBuffer($input, &view, PyBUF_SIMPLE) < 0) {
        SWIG_fail;
    }
    $1 = view.buf;
    $2 = (size_t)view.len;
}
%typemap(freearg) (const uint8_t *data, size_t size) {
    PyBuffer_Release(&view$argnum);
}
/* (id, action, service, error, payload) */
%typemap(in, numinputs=0) roburoc4_answer * (roburoc4_answer value) {
    $1 = &value;
}
%typemap(argout) roburoc4_answer * {
    Py_XDECREF($result);
    $result = Py_BuildValue("(iiiiy#)", $1->id, $1->action, $1->service, $1->error, $1->payload,
                            (Py_ssize_t)$1->payload_size);
}
/* (analog, digital) */
%typemap(in, numinputs=0) roburoc4_channels * (roburoc4_channels value) {
    $1 = &value;
}
%typemap(argout) roburoc4_channels * {
    Py_XDECREF($result);
    $result = Py_BuildValue("(NN)", tuple_of_view($1->analog, $1->analog_count),
                            tuple_of_bits($1->digital, $1->digital_count));
}
%define ROBUROC4_LIST(TYPE, ITEM, AT)
%typemap(in, numinputs=0) TYPE * (TYPE list) {
    $1 = &list;
}
%typemap(argout) TYPE * {
    Py_XDECREF($result);
    $result = PyTuple_New($1->count);
    for (uint32_t i = 0; $result != NULL && i < $1->count; i++) {
        ITEM item;
        (void)AT($1, i, &item);
        $result = put_item($result, i, record_of(#ITEM, &item));
    }
}
%enddef
ROBUROC4_LIST(roburoc4_directory, roburoc4_directory_entry, roburoc4_directory_at)
ROBUROC4_LIST(roburoc4_notification, roburoc4_subscription, roburoc4_notification_at)
ROBUROC4_LIST(roburoc4_telemeter_list, roburoc4_telemeter, roburoc4_telemeter_at)
/* A text of unknown character set, or a telegram. */
%typemap(in, numinputs=0) (char *buffer, size_t capacity) (char space[64]),
    (uint8_t *buffer, size_t capacity) (uint8_t space[ROBUROC4_SIM_MAX_TRANSMIT]) {
    $1 = space;
    $2 = sizeof space;
}
%typemap(argout) (char *buffer, size_t capacity), (uint8_t *buffer, size_t capacity) {
    Py_XDECREF($result);
    $result = PyBytes_FromStringAndSize((const char *)$1, result);
}
/* A text of our own, after what else is returned. */
%typemap(in, numinputs=0) (char *reply, size_t capacity) (char space[ROBUROC4_SIM_REPLY_SIZE] = ""),
    (char *room, size_t capacity) (char space[300]) {
    $1 = space;
    $2 = sizeof space;
}
%typemap(argout) (char *reply, size_t capacity) {
    $result = Py_BuildValue("(Ns)", $result, $1);
}
%typemap(argout) (char *room, size_t capacity) {
    Py_XDECREF($result);
    $result = PyUnicode_FromString($1);
}
/* An address is text: "192.168.0.2:60000". Reading one does not wait. */
%typemap(in, numinputs=0) roburoc4_address * (roburoc4_address value) {
    $1 = &value;
}
%typemap(argout) roburoc4_address * {
    char text[ROBUROC4_ADDRESS_TEXT_SIZE] = "";
    (void)roburoc4_udp_address_text($1, text, sizeof text);
    Py_XDECREF($result);
    $result = PyUnicode_FromString(text);
}
%typemap(argout) const roburoc4_address * "";
%typemap(in) const roburoc4_address * (roburoc4_address value) {
    $1 = NULL;
    if ($input != Py_None) {
        const char *text = PyUnicode_AsUTF8AndSize($input, NULL);
        roburoc4_result error = text != NULL ? roburoc4_udp_resolve(text, 0, &value) : 0;
        if (error < 0) {
            (void)raise_result(error);
        }
        if (text == NULL || error < 0) {
            SWIG_fail;
        }
        $1 = &value;
    }
}
/* Texts, some of them empty. */
%typemap(in) (const char *const *texts, uint32_t text_count) (char *texts[256]) {
    Py_ssize_t count = PyList_Size($input), i;
    for (i = 0; i < count && i < 256; i++) {
        texts[i] = PyBytes_AsString(PyList_GetItem($input, i));
    }
    if (PyErr_Occurred() != NULL) {
        SWIG_fail;
    }
    $1 = texts;
    $2 = (uint32_t)i;
}

/* ---- pointers ---- */
%define ROBUROC4_CAPSULE(TYPE, FREE)
%{
static void capsule_free_##TYPE(PyObject *capsule) {
    FREE(PyCapsule_GetPointer(capsule, #TYPE));
}
%}
%typemap(in) TYPE *, const TYPE *, struct TYPE * {
    $1 = PyCapsule_GetPointer($input, #TYPE);
    if ($1 == NULL) {
        SWIG_fail;
    }
}
%typemap(out) TYPE * {
    if ($1 == NULL) {
        if (PyErr_Occurred() == NULL) {
            (void)PyErr_NoMemory();
        }
        SWIG_fail;
    }
    $result = PyCapsule_New($1, #TYPE, capsule_free_##TYPE);
}
%enddef
ROBUROC4_CAPSULE(connection, connection_destroy)
ROBUROC4_CAPSULE(simulation, simulation_destroy)

/* A struct that Python allocates by NAME(); its members are read and set by STRUCT_MEMBER_get() and
 * STRUCT_MEMBER_set(). */
%define ROBUROC4_NEW(TYPE, NAME, PREPARE)
ROBUROC4_CAPSULE(TYPE, free)
%inline %{
TYPE *NAME(void) {
    TYPE *value = calloc(1, sizeof *value);
    if (value != NULL) {
        PREPARE;
    }
    return value;
}
%}
%enddef
ROBUROC4_NEW(roburoc4_config, new_config, (void)roburoc4_config_init(value, sizeof *value))
ROBUROC4_NEW(roburoc4_sim_config, new_sim_config, (void)roburoc4_sim_config_init(value, sizeof *value))
ROBUROC4_NEW(roburoc4_sim_faults, new_sim_faults, value->size = sizeof *value)
ROBUROC4_NEW(roburoc4_move_options, new_move_options, (void)roburoc4_move_options_init(value, sizeof *value))
ROBUROC4_NEW(roburoc4_move, new_move, )
ROBUROC4_NEW(roburoc4_pump_reader, new_reader, )
ROBUROC4_NEW(gate, new_gate, )
ROBUROC4_NEW(gate_rules, new_gate_rules, )
ROBUROC4_NEW(gate_stall, new_stall, )

/* STRUCT_MEMBER_set() of an array, for one item. */
%define ROBUROC4_ARRAY(TYPE, MEMBER, ITEM)
%inline %{
roburoc4_result TYPE##_##MEMBER##_set(TYPE *settings, uint32_t index, ITEM value) {
    if (index >= sizeof settings->MEMBER / sizeof value) {
        return ROBUROC4_ERR_INDEX;
    }
    settings->MEMBER[index] = value;
    return ROBUROC4_OK;
}
%}
%enddef
ROBUROC4_ARRAY(roburoc4_config, period_ms, uint16_t)
ROBUROC4_ARRAY(roburoc4_config, role_index, int16_t)
ROBUROC4_ARRAY(roburoc4_sim_config, service_ids, uint16_t)
ROBUROC4_ARRAY(roburoc4_sim_config, service_types, uint16_t)
ROBUROC4_ARRAY(gate_rules, enabled, bool)

/* ---- the gate of bridges ---- */
/* A drive command: (sender, utime, arrived_utime, finite, zero) */
%typemap(in) const gate_command * (gate_command command = {GATE_DRIVE, 0, 0, 0, 0, 0, 0, 0}) {
    Py_ssize_t length;
    int finite, zero;
    if (!PyArg_ParseTuple($input, "s#LLpp", &command.sender, &length, &command.utime,
                          &command.arrived_utime, &finite, &zero)) {
        SWIG_fail;
    }
    command.sender_length = (size_t)length;
    command.finite = finite != 0;
    command.zero = zero != 0;
    $1 = &command;
}
/* Of a drive command: (verdict, utime) */
%typemap(in) const gate_rejection * (gate_rejection rejection = {0, GATE_DRIVE, 0, "stamp"}) {
    int verdict;
    if (!PyArg_ParseTuple($input, "iL", &verdict, &rejection.utime)) {
        SWIG_fail;
    }
    rejection.verdict = verdict;
    $1 = &rejection;
}
%typemap(in, numinputs=0) uint32_t *lease_us (uint32_t value = 0), uint64_t *since_us (uint64_t value = 0) {
    $1 = &value;
}
%typemap(argout) uint32_t *lease_us, uint64_t *since_us {
    $result = Py_BuildValue("(NK)", $result, (unsigned long long)*$1);
}
%typemap(in) gate_time {
    if (!PyArg_ParseTuple($input, "KL", &$1.us, &$1.utime)) {
        SWIG_fail;
    }
}
%typemap(out) gate_robot {
    $result = Py_BuildValue("NNi", PyBool_FromLong($1.ready), PyBool_FromLong($1.armed), (int)$1.arm_refusal);
}
%typemap(in) const gate_robot * (gate_robot robot) {
    int ready, armed;
    if (!PyArg_ParseTuple($input, "ppi", &ready, &armed, &robot.arm_refusal)) {
        SWIG_fail;
    }
    robot.ready = ready != 0;
    robot.armed = armed != 0;
    $1 = &robot;
}
%typemap(in) (const char *sender, size_t length) (Py_ssize_t length) {
    $1 = (char *)PyUnicode_AsUTF8AndSize($input, &length);
    if ($1 == NULL) {
        SWIG_fail;
    }
    $2 = (size_t)length;
}
%typemap(in, numinputs=0) size_t *length (size_t length) {
    length = 0;
    $1 = &length;
}
%typemap(argout) size_t *length {
    Py_XDECREF($result);
    $result = PyUnicode_DecodeUTF8(result != NULL ? result : "", (Py_ssize_t)*$1, "replace");
}

/* Where the headers take a client or a simulator, Python gives a connection or a simulation. It is
 * locked when all arguments are read, and the time after that. Only commands change a client. */
%typemap(out) roburoc4_result roburoc4_client_channel_find, roburoc4_result roburoc4_sim_control_find,
    roburoc4_result roburoc4_sim_set, roburoc4_result roburoc4_sim_panel, roburoc4_result cause {
    $result = PyLong_FromLong($1); /* the caller explains a result below 0 */
}
%typemap(in) roburoc4_client * (connection *handle), const roburoc4_client * (connection *handle) {
    handle = PyCapsule_GetPointer($input, "connection");
    if (handle == NULL) {
        SWIG_fail;
    }
}
%typemap(check) roburoc4_client * {
    $1 = connection_enter(handle$argnum, 1);
    if ($1 == NULL) {
        SWIG_fail;
    }
}
%typemap(check) const roburoc4_client * {
    $1 = connection_enter(handle$argnum, 0);
    if ($1 == NULL) {
        SWIG_fail;
    }
}
%typemap(in) roburoc4_pump * {
    connection *handle = PyCapsule_GetPointer($input, "connection");
    if (handle == NULL) {
        SWIG_fail;
    }
    $1 = connection_pump(handle);
}
%typemap(in, numinputs=0) uint64_t now_us {
    $1 = 0;
}
%typemap(check) uint64_t now_us {
    $1 = connection_entered_us();
}
%typemap(in) roburoc4_udp *, const roburoc4_udp * {
    connection *handle = PyCapsule_GetPointer($input, "connection");
    if (handle == NULL) {
        SWIG_fail;
    }
    $1 = connection_udp(handle);
}
%typemap(in) roburoc4_sim * (simulation *handle), const roburoc4_sim * (simulation *handle) {
    handle = PyCapsule_GetPointer($input, "simulation");
    if (handle == NULL) {
        SWIG_fail;
    }
}
%typemap(check) roburoc4_sim *, const roburoc4_sim * {
    $1 = simulation_enter(handle$argnum);
}
