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
%thread roburoc4_udp_resolve;
%thread roburoc4_pump_wait_events;
%thread simulation_stop;

%include <stdint.i>
%include "typemaps.i"

/* Most structs are passed whole. */
%nodefaultctor;
%nodefaultdtor;
%rename("$ignore", regextarget=1, fullname=1) "^(?!(roburoc4_((sim_)?config|sim_faults|move_options|move|pump_reader)|gate(_rules)?)::).*::.*";
%rename("$ignore", regextarget=1, fullname=1) ".*::(size|private_.*|period_ms|role_index|service_(ids|types)|enabled|reserved)";
%rename("$ignore", regextarget=1, fullname=1) "^gate::(?!taken|rejected)";
%immutable gate::taken;
%immutable gate::rejected;

/* Of no use from Python: decode_status() has the statuses, and native.h opens connections. */
%rename("$ignore", regextarget=1) "^roburoc4_(decode_(text|\\w+_status|status_header)$|encode_(?!answer$)|directory_at|notification_at|telemeter_at|floats|config_init|abi_version|move_(options_init|step)$)";
%rename("$ignore", regextarget=1) "^roburoc4_(client_(size|init|start|receive|poll_transmit|take_events|description|inputs|distances|battery|localization|differential))$";
%rename("$ignore", regextarget=1) "^roburoc4_udp_(?!fault_text$|now_us$|resolve$|close$|fd$)";
%rename("$ignore", regextarget=1) "^roburoc4_recorder_";
%rename("$ignore", regextarget=1) "^roburoc4_(sample_latest$|pump_(?!close|running|description|reader|take_events|wait_events).*)";
%rename("$ignore", regextarget=1) "^roburoc4_(sim_(config_(init|family|robot_file)|create|destroy|receive|advance|poll_transmit|next_deadline)|world_.*)$";

#define ROBUROC4_API
#define ROBUROC4_SIM_API
/* A client or simulator is locked by a typemap before the call, and free again after it. */
%exception {
    $action
    leave_call();
}
%include "roburoc4_codec.h"
%include "roburoc4.h"
%include "roburoc4_move.h"
%rename("$ignore", regextarget=1) "^gate_(stop|hold|count_taken)$";
%include "gate_client.h"
%clear uint64_t now_us; /* from here on it is an argument */
%include "roburoc4_udp.h"
%include "roburoc4_sim.h"
%include "roburoc4_pump.h"
%exception;

%include "gate.h"
%include "reason.h"

%rename("$ignore", regextarget=1) "^(raise_result|record_.*|status_.*|decode_status|put_item|take_.*|shortest|tuple_.*|leave_call|connection_(pump|udp)|simulation_(on_port|lock|unlock|join|part|run)|(connection|simulation)_(enter|entered_us|destroy))$";
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
