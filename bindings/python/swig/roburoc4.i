/* SPDX-License-Identifier: MIT
 *
 * roburoc4.i - the private module roburoc4._native: the headers as they are, functions only, and
 * the few helpers that hand out memory or read many things in one call.
 */
%module(package="roburoc4") _native

%{
#include <errno.h>
#include <string.h>

#include "batch.h"
#include "decode.h"
#include "helpers.h"
#include "raise.h"
#include "records.h"
#include "roburoc4_pump.h"
#include "roburoc4_sim.h"
#include "samples.h"
#include "host.h"
%}

/* Only what waits gives the interpreter away. */
%nothread;
%thread roburoc4_udp_resolve;
%thread roburoc4_udp_wait;
%thread roburoc4_pump_close;
%thread roburoc4_pump_wait_events;
%thread sim_host_stop;

%include <stdint.i>
%include "typemaps.i"

/* Structs are passed whole, but for the settings. */
%nodefaultctor;
%nodefaultdtor;
%rename("$ignore", regextarget=1, fullname=1) "^(?!roburoc4_config::|roburoc4_sim_config::|roburoc4_sim_faults::).*::.*";
%immutable roburoc4_config::size;
%immutable roburoc4_sim_config::size;

/* Arrays; see the setters below. */
%ignore roburoc4_config::period_ms;
%ignore roburoc4_config::role_index;
%ignore roburoc4_sim_config::service_ids;
%ignore roburoc4_sim_config::service_types;

/* Of no use from Python: the codec is behind decode(), encoders have arrays. */
%ignore roburoc4_client_description;
%ignore roburoc4_udp_receive_one;
%ignore roburoc4_pump_read_samples;
%ignore roburoc4_pump_wait_samples;
%ignore roburoc4_sim_config_read;
%ignore roburoc4_pump_destroy;
%ignore roburoc4_sim_destroy;
%ignore roburoc4_sim_channel_destroy;
%ignore roburoc4_sim_panel;
%ignore roburoc4_sim_analog_output;
%rename("$ignore", regextarget=1) "^roburoc4_(decode_|encode_|directory_at|notification_at|telemeter_at|analog_values|digital_values|telemeter_distances)";

#define ROBUROC4_API
#define ROBUROC4_SIM_API
%include "roburoc4_codec.h"
%include "roburoc4.h"
%include "roburoc4_udp.h"
%include "roburoc4_pump.h"
%include "roburoc4_sim.h"

%ignore sim_host_destroy;
%ignore sim_host_lock;
%ignore sim_host_unlock;
%include "host.h"

PyObject *record_register(PyObject *classes);
PyObject *raise_register(PyObject *make);
PyObject *samples_read(roburoc4_pump *pump, roburoc4_pump_reader *reader, uint32_t mask);
PyObject *batch_decode(PyObject *source, size_t size, uint32_t service, uint32_t id,
                       uint32_t analog, uint32_t digital, PyObject *rows, size_t row);
%include "helpers.h"

/* The hottest call: without SWIG's unpacking of arguments. */
%init %{
    {
        static PyMethodDef methods[] = {
            {"decode", (PyCFunction)(void (*)(void))decode_telegram, METH_FASTCALL,
             "decode(data, layout, from_client)"},
            {NULL, NULL, 0, NULL}};
        if (PyModule_AddFunctions(m, methods) < 0) {
            SWIG_Error(SWIG_RuntimeError, "decode cannot be added");
        }
    }
%}
