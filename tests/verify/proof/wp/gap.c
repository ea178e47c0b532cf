/* SPDX-License-Identifier: MIT
 *
 * For Frama-C's WP: the gap between two statuses that src/link.c learns a period from is never 0,
 * which Eva believes (believed.h), and so nothing is divided by 0. Never compiled.
 */
#include "link.c"

/*@ predicate period_holds(service *s) = s->period_cycles >= 1 && s->gap_min >= 1; */

/*@ requires \valid(s) && period_holds(s);
    assigns s->lost, s->recent_lost; */
static void revoke_losses(service *s);

/*@ requires \valid(s) && period_holds(s);
    requires newer: gap >= 1;
    assigns s->gap_min, s->gap_count, s->period_cycles, s->lost, s->recent_lost;
    ensures period_holds(s); */
static void learn_period(service *s, uint16_t gap);

/*@ requires \valid(s) && period_holds(s);
    requires newer: robot_cycles > s->robot_cycles;
    assigns *s;
    ensures period_holds(s); */
static void count_gap(service *s, uint64_t robot_cycles);

/*@ requires \valid(l) && \valid_read(s);
    assigns l->back_count; */
static bool restarted(link *l, const service *s, uint64_t robot_cycles, uint64_t now_us);

/*@ requires \valid(s);
    assigns s->duplicates, s->late, s->seen, s->lost, s->recent_lost, s->recent_received; */
static void late(service *s, uint64_t robot_cycles);

/*@ requires \valid(s);
    assigns s->transit_us, s->jitter_us; */
static void measure_jitter(service *s, uint64_t robot_cycles, uint64_t now_us);

/*@ requires \valid(l);
    assigns l->mapped, l->offset_us, l->offset_before_us, l->offset_since_us; */
static void map_clock(link *l, uint64_t robot_cycles, uint64_t now_us);

/*@ requires \valid(l) && index < 5 && period_holds(&l->services[index]);
    assigns *l;
    ensures period_holds(&l->services[index]); */
verdict roburoc4_link_status(link *l, uint32_t index, uint64_t robot_cycles, uint64_t now_us);
