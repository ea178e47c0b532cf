/* SPDX-License-Identifier: MIT
 *
 * roburoc4_pump.h - a native thread that runs a client, for programs with many threads.
 *
 * A roburoc4_client needs its datagrams sent and received in time. The pump does this on a thread
 * of its own: it receives, sends, repeats a drive command while its lease lasts, and sends the stop
 * sequence when it is over. Language bindings use it: the interpreter may compute, collect garbage
 * or wait for a lock without harm to the link.
 *
 *     roburoc4_pump *pump = roburoc4_pump_create(&address, NULL, 0, NULL, &result);
 *     if (pump != NULL) {
 *         result = roburoc4_pump_arm(pump, 10000000);
 *     }
 *     while (result >= 0 && wanted()) {
 *         roburoc4_client *client = roburoc4_pump_lock(pump);
 *         result = roburoc4_client_drive(client, 0.5f, 0.0f, 0, roburoc4_udp_now_us());
 *         roburoc4_pump_unlock(pump);
 *         work_for_less_than_250_ms();
 *     }
 *     roburoc4_pump_destroy(pump);
 *
 * WHAT IT PROMISES
 *
 *   Motion        the pump never renews a lease: only roburoc4_client_drive() does, for lease_us
 *                 from its now_us. A program that hangs stops the robot.
 *   At once       what the client has to send after drive(), stop() and the like is sent by
 *                 roburoc4_pump_unlock(), which never waits for the network.
 *   Readers       each has its own cursor and sees every sample and every event. A slow reader
 *                 loses the oldest samples, and learns how many; it never delays the pump or
 *                 another reader.
 *   No callback   into your code, ever. For callbacks, let a thread of yours wait in
 *                 roburoc4_pump_wait_events() until ROBUROC4_ERR_CLOSED; at the end close the pump,
 *                 join the thread, and destroy the pump.
 *   The end       roburoc4_pump_close() disarms, sends the stop sequence if one is due, ends the
 *                 thread, and wakes all waiting calls. exit(), and the return from main(), do the
 *                 same, unless the calling thread holds the lock. A process that is killed,
 *                 or ends by abort() or _exit(), cannot send anything. Nor can a Windows DLL during
 *                 exit(), because the system has already ended its thread. Then the robot's own
 *                 watchdog stops it, 1 s after the last command.
 *
 * Threads: all functions can be called from any thread at any time between create and destroy. A
 * roburoc4_pump_reader is used by one thread at a time. After a fork() the child has no pump: there
 * every function returns ROBUROC4_ERR_CLOSED, and destroy only frees the memory.
 *
 * Signals: a handler may call roburoc4_pump_request_stop(), and nothing else in this header.
 *
 * Cancelled threads (pthread_cancel): only create and destroy are cancellation points, and nothing
 * between lock and unlock is. A thread that waits here is cancelled when its wait ends: give it a
 * time-out.
 */
#ifndef ROBUROC4_PUMP_H
#define ROBUROC4_PUMP_H

#include "roburoc4_move.h"
#include "roburoc4_record.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------- lifecycle --- */

/** A client, its socket and its thread. */
typedef struct roburoc4_pump roburoc4_pump;

/** Samples that are kept for readers unless roburoc4_pump_create() gets another number, and the
 *  range of that. One sample takes 128 bytes or less. */
#define ROBUROC4_PUMP_QUEUE_DEFAULT 10000
#define ROBUROC4_PUMP_QUEUE_MIN 16
#define ROBUROC4_PUMP_QUEUE_MAX 1000000

/** Open a socket to `address`, start a client with `config` (NULL: all defaults) and the thread,
 *  which connects by itself. queue_capacity is the number of samples to keep (0: the default). The
 *  recorder (or NULL) gets every datagram; close it after the pump is destroyed. Returns NULL on an
 *  error; *result (result may be NULL) then says which: ROBUROC4_ERR_ADDRESS, ROBUROC4_ERR_ARGUMENT
 *  (capacity), ROBUROC4_ERR_CONFIG (roburoc4_config_error() names the value), ROBUROC4_ERR_SYSTEM
 *  (no socket, thread or memory; errno says why). An absent robot is not an error. Free the pump
 *  with roburoc4_pump_destroy(). A NULL address makes a pump without socket, thread or
 *  recording, for virtual time (roburoc4_sim.h): start the client and give it its datagrams with
 *  the pump locked, and call roburoc4_pump_collect() after each. */
ROBUROC4_API roburoc4_pump *
roburoc4_pump_create(const roburoc4_address *address, const roburoc4_config *config,
                     uint32_t queue_capacity, roburoc4_recorder *recorder, roburoc4_result *result);
/** The same, sending from this local address and port: see roburoc4_udp_open_from(). */
ROBUROC4_API roburoc4_pump *
roburoc4_pump_create_from(const roburoc4_address *address, const roburoc4_address *local,
                          const roburoc4_config *config, uint32_t queue_capacity,
                          roburoc4_recorder *recorder, roburoc4_result *result);
/** Store the client's events, and the samples and texts that they announce, for readers: after the
 *  client received `datagram`, or was polled (NULL). Between lock and unlock, and only with a pump
 *  without an address. */
ROBUROC4_API void roburoc4_pump_collect(roburoc4_pump *pump, const uint8_t *datagram, size_t size);
/** Disarm, send the stop sequence if one is due, and end the thread; waits for that, at most the
 *  configured robot_watchdog_ms (or three drive periods) plus half a second. A pump without an
 *  address has no thread to do so: close its client first. Other waiting calls
 *  return ROBUROC4_ERR_CLOSED. Afterwards the client is idle: values and samples can still be read,
 *  and commands are refused as by any idle client. From any thread; further calls wait for the end
 *  and return 0. */
ROBUROC4_API roburoc4_result roburoc4_pump_close(roburoc4_pump *pump);
/** Close, wait until all waiting calls have returned, and free the memory. NULL is ignored. No
 * thread may use the pump afterwards. */
ROBUROC4_API void roburoc4_pump_destroy(roburoc4_pump *pump);
/** Record what the pump sends and receives from now on with this recorder, or with none (NULL).
 *  exit() ends the recording, too. ROBUROC4_ERR_CLOSED for a pump without an address. */
ROBUROC4_API roburoc4_result roburoc4_pump_record(roburoc4_pump *pump, roburoc4_recorder *recorder);
/** Take the pump's lock and get its client, for any roburoc4_client_*() call except receive(),
 *  poll_transmit(), take_events(), start() and close(), which only the pump makes. NULL in a forked
 *  child; then there is nothing to unlock. Read roburoc4_udp_now_us() while the lock is held. Hold
 *  it only for a few calls and never while waiting, as the link waits meanwhile; the only other
 *  function of this pump that may be called is roburoc4_pump_udp(). The pointer is valid until the
 *  unlock. */
ROBUROC4_API roburoc4_client *roburoc4_pump_lock(roburoc4_pump *pump);
/** The pump's socket, to read its fields; valid between lock and unlock. Without an address, all of
 *  them are 0. */
ROBUROC4_API const roburoc4_udp *roburoc4_pump_udp(roburoc4_pump *pump);
/** Send what the client has to send, wake the thread if something is due earlier than it expects,
 *  and release the lock. To be called by the thread that holds it. */
ROBUROC4_API void roburoc4_pump_unlock(roburoc4_pump *pump);
/** Arm as soon as possible, waiting at most timeout_us. Returns 0, or the reason against it, as
 *  roburoc4_client_arm() does: at once for a reason that does not pass by itself (see
 *  roburoc4_refusal_may_pass()), such as a held game pad, else after timeout_us. If it is
 *  ROBUROC4_ERR_NOT_READY, the fault of roburoc4_pump_udp() (with the pump locked) may say why.
 *  ROBUROC4_ERR_STOP_CALLED if roburoc4_pump_request_stop() was called meanwhile;
 *  ROBUROC4_ERR_CLOSED, also with a pump that was made without an address. */
ROBUROC4_MUST_CHECK ROBUROC4_API roburoc4_result roburoc4_pump_arm(roburoc4_pump *pump,
                                                                   uint32_t timeout_us);
/** Drive a move to its end: take its steps, and grant the speeds that it proposes. Waits for the
 *  move's own time-out at most. Returns move->outcome, of which only ROBUROC4_MOVE_REACHED is
 *  success (ROBUROC4_MOVE_CANCELLED after roburoc4_pump_request_stop()); or ROBUROC4_ERR_BUSY while
 *  another thread is in this function, or ROBUROC4_ERR_CLOSED, also with a pump that was made
 *  without an address. roburoc4_move_outcome_text() explains each of them. Between two steps the
 *  lock is free: other threads may read values, or end the move by roburoc4_client_pause() or
 *  _stop(); a drive() of theirs would fight with it. To stop and wait until the robot is at rest,
 *  drive a roburoc4_move_rest(). */
ROBUROC4_MUST_CHECK ROBUROC4_API int32_t roburoc4_pump_move(roburoc4_pump *pump,
                                                            roburoc4_move *move);
/** For signal handlers: stop the robot and disarm, as roburoc4_client_stop() does. It only sets a
 * request for the thread, so it never waits and keeps errno; the link stays up. If the lock is held
 * meanwhile, the zeros are sent when it is released, and a speed granted in between is never sent.
 * The program's next drive() returns ROBUROC4_ERR_STOP_CALLED. Several requests count as one. May
 * also be called outside of handlers; does nothing with a NULL pump, after close, in a forked
 * child, or with a pump without an address. It must not be called after destroy: first set the
 * pointer that the handler uses to NULL. Windows: for the handler of SetConsoleCtrlHandler(), which
 * is a thread of its own. On CTRL_CLOSE_EVENT and later ones Windows ends the process when the
 * handler returns: call roburoc4_pump_close() there, which waits for the stop. */
ROBUROC4_API void roburoc4_pump_request_stop(roburoc4_pump *pump);
/** 1 while the thread runs, 0 after roburoc4_pump_close() or in a forked child. */
ROBUROC4_API int32_t roburoc4_pump_running(roburoc4_pump *pump);

/* --------------------------------------------------------------------- samples and events --- */

/** The value of a sample: the member of its service. */
typedef union roburoc4_sample_value {
    roburoc4_inputs inputs;
    roburoc4_distances distances;
    roburoc4_battery_status battery;
    roburoc4_localization_status localization;
    roburoc4_differential_status differential;
} roburoc4_sample_value;

/** A sample is one status with its times. This struct is frozen. */
typedef struct roburoc4_sample {
    uint64_t sequence;     /* 0, 1, 2 ... over all services, in the order of arrival */
    uint64_t robot_cycles; /* when, on the robot's clock */
    uint64_t host_us;      /* when it was received, on roburoc4_udp_now_us() */
    uint64_t made_us; /* when the robot made it, by roburoc4_client_host_time(); never later than
                         host_us; equal to host_us for a status from before a restart */
    uint32_t service; /* ROBUROC4_SERVICE_IOCARD (inputs), _TELEMETER (distances), _BATTERY,
                         _LOCALIZATION, _DIFFERENTIAL */
    uint32_t reserved;
    roburoc4_sample_value value;
} roburoc4_sample;

/** A client's latest status of a service (ROBUROC4_SERVICE_*); its sequence is 0.
 *  ROBUROC4_ERR_NOT_KNOWN: there is none yet, and *out is 0 except for its service.
 *  ROBUROC4_ERR_ARGUMENT: a service without statuses. */
ROBUROC4_API roburoc4_result roburoc4_sample_latest(const roburoc4_client *client, uint32_t service,
                                                    roburoc4_sample *out);

/** A reader's position. Declare as many as you like; nothing needs to be freed. A reader whose
 *  bytes are all zero starts with all events since create and with the first sample (overwritten
 *  ones count as lost). */
typedef struct roburoc4_pump_reader {
    uint64_t next_sample; /* sequence of the next sample to read */
    uint64_t lost;        /* samples that were overwritten before this reader read them */
    uint64_t private_next_event;
    uint64_t private_spare[2];
} roburoc4_pump_reader;

/** Start with the samples and events from now on instead. ROBUROC4_ERR_CLOSED only in a forked
 * child. */
ROBUROC4_API roburoc4_result roburoc4_pump_reader_init(roburoc4_pump *pump,
                                                       roburoc4_pump_reader *reader);
/** Copy up to `capacity` samples, oldest first; never waits. Returns their number, 0 if all were
 *  read; ROBUROC4_ERR_CLOSED if all were read and no more will come. reader->lost grows by the
 *  samples that were overwritten before this call. */
ROBUROC4_API roburoc4_result roburoc4_pump_read_samples(roburoc4_pump *pump,
                                                        roburoc4_pump_reader *reader,
                                                        roburoc4_sample *samples,
                                                        uint32_t capacity);
/** Wait at most timeout_us for a sample. Returns how many can be read, 0 on time-out,
 *  ROBUROC4_ERR_CLOSED if no more will come. */
ROBUROC4_API roburoc4_result roburoc4_pump_wait_samples(roburoc4_pump *pump,
                                                        const roburoc4_pump_reader *reader,
                                                        uint32_t timeout_us);
/** ROBUROC4_EVENT_* bits since this reader's last call; other readers keep theirs. 0 if there are
 *  none; ROBUROC4_ERR_CLOSED if no more will come. */
ROBUROC4_API roburoc4_result roburoc4_pump_take_events(roburoc4_pump *pump,
                                                       roburoc4_pump_reader *reader);
/** Wait at most timeout_us for one of the events in `mask` (UINT32_MAX: any). Returns those of
 *  them that occurred, without taking any; 0 on time-out; ROBUROC4_ERR_CLOSED if no more will
 *  come. */
ROBUROC4_API roburoc4_result roburoc4_pump_wait_events(roburoc4_pump *pump,
                                                       const roburoc4_pump_reader *reader,
                                                       uint32_t mask, uint32_t timeout_us);

/* ---------------------------------------------------------------------------- descriptions --- */

/** Enough for every description, including its NUL; the pump cuts longer texts. */
#define ROBUROC4_PUMP_DESCRIPTION_SIZE 64

/** The robot's text for an IO channel (io_type ROBUROC4_IO_*, wire index) or for entry `index` of
 *  its directory (io_type -1). Writes it with a terminating NUL and returns its length. Its
 *  character set is not specified, and it may be empty. A buffer of ROBUROC4_PUMP_DESCRIPTION_SIZE
 *  always suffices. ROBUROC4_ERR_NOT_KNOWN: the robot gave none (yet); ROBUROC4_ERR_INDEX: beyond
 *  the client's capacities; ROBUROC4_ERR_ARGUMENT: no such io_type; ROBUROC4_ERR_BUFFER. */
ROBUROC4_API roburoc4_result roburoc4_pump_description(roburoc4_pump *pump, int32_t io_type,
                                                       uint32_t index, char *buffer,
                                                       size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
