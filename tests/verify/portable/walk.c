/* SPDX-License-Identifier: MIT
 *
 * The safety walk: lives of a client and a robot in virtual time, with a user that behaves badly,
 * over a network that loses, doubles, delays, overtakes and damages, with reboots, a game pad,
 * clocks that step and callers that hang. Everything is drawn from the life's number.
 */
#include <string.h>

#include "check.h"
#include "network.h"
#include "referee.h"

#define PART "walk.c"
#define MS 1000UL
#define SECOND 1000000UL
#define LIVES 16U
#define FAULTS_US (12 * SECOND)
#define STEP_US (10 * MS)
/* After the faults: ready within the first, moving within the second; idle after close(). */
#define READY_US (15 * SECOND)
#define MOVING_US (25 * SECOND)

static struct {
    network net;
    robot robot;
    referee referee;
    uint64_t now_us;         /* true time */
    uint64_t clock_us;       /* what the client's clock shows at true time 0 */
    uint64_t hung_until_us;  /* the caller is not there */
    uint64_t event_until_us; /* the pad is held, or the robot is off */
    uint64_t drive_until_us, quiet_until_us, drove_us;
    float want[2];
} life;

static uint64_t client_now(void) {
    return life.now_us + life.clock_us;
}

/* -------------------------------------------------------------------------------- people --- */

/** -4 to 4, also beyond the robot's limits; exact, so that it is the same on every target. */
static float some_speed(void) {
    return (float)((int32_t)roll(&life.net, 1025) - 512) / 128.0f;
}

static void user_drives(void) {
    if (life.now_us >= life.drive_until_us) {
        life.quiet_until_us = life.now_us + roll(&life.net, 600 * MS);
        life.drive_until_us = life.quiet_until_us + roll(&life.net, 2 * SECOND);
    }
    if (life.now_us < life.quiet_until_us) {
        return;
    }
    if (chance(&life.net, 24)) {
        life.want[0] = some_speed();
        life.want[1] = some_speed();
    }
    if (referee_drive(&life.referee, life.want[0], life.want[1], client_now()) >= 0) {
        life.drove_us = life.now_us;
    }
}

/** Bits of a NaN and of infinity: never accepted. */
static void user_drives_nonsense(void) {
    const uint32_t bits = chance(&life.net, 128) ? 0x7FC00000UL : 0xFF800000UL;
    float nonsense;
    memcpy(&nonsense, &bits, sizeof nonsense);
    CHECK(roburoc4_client_drive(&life.referee.client, nonsense, 0, 0, client_now()) ==
          ROBUROC4_ERR_NOT_FINITE);
}

static void user_acts(void) {
    if (life.referee.monitor) {
        return;
    }
    if (!life.referee.armed) {
        if (chance(&life.net, 32)) {
            (void)referee_arm(&life.referee, client_now());
        }
    } else if (chance(&life.net, 64)) {
        user_drives();
    }
    if (chance(&life.net, 1)) {
        referee_stop(&life.referee, client_now());
    }
    if (chance(&life.net, 1)) {
        referee_disarm(&life.referee, client_now());
    }
    if (chance(&life.net, 1)) {
        user_drives_nonsense();
    }
}

/* -------------------------------------------------------------------------------- faults --- */

static void garbage_arrives(void) {
    uint8_t data[NETWORK_LONGEST];
    const size_t size = roll(&life.net, NETWORK_LONGEST) + 1;
    size_t i;
    for (i = 0; i < size; i++) {
        data[i] = (uint8_t)roll(&life.net, 256);
    }
    data[0] = (uint8_t)(data[0] % 16); /* an answer, mostly */
    data[3] = 0xEE;                    /* of a service that is not there */
    network_send(&life.net, TO_CLIENT, data, size, life.now_us);
}

static void robot_suffers(void) {
    if (life.now_us < life.event_until_us) {
        return;
    }
    if (life.event_until_us != 0) {
        life.event_until_us = 0;
        life.robot.pad_a = 0;
        if (!life.robot.powered) {
            robot_boot(&life.robot, life.now_us);
        }
    } else if (roll(&life.net, 600) == 0) {
        life.event_until_us = life.now_us + 100 * MS + roll(&life.net, 2 * SECOND);
        life.robot.pad_a = chance(&life.net, 170) ? 1 : 0;
        life.robot.powered = life.robot.pad_a;
        if (!life.robot.powered) {
            life.robot.target[0] = life.robot.target[1] = 0;
        }
    }
}

static void host_suffers(void) {
    if (roll(&life.net, 500) == 0) {
        life.hung_until_us = life.now_us + roll(&life.net, 1500 * MS);
    }
    if (roll(&life.net, 800) == 0) {
        life.clock_us += roll(&life.net, 2 * SECOND);
    } else if (roll(&life.net, 800) == 0) {
        life.clock_us -= roll(&life.net, 2 * SECOND);
    }
    if (chance(&life.net, 4)) {
        garbage_arrives();
    }
}

static void weather_changes(void) {
    if (roll(&life.net, 300) == 0) {
        life.net.loss = (uint8_t)roll(&life.net, 154); /* to 60 % */
        life.net.duplicate = (uint8_t)roll(&life.net, 40);
        life.net.damage = (uint8_t)roll(&life.net, 20);
        life.net.delay_us = roll(&life.net, 60 * MS);
        life.net.jitter_us = roll(&life.net, 200 * MS);
    }
}

/* ------------------------------------------------------------------------------- a life --- */

static void robot_speaks(void) {
    uint8_t data[NETWORK_LONGEST], reply[NETWORK_LONGEST];
    size_t size;
    robot_advance(&life.robot, life.now_us);
    while ((size = network_take(&life.net, TO_ROBOT, life.now_us, data)) > 0) {
        size = robot_hear(&life.robot, data, size, reply, sizeof reply);
        if (size > 0) {
            network_send(&life.net, TO_CLIENT, reply, size, life.now_us);
        }
    }
    while ((size = robot_status(&life.robot, data, sizeof data)) > 0) {
        network_send(&life.net, TO_CLIENT, data, size, life.now_us);
    }
}

static void client_speaks(void) {
    uint8_t data[ROBUROC4_MAX_TRANSMIT];
    size_t size;
    while ((size = network_take(&life.net, TO_CLIENT, life.now_us, data)) > 0) {
        referee_receive(&life.referee, data, size, client_now());
    }
    while ((size = referee_poll(&life.referee, data, sizeof data, client_now())) > 0) {
        network_send(&life.net, TO_ROBOT, data, size, life.now_us);
    }
}

/** Whoever stops asking for speed has a robot that stands still: after the lease, the slowest
 *  datagram, and the robot's watchdog. */
static void judge_robot(void) {
    const uint64_t longest_us = life.referee.lease_us + 260 * MS + ROBOT_WATCHDOG_US + 2 * STEP_US;
    CHECK(!robot_moves(&life.robot) || life.now_us - life.drove_us <= longest_us);
}

/** To the next moment at which anything happens, 10 ms on at most. */
static void step(void) {
    uint64_t next_us = life.now_us + STEP_US;
    const uint64_t arrival_us = network_next_us(&life.net);
    const uint64_t deadline_us =
        roburoc4_client_next_deadline(&life.referee.client) - life.clock_us;
    if (arrival_us < next_us && arrival_us > life.now_us) {
        next_us = arrival_us;
    }
    if (deadline_us < next_us && deadline_us > life.now_us) {
        next_us = deadline_us;
    }
    life.now_us = next_us;
    robot_speaks();
    if (life.now_us >= life.hung_until_us) {
        client_speaks();
    }
    judge_robot();
}

static void be_born(uint32_t number) {
    const uint32_t digest = life.referee.digest;
    memset(&life, 0, sizeof life);
    life.net.dice = number * 2654435769UL;
    life.clock_us = 100 * (uint64_t)SECOND;
    life.robot.first_id = (uint16_t)(number % 2 == 0 ? 2 : 40);
    robot_boot(&life.robot, 0);
    life.referee.digest = digest;
    life.referee.monitor = number % 8 == 7;
    roburoc4_config_init(&life.referee.config, sizeof life.referee.config);
    life.referee.config.lease_ms = 100 + roll(&life.net, 400);
    life.referee.config.drive_period_ms = 20 + roll(&life.net, 30);
    referee_begin(&life.referee, &life.robot, client_now());
}

static void suffer(void) {
    while (life.now_us < FAULTS_US) {
        weather_changes();
        robot_suffers();
        host_suffers();
        if (life.now_us >= life.hung_until_us) {
            user_acts();
        }
        step();
    }
}

/** The faults are over: it is ready again, and can be driven again. */
static void recover(void) {
    const uint64_t begun_us = life.now_us;
    roburoc4_client *client = &life.referee.client;
    life.net.loss = life.net.duplicate = life.net.damage = 0;
    life.net.delay_us = 1 * MS;
    life.net.jitter_us = 0;
    life.robot.pad_a = 0;
    if (!life.robot.powered) {
        robot_boot(&life.robot, life.now_us);
    }
    while (roburoc4_client_state(client) != ROBUROC4_STATE_READY &&
           life.now_us - begun_us < READY_US) {
        step();
    }
    CHECK(roburoc4_client_state(client) == ROBUROC4_STATE_READY);
    while (!life.referee.monitor && !robot_moves(&life.robot) &&
           life.now_us - begun_us < MOVING_US) {
        if (!life.referee.armed) {
            (void)referee_arm(&life.referee, client_now());
        } else if (referee_drive(&life.referee, 0.5f, -0.25f, client_now()) >= 0) {
            life.drove_us = life.now_us;
        }
        step();
    }
    CHECK(life.referee.monitor || robot_moves(&life.robot));
}

static void die(void) {
    const uint64_t begun_us = life.now_us;
    referee_close(&life.referee, client_now());
    while (roburoc4_client_state(&life.referee.client) != ROBUROC4_STATE_IDLE &&
           life.now_us - begun_us < ROBOT_WATCHDOG_US + 100 * MS) {
        step();
    }
    CHECK(roburoc4_client_state(&life.referee.client) == ROBUROC4_STATE_IDLE);
    CHECK(!robot_moves(&life.robot));
}

uint32_t test_walk(void) {
    uint32_t number, speeds = 0, trains = 0, faults = 0;
    life.referee.digest = 2166136261UL;
    for (number = 1; number <= LIVES && failures() == 0; number++) {
        be_born(number);
        suffer();
        recover();
        die();
        speeds += life.referee.speeds;
        trains += life.referee.trains;
        faults += life.referee.lost + life.referee.reboots + life.referee.clock_faults +
                  life.referee.overrides + life.referee.leases_over;
        if (failures() > 0) {
            say("in life ");
            say_number(number);
            say("\n");
        }
    }
    /* The lives were not empty. */
    CHECK(failures() > 0 || (speeds >= 50UL * LIVES && trains >= 5UL * LIVES));
    CHECK(failures() > 0 || faults >= 10UL * LIVES);
    return life.referee.digest;
}
