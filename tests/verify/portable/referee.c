/* SPDX-License-Identifier: MIT
 *
 * The small referee's books, and its judgement of each datagram that leaves the client.
 */
#include "referee.h"

#include <string.h>

#include "check.h"
#include "../../support/telegrams.h"

#define PART "referee.c"
#define MS 1000UL
#define TRAIN_ZEROS 3U

static int is_zero(float linear, float angular) {
    return linear >= 0 && linear <= 0 && angular >= 0 && angular <= 0;
}

static float between(float value, float low, float high) {
    return value < low ? low : value > high ? high : value;
}

static roburoc4_facts facts_of(const referee *f) {
    roburoc4_facts facts;
    facts.size = sizeof facts;
    CHECK(roburoc4_client_facts(&f->client, f->now_us, &facts) == 0);
    return facts;
}

/* ------------------------------------------------------------------------ leaving driving --- */

static void begin_train(referee *f) {
    f->train = 1;
    f->zeros = 0;
    f->confirmed = f->confirmed_late = f->spoke = 0;
    f->trains++;
}

static void leave(referee *f) {
    f->leased = 0;
    if (f->spoke) {
        begin_train(f);
    }
}

static void lose_arming(referee *f) {
    f->armed = 0;
    leave(f);
}

static int lease_lives(const referee *f) {
    return f->leased && f->now_us - f->granted_us < f->lease_us;
}

/** Every call that takes the time: a clock that went back is an exit. */
static void begin(referee *f, uint64_t now_us) {
    if (now_us < f->now_us) {
        f->clock_faults++;
        lose_arming(f);
        f->sent_any = 0;
        f->first_zero_us = now_us;
    }
    f->now_us = now_us;
}

/** Calls at which the client looks whether the lease is over. */
static void tick(referee *f) {
    if (f->leased && !lease_lives(f)) {
        f->leases_over++;
        leave(f);
    }
}

static void end(referee *f) {
    const uint32_t events = roburoc4_client_take_events(&f->client);
    const roburoc4_facts facts = facts_of(f);
    if ((events & ROBUROC4_EVENT_LOST) != 0) {
        f->lost++;
        lose_arming(f);
    }
    if ((events & ROBUROC4_EVENT_REBOOT) != 0) {
        f->reboots++;
        lose_arming(f);
    }
    if ((events & ROBUROC4_EVENT_DISARMED) != 0) {
        lose_arming(f);
    }
    if (roburoc4_client_state(&f->client) == ROBUROC4_STATE_SUBSCRIBING ||
        roburoc4_client_state(&f->client) == ROBUROC4_STATE_READY) {
        roburoc4_differential_properties properties; /* which a bad link may leave unanswered */
        f->known = roburoc4_client_differential_properties(&f->client, &properties) == 0;
    }
    CHECK((events & ROBUROC4_EVENT_ARMED) == 0 || f->calling); /* it never arms by itself */
    CHECK(facts.armed == f->armed);
    CHECK(!facts.driving || lease_lives(f));
}

/* ------------------------------------------------------------------------------ the calls --- */

void referee_begin(referee *f, const robot *r, uint64_t now_us) {
    const uint32_t digest = f->digest;
    const roburoc4_config config = f->config;
    const uint8_t monitor = f->monitor;
    memset(f, 0, sizeof *f);
    f->digest = digest;
    f->config = config;
    f->monitor = monitor;
    f->now_us = now_us;
    f->iocard_id = robot_id(r, ROBUROC4_SERVICE_IOCARD);
    f->differential_id = robot_id(r, ROBUROC4_SERVICE_DIFFERENTIAL);
    CHECK(roburoc4_client_init(&f->client, sizeof f->client, &f->config) == 0);
    CHECK(roburoc4_client_start(&f->client, now_us) == 0);
    end(f);
}

roburoc4_result referee_arm(referee *f, uint64_t now_us) {
    roburoc4_result result;
    begin(f, now_us);
    tick(f);
    result = roburoc4_client_arm(&f->client, now_us);
    if (result >= 0) {
        CHECK(!f->overridden);
        CHECK(roburoc4_client_state(&f->client) == ROBUROC4_STATE_READY);
        f->armed = 1;
    }
    f->calling = 1;
    end(f);
    f->calling = 0;
    return result;
}

void referee_disarm(referee *f, uint64_t now_us) {
    begin(f, now_us);
    lose_arming(f);
    CHECK(roburoc4_client_disarm(&f->client, now_us) == 0);
    end(f);
}

roburoc4_result referee_drive(referee *f, float linear, float angular, uint64_t now_us) {
    roburoc4_result result;
    begin(f, now_us);
    tick(f);
    result = roburoc4_client_drive(&f->client, linear, angular, 0, now_us);
    if (result >= 0) {
        CHECK(f->armed);
        f->leased = 1;
        f->granted_us = now_us;
        f->lease_us = (uint32_t)(f->config.lease_ms * MS);
        f->target[0] = between(linear, -ROBOT_MAX_LINEAR, ROBOT_MAX_LINEAR);
        f->target[1] = between(angular, -ROBOT_MAX_ANGULAR, ROBOT_MAX_ANGULAR);
    }
    end(f);
    return result;
}

void referee_stop(referee *f, uint64_t now_us) {
    if (!f->known) {
        return; /* it would wait until the service is known; the big referee judges that */
    }
    begin(f, now_us);
    f->leased = 0;
    begin_train(f);
    CHECK(roburoc4_client_stop(&f->client, now_us) == 0);
    end(f);
}

void referee_close(referee *f, uint64_t now_us) {
    begin(f, now_us);
    lose_arming(f);
    CHECK(roburoc4_client_close(&f->client, now_us) == 0);
    end(f);
}

/* ---------------------------------------------------------------------- what is received --- */

/** A status that the client used. */
static void note_status(referee *f, const uint8_t *data, size_t size) {
    roburoc4_differential_status speed;
    roburoc4_channels inputs;
    if (roburoc4_decode_iocard_status(data, size, ROBUROC4_AI_COUNT, ROBUROC4_DI_COUNT, &inputs) >=
            0 &&
        inputs.service == f->iocard_id) {
        f->overridden = digital_at(&inputs, ROBUROC4_DI_PAD_A) == 1;
        if (f->overridden) {
            f->overrides++;
            lose_arming(f);
        }
    } else if (roburoc4_decode_differential_status(data, size, &speed) >= 0 &&
               speed.service == f->differential_id &&
               is_zero(speed.target_linear_m_s, speed.target_angular_rad_s)) {
        f->confirmed = (uint8_t)(f->confirmed || f->zeros > 0);
        f->confirmed_late = (uint8_t)(f->confirmed_late || f->zeros >= TRAIN_ZEROS);
    }
}

void referee_receive(referee *f, const uint8_t *data, size_t size, uint64_t now_us) {
    roburoc4_result result;
    begin(f, now_us);
    result = roburoc4_client_receive(&f->client, data, size, now_us);
    if (result >= 0 && data[0] == ROBUROC4_HEADER_STATUS) {
        note_status(f, data, size);
    }
    end(f);
}

/* -------------------------------------------------------------------------- what is sent --- */

static uint64_t period_us(const referee *f) {
    return f->config.drive_period_ms * MS;
}

static int watchdog_over(const referee *f) {
    return f->now_us - f->first_zero_us >= f->config.robot_watchdog_ms * MS;
}

static int train_may_end(const referee *f) {
    return f->zeros >= TRAIN_ZEROS && (f->confirmed || watchdog_over(f));
}

/** The first zero interrupts a speed at once; after a zero it waits for the next robot cycle. */
static int first_zero_owed(const referee *f) {
    return f->train && f->zeros == 0 && f->known &&
           (!f->sent_any || !is_zero(f->sent[0], f->sent[1]) ||
            f->now_us - f->sent_us >= ROBUROC4_CYCLE_US);
}

static void judge_speed(referee *f, float linear, float angular) {
    f->speeds++;
    CHECK(!f->monitor);
    CHECK(f->armed);
    CHECK(lease_lives(f));
    CHECK(!f->train || train_may_end(f));
    CHECK(linear >= f->target[0] && linear <= f->target[0]);
    CHECK(angular >= f->target[1] && angular <= f->target[1]);
    f->train = 0;
    f->spoke = 1;
}

static void judge_zero(referee *f) {
    if (f->train) {
        if (f->zeros++ == 0) {
            f->first_zero_us = f->now_us;
        }
        return;
    }
    CHECK(!f->monitor);
    CHECK(f->armed && lease_lives(f) && is_zero(f->target[0], f->target[1]));
}

static void judge(referee *f, const uint8_t *data, size_t size) {
    roburoc4_differential_command c;
    const int owed = first_zero_owed(f);
    if (data[0] != ROBUROC4_HEADER_STATUS) {
        CHECK(!owed); /* zeros go before all other traffic */
        return;
    }
    CHECK(roburoc4_decode_differential_command(data, size, &c) == 0);
    CHECK(c.service == f->differential_id);
    CHECK(owed || !f->sent_any || f->now_us - f->sent_us >= ROBUROC4_CYCLE_US);
    if (is_zero(c.linear_m_s, c.angular_rad_s)) {
        judge_zero(f);
    } else {
        judge_speed(f, c.linear_m_s, c.angular_rad_s);
    }
    f->sent_any = 1;
    f->sent_us = f->now_us;
    f->sent[0] = c.linear_m_s;
    f->sent[1] = c.angular_rad_s;
}

/** Nothing more leaves at this time: is anything owed, and is the caller told to come in time? */
static void judge_rest(const referee *f) {
    const uint64_t since_us = f->sent_any ? f->now_us - f->sent_us : UINT64_MAX;
    const uint64_t deadline_us = roburoc4_client_next_deadline(&f->client);
    CHECK(!first_zero_owed(f));
    CHECK(!f->train || f->zeros == 0 || train_may_end(f) || since_us < period_us(f));
    if (f->armed && lease_lives(f) && !f->train) {
        CHECK(since_us < period_us(f));
        CHECK(deadline_us <= f->granted_us + f->lease_us);
        CHECK(deadline_us <= f->sent_us + period_us(f));
    }
}

static void add_to_digest(referee *f, const uint8_t *data, size_t size) {
    size_t i;
    for (i = 0; i < size; i++) {
        f->digest = (f->digest ^ data[i]) * 16777619UL; /* FNV-1a */
    }
    for (i = 0; i < 8; i++) {
        f->digest = (f->digest ^ (uint8_t)(f->now_us >> 8 * i)) * 16777619UL;
    }
}

size_t referee_poll(referee *f, uint8_t *buffer, size_t capacity, uint64_t now_us) {
    roburoc4_result size;
    begin(f, now_us);
    tick(f);
    if (f->train && f->zeros >= TRAIN_ZEROS && (f->confirmed_late || watchdog_over(f))) {
        f->train = 0;
    }
    size = roburoc4_client_poll_transmit(&f->client, buffer, capacity, now_us);
    CHECK(size >= 0);
    end(f);
    if (size > 0) {
        judge(f, buffer, (size_t)size);
        add_to_digest(f, buffer, (size_t)size);
    } else if (roburoc4_client_state(&f->client) != ROBUROC4_STATE_IDLE) {
        judge_rest(f);
    }
    return size > 0 ? (size_t)size : 0;
}
