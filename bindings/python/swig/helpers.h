/* SPDX-License-Identifier: MIT
 *
 * helpers.h - what the headers leave to their caller and Python cannot do: memory for structs,
 * arrays inside of settings, and calls that give several things at once.
 */
#ifndef ROBUROC4_PY_HELPERS_H
#define ROBUROC4_PY_HELPERS_H

#include <Python.h>

#include "roburoc4_pump.h"
#include "roburoc4_sim.h"
#include "host.h"

/* Structs, zeroed or with their defaults; NULL without memory. Give each to own_memory(). */
roburoc4_address *new_address(void);
roburoc4_config *new_config(void);
roburoc4_client *new_client(void);
roburoc4_udp *new_udp(void);
roburoc4_pump_reader *new_reader(void);
roburoc4_sim_config *new_sim_config(void);
roburoc4_sim_faults *new_faults(void);

/* Owners: objects that give back what they own when they go. Whoever keeps a pointer keeps its
 * owner too: then it is valid in finalizers and weak reference callbacks of any order. */
PyObject *own_memory(void *memory);
PyObject *own_pump(roburoc4_pump *pump);
PyObject *own_sim(roburoc4_sim *sim);
PyObject *own_channel(roburoc4_sim_channel *channel);
PyObject *own_host(sim_host *host);

/* 0, or ROBUROC4_ERR_ARGUMENT for a service or role that is none. */
roburoc4_result config_set_period(roburoc4_config *config, uint32_t service, uint16_t period_ms);
roburoc4_result config_set_role(roburoc4_config *config, uint32_t role, int16_t index);
roburoc4_result sim_config_set_id(roburoc4_sim_config *config, uint32_t service, uint16_t id);

/* Samples that a reader came too late for. */
uint64_t reader_lost(const roburoc4_pump_reader *reader);
/* Take one datagram, if one is there: (ROBUROC4_UDP_* , the datagram as bytes). */
PyObject *udp_receive(roburoc4_udp *udp, roburoc4_client *client);
/* (io_type, index, text as bytes) of a datagram that was just received; None if it is no text. */
PyObject *client_describe(const roburoc4_client *client, PyObject *datagram);
/* function(*arguments), a function of this module, with the host's lock, which is free again
 * whatever a signal handler raises. */
PyObject *sim_host_call(sim_host *host, PyObject *function, PyObject *arguments);
/* (result, reply) of a line for the simulator's panel. */
PyObject *sim_panel(roburoc4_sim *sim, const char *line);
/* The program roburoc4-sim with these arguments (a list of str); its exit status. */
PyObject *run_sim(PyObject *arguments);

#endif
