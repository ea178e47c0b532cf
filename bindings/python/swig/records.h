/* SPDX-License-Identifier: MIT
 *
 * records.h - C structs to the typed records of roburoc4/records.py, each made in one call.
 */
#ifndef ROBUROC4_PY_RECORDS_H
#define ROBUROC4_PY_RECORDS_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "roburoc4_pump.h"
#include "roburoc4_sim.h"

/* The classes of records.py that are made here, in the order of record_names. */
typedef enum record_kind {
    RECORD_IOCARD_STATUS,
    RECORD_TELEMETER_STATUS,
    RECORD_BATTERY_STATUS,
    RECORD_LOCALIZATION_STATUS,
    RECORD_DIFFERENTIAL_STATUS,
    RECORD_UNKNOWN_STATUS,
    RECORD_ANSWER,
    RECORD_DIRECTORY_ENTRY,
    RECORD_SUBSCRIPTION,
    RECORD_IOCARD_PROPERTIES,
    RECORD_TELEMETER_PROPERTIES,
    RECORD_BATTERY_PROPERTIES,
    RECORD_LOCALIZATION_PROPERTIES,
    RECORD_DIFFERENTIAL_PROPERTIES,
    RECORD_REQUEST,
    RECORD_IOCARD_COMMAND,
    RECORD_DIFFERENTIAL_COMMAND,
    RECORD_UNKNOWN_COMMAND,
    RECORD_FACTS,
    RECORD_LINK,
    RECORD_SERVICE_LINK,
    RECORD_SIM_STATE,
    RECORD_KINDS
} record_kind;

/* Learn the classes: a dict of their names, with BatteryState and LocalizationFlag too. */
PyObject *record_register(PyObject *classes);
/* A record of these values, a tuple, which it takes over (NULL: an error is set already). */
PyObject *record_new(record_kind kind, PyObject *values);
/* Members of the enumerations; plain integers for values that the manual does not have. */
PyObject *record_battery_state(uint8_t state);
PyObject *record_localization_flags(uint32_t flags);

PyObject *record_of_inputs(const roburoc4_inputs *inputs, uint64_t host_us);
PyObject *record_of_distances(const roburoc4_distances *distances, uint64_t host_us);
PyObject *record_of_battery(const roburoc4_battery_status *status, uint64_t host_us);
PyObject *record_of_localization(const roburoc4_localization_status *status, uint64_t host_us);
PyObject *record_of_differential(const roburoc4_differential_status *status, uint64_t host_us);

PyObject *record_of_iocard_properties(const roburoc4_iocard_properties *properties);
PyObject *record_of_telemeter(const roburoc4_telemeter *telemeter);
PyObject *record_of_battery_properties(const roburoc4_battery_properties *properties);
PyObject *record_of_localization_properties(const roburoc4_localization_properties *properties);
PyObject *record_of_differential_properties(const roburoc4_differential_properties *properties);
PyObject *record_of_directory_entry(const roburoc4_directory_entry *entry);
PyObject *record_of_facts(const roburoc4_facts *facts);
PyObject *record_of_link(const roburoc4_link *link);
PyObject *record_of_service_link(const roburoc4_service_link *link);
PyObject *record_of_sim_state(const roburoc4_sim_state *state);

#endif
