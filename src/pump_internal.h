/* SPDX-License-Identifier: MIT
 *
 * pump_internal.h - the pump's memory, and what pump_store.c (lock, samples, events, descriptions)
 * offers pump.c (lifecycle, thread). Not public.
 */
#ifndef ROBUROC4_PUMP_INTERNAL_H
#define ROBUROC4_PUMP_INTERNAL_H

#include "os.h"
#include "roburoc4_pump.h"

/** Phases of a pump's lifecycle; they only advance. */
#define ROBUROC4_PUMP_RUNNING 0
#define ROBUROC4_PUMP_STOPPING 1 /* close() was called: the stop sequence is being sent */
#define ROBUROC4_PUMP_ENDED 2    /* the thread has left its loop */
#define ROBUROC4_PUMP_JOINED 3

/** All descriptions in one array: the directory's, then by ROBUROC4_IO_*. */
#define ROBUROC4_PUMP_TEXTS                                                                        \
    (ROBUROC4_MAX_SERVICES + ROBUROC4_MAX_ANALOG_INPUTS + ROBUROC4_MAX_ANALOG_OUTPUTS +            \
     ROBUROC4_MAX_DIGITAL_INPUTS + ROBUROC4_MAX_DIGITAL_OUTPUTS)

typedef struct roburoc4_pump_text {
    uint8_t known, length;
    char text[ROBUROC4_PUMP_DESCRIPTION_SIZE - 1];
} roburoc4_pump_text;

struct roburoc4_pump {
    int64_t process; /* the process that made it: a forked child has no thread, and the lock may be
                        in any state */
    roburoc4_thread thread;
    roburoc4_wake wake;
    roburoc4_lock lock;       /* protects everything below; never held while waiting */
    roburoc4_signal changed;  /* samples, events, phase, waiters */
    uint32_t phase;           /* ROBUROC4_PUMP_* */
    uint32_t waiters;         /* threads inside a wait on `changed` */
    uint64_t stop_by_us;      /* STOPPING ends then, whatever the robot does */
    uint64_t asleep_until_us; /* what the thread waits for; 0 while it is awake */
    int threadless;           /* without socket and thread */
    uint32_t stop_sequence_us;
    uint32_t stops; /* stop requests that were carried out */
    int moving;     /* in roburoc4_pump_move() */

    roburoc4_atomic stop_requested, close_requested; /* set without the lock, read by flush() */
    roburoc4_pump *next;                             /* in the list of pumps that exit() closes */

    roburoc4_udp udp;
    roburoc4_client client;

    uint64_t event_turn;     /* counts polls that returned events */
    uint64_t event_last[32]; /* for each bit the last turn in which it was set; 0 for never */
    uint64_t next_sample;    /* number of samples so far */
    uint32_t capacity;
    roburoc4_sample *samples; /* a ring: sequence s is at s modulo capacity */
    roburoc4_pump_text texts[ROBUROC4_PUMP_TEXTS];
};

/** Takes the lock; 0 in a forked child, where it must not be touched. */
int roburoc4_pump_enter(roburoc4_pump *pump);
void roburoc4_pump_leave(roburoc4_pump *pump);
/** Waits for `changed`, at most until until_us. Between enter and leave. */
void roburoc4_pump_wait(roburoc4_pump *pump, uint64_t until_us);

#endif
