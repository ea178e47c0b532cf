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

%include <stdint.i>
%include "typemaps.i"

/* Structs are passed whole. */
%nodefaultctor;
%nodefaultdtor;
%rename("$ignore", regextarget=1, fullname=1) ".*::.*";

/* Of no use from Python: the codec is behind decode(), and native.h opens connections. */
%rename("$ignore", regextarget=1) "^roburoc4_(decode_|encode_|directory_at|notification_at|telemeter_(at|distances)|(analog|digital)_values|config_init|abi_version)";
%rename("$ignore", regextarget=1) "^roburoc4_(client_(size|init|start|receive|poll_transmit|description)|udp_(resolve|open|count|address|receive_all|wait|system_error)|address_text|udp_address_text)$";
%rename("$ignore", regextarget=1) "^roburoc4_pump_(?!close|running|description|reader_init|take_events|wait_events).*";
%rename("$ignore", regextarget=1) "^roburoc4_(sim_(config_init|config_read|create|destroy|reconfigure|receive|advance|poll_transmit|next_deadline|panel|analog_output|subscription|channel_.*|peer_unreachable)|world_(?!step$|now_us$).*)$";

#define ROBUROC4_API
#define ROBUROC4_SIM_API
/* A client or simulator is locked by a typemap before the call, and free again after it. */
%exception {
    $action
    connection_leave();
    simulation_leave();
}
/* These move a client's datagrams; all others that change one are commands. */
roburoc4_result roburoc4_client_close(roburoc4_client *mover, uint64_t now_us);
uint32_t roburoc4_client_take_events(roburoc4_client *mover);
roburoc4_result roburoc4_udp_transmit_all(roburoc4_udp *udp, roburoc4_client *mover);
roburoc4_result roburoc4_udp_receive_one(roburoc4_udp *udp, roburoc4_client *mover,
                                         const uint8_t **datagram, size_t *size);
#pragma SWIG nowarn=322
%include "roburoc4_codec.h"
%include "roburoc4.h"
%clear uint64_t now_us; /* from here on it is an argument */
%include "roburoc4_udp.h"
%include "roburoc4_sim.h"
%exception;
%include "roburoc4_pump.h"

%ignore raise_result;
%rename("$ignore", regextarget=1) "^(record_|decode_telegram|tuple_of|(connection|simulation)_(enter|leave|entered_us|destroy|pump|udp|world)$)";
%include "native.h"

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
