/* SPDX-License-Identifier: MIT
 *
 * roburoc4.i - the private module roburoc4._native: the functions of the headers that Python
 * needs, and native.h.
 */
%module(package="roburoc4") _native

%{
#include "native.h"
%}

/* Only what waits gives the interpreter's lock away. */
%nothread;
%thread roburoc4_pump_close;
%thread roburoc4_pump_wait_events;
%thread simulation_stop;

%include <stdint.i>
%include "typemaps.i"

/* Structs are passed whole. */
%nodefaultctor;
%nodefaultdtor;
%rename("$ignore", regextarget=1, fullname=1) ".*::.*";

/* Of no use from Python: decode_status() has the statuses, and native.h opens connections. */
%rename("$ignore", regextarget=1) "^roburoc4_(decode_(text|\\w+_status|status_header)$|encode_(?!answer$)|directory_at|notification_at|telemeter_at|floats|config_init|abi_version|move_(options_init|step)$)";
%rename("$ignore", regextarget=1) "^roburoc4_(client_(size|init|start|close|receive|poll_transmit|take_events|description|inputs|distances|battery|localization|differential))$";
%rename("$ignore", regextarget=1) "^roburoc4_udp_(?!fault_text$|now_us$)";
%rename("$ignore", regextarget=1) "^roburoc4_recorder_";
%rename("$ignore", regextarget=1) "^roburoc4_pump_(?!close|running|description|reader_init|take_events|wait_events).*";
%rename("$ignore", regextarget=1) "^roburoc4_(sim_(config_init|create|destroy|receive|advance|poll_transmit|next_deadline|panel)|world_.*)$";

#define ROBUROC4_API
#define ROBUROC4_SIM_API
/* A client or simulator is locked by a typemap before the call, and free again after it. */
%exception {
    $action
    connection_leave();
    simulation_leave();
}
%include "roburoc4_codec.h"
%include "roburoc4.h"
%include "roburoc4_move.h"
/* Its facts and commands are ours: the rest of a gate knows no client. */
%rename("$ignore", regextarget=1) "^(gate_init|gate_judge|gate_look_for_stall|gate_arrival|gate_is_incident|gate_stop|gate_hold|gate_count_taken|gate_clock_was_set|gate_was_stalled|gate_look_at_clock)$";
%include "gate_client.h"
%clear uint64_t now_us; /* from here on it is an argument */
%include "roburoc4_udp.h"
%include "roburoc4_sim.h"
%exception;
%include "roburoc4_pump.h"

%include "gate.h"

%ignore raise_result;
%rename("$ignore", regextarget=1) "^(record_|decode_status$|put_item$|tuple_of|connection_pump$|simulation_(on_port|lock|unlock|join|part|run)$|(connection|simulation)_(enter|leave|entered_us|destroy)$)";
%include "simulation.h"
%include "native.h"

/* The hottest call: without SWIG's unpacking of arguments. */
%init %{
    {
        static PyMethodDef methods[] = {
            {"decode_status", (PyCFunction)(void (*)(void))decode_status, METH_FASTCALL,
             "decode_status(data, layout)"},
            {NULL, NULL, 0, NULL}};
        if (PyModule_AddFunctions(m, methods) < 0) {
            SWIG_Error(SWIG_RuntimeError, "decode_status cannot be added");
        }
    }
%}
