/* SPDX-License-Identifier: MIT
 *
 * The typed records. tuple.__new__ is called directly: the __new__ that a NamedTuple has costs
 * more than all of the rest.
 */
#include "records.h"

#include <string.h>

static const char *const record_names[RECORD_KINDS] = {"IoCardStatus",
                                                       "TelemeterStatus",
                                                       "BatteryStatus",
                                                       "LocalizationStatus",
                                                       "DifferentialStatus",
                                                       "UnknownStatus",
                                                       "Answer",
                                                       "DirectoryEntry",
                                                       "Subscription",
                                                       "IoCardProperties",
                                                       "TelemeterProperties",
                                                       "BatteryProperties",
                                                       "LocalizationProperties",
                                                       "DifferentialProperties",
                                                       "Request",
                                                       "IoCardCommand",
                                                       "DifferentialCommand",
                                                       "UnknownCommand",
                                                       "Facts",
                                                       "Link",
                                                       "ServiceLink",
                                                       "SimState"};

#define BATTERY_STATES 4
#define LOCALIZATION_FLAGS 128

static PyObject *types[RECORD_KINDS];
static PyObject *battery_states[BATTERY_STATES];
static PyObject *localization_flag_type;
static PyObject *localization_flags[LOCALIZATION_FLAGS];
static newfunc tuple_new;

static int learn(PyObject *classes, const char *name, PyObject **place) {
    PyObject *found = PyDict_GetItemString(classes, name);
    if (found == NULL) {
        PyErr_Format(PyExc_KeyError, "%s", name);
        return -1;
    }
    Py_XDECREF(*place);
    Py_INCREF(found);
    *place = found;
    return 0;
}

PyObject *record_register(PyObject *classes) {
    PyObject *battery_state_type = NULL;
    int kind;
    void *slot = PyType_GetSlot(&PyTuple_Type, Py_tp_new);
    memcpy(&tuple_new, &slot, sizeof tuple_new); /* C has no cast for it */
    for (kind = 0; kind < RECORD_KINDS; kind++) {
        if (learn(classes, record_names[kind], &types[kind]) < 0) {
            return NULL;
        }
    }
    if (learn(classes, "LocalizationFlag", &localization_flag_type) < 0 ||
        learn(classes, "BatteryState", &battery_state_type) < 0) {
        return NULL;
    }
    for (kind = 0; kind < BATTERY_STATES; kind++) {
        battery_states[kind] = PyObject_CallFunction(battery_state_type, "i", kind);
        if (battery_states[kind] == NULL) {
            break;
        }
    }
    Py_DECREF(battery_state_type);
    if (PyErr_Occurred() != NULL) {
        return NULL;
    }
    Py_RETURN_NONE;
}

PyObject *record_new(record_kind kind, PyObject *values) {
    PyObject *arguments, *record;
    if (values == NULL) {
        return NULL;
    }
    arguments = PyTuple_Pack(1, values);
    Py_DECREF(values);
    if (arguments == NULL) {
        return NULL;
    }
    record = tuple_new((PyTypeObject *)types[kind], arguments, NULL);
    Py_DECREF(arguments);
    return record;
}

PyObject *record_battery_state(uint8_t state) {
    if (state >= BATTERY_STATES) {
        return PyLong_FromLong(state);
    }
    Py_INCREF(battery_states[state]);
    return battery_states[state];
}

PyObject *record_localization_flags(uint32_t flags) {
    if (flags >= LOCALIZATION_FLAGS) {
        return PyLong_FromUnsignedLong(flags);
    }
    if (localization_flags[flags] == NULL) {
        localization_flags[flags] = PyObject_CallFunction(localization_flag_type, "I", flags);
    }
    Py_XINCREF(localization_flags[flags]);
    return localization_flags[flags];
}

/* -------------------------------------------------------------------------------- statuses --- */

static PyObject *floats(const float *values, uint32_t count) {
    PyObject *tuple = PyTuple_New(count);
    uint32_t i;
    for (i = 0; tuple != NULL && i < count; i++) {
        PyObject *value = PyFloat_FromDouble(values[i]);
        if (value == NULL) {
            Py_CLEAR(tuple);
        } else {
            (void)PyTuple_SetItem(tuple, i, value);
        }
    }
    return tuple;
}

static PyObject *bits(uint64_t values, uint32_t count) {
    PyObject *tuple = PyTuple_New(count);
    uint32_t i;
    for (i = 0; tuple != NULL && i < count; i++) {
        (void)PyTuple_SetItem(tuple, i, PyBool_FromLong((long)(values >> i & 1)));
    }
    return tuple;
}

PyObject *record_of_inputs(const roburoc4_inputs *inputs, uint64_t host_us) {
    return record_new(RECORD_IOCARD_STATUS,
                      Py_BuildValue("(KNNK)", (unsigned long long)inputs->robot_cycles,
                                    floats(inputs->analog, inputs->analog_count),
                                    bits(inputs->digital, inputs->digital_count),
                                    (unsigned long long)host_us));
}

PyObject *record_of_distances(const roburoc4_distances *distances, uint64_t host_us) {
    return record_new(RECORD_TELEMETER_STATUS,
                      Py_BuildValue("(KNK)", (unsigned long long)distances->robot_cycles,
                                    floats(distances->distance_m, distances->count),
                                    (unsigned long long)host_us));
}

PyObject *record_of_battery(const roburoc4_battery_status *status, uint64_t host_us) {
    return record_new(RECORD_BATTERY_STATUS,
                      Py_BuildValue("(KNiK)", (unsigned long long)status->robot_cycles,
                                    record_battery_state(status->state),
                                    (int)status->remaining_percent, (unsigned long long)host_us));
}

PyObject *record_of_localization(const roburoc4_localization_status *status, uint64_t host_us) {
    return record_new(RECORD_LOCALIZATION_STATUS,
                      Py_BuildValue("(KdddNK)", (unsigned long long)status->robot_cycles,
                                    status->x_m, status->y_m, status->theta_rad,
                                    record_localization_flags(status->flags),
                                    (unsigned long long)host_us));
}

PyObject *record_of_differential(const roburoc4_differential_status *status, uint64_t host_us) {
    return record_new(
        RECORD_DIFFERENTIAL_STATUS,
        Py_BuildValue("(KddddK)", (unsigned long long)status->robot_cycles,
                      (double)status->target_linear_m_s, (double)status->current_linear_m_s,
                      (double)status->target_angular_rad_s, (double)status->current_angular_rad_s,
                      (unsigned long long)host_us));
}

/* ------------------------------------------------------------------------------ properties --- */

PyObject *record_of_directory_entry(const roburoc4_directory_entry *entry) {
    return record_new(RECORD_DIRECTORY_ENTRY, Py_BuildValue("(ii)", entry->type, entry->id));
}

PyObject *record_of_iocard_properties(const roburoc4_iocard_properties *p) {
    return record_new(RECORD_IOCARD_PROPERTIES,
                      Py_BuildValue("(iiii)", p->analog_inputs, p->analog_outputs,
                                    p->digital_inputs, p->digital_outputs));
}

PyObject *record_of_telemeter(const roburoc4_telemeter *t) {
    return record_new(RECORD_TELEMETER_PROPERTIES,
                      Py_BuildValue("(ddddddd)", (double)t->x_m, (double)t->y_m,
                                    (double)t->theta_rad, (double)t->field_of_view_rad,
                                    (double)t->min_distance_m, (double)t->max_distance_m,
                                    (double)t->distance_m));
}

PyObject *record_of_battery_properties(const roburoc4_battery_properties *p) {
    return record_new(RECORD_BATTERY_PROPERTIES,
                      Py_BuildValue("(ddi)", (double)p->nominal_voltage_v, (double)p->capacity_ah,
                                    (int)p->minimum_percent));
}

PyObject *record_of_localization_properties(const roburoc4_localization_properties *p) {
    return record_new(
        RECORD_LOCALIZATION_PROPERTIES,
        Py_BuildValue("(dddN)", p->x_m, p->y_m, p->theta_rad, record_localization_flags(p->flags)));
}

PyObject *record_of_differential_properties(const roburoc4_differential_properties *p) {
    return record_new(RECORD_DIFFERENTIAL_PROPERTIES,
                      Py_BuildValue("(ddddddddddddd)", (double)p->target_linear_m_s,
                                    (double)p->target_angular_rad_s, (double)p->current_linear_m_s,
                                    (double)p->current_angular_rad_s, (double)p->max_linear_m_s,
                                    (double)p->min_linear_m_s, (double)p->max_angular_rad_s,
                                    (double)p->min_angular_rad_s, (double)p->max_linear_m_s2,
                                    (double)p->min_linear_m_s2, (double)p->max_angular_rad_s2,
                                    (double)p->min_angular_rad_s2, (double)p->width_m));
}

/* ------------------------------------------------------------------------ facts and figures --- */

static PyObject *yes(int value) {
    return PyBool_FromLong(value);
}

PyObject *record_of_facts(const roburoc4_facts *f) {
    return record_new(RECORD_FACTS,
                      Py_BuildValue("(INNNNNNNNNNNNiiiIdd)", f->state, yes(f->armed),
                                    yes(f->driving), yes(f->stopping), yes(f->override_known),
                                    yes(f->overridden), yes(f->other_commander), yes(f->inhibited),
                                    yes(f->fixed_id), yes(f->front_bumper), yes(f->rear_bumper),
                                    yes(f->descriptions_done), yes(f->battery_low), f->disarm_cause,
                                    f->arm_refusal, f->relocalize_result, f->lease_left_us,
                                    (double)f->linear_m_s, (double)f->angular_rad_s));
}

PyObject *record_of_link(const roburoc4_link *l) {
    return record_new(RECORD_LINK,
                      Py_BuildValue("(IIIIId)", l->round_trip_us, l->round_trip_min_us,
                                    l->silence_us, l->received, l->lost, (double)l->loss));
}

PyObject *record_of_service_link(const roburoc4_service_link *l) {
    PyObject *age = Py_None;
    if (l->age_us != UINT32_MAX) {
        age = PyLong_FromUnsignedLong(l->age_us);
    } else {
        Py_INCREF(age);
    }
    return record_new(RECORD_SERVICE_LINK,
                      Py_BuildValue("(NIIIIIINd)", yes(l->subscribed != 0), l->received, l->lost,
                                    l->late, l->duplicates, l->period_us, l->jitter_us, age,
                                    (double)l->loss));
}

PyObject *record_of_sim_state(const roburoc4_sim_state *s) {
    PyObject *motion = Py_BuildValue(
        "(NKKddddddddddddddK(dd)dd)", record_battery_state((uint8_t)s->battery_state),
        (unsigned long long)s->now_us, (unsigned long long)s->cycles, s->true_x_m, s->true_y_m,
        s->true_theta_rad, s->true_linear_m_s, s->true_angular_rad_s, s->odometry_x_m,
        s->odometry_y_m, s->odometry_theta_rad, s->wheel_linear_m_s, s->wheel_angular_rad_s,
        s->target_linear_m_s, s->target_angular_rad_s, s->last_linear_m_s, s->last_angular_rad_s,
        (unsigned long long)s->last_command_us, (double)s->telemeters_m[0],
        (double)s->telemeters_m[1], (double)s->battery_percent, (double)s->battery_v);
    PyObject *rest = Py_BuildValue(
        "(NNNNNNNNNNIIIIIIIIIII)", yes(s->powered), yes(s->motors_enabled), yes(s->estop_local),
        yes(s->estop_remote), yes(s->brakes_released), yes(s->charger), yes(s->overridden),
        yes(s->watchdog_bitten), yes(s->bumper_front), yes(s->bumper_rear), s->reboots, s->requests,
        s->errors, s->speed_commands, s->nonzero_speed_commands, s->refused_speed_commands,
        s->io_commands, s->ignored, s->dropped, s->peers, s->subscriptions);
    PyObject *both = NULL;
    if (motion != NULL && rest != NULL) {
        both = PySequence_Concat(motion, rest);
    }
    Py_XDECREF(motion);
    Py_XDECREF(rest);
    return record_new(RECORD_SIM_STATE, both);
}
