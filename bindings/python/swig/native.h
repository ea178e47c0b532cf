/* SPDX-License-Identifier: MIT
 *
 * native.h - what the files of roburoc4._native share, and what roburoc4.i wraps beside the C
 * headers. Functions that return a pointer or PyObject * set a Python exception when it is NULL.
 */
#ifndef ROBUROC4_PY_NATIVE_H
#define ROBUROC4_PY_NATIVE_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "gate_client.h"
#include "reason.h"
#include "roburoc4_move.h"
#include "roburoc4_pump.h"
#include "simulation.h"

/* ---- records, settings and exceptions (records.c) ---- */

/* The classes of records.py that are made here; those of statuses in the order of the services.
 * _MADE of records.py has the same order. */
typedef enum record_kind {
    RECORD_IOCARD_STATUS,
    RECORD_TELEMETER_STATUS,
    RECORD_BATTERY_STATUS,
    RECORD_LOCALIZATION_STATUS,
    RECORD_DIFFERENTIAL_STATUS,
    RECORD_DIRECTORY_ENTRY,
    RECORD_SUBSCRIPTION,
    RECORD_IOCARD_PROPERTIES,
    RECORD_TELEMETER_PROPERTIES,
    RECORD_BATTERY_PROPERTIES,
    RECORD_LOCALIZATION_PROPERTIES,
    RECORD_DIFFERENTIAL_PROPERTIES,
    RECORD_REQUEST,
    RECORD_DIFFERENTIAL_COMMAND,
    RECORD_FACTS,
    RECORD_LINK,
    RECORD_SERVICE_LINK,
    RECORD_SIM_STATE,
    RECORD_KINDS
} record_kind;

/* Learn a class and its members: a list of (name in the C struct, what Python has for some of its
 * numbers: a dict, or None). For a class that is made by hand, `structure` is its name and those of
 * its fields. AttributeError for a member that the struct does not have, or for other fields. */
PyObject *register_record(uint32_t kind, PyObject *type, const char *structure, PyObject *members);
/* Learn the function that makes an exception of a result. */
PyObject *register_errors(PyObject *error_of);
/* Set the exception of a result below 0; always NULL. */
PyObject *raise_result(roburoc4_result result);

/* Numbers of any kind, NumPy's too, for an argument of C; -1 with an exception. 250.0 is whole. */
int take_double(PyObject *number, double *out);
int take_float(PyObject *number, float *out);
int take_whole(PyObject *number, long long low, long long high, long long *out);
int take_uint64(PyObject *number, uint64_t *out);

/* Put an item into a new tuple; NULL, with both released, if there is no tuple or no item. */
PyObject *put_item(PyObject *tuple, Py_ssize_t i, PyObject *item);
/* A record of these values, a tuple, which it takes over (NULL: an exception is set already). */
PyObject *record_new(record_kind kind, PyObject *values);
/* The record of a C struct of this kind. */
PyObject *record_of(record_kind kind, const void *value);
/* The record of a status: of its C struct, for the IO card roburoc4_inputs and for telemeters
 * roburoc4_distances. */
PyObject *record_of_status(record_kind kind, const void *status, uint64_t host_us, uint64_t utc_us);
/* The shortest decimal that is this number in 32 bits: 2.6, not 2.5999999046325684. */
double shortest(float value);
PyObject *tuple_of_floats(const float *values, uint32_t count);
/* Of a view on a datagram. */
PyObject *tuple_of_view(const uint8_t *view, uint32_t count);
/* Channel 8 k + b is bit b of byte k. */
PyObject *tuple_of_bits(const uint8_t *blocks, uint32_t count);
/* Change a member of settings, of an array the one at index; `settings` is the capsule of a struct.
 * AttributeError, OverflowError. */
PyObject *set_member(PyObject *settings, const char *name, PyObject *value, uint32_t index);

/* ---- telegrams of tools (decode.c) ---- */

/* decode_status(data, layout): layout is None or the tuple of nine integers of Layout in
 * telegrams.py; None for what is not a status, or of another service. For METH_FASTCALL. */
PyObject *decode_status(PyObject *self, PyObject *const *arguments, Py_ssize_t count);

/* ---- the simulator (simulator.c, beside simulation.h) ---- */

/* simulation_on_port(); OSError. */
simulation *new_host(const roburoc4_sim_config *config, const char *address, uint16_t port);
/* The answer of a factory-new RobuROC4 to a request; None if it does not answer. */
PyObject *usual_answer(PyObject *request);
/* All roburoc4_sim_*() calls are made on a simulation: lock it for one call, and give it back; the
 * latter does nothing where none is entered. */
roburoc4_sim *simulation_enter(simulation *s);
void simulation_leave(void);
/* (result, reply) of a line for the simulator's panel. */
PyObject *simulation_panel(simulation *s, const char *line);

/* ---- a client, and who moves its datagrams (connection.c) ---- */

/*
 * A client with its pump, its socket, or in the world of a simulation. All roburoc4_client_*()
 * calls are made on a connection, by connection_enter() and connection_leave(), whatever moves it.
 */
typedef struct connection connection;

/* To "HOST" or "HOST:PORT"; without a thread the user moves the datagrams. capacity: samples that
 * are kept. record: where to record, or None; see roburoc4_recorder_options. Also OSError. */
connection *connect_host(const char *host, int threaded, const roburoc4_config *config,
                         uint32_t capacity, const char *record, uint64_t max_file_bytes,
                         uint64_t max_file_s);
/* In the world of a simulation (a capsule), which lives as long as the connection. */
connection *connect_virtual(PyObject *simulation, const roburoc4_config *config, uint32_t capacity);
/* Without a network: who plays a recording gives it the time, from begin_us on, and datagrams. */
connection *connect_played(const roburoc4_config *config, uint32_t capacity, uint64_t begin_us);
void connection_destroy(connection *c);
/* "HOST" or "HOST:PORT" in numbers. */
PyObject *resolve_address(const char *host);
/* The robot's address in numbers; empty in virtual time. */
const char *connection_address(const connection *c);

/* Lock the client for one call. NULL: the connection belongs to the parent of a fork, or a command
 * comes after connection_close(); ClosedError is set. */
roburoc4_client *connection_enter(connection *c, int is_command);
/* The time for that call. */
uint64_t connection_entered_us(void);
/* After the call: send what a command has to send, and unlock. Does nothing where none is
 * entered. */
void connection_leave(void);

roburoc4_pump *connection_pump(connection *c);
uint64_t connection_now_us(const connection *c);
/* The record of the latest status of a service. Its utc_s, when the robot made it, is by the clock
 * that this machine shows now; in virtual time by the simulation's. */
PyObject *latest_status(connection *c, uint32_t service);
/* ROBUROC4_FAULT_*. */
uint32_t connection_fault(connection *c);

/* Complete the recording's file; does nothing without one. */
void connection_end_recording(connection *c);
/* The members of roburoc4_recorder_state, path first; None where nothing is recorded. */
PyObject *connection_recorder_state(connection *c);

/* Without a thread. */

/* Disarm, and send the first zero command where a speed was sent; no command is taken after it. The
 * others are sent as time passes, until the client is idle. */
PyObject *connection_disarm_for_good(connection *c);
/* Send what is due and receive what is there; how many datagrams came in. */
PyObject *connection_exchange(connection *c);
/* The socket, to watch for reading. */
long connection_fd(const connection *c);
void connection_close_socket(connection *c);

/* It is this time in the recording: give the client a datagram (None: none); a list of what it has
 * to send now. */
PyObject *connection_play(connection *c, PyObject *datagram, uint64_t at_us);

/* Some more samples, of the services in `mask`; None when all were read. */
PyObject *read_samples(connection *c, roburoc4_pump_reader *reader, uint32_t mask);
uint64_t reader_lost(const roburoc4_pump_reader *reader);

/* One step of a move, and the drive command that it proposes; ROBUROC4_MOVE_*. */
PyObject *move_step(connection *c, roburoc4_move *move);
/* (result, cause, distance_m, angle_rad, left_m, left_rad) */
PyObject *move_values(const roburoc4_move *move);

/* ---- the gate of bridges, for drive commands (command_gate.c) ---- */

/* A gate of gate.h, and the watch for stalls of the thread that uses it. */
typedef struct command_gate command_gate;

command_gate *new_command_gate(int enabled, uint32_t lease_us, uint32_t max_age_us, gate_time now);
/* (verdict, lease_us) of a command that is (sender, utime, arrived_utime, finite, zero). */
PyObject *judge_drive(command_gate *g, PyObject *command, const gate_robot *robot, gate_time now);
/* Notice a stall, and hold for as long; (stalled, step of the clock in microseconds). */
PyObject *look_for_trouble(command_gate *g, uint32_t asked_us, gate_time now);
/* When a command came at the earliest that seems to come at this time. */
int64_t command_arrival(const command_gate *g, int64_t utime);
/* (why, whether it begins an incident) of a rejection, for a log. */
PyObject *explain_rejection(command_gate *g, enum gate_verdict verdict, const char *sender,
                            size_t length, int64_t utime, gate_time now);
/* How many commands were taken, and rejected by verdict. */
PyObject *command_counts(const command_gate *g);

#endif
