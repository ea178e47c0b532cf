/* SPDX-License-Identifier: MIT
 *
 * portable_sockets HOST:PORT [SECONDS]: the UDP adapter, then the pump, on this target's sockets,
 * threads and clock, against roburoc4-sim: connect, arm, drive until the robot moves, stop, leave.
 * Its last line is "sockets: ok", or says what did not happen within SECONDS.
 */
#include <stdio.h>
#include <stdlib.h>

#include "roburoc4_pump.h"

#define PATIENCE_S 60U /* an emulated machine that is loaded is slow */
#define STEP_US 50000U
#define SPEED_M_S 0.5f

static uint64_t patience_us = PATIENCE_S * UINT64_C(1000000);

static int failed(const char *what) {
    printf("sockets: FAILED: %s\n", what);
    return 1;
}

static int is_late(uint64_t begun_us) {
    return roburoc4_udp_now_us() - begun_us >= patience_us;
}

/* ------------------------------------------------------------------------------- adapter --- */

/** For calls that may be refused here. */
static void ignore(roburoc4_result result) {
    (void)result;
}

static roburoc4_udp udp;
static roburoc4_client client;

/** Wait until the robot's speed is (or is not) 0; while it is wanted, keep driving, and arm again
 * where a machine that is slow was disarmed. */
static int adapter_until(int moving) {
    const uint64_t begun_us = roburoc4_udp_now_us();
    while (!is_late(begun_us)) {
        roburoc4_differential_status speed;
        roburoc4_udp_wait(&udp, &client, STEP_US);
        if (moving) {
            ignore(roburoc4_client_arm(&client, roburoc4_udp_now_us()));
            ignore(roburoc4_client_drive(&client, SPEED_M_S, 0, 0, roburoc4_udp_now_us()));
        }
        if (roburoc4_client_differential(&client, &speed, NULL) == 0 &&
            (speed.current_linear_m_s > 0.1f) == moving) {
            return 1;
        }
    }
    return 0;
}

static int test_adapter(const roburoc4_address *robot) {
    uint64_t begun_us;
    if (roburoc4_udp_open(&udp, sizeof udp, robot) < 0) {
        return failed("the socket does not open");
    }
    if (roburoc4_client_init(&client, sizeof client, NULL) < 0 ||
        roburoc4_client_start(&client, roburoc4_udp_now_us()) < 0) {
        return failed("the client does not start");
    }
    if (!adapter_until(1)) {
        return failed("adapter: the robot does not move");
    }
    ignore(roburoc4_client_stop(&client, roburoc4_udp_now_us()));
    if (!adapter_until(0)) {
        return failed("adapter: the robot does not stop");
    }
    roburoc4_client_close(&client, roburoc4_udp_now_us());
    begun_us = roburoc4_udp_now_us();
    while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE && !is_late(begun_us)) {
        roburoc4_udp_wait(&udp, &client, STEP_US);
    }
    return roburoc4_udp_close(&udp) < 0 ? failed("the socket does not close") : 0;
}

/* ---------------------------------------------------------------------------------- pump --- */

/** Arm and drive if the robot is to move; returns whether it does what is wanted. */
static int pump_turn(roburoc4_pump *pump, int moving) {
    roburoc4_differential_status speed;
    roburoc4_client *of_pump = roburoc4_pump_lock(pump);
    int done;
    if (moving) {
        ignore(roburoc4_client_arm(of_pump, roburoc4_udp_now_us()));
        ignore(roburoc4_client_drive(of_pump, SPEED_M_S, 0, 0, roburoc4_udp_now_us()));
    } else {
        ignore(roburoc4_client_stop(of_pump, roburoc4_udp_now_us()));
    }
    done = roburoc4_client_differential(of_pump, &speed, NULL) == 0 &&
           (speed.current_linear_m_s > 0.1f) == moving;
    roburoc4_pump_unlock(pump);
    return done;
}

static int pump_until(roburoc4_pump *pump, roburoc4_pump_reader *reader, int moving) {
    const uint64_t begun_us = roburoc4_udp_now_us();
    while (!is_late(begun_us)) {
        roburoc4_sample samples[16];
        (void)roburoc4_pump_wait_samples(pump, reader, STEP_US);
        (void)roburoc4_pump_read_samples(pump, reader, samples, 16);
        if (pump_turn(pump, moving)) {
            return 1;
        }
    }
    return 0;
}

static int test_pump(const roburoc4_address *robot) {
    roburoc4_pump_reader reader = {0};
    roburoc4_result result = 0;
    roburoc4_pump *pump = roburoc4_pump_create(robot, NULL, 0, NULL, &result);
    int moved, stopped;
    if (pump == NULL) {
        return failed(roburoc4_result_text(result));
    }
    moved = pump_until(pump, &reader, 1);
    stopped = moved && pump_until(pump, &reader, 0);
    result = roburoc4_pump_close(pump);
    roburoc4_pump_destroy(pump);
    if (!moved) {
        return failed("pump: the robot does not move");
    }
    if (!stopped) {
        return failed("pump: the robot does not stop");
    }
    return result < 0 ? failed("pump: it does not end") : 0;
}

int main(int argc, char **argv) {
    roburoc4_address robot;
    if (argc < 2 || argc > 3 || roburoc4_udp_resolve(argv[1], 0, &robot) < 0) {
        printf("Usage: portable_sockets HOST:PORT [SECONDS] (of roburoc4-sim)\n");
        return 2;
    }
    if (argc == 3) {
        patience_us = strtoul(argv[2], NULL, 10) * UINT64_C(1000000);
    }
    if (test_adapter(&robot) != 0 || test_pump(&robot) != 0) {
        return 1;
    }
    printf("sockets: ok\n");
    return 0;
}
