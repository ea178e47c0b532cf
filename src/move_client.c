/* SPDX-License-Identifier: MIT
 *
 * Moves of a client: what they see of it, and what they ask of it.
 */
#include "move_axis.h"

static bool usable(const roburoc4_localization_status *pose) {
    return finite_f64_bits(bits_from_f64(pose->x_m)) && finite_f64_bits(bits_from_f64(pose->y_m)) &&
           finite_f64_bits(bits_from_f64(pose->theta_rad)) &&
           (pose->flags & (ROBUROC4_LOCALIZATION_INVALID | ROBUROC4_LOCALIZATION_ERROR)) == 0;
}

/* A telemeter sees what is ahead if its beam passes by this much at most. */
#define ASIDE_RAD 0.26F

static void view_distances(roburoc4_move_view *v, const roburoc4_client *client) {
    roburoc4_distances distances;
    roburoc4_telemeter telemeter;
    v->front_m = FAR_M;
    v->rear_m = FAR_M;
    if (roburoc4_client_distances(client, &distances, NULL) != ROBUROC4_OK) {
        return;
    }
    for (uint32_t i = 0;
         i < distances.count && roburoc4_client_telemeter(client, i, &telemeter) == ROBUROC4_OK;
         i++) {
        const float aside = roburoc4_move_half_turn(telemeter.theta_rad);
        const float seen = 0.5F * telemeter.field_of_view_rad + ASIDE_RAD;
        if (!beyond(aside, PI_F / 3)) {
            v->front_m = nearer(v->front_m, telemeter.distance_m);
            v->front_known |= !beyond(aside, seen);
        } else if (beyond(aside, 2 * PI_F / 3)) {
            v->rear_m = nearer(v->rear_m, telemeter.distance_m);
            v->rear_known |= !beyond(PI_F - magnitude(aside), seen);
        }
    }
}

/** The smaller size of a pair of limits. */
static float both_ways(float low, float high) {
    return lesser(magnitude(low), magnitude(high));
}

static void view_facts(roburoc4_move_view *v, const roburoc4_facts *facts) {
    v->armed = facts->armed;
    v->overridden = facts->overridden;
    v->inhibited = facts->inhibited;
    v->front_bumper = facts->front_bumper;
    v->rear_bumper = facts->rear_bumper;
    v->front_bumper_known = facts->front_bumper_known;
    v->rear_bumper_known = facts->rear_bumper_known;
    v->distance_age_us = facts->age_us[ROBUROC4_SERVICE_TELEMETER];
    v->disarm_cause = facts->disarm_cause;
    if (facts->driving) {
        v->sent_linear_m_s = facts->sent_linear_m_s;
        v->sent_angular_rad_s = facts->sent_angular_rad_s;
    }
}

static void view_speeds(roburoc4_move_view *v, const roburoc4_client *client,
                        const roburoc4_facts *facts) {
    roburoc4_differential_properties limits;
    roburoc4_differential_status speeds;
    if (facts->age_us[ROBUROC4_SERVICE_DIFFERENTIAL] != UINT32_MAX &&
        !client->private_outputs.relocalizing &&
        roburoc4_client_differential(client, &speeds, NULL) == ROBUROC4_OK) {
        v->speed_cycles = speeds.robot_cycles;
        v->linear_m_s = speeds.current_linear_m_s;
        v->angular_rad_s = speeds.current_angular_rad_s;
    }
    if (roburoc4_client_differential_properties(client, &limits) == ROBUROC4_OK) {
        v->max_linear_m_s = both_ways(limits.min_linear_m_s, limits.max_linear_m_s);
        v->max_angular_rad_s = both_ways(limits.min_angular_rad_s, limits.max_angular_rad_s);
        v->max_linear_m_s2 = both_ways(limits.min_linear_m_s2, limits.max_linear_m_s2);
        v->max_angular_rad_s2 = both_ways(limits.min_angular_rad_s2, limits.max_angular_rad_s2);
    }
}

static void view_pose(roburoc4_move_view *v, const roburoc4_client *client,
                      const roburoc4_facts *facts) {
    roburoc4_localization_status pose;
    if (facts->age_us[ROBUROC4_SERVICE_LOCALIZATION] >= client->private_config.fresh_ms * 1000U ||
        roburoc4_client_localization(client, &pose, NULL) != ROBUROC4_OK || !usable(&pose)) {
        return;
    }
    v->pose_cycles = pose.robot_cycles;
    v->x_m = pose.x_m;
    v->y_m = pose.y_m;
    v->theta_rad = pose.theta_rad;
    v->pose_external = (pose.flags & ROBUROC4_LOCALIZATION_EXTEROCEPTIVE) != 0;
}

static void view_client(roburoc4_move_view *v, const roburoc4_client *client,
                        const roburoc4_facts *facts) {
    memset(v, 0, sizeof *v);
    v->size = sizeof *v;
    v->relocalized = (uint32_t)client->private_outputs.relocalize_us;
    view_facts(v, facts);
    view_speeds(v, client, facts);
    v->scale_linear = client->private_config.scale_linear;
    v->scale_angular = client->private_config.scale_angular;
    /* the facts have scaled speeds */
    v->sent_linear_m_s *= 1 / v->scale_linear;
    v->sent_angular_rad_s *= 1 / v->scale_angular;
    view_pose(v, client, facts);
    view_distances(v, client);
}

/** Whether a speed was asked for that the client would lower; the defaults are lowered. */
static bool too_fast(roburoc4_move *m, const roburoc4_client *client) {
    const roburoc4_config *config = &client->private_config;
    const float most[BOTH] = {config->max_linear_m_s, config->max_angular_rad_s};
    /* They bound the speeds before and after these are scaled. */
    const float ceilings[BOTH] = {lesser(most[0], most[0] / config->scale_linear),
                                  lesser(most[1], most[1] / config->scale_angular)};
    const float defaults[BOTH] = {roburoc4_move_defaults.max_linear_m_s,
                                  roburoc4_move_defaults.max_angular_rad_s};
    float *asked[BOTH] = {&m->private_options.max_linear_m_s,
                          &m->private_options.max_angular_rad_s};
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        if (beyond(m->private_kind == FOR ? m->private_goal[axis] : *asked[axis], ceilings[axis]) &&
            (m->private_kind == FOR || !is_zero(*asked[axis] - defaults[axis]))) {
            return true;
        }
        *asked[axis] = lesser(*asked[axis], ceilings[axis]);
    }
    return false;
}

/** Whether a stop sequence began that this move has not seen before. */
static bool stop_began(roburoc4_move *m, const roburoc4_private_drive *d, bool stops) {
    enum { MOVES, WILL_STOP, STOPS };
    const uint8_t before = m->private_begun ? m->private_stopping : WILL_STOP;
    const uint8_t stopping = !stops ? MOVES : d->zeros_sent == 0 ? WILL_STOP : STOPS;
    const bool another = before == STOPS && d->stop_us != m->private_stop_us;
    m->private_stopping = stopping;
    m->private_stop_us = d->stop_us;
    return (stopping != MOVES && (before == MOVES || another)) ||
           (stopping == WILL_STOP && before == STOPS);
}

/** Whether its lease ended without it, perhaps before it drove on: then another stop sequence
 * began. */
static bool ended_elsewhere(roburoc4_move *m, const roburoc4_client *client,
                            const roburoc4_facts *facts) {
    const roburoc4_private_drive *d = &client->private_drive;
    const bool stopped = stop_began(m, d, facts->stopping);
    if (!m->private_begun) {
        m->private_granted_us = d->granted_us;
    }
    m->private_driven |= facts->driving || d->granted_us != m->private_granted_us;
    return m->private_kind != REST && m->private_driven && facts->armed &&
           (stopped || !facts->driving);
}

/** Whether a stop sequence is due: at the end; and for a robot that is brought to rest, until one
 * is confirmed, and again where another commander drives it. A client that disarmed itself has
 * begun its stop sequence, and one that never drove commands nothing. */
static bool stops(const roburoc4_move *m, const roburoc4_client *client,
                  const roburoc4_facts *facts) {
    const roburoc4_differential_status *s = &client->private_values.differential;
    if (m->outcome != ROBUROC4_MOVE_RUNNING) {
        return facts->armed;
    }
    return m->private_kind == REST && !facts->stopping &&
           (m->private_first_us == 0 || facts->stop_outcome == ROBUROC4_STOP_TIMED_OUT ||
            !nearly_zero(s->target_linear_m_s) || !nearly_zero(s->target_angular_rad_s));
}

/** One step of a move that nothing of the client has ended. */
static void step(roburoc4_move *m, const roburoc4_client *client, const roburoc4_facts *facts,
                 uint64_t now_us) {
    roburoc4_move_view view;
    const bool rest = m->private_kind == REST;
    const bool unconfirmed = rest && facts->stop_outcome == ROBUROC4_STOP_TIMED_OUT;
    /* what it was told before may not have arrived, or it was at rest a while ago */
    if (facts->stopping || unconfirmed ||
        facts->age_us[ROBUROC4_SERVICE_DIFFERENTIAL] >= client->private_config.fresh_ms * 1000U) {
        m->private_quiet_cycles = m->private_still = 0;
    }
    if (facts->stopping && !rest) { /* only zeros are sent yet */
        roburoc4_move_hold(m);
    }
    view_client(&view, client, facts);
    (void)roburoc4_move_advance(m, &view, now_us);
}

int32_t roburoc4_move_step(roburoc4_move *move, roburoc4_client *client, uint64_t now_us) {
    roburoc4_facts facts;
    if (move->outcome != ROBUROC4_MOVE_RUNNING) {
        return move->outcome;
    }
    (void)roburoc4_client_facts(client, now_us, ROBUROC4_SIZED(&facts));
    /* After a lapse the stop sequence is sent already. pause() would keep the client armed. */
    const bool lapsed = facts.armed && facts.lapsed;
    const bool elsewhere = ended_elsewhere(move, client, &facts);
    if (!move->private_ready && move->private_kind != REST && too_fast(move, client)) {
        roburoc4_move_end(move, ROBUROC4_MOVE_TOO_FAST);
    } else if (elsewhere) {
        roburoc4_move_end(move, lapsed ? ROBUROC4_MOVE_LAPSED : ROBUROC4_MOVE_CANCELLED);
    } else {
        step(move, client, &facts, now_us);
    }
    if (!lapsed && stops(move, client, &facts)) {
        move->private_first_us = now_us;
        (void)roburoc4_client_pause(client, now_us);
    }
    if (move->outcome == ROBUROC4_MOVE_TIMEOUT && facts.other_commander) {
        move->outcome = ROBUROC4_MOVE_OTHER_COMMANDER;
    }
    return move->outcome;
}

void roburoc4_move_cancel(roburoc4_move *move, roburoc4_client *client, uint64_t now_us) {
    if (move->outcome == ROBUROC4_MOVE_RUNNING) {
        roburoc4_move_end(move, ROBUROC4_MOVE_CANCELLED);
        (void)roburoc4_client_pause(client, now_us);
    }
}

const char *roburoc4_move_outcome_text(int32_t outcome) {
    static const char *const texts[] = {
        "the move is under way",
        "goal reached, the robot is at rest",
        "somebody holds [A] on the game pad: wait until it is released, then begin again",
        "a bumper is pressed: check what it touches, then back away",
        "a telemeter sees something too near: clear the way, or give a smaller clearance",
        "the robot does not follow: check emergency stops, brakes, green button and other programs",
        "statuses or commands do not arrive: check the link and the subscriptions, then arm again",
        "another client commands the robot: end that one first",
        "timed out: check what blocks the robot, or allow more time",
        "cancelled, or not armed: call arm(), then begin again",
        "the program did not step the move in time: find what blocked it, then begin again",
        "commands, speeds and pose disagree: check the odometry and what blocks or slips",
        "the robot was relocalized, or its pose jumped: begin again from its new pose",
        "off its path, or not at its goal: go on from here, slower",
        "a speed beyond the ceilings: ask for less, or raise max_linear_m_s or max_angular_rad_s",
        "the front bumper is not known: set front_bumper_index, or give a clearance of 0",
        "the rear bumper is not known: set rear_bumper_index, or give a clearance of 0",
        "no fresh distance ahead: check the front telemeter, or give a clearance of 0",
        "no fresh distance behind: check the rear telemeter, or give a clearance of 0",
    };
    if (outcome < 0) {
        return roburoc4_result_text(outcome);
    }
    return outcome < (int32_t)(sizeof texts / sizeof *texts) ? texts[outcome] : "unknown outcome";
}
