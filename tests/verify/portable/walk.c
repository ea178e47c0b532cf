/* SPDX-License-Identifier: MIT
 *
 * The walk: a client and a robot in virtual time, with a user who behaves badly, over a network
 * that loses, doubles, delays, reorders and damages, with reboots, a game pad, clocks that step and
 * callers that hang. All that they send, and when, goes into one digest, which must be the same on
 * every target; whether it is right is for the unit tests and the soak test on a host to say. Its
 * last line is "portable: ok, walk DIGEST", or says that a check failed.
 */
#include <string.h>

#include "port.h"
#include "robot.h"

#define MS 1000UL
#define SECOND 1000000UL
#define RUNS 12U
#define FAULTS_US (12 * SECOND)
#define STEP_US (10 * MS)
/* After the faults the robot moves again within this; a bound on ages that answers contradict is
 * lowered after a minute. */
#define RECOVERED_US (75 * SECOND)
#define FLIGHTS 20
#define LONGEST 75
#define STATUS_HEAD 11 /* service and time of a status, which are never damaged */

enum { TO_CLIENT, TO_ROBOT };

typedef struct flight {
    uint64_t at_us;
    uint8_t used, to, size;
    uint8_t data[LONGEST];
} flight;

static struct {
    flight flights[FLIGHTS];
    uint8_t loss, duplicate, damage; /* of 256 */
    uint32_t delay_us, jitter_us;
} net;

static roburoc4_client client;
static robot partner;
static uint32_t dice, digest = 2166136261UL;
static uint64_t now_us;         /* true time */
static uint64_t clock_us;       /* what the client's clock shows at true time 0 */
static uint64_t hung_until_us;  /* until then the caller makes no call */
static uint64_t event_until_us; /* the pad is held, or the robot is off */
static uint64_t drive_until_us, quiet_until_us, drove_us;
static float want[2];
static uint32_t failed, speeds;

/* ------------------------------------------------------------------------------- output --- */

static void say(const char *text) {
    while (*text != '\0') {
        port_put(*text++);
    }
}

static void say_hex(uint32_t number) {
    int shift;
    for (shift = 28; shift >= 0; shift -= 4) {
        port_put("0123456789abcdef"[number >> shift & 15U]);
    }
}

static void check(int passed, const char *what) {
    if (!passed && failed++ < 10) {
        say("failed: ");
        say(what);
        say("\n");
    }
}

static void add_to_digest(const void *data, size_t size) {
    const uint8_t *bytes = (const uint8_t *)data;
    size_t i;
    for (i = 0; i < size; i++) {
        digest = (digest ^ bytes[i]) * 16777619UL; /* FNV-1a */
    }
}

/** In the same byte order on every target. */
static void add_number(uint64_t number) {
    uint8_t bytes[8];
    int i;
    for (i = 0; i < 8; i++) {
        bytes[i] = (uint8_t)(number >> 8 * i);
    }
    add_to_digest(bytes, sizeof bytes);
}

/* ------------------------------------------------------------------------------ network --- */

/** 0 to below - 1. */
static uint32_t roll(uint32_t below) {
    dice ^= dice << 13;
    dice ^= dice >> 17;
    dice ^= dice << 5;
    return dice % below;
}

static int chance(uint8_t of_256) {
    return roll(256) < of_256;
}

/** Flip a bit behind the head of a status, or cut its end off. */
static void damage(flight *f) {
    if (f->to != TO_CLIENT || f->data[0] != ROBUROC4_HEADER_STATUS || f->size <= STATUS_HEAD) {
        return;
    }
    if (chance(64)) {
        f->size = (uint8_t)(1 + roll(f->size));
    } else {
        const uint32_t at = STATUS_HEAD + roll((uint32_t)f->size - STATUS_HEAD);
        f->data[at] = (uint8_t)(f->data[at] ^ 1U << roll(8));
    }
}

static void transmit(uint8_t to, const uint8_t *data, size_t size) {
    int copies = chance(net.loss) ? 0 : chance(net.duplicate) ? 2 : 1;
    add_to_digest(data, size);
    add_number(now_us);
    for (; copies > 0; copies--) {
        flight *f = net.flights;
        while (f < net.flights + FLIGHTS && f->used) {
            f++;
        }
        if (f == net.flights + FLIGHTS || size > LONGEST) {
            return;
        }
        f->used = 1;
        f->to = to;
        f->size = (uint8_t)size;
        f->at_us = now_us + net.delay_us + roll(net.jitter_us + 1);
        memcpy(f->data, data, size);
        if (chance(net.damage)) {
            damage(f);
        }
    }
}

/** Take the first datagram that has arrived: its length, or 0. */
static size_t take(uint8_t to, uint8_t *buffer) {
    flight *first = NULL;
    size_t i;
    for (i = 0; i < FLIGHTS; i++) {
        flight *f = &net.flights[i];
        if (f->used && f->to == to && f->at_us <= now_us &&
            (first == NULL || f->at_us < first->at_us)) {
            first = f;
        }
    }
    if (first == NULL) {
        return 0;
    }
    memcpy(buffer, first->data, first->size);
    first->used = 0;
    return first->size;
}

/* --------------------------------------------------------------------------------- user --- */

static uint64_t client_us(void) {
    return now_us + clock_us;
}

/** For calls that may be refused here. */
static void ignore(roburoc4_result result) {
    (void)result;
}

static void drive(float linear, float angular) {
    if (roburoc4_client_drive(&client, linear, angular, 0, client_us()) >= 0) {
        drove_us = now_us;
    }
}

/** -4 to 4, also beyond the robot's limits; exact, so that it is the same on every target. */
static float some_speed(void) {
    return (float)((int32_t)roll(1025) - 512) / 128.0f;
}

static void user_drives(void) {
    if (now_us >= drive_until_us) {
        quiet_until_us = now_us + roll(600 * MS);
        drive_until_us = quiet_until_us + roll(2 * SECOND);
    }
    if (now_us < quiet_until_us) {
        return;
    }
    if (chance(24)) {
        want[0] = some_speed();
        want[1] = some_speed();
    }
    drive(want[0], want[1]);
}

static void user_asks_else(void) {
    switch (roll(5)) {
    case 0:
        ignore(roburoc4_client_pause(&client, client_us()));
        break;
    case 1:
        ignore(roburoc4_client_stop(&client, client_us()));
        break;
    case 2:
        (void)roburoc4_client_relocalize(&client, 1.5, -2.25, 0.5, client_us());
        break;
    case 3:
        (void)roburoc4_client_set_digital_outputs(&client, 255, roll(256), client_us());
        break;
    default: {
        const uint32_t bits = chance(128) ? 0x7FC00000UL : 0xFF800000UL; /* NaN, -infinity */
        float nonsense;
        memcpy(&nonsense, &bits, sizeof nonsense);
        check(roburoc4_client_drive(&client, nonsense, 0, 0, client_us()) ==
                  ROBUROC4_ERR_NOT_FINITE,
              "a speed that is no number is refused");
    }
    }
}

static void user_acts(void) {
    if (chance(32)) {
        ignore(roburoc4_client_arm(&client, client_us()));
    }
    if (chance(64)) {
        user_drives();
    }
    if (chance(4)) {
        user_asks_else();
    }
}

/* ------------------------------------------------------------------------------- faults --- */

static void garbage_arrives(void) {
    uint8_t data[LONGEST];
    const size_t size = roll(LONGEST) + 1;
    size_t i;
    for (i = 0; i < size; i++) {
        data[i] = (uint8_t)roll(256);
    }
    data[0] = (uint8_t)(data[0] % 16); /* an answer, mostly */
    transmit(TO_CLIENT, data, size);
}

static void robot_suffers(void) {
    if (now_us < event_until_us) {
        return;
    }
    if (event_until_us != 0) {
        event_until_us = 0;
        partner.pad_a = 0;
        if (!partner.powered) {
            robot_boot(&partner, now_us);
        }
    } else if (roll(600) == 0) {
        event_until_us = now_us + 100 * MS + roll(2 * SECOND);
        partner.pad_a = chance(170) ? 1 : 0;
        partner.powered = partner.pad_a;
    }
}

static void all_suffer(void) {
    robot_suffers();
    if (roll(300) == 0) {
        net.loss = (uint8_t)roll(154); /* to 60 % */
        net.duplicate = (uint8_t)roll(40);
        net.damage = (uint8_t)roll(20);
        net.delay_us = roll(60 * MS);
        net.jitter_us = roll(200 * MS);
    }
    if (roll(500) == 0) {
        hung_until_us = now_us + roll(1500 * MS);
    }
    if (roll(800) == 0) {
        clock_us += roll(2 * SECOND);
    } else if (roll(800) == 0) {
        clock_us -= roll(2 * SECOND);
    }
    if (chance(4)) {
        garbage_arrives();
    }
}

/* --------------------------------------------------------------------------------- time --- */

static void robot_speaks(void) {
    uint8_t data[LONGEST], reply[LONGEST];
    size_t size;
    robot_advance(&partner, now_us);
    while ((size = take(TO_ROBOT, data)) > 0) {
        size = robot_hear(&partner, data, size, reply, sizeof reply);
        if (size > 0) {
            transmit(TO_CLIENT, reply, size);
        }
    }
    while ((size = robot_status(&partner, data, sizeof data)) > 0) {
        transmit(TO_CLIENT, data, size);
    }
}

static void client_speaks(void) {
    uint8_t data[LONGEST];
    size_t size;
    roburoc4_result length;
    while ((size = take(TO_CLIENT, data)) > 0) {
        (void)roburoc4_client_receive(&client, data, size, client_us());
    }
    while ((length = roburoc4_client_poll_transmit(&client, data, sizeof data, client_us())) > 0) {
        transmit(TO_ROBOT, data, (size_t)length);
        speeds += data[0] == ROBUROC4_HEADER_STATUS;
    }
    add_number(roburoc4_client_take_events(&client));
}

/** To the next moment at which something happens, 10 ms on at most. */
static void step(void) {
    uint64_t next_us = now_us + STEP_US;
    const uint64_t deadline_us = roburoc4_client_next_deadline(&client) - clock_us;
    size_t i;
    for (i = 0; i < FLIGHTS; i++) {
        const uint64_t at_us = net.flights[i].at_us;
        if (net.flights[i].used && at_us < next_us && at_us > now_us) {
            next_us = at_us;
        }
    }
    if (deadline_us < next_us && deadline_us > now_us) {
        next_us = deadline_us;
    }
    now_us = next_us;
    robot_speaks();
    if (now_us >= hung_until_us) {
        client_speaks();
    }
    /* A speed that nobody renews ends: lease, slowest datagram, the robot's watchdog. */
    check(!robot_moves(&partner) ||
              now_us - drove_us <= 250 * MS + 260 * MS + ROBOT_WATCHDOG_US + 2 * STEP_US,
          "the robot stops when nobody drives");
}

static void begin(uint32_t number) {
    roburoc4_config config;
    memset(&net, 0, sizeof net);
    memset(&partner, 0, sizeof partner);
    now_us = hung_until_us = event_until_us = drive_until_us = quiet_until_us = drove_us = 0;
    dice = number * 2654435769UL;
    clock_us = 100 * (uint64_t)SECOND;
    partner.first_id = (uint16_t)(number % 2 == 0 ? 2 : 40);
    robot_boot(&partner, 0);
    (void)roburoc4_config_init(&config, sizeof config);
#ifdef ROBUROC4_NO_TEXTS
    config.iocard_id = partner.first_id;
    config.differential_id =
        partner.first_id + ROBUROC4_SERVICE_DIFFERENTIAL - ROBUROC4_SERVICE_IOCARD;
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
#endif
    check(roburoc4_client_init(&client, sizeof client, &config) == ROBUROC4_OK, "init");
    check(roburoc4_client_start(&client, client_us()) == ROBUROC4_OK, "start");
}

static void suffer(void) {
    while (now_us < FAULTS_US) {
        all_suffer();
        if (now_us >= hung_until_us) {
            user_acts();
        }
        step();
    }
}

/** The faults are over: the client is ready again, and the robot can be driven again. */
static void recover(void) {
    const uint64_t begun_us = now_us;
    net.loss = net.duplicate = net.damage = 0;
    net.delay_us = net.jitter_us = 0;
    partner.pad_a = 0;
    if (!partner.powered) {
        robot_boot(&partner, now_us);
    }
    do {
        ignore(roburoc4_client_arm(&client, client_us()));
        drive(0.5f, -0.25f);
        step();
    } while (!robot_moves(&partner) && now_us - begun_us < RECOVERED_US);
    check(robot_moves(&partner), "the robot moves again after the faults");
}

static void end(void) {
    const uint64_t begun_us = now_us;
    (void)roburoc4_client_close(&client, client_us());
    while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE &&
           now_us - begun_us < ROBOT_WATCHDOG_US + 100 * MS) {
        step();
    }
    check(roburoc4_client_state(&client) == ROBUROC4_STATE_IDLE, "idle after close()");
    check(!robot_moves(&partner), "the robot stands after close()");
}

int main(void) {
    uint32_t number;
    port_begin();
    for (number = 1; number <= RUNS && failed == 0; number++) {
        begin(number);
        suffer();
        recover();
        end();
    }
    check(failed > 0 || speeds >= 100UL * RUNS, "commands were sent");
    say(failed > 0 ? "portable: FAILED, walk " : "portable: ok, walk ");
    say_hex(digest);
    say("\n");
    port_end(failed > 0);
    return failed > 0;
}
