/* SPDX-License-Identifier: MIT
 *
 * roburoc4_record.h - a flight recorder: every datagram of one or more sockets, in both directions,
 * with its time, in a pcapng file that Wireshark, tshark and tcpdump open.
 *
 *     roburoc4_recorder *recorder = roburoc4_recorder_open("run.pcapng", NULL, &result);
 *     roburoc4_udp_record(&udp, recorder);    (for a pump: roburoc4_pump_record(pump, recorder))
 *     ...
 *     roburoc4_udp_close(&udp);               (roburoc4_pump_destroy(pump))
 *     roburoc4_recorder_close(recorder, NULL);
 *
 * WHAT IT PROMISES
 *
 *   No delay          recording copies a datagram into a buffer and never waits for the disk: a
 *                     thread writes the buffer. Nothing is allocated after
 *                     roburoc4_recorder_open().
 *   A crash           the thread writes every 50 ms, so a killed process usually loses less than
 *                     the last 100 ms; with a full or slow disk, the buffers too. A power cut may
 *                     lose more: the system decides when data reaches the disk.
 *   A full disk       datagrams that do not fit into the buffer while the disk is full or slow are
 *                     dropped and counted: in the file, with the next datagram that is written and
 *                     in the statistics at its end, and in roburoc4_recorder_state. Writing is
 *                     retried until there is room.
 *   Old recordings    are never overwritten: if run.pcapng exists, run.2.pcapng is written, or the
 *                     first number that is free. Two processes may use the same name.
 *   The format        pcapng, little-endian, one interface of raw IP (link type 101), times in
 *                     microseconds since 1970 (UTC). Each datagram has an IP and UDP header with
 *                     its real addresses and ports, and is marked as inbound or outbound.
 *
 * Threads: all functions can be called from any thread. In the child of a fork() nothing is
 * recorded.
 */
#ifndef ROBUROC4_RECORD_H
#define ROBUROC4_RECORD_H

#include "roburoc4_udp.h"

#ifdef __cplusplus
extern "C" {
#endif

/** An open recording. */
typedef struct roburoc4_recorder roburoc4_recorder;

/** How to record; members that are 0 have their defaults. */
typedef struct roburoc4_recorder_options {
    uint32_t size;           /* sizeof(roburoc4_recorder_options) */
    uint32_t buffer_bytes;   /* of each of two buffers, 4096 or more (0: 262144, half a minute) */
    uint64_t max_file_bytes; /* the next file begins where this one would be longer (0: never) */
    uint64_t max_file_s;     /* or is older than this, in seconds (0: never) */
    const char *robot;       /* the interface's name in the file (NULL: "roburoc4") */
} roburoc4_recorder_options;

/** Enough for every path of a recording, including its NUL. */
#define ROBUROC4_RECORDER_PATH_SIZE 1024

/** The state of a recording (frozen: this struct never changes). */
typedef struct roburoc4_recorder_state {
    uint64_t recorded;    /* datagrams copied into the buffer */
    uint64_t dropped;     /* datagrams lost because the buffer was full */
    uint64_t bytes;       /* written, to all files */
    uint32_t files;       /* begun so far, one or more */
    int32_t system_error; /* errno of the last failed write, 0 as soon as one succeeds */
    char path[ROBUROC4_RECORDER_PATH_SIZE]; /* the current file */
} roburoc4_recorder_state;

/** Begin a recording. If `path` is a folder, the file is named after the time (UTC):
 *  roburoc4-20260102T030405Z.pcapng. A pipe or device is written directly. options may be NULL.
 *  Returns NULL on an error; *result (result may be NULL) then says which: ROBUROC4_ERR_ARGUMENT
 * (no path, one that is too long, or buffer_bytes), ROBUROC4_ERR_SIZE (of the options),
 *  ROBUROC4_ERR_SYSTEM (no file, thread or memory; errno says why). */
ROBUROC4_API roburoc4_recorder *roburoc4_recorder_open(const char *path,
                                                       const roburoc4_recorder_options *options,
                                                       roburoc4_result *result);
/** Copy the current state; never waits for the disk. */
ROBUROC4_API void roburoc4_recorder_get_state(roburoc4_recorder *recorder,
                                              roburoc4_recorder_state *out);
/** Write the rest, end the file and free the memory; *last (last may be NULL) is the final state.
 *  First close every socket and pump that uses the recorder, or give it another one. NULL is
 *  ignored. Waits for the disk for at most 2 s. ROBUROC4_ERR_SYSTEM: the end of the recording could
 *  not be written (last->system_error says why); the memory may stay allocated. */
ROBUROC4_API roburoc4_result roburoc4_recorder_close(roburoc4_recorder *recorder,
                                                     roburoc4_recorder_state *last);

/** Record what this socket sends and receives from now on; NULL ends it. Several sockets may
 *  share a recorder. ROBUROC4_ERR_CLOSED. For a pump: roburoc4_pump_record(). */
ROBUROC4_API roburoc4_result roburoc4_udp_record(roburoc4_udp *udp, roburoc4_recorder *recorder);

#ifdef __cplusplus
}
#endif

#endif
