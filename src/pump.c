/* SPDX-License-Identifier: MIT
 *
 * pump.c - a pump: its lifecycle and its thread, the loop that waits for the robot or the client's
 * deadline without the lock, and receives and sends with it; and what exit() does to it.
 */
#include "pump_internal.h"
#include "record_internal.h"

#include <errno.h>
#include <stdlib.h>

/* In addition to the longest stop sequence, which the client ends itself. */
#define STOP_MARGIN_US 500000u
/* The pause while the socket itself fails, so that the thread does not spin. */
#define BROKEN_PACE_US 100000u

/* A move takes its next step after this time, or earlier with each status. */
#define MOVE_STEP_US 20000u
/* How often to check whether a thread has ended when its lock must not be taken. */
#define EXIT_PACE_US 2000u

/* ---------------------------------------------------------------------------------- thread --- */

static void begin_to_close(roburoc4_pump *pump) {
    uint64_t now_us = roburoc4_udp_now_us();
    pump->phase = ROBUROC4_PUMP_STOPPING;
    pump->stop_by_us = now_us + pump->stop_sequence_us + STOP_MARGIN_US;
    (void)roburoc4_client_close(&pump->client, now_us);
    roburoc4_wake_raise(&pump->wake);
    roburoc4_signal_wake_all(&pump->changed);
}

static void heed_requests(roburoc4_pump *pump) {
    if (pump->phase == ROBUROC4_PUMP_RUNNING && roburoc4_atomic_read(&pump->close_requested)) {
        begin_to_close(pump);
    } else if (roburoc4_atomic_exchange(&pump->stop_requested, 0)) {
        uint64_t now_us = roburoc4_udp_now_us();
        const roburoc4_result stopped = roburoc4_client_stop(&pump->client, now_us);
        (void)stopped; /* nothing moves if it is idle or closing */
        pump->stops++;
        roburoc4_signal_wake_all(&pump->changed);
    }
}

static void seen(void *pump, const uint8_t *datagram, size_t size) {
    roburoc4_pump_collect(pump, datagram, size);
}

/* Carries out requests, receives, sends what the client has to send, stores its events, and
 * shortens the thread's sleep if the client must be called earlier. The result is that of
 * receiving. */
static roburoc4_result serve(roburoc4_pump *pump) {
    roburoc4_result received = ROBUROC4_OK;
    if (!pump->threadless) { /* a pump without a thread gets its time from the caller */
        heed_requests(pump);
        /* A robot whose datagrams wait is not silent: the thread may not have run. */
        received = roburoc4_udp_receive(&pump->udp, &pump->client, seen, pump);
    }
    (void)roburoc4_udp_transmit_all(&pump->udp, &pump->client);
    roburoc4_pump_collect(pump, NULL, 0);
    if (roburoc4_client_next_deadline(&pump->client) < pump->asleep_until_us) {
        roburoc4_wake_raise(&pump->wake);
    }
    return received;
}

static void flush(roburoc4_pump *pump) {
    (void)serve(pump);
}

static int is_over(const roburoc4_pump *pump) {
    return pump->phase == ROBUROC4_PUMP_STOPPING &&
           (roburoc4_client_state(&pump->client) == ROBUROC4_STATE_IDLE ||
            roburoc4_udp_now_us() >= pump->stop_by_us);
}

/* Waits without the lock, which a constant socket number does not need. */
static void sleep_until_due(roburoc4_pump *pump, roburoc4_result received) {
    uint64_t deadline_us = roburoc4_client_next_deadline(&pump->client);
    uint64_t now_us = roburoc4_udp_now_us(), wait_us;
    int64_t socket = pump->udp.private_connected ? pump->udp.private_socket : ROBUROC4_OS_NO_SOCKET;
    if (pump->phase == ROBUROC4_PUMP_STOPPING && pump->stop_by_us < deadline_us) {
        deadline_us = pump->stop_by_us;
    }
    if (received < 0) {
        socket = ROBUROC4_OS_NO_SOCKET;
        if (deadline_us > now_us + BROKEN_PACE_US) {
            deadline_us = now_us + BROKEN_PACE_US;
        }
    }
    pump->asleep_until_us = deadline_us;
    wait_us = deadline_us > now_us ? deadline_us - now_us : 0;
    roburoc4_pump_leave(pump);
    if (roburoc4_os_wait(socket, pump->wake.wait_on, wait_us) < 0) {
        (void)roburoc4_os_wait(ROBUROC4_OS_NO_SOCKET, ROBUROC4_OS_NO_SOCKET,
                               wait_us < BROKEN_PACE_US ? wait_us : BROKEN_PACE_US);
    }
    roburoc4_lock_take(&pump->lock);
    pump->asleep_until_us = 0;
    roburoc4_wake_clear(&pump->wake);
}

static void run(void *argument) {
    roburoc4_pump *pump = argument;
    roburoc4_lock_take(&pump->lock);
    while (!is_over(pump)) {
        roburoc4_result received = serve(pump);
        if (!is_over(pump)) {
            sleep_until_due(pump, received);
        }
    }
    pump->phase = ROBUROC4_PUMP_ENDED;
    roburoc4_signal_wake_all(&pump->changed);
    roburoc4_pump_leave(pump);
}

/* -------------------------------------------------------------------- the client, locked --- */

roburoc4_client *roburoc4_pump_lock(roburoc4_pump *pump) {
    return roburoc4_pump_enter(pump) ? &pump->client : NULL;
}

const roburoc4_udp *roburoc4_pump_udp(roburoc4_pump *pump) {
    return &pump->udp;
}

void roburoc4_pump_unlock(roburoc4_pump *pump) {
    if (pump->phase != ROBUROC4_PUMP_JOINED) {
        flush(pump);
    }
    roburoc4_pump_leave(pump);
}

roburoc4_result roburoc4_pump_record(roburoc4_pump *pump, roburoc4_recorder *recorder) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_udp_record(&pump->udp, recorder);
        roburoc4_pump_leave(pump);
    }
    return result;
}

/* As roburoc4_client_arm(); fails if pump->stops is no longer `stops`. */
static roburoc4_result try_to_arm(roburoc4_pump *pump, uint32_t stops) {
    roburoc4_result result;
    if (pump->phase == ROBUROC4_PUMP_RUNNING) {
        flush(pump);
    }
    if (pump->phase != ROBUROC4_PUMP_RUNNING) {
        return ROBUROC4_ERR_CLOSED;
    }
    if (pump->stops != stops) {
        return ROBUROC4_ERR_STOP_CALLED;
    }
    result = roburoc4_client_arm(&pump->client, roburoc4_udp_now_us());
    flush(pump);
    return pump->stops != stops ? ROBUROC4_ERR_STOP_CALLED : result;
}

roburoc4_result roburoc4_pump_arm(roburoc4_pump *pump, uint32_t timeout_us) {
    uint64_t until_us = roburoc4_udp_now_us() + timeout_us;
    roburoc4_result result;
    uint32_t stops;
    if (pump->threadless || !roburoc4_pump_enter(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    stops = pump->stops;
    while (roburoc4_refusal_may_pass(result = try_to_arm(pump, stops)) &&
           roburoc4_udp_now_us() < until_us) {
        roburoc4_pump_wait(pump, until_us);
    }
    roburoc4_pump_leave(pump);
    return result;
}

/* A stop that a handler requested comes first; what the step granted leaves at once. */
static int32_t step(roburoc4_pump *pump, roburoc4_move *move) {
    uint64_t now_us;
    flush(pump);
    now_us = roburoc4_udp_now_us();
    if (roburoc4_move_step(move, &pump->client, now_us) == ROBUROC4_MOVE_RUNNING) {
        const roburoc4_result granted =
            roburoc4_client_drive(&pump->client, move->linear_m_s, move->angular_rad_s, 0, now_us);
        (void)granted; /* where it is refused, the next step ends the move and says why */
    }
    flush(pump);
    return move->outcome;
}

int32_t roburoc4_pump_move(roburoc4_pump *pump, roburoc4_move *move) {
    int32_t result = ROBUROC4_ERR_CLOSED;
    if (pump->threadless || !roburoc4_pump_enter(pump)) {
        return result;
    }
    if (pump->phase == ROBUROC4_PUMP_RUNNING && pump->moving) {
        roburoc4_pump_leave(pump);
        return ROBUROC4_ERR_BUSY;
    }
    pump->moving = 1;
    while (pump->phase == ROBUROC4_PUMP_RUNNING &&
           (result = step(pump, move)) == ROBUROC4_MOVE_RUNNING) {
        roburoc4_pump_wait(pump, roburoc4_udp_now_us() + MOVE_STEP_US);
    }
    pump->moving = 0;
    roburoc4_pump_leave(pump);
    return result == ROBUROC4_MOVE_RUNNING ? ROBUROC4_ERR_CLOSED : result;
}

void roburoc4_pump_request_stop(roburoc4_pump *pump) {
    if (pump != NULL && pump->process == roburoc4_process_id()) {
        (void)roburoc4_atomic_exchange(&pump->stop_requested, 1);
        roburoc4_wake_raise(&pump->wake);
    }
}

/* ---------------------------------------------------------------------------------- exit() --- */

/* This process's pumps with a thread. Their locks are not taken here, because the caller of exit()
 * may hold them. In that case the thread cannot close, and exit() continues STOP_MARGIN_US after
 * the longest stop sequence. */
static roburoc4_lock living_lock = ROBUROC4_LOCK_INIT;
static roburoc4_pump *living;
static int64_t living_process;

static void close_all(void) {
    uint64_t begun_us = roburoc4_udp_now_us();
    roburoc4_pump *pump;
    if (living_process != roburoc4_process_id()) {
        return; /* a forked child: the pumps belong to its parent, and the lock may be in any state
                 */
    }
    roburoc4_lock_take(&living_lock);
    for (pump = living; pump != NULL; pump = pump->next) {
        (void)roburoc4_atomic_exchange(&pump->close_requested, 1);
        roburoc4_wake_raise(&pump->wake);
    }
    for (pump = living; pump != NULL; pump = pump->next) {
        while (!roburoc4_thread_is_over(&pump->thread) &&
               roburoc4_udp_now_us() - begun_us < pump->stop_sequence_us + STOP_MARGIN_US) {
            (void)roburoc4_os_wait(ROBUROC4_OS_NO_SOCKET, ROBUROC4_OS_NO_SOCKET, EXIT_PACE_US);
        }
    }
    for (pump = living; pump != NULL; pump = pump->next) {
        if (pump->udp.private_recorder != NULL) { /* only now, as pumps may share one */
            (void)roburoc4_recorder_finish(pump->udp.private_recorder);
        }
    }
    roburoc4_lock_give(&living_lock);
}

static void close_at_exit(roburoc4_pump *pump) {
    roburoc4_lock_take(&living_lock);
    if (living_process != roburoc4_process_id()) {
        if (living_process == 0) {
            (void)atexit(close_all);
        }
        living_process = roburoc4_process_id();
        living = NULL;
    }
    pump->next = living;
    living = pump;
    roburoc4_lock_give(&living_lock);
}

static void forget_at_exit(const roburoc4_pump *pump) {
    roburoc4_pump **link = &living;
    roburoc4_lock_take(&living_lock);
    while (*link != NULL && *link != pump) {
        link = &(*link)->next;
    }
    if (*link != NULL) {
        *link = pump->next;
    }
    roburoc4_lock_give(&living_lock);
}

/* ------------------------------------------------------------------------------- lifecycle --- */

static void free_memory(roburoc4_pump *pump) {
    if (pump != NULL) {
        free(pump->samples);
    }
    free(pump);
}

static roburoc4_pump *allocate(uint32_t capacity) {
    roburoc4_pump *pump = calloc(1, sizeof *pump);
    if (pump != NULL) {
        pump->process = roburoc4_process_id();
        pump->capacity = capacity;
        pump->samples = calloc(capacity, sizeof *pump->samples);
    }
    if (pump == NULL || pump->samples == NULL) {
        free_memory(pump);
        errno = ENOMEM; /* also where free() changes it */
        return NULL;
    }
    return pump;
}

/* Creates lock, signal and wake: all or none. */
static int make_meeting_points(roburoc4_pump *pump) {
    if (!roburoc4_lock_create(&pump->lock)) {
        return 0;
    }
    if (roburoc4_signal_create(&pump->changed)) {
        if (roburoc4_wake_create(&pump->wake)) {
            return 1;
        }
        roburoc4_signal_destroy(&pump->changed);
    }
    roburoc4_lock_destroy(&pump->lock);
    return 0;
}

static void drop_meeting_points(roburoc4_pump *pump) {
    roburoc4_wake_destroy(&pump->wake);
    roburoc4_signal_destroy(&pump->changed);
    roburoc4_lock_destroy(&pump->lock);
}

/* The zeros end after the watchdog's time, but at least three are sent. */
static uint32_t longest_stop_sequence_us(const roburoc4_config *config) {
    const uint32_t zeros_ms = 3 * config->drive_period_ms;
    return 1000u * (config->robot_watchdog_ms > zeros_ms ? config->robot_watchdog_ms : zeros_ms);
}

/* Sets up socket, client and thread: all or none. Without an address only the client. */
static roburoc4_result begin(roburoc4_pump *pump, const roburoc4_address *address,
                             const roburoc4_address *local, const roburoc4_config *config,
                             roburoc4_recorder *recorder) {
    roburoc4_result result = roburoc4_client_init(&pump->client, sizeof pump->client, config);
    if (result < 0) {
        return result;
    }
    pump->stop_sequence_us = longest_stop_sequence_us(&pump->client.private_config);
    if (address == NULL) {
        pump->threadless = 1;
        return make_meeting_points(pump) ? ROBUROC4_OK : ROBUROC4_ERR_SYSTEM;
    }
    result = roburoc4_udp_open_from(&pump->udp, sizeof pump->udp, address, local);
    if (result < 0) {
        return result;
    }
    if (make_meeting_points(pump)) {
        (void)roburoc4_udp_record(&pump->udp, recorder); /* before the thread sends anything */
        (void)roburoc4_client_start(&pump->client, roburoc4_udp_now_us());
        if (roburoc4_thread_start(&pump->thread, run, pump)) {
            close_at_exit(pump);
            return ROBUROC4_OK;
        }
        drop_meeting_points(pump);
    }
    (void)roburoc4_udp_close(&pump->udp);
    return ROBUROC4_ERR_SYSTEM;
}

roburoc4_pump *roburoc4_pump_create(const roburoc4_address *address, const roburoc4_config *config,
                                    uint32_t queue_capacity, roburoc4_recorder *recorder,
                                    roburoc4_result *result) {
    return roburoc4_pump_create_from(address, NULL, config, queue_capacity, recorder, result);
}

roburoc4_pump *roburoc4_pump_create_from(const roburoc4_address *address,
                                         const roburoc4_address *local,
                                         const roburoc4_config *config, uint32_t queue_capacity,
                                         roburoc4_recorder *recorder, roburoc4_result *result) {
    uint32_t capacity = queue_capacity != 0 ? queue_capacity : ROBUROC4_PUMP_QUEUE_DEFAULT;
    roburoc4_pump *pump = NULL;
    roburoc4_result outcome = ROBUROC4_ERR_ARGUMENT;
    if (capacity >= ROBUROC4_PUMP_QUEUE_MIN && capacity <= ROBUROC4_PUMP_QUEUE_MAX) {
        pump = allocate(capacity);
        outcome =
            pump != NULL ? begin(pump, address, local, config, recorder) : ROBUROC4_ERR_SYSTEM;
    }
    if (outcome < 0) {
        int error = errno;
        free_memory(pump);
        pump = NULL;
        errno = error;
    }
    if (result != NULL) {
        *result = outcome;
    }
    return pump;
}

roburoc4_result roburoc4_pump_close(roburoc4_pump *pump) {
    if (!roburoc4_pump_enter(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    if (pump->phase == ROBUROC4_PUMP_RUNNING && pump->threadless) {
        pump->phase = ROBUROC4_PUMP_JOINED;
        roburoc4_signal_wake_all(&pump->changed);
    }
    if (pump->phase == ROBUROC4_PUMP_RUNNING) {
        begin_to_close(pump);
        flush(pump);
    }
    while (pump->phase == ROBUROC4_PUMP_STOPPING) {
        roburoc4_pump_wait(pump, UINT64_MAX);
    }
    if (pump->phase == ROBUROC4_PUMP_ENDED) {
        pump->phase = ROBUROC4_PUMP_JOINED;
        roburoc4_thread_join(&pump->thread); /* it has released the lock and is about to return */
        roburoc4_signal_wake_all(&pump->changed);
    }
    roburoc4_pump_leave(pump);
    return ROBUROC4_OK;
}

void roburoc4_pump_destroy(roburoc4_pump *pump) {
    if (pump == NULL) {
        return;
    }
    if (roburoc4_pump_close(pump) == ROBUROC4_OK) {
        forget_at_exit(pump);
        roburoc4_lock_take(&pump->lock);
        while (pump->waiters > 0) {
            roburoc4_signal_wait(&pump->changed, &pump->lock, STOP_MARGIN_US);
        }
        roburoc4_lock_give(&pump->lock);
        drop_meeting_points(pump);
    } else {
        roburoc4_wake_destroy(&pump->wake); /* the fork may have copied the lock in any state */
    }
    (void)roburoc4_udp_close(&pump->udp);
    free_memory(pump);
}

int32_t roburoc4_pump_running(roburoc4_pump *pump) {
    int32_t running = 0;
    if (roburoc4_pump_enter(pump)) {
        running = pump->phase == ROBUROC4_PUMP_RUNNING;
        roburoc4_pump_leave(pump);
    }
    return running;
}
