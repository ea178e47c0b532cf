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

/* Services that send statuses: from ROBUROC4_SERVICE_IOCARD on. */
#define STATUS_SERVICES 5

/* ---- records, exceptions and numbers (records.c) ---- */

/* Learn the class of a C struct and its members: a list of (name in the struct, what Python has for
 * some of its numbers: a dict, or None). The first are those of statuses, in the order of services.
 * AttributeError for a member that the struct does not have. */
PyObject *register_record(const char *structure, PyObject *type, PyObject *members);
/* Learn the function that makes an exception of a result. */
PyObject *register_errors(PyObject *error_of);
/* Set the exception of a result below 0; always NULL. */
PyObject *raise_result(roburoc4_result result);

/* Numbers of any kind, NumPy's too, for an argument of C; -1 with an exception. 250.0 is whole. */
int take_double(PyObject *number, double *out);
int take_float(PyObject *number, float *out);
int take_whole(PyObject *number, long long low, long long high, long long *out);
int take_uint64(PyObject *number, uint64_t *out);
/* A text without NUL characters, which C would take as its end. */
int take_text(PyObject *text, const char **out);

/* Put an item into a new tuple; NULL, with both released, if either is NULL. */
PyObject *put_item(PyObject *tuple, Py_ssize_t i, PyObject *item);
PyObject *tuple_of_floats(const float *values, uint32_t count);
/* Of a view on a datagram. */
PyObject *tuple_of_view(const uint8_t *view, uint32_t count);
/* Channel 8 k + b is bit b of byte k. */
PyObject *tuple_of_bits(const uint8_t *blocks, uint32_t count);
/* The record of a C struct with this name. */
PyObject *record_of(const char *structure, const void *value);
/* The record of a service's status: of its struct, or of all its values, a tuple, which is taken
 * over (NULL: an exception is set already). */
PyObject *status_of_struct(uint32_t service, const void *value, uint64_t host_us, double utc_s);
PyObject *status_of_values(uint32_t service, PyObject *values);
/* The shortest decimal that is this number in 32 bits: 2.6, not 2.5999999046325684. */
double shortest(float value);

/* ---- statuses (statuses.c) ---- */

PyObject *record_of_sample(const roburoc4_sample *sample, double utc_s);
/* decode_status(data, layout): layout is None or the tuple of nine integers of Layout in
 * telegrams.py; None for what is not a status, or of another service. For METH_FASTCALL. */
PyObject *decode_status(PyObject *self, PyObject *const *arguments, Py_ssize_t count);

/* ---- a client, and who moves its datagrams (connection.c) ---- */

/*
 * A client with its pump, its socket, or in a simulation. All roburoc4_client_*()
 * calls are made on a connection, by connection_enter() and leave_call(), whatever moves it.
 */
typedef struct connection connection;

/* With an address, the pump's thread moves the datagrams; without one, whoever calls one of the
 * three functions below. capacity: samples that are kept. record: where to record, or None; see
 * roburoc4_recorder_options. Also OSError. */
connection *new_connection(const roburoc4_address *address, const roburoc4_config *config,
                           uint32_t capacity, const char *robot, const char *record,
                           uint64_t max_file_bytes, uint64_t max_file_s);
/* To a robot: the user calls connection_exchange(). */
roburoc4_result connection_open_socket(connection *c, const roburoc4_address *robot);
/* In a simulation (a capsule), which is kept as long as the connection. */
PyObject *connection_join(connection *c, PyObject *owner);
/* Without a network: the player of a recording passes it the time, from begin_us on, and
 * datagrams. */
void connection_begin(connection *c, uint64_t begin_us);
void connection_destroy(connection *c);

/* Lock the client for one call. NULL: the connection belongs to the parent of a fork, or a command
 * comes after the end; ClosedError is set. */
roburoc4_client *connection_enter(connection *c, int is_command);
/* The time for that call. */
uint64_t connection_entered_us(void);
/* All roburoc4_sim_*() calls are made on a simulation: lock it for one call. */
roburoc4_sim *simulation_enter(simulation *s);
/* After the call: send what a command has to send, and unlock. Does nothing without an
 * entered call. */
void leave_call(void);

roburoc4_pump *connection_pump(connection *c);
roburoc4_udp *connection_udp(connection *c);
uint64_t connection_now_us(const connection *c);
/* The record of the latest status of a service. Its utc_s, when the robot made it, is by the clock
 * that this machine shows now; in virtual time by the simulation's. */
PyObject *latest_status(connection *c, uint32_t service);
/* ROBUROC4_FAULT_*. */
uint32_t connection_fault(connection *c);

/* Complete the recording's file; does nothing without one. */
void connection_end_recording(connection *c);
/* None where nothing is recorded. */
PyObject *connection_recorder_state(connection *c);

/* Send what is due and receive what is there; return how many datagrams were received. */
PyObject *connection_exchange(connection *c);
/* At this time of the recording, pass the client a datagram (empty: none); return a list of what it
 * has to send now. */
PyObject *connection_play(connection *c, const uint8_t *data, size_t size, uint64_t at_us);
/* Some more samples, of the services in `mask`; None when all were read. */
PyObject *read_samples(connection *c, roburoc4_pump_reader *reader, uint32_t mask);
/* One step of a move, and the drive command that it proposes; ROBUROC4_MOVE_*. */
PyObject *move_step(connection *c, roburoc4_move *move);
/* roburoc4_client_drive() and True; or nothing and False, if the lease has ended and the client is
 * still armed. */
PyObject *renew_drive(connection *c, float linear_m_s, float angular_rad_s);

/* ---- robot files (robot_file.c) ---- */

/* The numbers of a robot file's text by name; ValueError names line and remedy. */
PyObject *robot_file_read(const char *text);
/* The text of a robot file; ValueError names what cannot be in it. */
PyObject *robot_file_write(PyObject *values);
/* Change what is known in a configuration. */
PyObject *robot_file_config(PyObject *values, roburoc4_config *config);
PyObject *robot_file_sim_config(PyObject *values, roburoc4_sim_config *config);

/* ---- simulated robots (simulator.c) ---- */

/* A simulated robot on an IPv4 address and port (0: any free one). Also OSError. */
simulation *new_simulation(const roburoc4_sim_config *config, const char *address, uint16_t port);
/* Make the configuration that of a member of the family. */
void draw_family(roburoc4_sim_config *config, uint64_t seed);
/* The answer of a factory-new RobuROC4 to a request; its length, or 0 if it does not answer. */
roburoc4_result usual_answer(const uint8_t *data, size_t size, uint8_t *buffer, size_t capacity);

#endif
