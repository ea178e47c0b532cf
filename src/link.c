/* SPDX-License-Identifier: MIT
 *
 * The link: order, loss and jitter of statuses; mapping of the robot's clock; detection of
 * restarts.
 */
#include "machines.h"

typedef roburoc4_private_service service;

/* Three statuses in a row that are this much older than the newest mean a restart. */
#define BACK_CYCLES 100
#define BACK_STATUSES 3
/* The period is the shortest of this many gaps: loss would have to fall into all of them. */
#define PERIOD_GAPS 16
#define SEEN_BITS 64
/* A longer gap is a pause of the robot, not loss. */
#define LONGEST_GAP 6000
#define RECENT_STATUSES 200
#define MAP_WINDOW_US (5 * SECOND)
#define AGE_UNKNOWN UINT32_MAX
/* A bound on ages as high as this is of little use. */
#define POOR_US (300 * MS)
/* So is one that was not proved for this long. */
#define UNPROVEN_US (5 * SECOND)
/* The unit of `lowered`, as a power of two of microseconds. */
#define LOWERED_BITS 10
/* A robot cannot restart within this time; after a longer gap, or once it was lost, its clock must
 * have advanced as the host's, give or take a second. */
#define RESTART_US SECOND
#define CLOCK_TOLERANCE_US SECOND
/* Answers are prompt, but statuses more than a second late: after this long, the robot's clock was
 * set. */
#define CONTRADICTION_US (2 * SECOND)
/* If statuses are less late than that, answers are believed after this long. */
#define FORGIVEN_US (60 * SECOND)
/* How late or early a status is, in 32 bits: at most this. */
#define FAR_US (INT32_C(1) << 30)
/* The same for drift; less, so that it hides no other robot. */
#define MOST_DRIFT_US (UINT32_C(1) << 29)

void roburoc4_link_expect(roburoc4_private_link *l, uint32_t index, uint32_t period_ms) {
    service *s = &l->services[index];
    s->period_cycles = (uint16_t)cycles_of(period_ms);
    s->gap_min = UINT16_MAX;
    s->gap_count = 0;
}

void roburoc4_link_renewed(roburoc4_private_link *l, uint32_t index, uint32_t now_us) {
    l->services[index].renewed = 1;
    if (index == STATUS_INDEX(ROBUROC4_SERVICE_IOCARD)) {
        l->card_inserted_us = now_us;
    }
}

bool roburoc4_link_heard(const roburoc4_private_link *l, uint32_t index) {
    return l->services[index].fresh && !l->services[index].renewed;
}

void roburoc4_link_forget_times(roburoc4_private_link *l, uint32_t now_us) {
    l->mapped = 0;
    l->asked_us = now_us - OLDEST_US;
    l->answered = 0;
    l->round_trip_us = 0;
    l->round_trip_min_us = 0;
    l->slack_us = 0;
    l->contradicted = 0;
}

void roburoc4_link_pause(roburoc4_private_link *l, uint64_t pause_us) {
    const uint32_t jump_us = clipped(pause_us);
    l->slack_us = jump_us > l->slack_us ? jump_us : l->slack_us;
}

void roburoc4_link_restart(roburoc4_private_link *l, const roburoc4_config *config) {
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        service *s = &l->services[i];
        s->seen = 0;
        roburoc4_link_expect(l, i, config->period_ms[i + ROBUROC4_SERVICE_IOCARD]);
    }
    l->answered = 0;
    l->round_trip_us = 0;
    l->round_trip_min_us = 0;
    if (l->floor_age_us == AGE_UNKNOWN) {
        l->mapped = 0; /* nothing tells which time the same robot would show */
    }
}

/** From the robot's stamp to arrival. The clocks differ, so only differences of it mean something.
 */
static uint64_t transit_of(uint64_t robot_cycles, uint64_t received_us) {
    return received_us - robot_cycles * ROBUROC4_CYCLE_US;
}

static uint32_t sum(uint32_t a, uint32_t b) {
    return a + b >= a ? a + b : UINT32_MAX;
}

static uint32_t not_negative(int32_t value) {
    return value > 0 ? (uint32_t)value : 0;
}

/** By how much this transit time exceeds the shortest one; negative if it is shorter, 0 if it is
 * the first one. */
static int32_t late_by(const roburoc4_private_link *l, uint64_t transit) {
    const int64_t late_us = (int64_t)(transit - l->floor_us);
    if (!l->mapped) {
        return 0;
    }
    return late_us > FAR_US ? FAR_US : late_us < -FAR_US ? -FAR_US : (int32_t)late_us;
}

/** Whether a status that is older than the newest of all services is from a restarted robot. */
static bool restarted(roburoc4_private_link *l, const service *s, uint64_t robot_cycles,
                      uint64_t now_us) {
    const bool renewed = s->renewed && now_us - s->received_us >= SECOND;
    if (l->was_lost) {
        return true;
    }
    if (renewed && s->seen != 0 && robot_cycles < s->robot_cycles) {
        return true; /* the first of a service that fell silent and was subscribed to again */
    }
    l->back_count = robot_cycles + BACK_CYCLES < l->newest_cycles ? l->back_count + 1U : 0;
    return l->back_count >= BACK_STATUSES;
}

/** A status that is not newer: a late one, which was counted as lost, or a duplicate. */
static void late(service *s, uint64_t robot_cycles) {
    const uint64_t behind = s->robot_cycles - robot_cycles;
    const uint64_t bit = behind < SEEN_BITS ? (uint64_t)1 << behind : 0;
    if ((s->seen & bit) != 0) {
        s->duplicates++;
        return;
    }
    s->late++;
    if (bit != 0 && s->lost > 0) {
        s->seen |= bit;
        s->lost--;
        if (s->recent_lost > 0) {
            s->recent_lost--;
        }
    }
}

/** How many periods a gap is, to the nearest. Dividing is a large function on small machines. */
static uint32_t periods_in(uint32_t gap, uint32_t period_cycles) {
    uint32_t periods = 0;
    for (gap += period_cycles / 2; gap >= period_cycles; gap -= period_cycles) {
        periods++;
    }
    return periods;
}

/** The period is longer than expected: what seemed lost was never sent. */
static void revoke_losses(service *s) {
    const uint32_t steps = periods_in(s->gap_min, s->period_cycles);
    const uint32_t wrong = (steps - 1) * (PERIOD_GAPS - 1);
    s->lost -= wrong < s->lost ? wrong : s->lost;
    const uint16_t recent = (uint16_t)at_most(wrong, s->recent_lost);
    s->recent_lost -= recent;
    s->recent -= recent;
}

/** Take the shortest of several gaps as the period. */
static void learn_period(service *s, uint16_t gap) {
    if (gap < s->gap_min) {
        s->gap_min = gap;
    }
    if (++s->gap_count >= PERIOD_GAPS || gap < s->period_cycles) {
        if (s->gap_min > s->period_cycles) {
            revoke_losses(s);
        }
        s->period_cycles = s->gap_min;
        s->gap_min = UINT16_MAX;
        s->gap_count = 0;
    }
}

static void mark_seen(service *s, uint64_t gap) {
    s->seen = gap < SEEN_BITS ? s->seen << gap | 1 : 1;
}

/** The statuses of the periods since the last one: this one came, those in between are missing. */
static void count_periods(service *s, uint16_t gap) {
    uint32_t steps = 1;
    if (gap > s->period_cycles) { /* otherwise nothing is missing */
        steps = periods_in(gap, s->period_cycles);
        s->lost += steps - 1;
        s->recent_lost = (uint16_t)(s->recent_lost + steps - 1); /* both are small */
    }
    s->recent = (uint16_t)(s->recent + steps);
    if (s->recent >= RECENT_STATUSES) {
        s->recent /= 2;
        s->recent_lost /= 2;
    }
}

/** RFC 3550, 6.4.1: the deviation of transit times, smoothed by 16. */
static void measure_jitter(service *s, uint64_t transit) {
    const uint32_t change = (uint32_t)(transit - transit_of(s->robot_cycles, s->received_us));
    const uint32_t deviation = change < 0x80000000U ? change : 0U - change;
    s->jitter_us = s->jitter_us - s->jitter_us / 16 + deviation / 16;
}

/** What the time since the last status tells of period, loss and jitter. */
static void measure(service *s, uint64_t gap, uint64_t transit) {
    measure_jitter(s, transit);
    if (gap <= LONGEST_GAP) {
        learn_period(s, (uint16_t)gap);
        count_periods(s, (uint16_t)gap);
    }
}

/** How far the bound on ages has grown since it was proven: the clocks of host and robot may have
 *  drifted apart by 500 ppm. */
static uint32_t drifted_us(const roburoc4_private_link *l, uint64_t now_us) {
    const uint64_t part_us = (now_us - l->proven_us) >> 11;
    if (part_us >> 52 != 0) {
        return 0; /* it was proven later */
    }
    const uint32_t least_us = part_us < MOST_DRIFT_US ? (uint32_t)part_us : MOST_DRIFT_US;
    return least_us + (least_us >> 5);
}

/** A status came faster than any before: so much of the drift did not happen. */
static void lower_floor(roburoc4_private_link *l, uint64_t transit, uint32_t below_us,
                        uint64_t now_us) {
    const uint32_t drifted = drifted_us(l, now_us);
    if (drifted > below_us) {
        l->floor_age_us = sum(l->floor_age_us, drifted - below_us);
    }
    l->floor_us = transit;
    l->proven_us = now_us;
}

/** The clock is mapped by the smallest offset of the last one to two windows, because delays only
 *  add to it. floor_us is the shortest transit time so far; the status that had it was at most
 *  floor_age_us old when it arrived, which is unknown until the first answer. */
static inline void map_times(roburoc4_private_link *l, uint64_t transit, int32_t late_us,
                             uint64_t now_us) {
    const int64_t offset = (int64_t)transit;
    if (!l->mapped) {
        l->mapped = 1;
        l->offset_us = l->offset_before_us = offset;
        l->offset_since_us = (uint32_t)now_us;
        l->floor_age_us = AGE_UNKNOWN;
        l->floor_us = transit;
        l->proven_us = now_us;
        l->lowered = 0;
        l->excess_us = 0;
        return;
    }
    if ((uint32_t)now_us - l->offset_since_us >= MAP_WINDOW_US) {
        l->offset_before_us = l->offset_us;
        l->offset_us = offset;
        l->offset_since_us = (uint32_t)now_us;
    } else if (offset < l->offset_us) {
        l->offset_us = offset;
    }
    if (late_us < 0) {
        lower_floor(l, transit, (uint32_t)-late_us, now_us);
    }
}

/** Whether answers have been on time, but statuses late, for this long. */
static bool contradicted_for(roburoc4_private_link *l, uint32_t span_us, uint32_t now_us) {
    if (!l->contradicted) {
        l->contradicted = 1;
        l->contradicted_us = now_us;
    }
    return now_us - l->contradicted_us >= span_us;
}

/** Pairs of an answer and a status showed that the bound is too high by this: raise floor_us as far
 *  as the clocks may have drifted or jumped since it was proven, then lower floor_age_us. If both
 *  do not suffice, answers may have a queue of their own, and prove nothing for a while. */
static void lower_bound(roburoc4_private_link *l, uint32_t late_us, uint32_t by_us,
                        uint64_t now_us) {
    const uint32_t drifted = drifted_us(l, now_us);
    const uint32_t age_us = sum(l->floor_age_us, drifted);
    uint32_t rise_us = at_most(at_most(sum(drifted, l->slack_us), late_us), by_us);
    if (by_us - rise_us <= age_us) {
        l->contradicted = 0;
    } else if (contradicted_for(l, FORGIVEN_US, (uint32_t)now_us)) {
        rise_us = at_most(by_us - age_us, late_us);
        by_us = rise_us + age_us;
        l->contradicted = 0;
    } else {
        rise_us = by_us = 0;
    }
    if (by_us != 0) {
        l->lowered = 0;
    }
    l->floor_us += rise_us;
    l->floor_age_us = age_us - (by_us - rise_us);
    l->proven_us = now_us;
}

/** By how much the last status of a service was late. */
static uint32_t late_of(const roburoc4_private_link *l, const service *s) {
    const int32_t late_us = late_by(l, transit_of(s->robot_cycles, s->received_us));
    return late_us < FAR_US ? not_negative(late_us) : AGE_UNKNOWN;
}

/** By how much all statuses of the last second were late: that is a queue's. What one is later than
 *  that is its own, and an answer may have overtaken it. */
static uint32_t common_lateness(const roburoc4_private_link *l, uint32_t late_us, uint64_t now_us) {
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        if (now_us - l->services[i].received_us < SECOND) {
            late_us = at_most(late_us, late_of(l, &l->services[i]));
        }
    }
    return late_us;
}

/** The first status after an answer was made after the request was sent, give or take a cycle. That
 *  bounds its age, and tells drifting clocks from a growing queue: with either, all statuses look
 *  late. A network can swap an answer and a status, so the bound is lowered only by what all such
 *  pairs within a second agree on. */
static void learn_age(roburoc4_private_link *l, uint32_t late_us, uint64_t now_us) {
    const uint32_t drifted = drifted_us(l, now_us);
    const uint32_t passed_us = (uint32_t)now_us - l->asked_us; /* that or longer */
    const uint32_t proven_us = passed_us < OLDEST_US ? passed_us + ROBUROC4_CYCLE_US : AGE_UNKNOWN;
    const uint32_t common_us = common_lateness(l, late_us, now_us);
    const uint32_t bound_us = sum(common_us + drifted, l->floor_age_us);
    const uint32_t excess_us = bound_us > proven_us ? bound_us - proven_us : 0;
    if (l->floor_age_us == AGE_UNKNOWN) {
        l->floor_age_us = proven_us;
        l->proven_us = now_us;
        l->lowered = 0;
    } else if (l->excess_us == 0) {
        if (late_us <= sum(l->round_trip_min_us, ROBUROC4_CYCLE_US + drifted)) {
            l->contradicted = 0; /* a slow answer alone would not show it */
        }
        l->excess_us = excess_us;
        l->excess_since_us = (uint32_t)now_us;
    } else {
        l->excess_us = at_most(l->excess_us, excess_us);
        if ((uint32_t)now_us - l->excess_since_us >= SECOND) {
            lower_bound(l, common_us, l->excess_us, now_us);
            if (excess_us - l->excess_us + (late_us - common_us) < ROBUROC4_CYCLE_US) {
                l->slack_us = 0; /* none of that is from before the jump */
            }
            l->excess_us = 0;
        }
    }
}

/** Whether this status was made when its stamp says. Stamps of measured motion may be older, that
 * of a service's first status by a whole refresh, so the IO card's are preferred where they come.
 */
static bool dates_itself(const roburoc4_private_link *l, const service *s, bool first,
                         uint64_t now_us) {
    const service *card = &l->services[STATUS_INDEX(ROBUROC4_SERVICE_IOCARD)];
    return s < &l->services[STATUS_INDEX(ROBUROC4_SERVICE_LOCALIZATION)] ||
           (!first && now_us - card->received_us >= SECOND &&
            (uint32_t)now_us - l->card_inserted_us >= SECOND);
}

/** Whether the bound on ages needs another proof, even by a status that is late by itself. */
static bool is_poor(const roburoc4_private_link *l, uint64_t now_us) {
    return (l->floor_age_us >= POOR_US && l->floor_age_us != AGE_UNKNOWN) ||
           now_us - l->proven_us >= UNPROVEN_US;
}

/** By how much less a status took than any before, beyond what clocks drift apart. */
static uint32_t early_by(const roburoc4_private_link *l, int32_t late_us, uint64_t now_us) {
    if (late_us >= 0) {
        return 0;
    }
    const uint32_t drifted = drifted_us(l, now_us);
    return (uint32_t)-late_us > drifted ? (uint32_t)-late_us - drifted : 0;
}

/** Whether a status is from later than is possible: of a robot that restarted, or another one. In
 * many small steps, too, delays can shrink only by what they were when the floor's age was proven.
 */
static bool ahead_of_time(const roburoc4_private_link *l, uint32_t early_us, bool gap) {
    if (early_us == 0) {
        return false;
    }
    const bool known = gap && l->floor_age_us != AGE_UNKNOWN;
    const uint32_t span_us =
        known ? sum(l->floor_age_us, 2 * ROBUROC4_CYCLE_US) : CLOCK_TOLERANCE_US;
    return early_us > span_us || sum(early_us, (uint32_t)l->lowered << LOWERED_BITS) >
                                     sum(l->floor_age_us, CLOCK_TOLERANCE_US);
}

/** Whether statuses are so late that the robot's clock was set back, by a restart. It may also be a
 *  queue that holds them back, unless answers are on time, or nothing came for a while. */
static bool clock_was_set(roburoc4_private_link *l, int32_t late_us, uint64_t now_us) {
    if (!l->mapped || not_negative(late_us) <= drifted_us(l, now_us) + CLOCK_TOLERANCE_US) {
        return false;
    }
    return l->was_lost || (l->answered && (uint32_t)now_us - l->asked_us < CLOCK_TOLERANCE_US &&
                           contradicted_for(l, CONTRADICTION_US, (uint32_t)now_us));
}

static bool was_silent(const roburoc4_private_link *l, uint64_t now_us) {
    return l->was_lost || (uint32_t)now_us - l->heard_us >= RESTART_US;
}

/** Whether a status may be from another start of the robot than what was read before, though its
 * stamp cannot show it: the robot was silent before its first status, or this machine's clock
 * jumped in a silence, so that nothing tells which time the robot should show. */
static bool clock_is_lost(const roburoc4_private_link *l, uint64_t robot_cycles, uint64_t now_us) {
    if (l->mapped || l->newest_cycles == 0) {
        return !l->mapped && l->was_lost;
    }
    return was_silent(l, now_us) || robot_cycles > l->newest_cycles + BACK_CYCLES;
}

/** Many small steps must not hide a large one: see ahead_of_time(). */
static void count_early(roburoc4_private_link *l, uint32_t early_us) {
    l->lowered = (uint16_t)at_most(l->lowered + (early_us >> LOWERED_BITS), UINT16_MAX);
}

void roburoc4_link_overhear(roburoc4_private_link *l, uint64_t robot_cycles, uint64_t now_us) {
    const uint64_t transit = transit_of(robot_cycles, now_us);
    const int32_t late_us = late_by(l, transit);
    const uint32_t early_us = early_by(l, late_us, now_us);
    if (robot_cycles < l->newest_cycles || ahead_of_time(l, early_us, true) ||
        clock_is_lost(l, robot_cycles, now_us)) {
        return; /* perhaps from another start: its subscribed statuses tell */
    }
    count_early(l, early_us);
    l->newest_cycles = robot_cycles;
    l->back_count = 0;
    map_times(l, transit, late_us, now_us);
}

/** What a status that is not the next one, on time, means for the robot. */
static verdict judge_time(roburoc4_private_link *l, const service *s, uint64_t robot_cycles,
                          int32_t late_us, uint64_t now_us) {
    const bool gap = was_silent(l, now_us);
    const uint32_t early_us = early_by(l, late_us, now_us);
    if (clock_is_lost(l, robot_cycles, now_us)) {
        return VERDICT_REBOOT;
    }
    if (ahead_of_time(l, early_us, gap)) {
        l->back_count++; /* without a gap, one may be a corrupted datagram */
        return gap || l->back_count >= BACK_STATUSES ? VERDICT_REBOOT : VERDICT_OLD;
    }
    count_early(l, early_us);
    const bool restart = robot_cycles < l->newest_cycles ? restarted(l, s, robot_cycles, now_us)
                                                         : clock_was_set(l, late_us, now_us);
    return restart ? VERDICT_REBOOT : VERDICT_NEW;
}

/** What a status that counts tells of the clocks and of ages. */
static void learn_times(roburoc4_private_link *l, const service *s, uint64_t transit,
                        int32_t late_us, bool newest, bool first, uint64_t now_us) {
    map_times(l, transit, late_us, now_us);
    if (l->slack_us > not_negative(late_us)) {
        l->slack_us = not_negative(late_us); /* the clock has not jumped by more */
    }
    if (l->answered && dates_itself(l, s, first, now_us) && (newest || is_poor(l, now_us))) {
        l->answered = 0;
        learn_age(l, not_negative(late_us), now_us);
    }
}

verdict roburoc4_link_status(roburoc4_private_link *l, service *s, uint64_t robot_cycles,
                             uint64_t now_us) {
    const uint64_t transit = transit_of(robot_cycles, now_us);
    const bool newest = robot_cycles >= l->newest_cycles, first = s->seen == 0;
    int32_t late_us = (int32_t)(transit - l->floor_us); /* if it is on time */
    if (!newest || !l->mapped || l->was_lost || transit - l->floor_us >= CLOCK_TOLERANCE_US) {
        late_us = late_by(l, transit);
        const verdict verdict = judge_time(l, s, robot_cycles, late_us, now_us);
        if (verdict != VERDICT_NEW) {
            return verdict;
        }
    }
    if (newest) {
        l->newest_cycles = robot_cycles;
        l->back_count = 0;
    }
    if (first) {
        s->seen = 1;
    } else if (robot_cycles <= s->robot_cycles) {
        if (WITH_STATISTICS) {
            late(s, robot_cycles);
        }
        return VERDICT_OLD;
    } else {
        const uint64_t gap = robot_cycles - s->robot_cycles;
        mark_seen(s, gap);
        if (WITH_STATISTICS) {
            measure(s, gap, transit);
        }
    }
    learn_times(l, s, transit, late_us, newest, first, now_us);
    s->received++;
    s->robot_cycles = robot_cycles;
    s->received_us = now_us;
    s->fresh = 1;
    s->renewed = 0;
    l->heard_us = (uint32_t)now_us;
    l->was_lost = 0;
    return VERDICT_NEW;
}

void roburoc4_link_round_trip(roburoc4_private_link *l, bool text, uint32_t sent_us,
                              uint32_t now_us) {
    const uint32_t passed_us = now_us - sent_us;
    const uint32_t sample = passed_us > 0 ? passed_us : 1; /* 0 is none yet */
    if (l->round_trip_min_us == 0 || sample < l->round_trip_min_us) {
        l->round_trip_min_us = sample;
    }
    l->round_trip_us =
        l->round_trip_us == 0 ? sample : l->round_trip_us - l->round_trip_us / 8 + sample / 8;
    if (!text && (int32_t)(sent_us - l->asked_us) >= 0) {
        l->asked_us = sent_us;
        l->answered = 1;
    }
}

uint32_t roburoc4_link_age(const roburoc4_private_link *l, uint32_t index, uint64_t now_us) {
    const service *s = &l->services[index];
    const uint32_t grown_us = sum(late_of(l, s), drifted_us(l, s->received_us));
    return sum(clipped(now_us - s->received_us), sum(grown_us, l->floor_age_us));
}

uint32_t roburoc4_link_age_at_arrival(const roburoc4_private_link *l, uint32_t index) {
    return roburoc4_link_age(l, index, l->services[index].received_us);
}

bool roburoc4_link_fresh(const roburoc4_private_link *l, uint32_t index, uint32_t limit_us,
                         uint64_t now_us, timer *t) {
    return l->services[index].fresh && !reached(t, roburoc4_link_age(l, index, now_us), limit_us);
}

void roburoc4_link_invalidate(roburoc4_private_link *l) {
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        l->services[i].fresh = 0;
    }
}

void roburoc4_link_rebase(roburoc4_private_link *l, uint32_t now_us) {
    roburoc4_link_invalidate(l); /* the age of statuses is no longer known */
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        l->services[i].renewed = 0;
    }
    roburoc4_link_forget_times(l, now_us);
    l->asked_us = now_us; /* nor is it known when the open requests were sent */
}
