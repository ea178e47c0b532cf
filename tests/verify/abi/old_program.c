/* SPDX-License-Identifier: MIT
 *
 * old_program: what somebody compiled against the released headers (released/) and did not compile
 * again. It carries the sizes, offsets and constants of that day, runs with the library of today,
 * and drives the simulator in virtual time.
 */
#include <stdio.h>
#include <string.h>

#include "roburoc4.h"
#include "roburoc4_pump.h"
#include "roburoc4_sim.h"
#include "roburoc4_udp.h"

static int failed;

#define EXPECT(condition)                                                                          \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            failed = 1;                                                                            \
            printf("old program: line %d: %s\n", __LINE__, #condition);                            \
        }                                                                                          \
    } while (0)

/* What follows a struct must not be written. */
static struct {
    roburoc4_client client;
    uint64_t behind_client;
    roburoc4_facts facts;
    uint64_t behind_facts;
    roburoc4_config config;
    uint64_t behind_config;
} own;

#define UNTOUCHED 0x5A5AA5A5C3C33C3CU

static void check_sizes(void) {
    EXPECT(roburoc4_abi_version() == ROBUROC4_ABI_VERSION);
    EXPECT(roburoc4_version() >= ROBUROC4_VERSION);
    EXPECT(roburoc4_client_size() == sizeof(roburoc4_client));
    EXPECT(roburoc4_udp_size() == sizeof(roburoc4_udp));
    EXPECT(roburoc4_config_init(&own.config, sizeof own.config) == ROBUROC4_OK);
    EXPECT(roburoc4_client_init(&own.client, sizeof own.client - 8, NULL) == ROBUROC4_ERR_SIZE);
    EXPECT(strcmp(roburoc4_result_text(ROBUROC4_ERR_SHORT), "unknown error") != 0);
}

/** Up to `until_us`; gives the highest speed that the robot reported. */
static float drive(roburoc4_sim *robot, uint64_t until_us) {
    uint8_t datagram[ROBUROC4_SIM_MAX_TRANSMIT];
    float fastest = 0;
    uint64_t now_us;
    for (now_us = 0; now_us < until_us; now_us += 5000) {
        roburoc4_result size;
        uint64_t peer;
        roburoc4_differential_status speed;
        roburoc4_sim_advance(robot, now_us);
        while ((size = roburoc4_sim_poll_transmit(robot, &peer, datagram, sizeof datagram)) > 0) {
            roburoc4_client_receive(&own.client, datagram, (size_t)size, now_us);
        }
        if (roburoc4_client_arm(&own.client, now_us) == ROBUROC4_OK) {
            EXPECT(roburoc4_client_drive(&own.client, 0.5f, 0, 0, now_us) >= 0);
        }
        while ((size = roburoc4_client_poll_transmit(&own.client, datagram, sizeof datagram,
                                                     now_us)) > 0) {
            roburoc4_sim_receive(robot, 1, datagram, (size_t)size);
        }
        if (roburoc4_client_differential(&own.client, &speed, NULL) == ROBUROC4_OK &&
            speed.current_linear_m_s > fastest) {
            fastest = speed.current_linear_m_s;
        }
        own.facts.size = sizeof own.facts;
        EXPECT(roburoc4_client_facts(&own.client, now_us, &own.facts) == ROBUROC4_OK);
    }
    return fastest;
}

int main(void) {
    roburoc4_sim *robot = roburoc4_sim_create(NULL);
    own.behind_client = own.behind_facts = own.behind_config = UNTOUCHED;
    check_sizes();
    EXPECT(robot != NULL);
    EXPECT(roburoc4_client_init(&own.client, sizeof own.client, &own.config) == ROBUROC4_OK);
    EXPECT(roburoc4_client_start(&own.client, 0) == ROBUROC4_OK);
    EXPECT(drive(robot, 6000000) > 0.3f);
    EXPECT(own.facts.state == ROBUROC4_STATE_READY && own.facts.armed == 1);
    EXPECT(own.facts.linear_m_s == 0.5f && own.facts.lease_left_us > 0);
    EXPECT(own.behind_client == UNTOUCHED && own.behind_facts == UNTOUCHED &&
           own.behind_config == UNTOUCHED);
    roburoc4_sim_destroy(robot);
    printf("old program: %s\n", failed ? "FAILED" : "ok");
    return failed;
}
