/* SPDX-License-Identifier: MIT */
#include "family.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846
#define DEGREE (PI / 180)
#define LINEAR_M_S2 0.5 /* defaults of a move */
#define ANGULAR_RAD_S2 1.0
#define WATCHDOG_MS 1000

/* ------------------------------------------------------------------------------- the family --- */

static const double naturals[] = {0, 1.5, 2.46, 4, 8};
static const double dampings[] = {0.6, 0.79, 1.2};
static const double gains[] = {0.85, 1, 1.15};
static const uint32_t deads_ms[] = {0, 50, 150};
static const double noises[] = {0, 0.02};
static const uint32_t odometries_ms[] = {10, 50, 100, 200};
static const uint32_t statuses_ms[] = {50, 100};
static const double speeds[] = {0.3, 1};

static uint32_t choose(uint32_t *index, uint32_t count) {
    const uint32_t chosen = *index % count;
    *index /= count;
    return chosen;
}

family_member family_member_at(uint32_t index) {
    family_member m;
    memset(&m, 0, sizeof m);
    m.turn = (int)choose(&index, 2);
    m.speed = speeds[choose(&index, 2)];
    m.status_ms = statuses_ms[choose(&index, 2)];
    m.odometry_ms = odometries_ms[choose(&index, 4)];
    m.noise_m_s = noises[choose(&index, 2)];
    m.dead_ms = deads_ms[choose(&index, 3)];
    m.gain = gains[choose(&index, 3)];
    m.natural_rad_s = naturals[index == 0 ? 0 : (index - 1) / 3 + 1];
    m.damping = index == 0 ? 1 : dampings[(index - 1) % 3];
    return m;
}

uint64_t family_random(uint64_t *state) { /* splitmix64 */
    uint64_t z = (*state += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
}

static double uniform(uint64_t *state) {
    return (double)(family_random(state) >> 11) / 9007199254740992.0;
}

static double between(uint64_t *state, double low, double high) {
    return low + (high - low) * uniform(state);
}

family_member family_member_drawn(uint64_t *state) {
    family_member m;
    memset(&m, 0, sizeof m);
    m.natural_rad_s = uniform(state) < 0.1 ? 0 : 1.5 * pow(8 / 1.5, uniform(state));
    m.damping = between(state, 0.6, 1.2);
    m.gain = between(state, 0.85, 1.15);
    m.dead_ms = (uint32_t)between(state, 0, 151);
    m.noise_m_s = between(state, 0, 0.02);
    m.odometry_ms = 10 * (uint32_t)between(state, 1, 21);
    m.status_ms = 10 * (uint32_t)between(state, 5, 11);
    m.speed = between(state, 0.3, 1);
    m.turn = uniform(state) < 0.5;
    m.loss = uniform(state) < 0.5 ? 0 : 0.2;
    return m;
}

static double normal(uint64_t *state) {
    double sum = -6;
    for (int i = 0; i < 12; i++) {
        sum += uniform(state);
    }
    return sum;
}

/* -------------------------------------------------------------------------------- the robot --- */

static double wrapped(double angle_rad) {
    return remainder(angle_rad, 2 * PI);
}

/** A millisecond of the wheels. */
static void roll(family_robot *r) {
    double *now = r->command[r->now_ms % FAMILY_DEAD_MS];
    const double *then = r->command[(r->now_ms + FAMILY_DEAD_MS - r->is.dead_ms) % FAMILY_DEAD_MS];
    const double dt = 1e-3;
    if (r->now_ms - r->commanded_ms >= WATCHDOG_MS) {
        r->target[0] = r->target[1] = 0;
    }
    now[0] = r->target[0];
    now[1] = r->target[1];
    for (int axis = 0; axis < 2; axis++) {
        const double wanted = r->is.gain * then[axis];
        const double w = axis == 1 && r->turning_rad_s > 0 ? r->turning_rad_s : r->is.natural_rad_s;
        if (w > 0) {
            r->slope[axis] +=
                dt * (w * w * (wanted - r->speed[axis]) - 2 * r->is.damping * w * r->slope[axis]);
            r->speed[axis] += dt * r->slope[axis];
        } else {
            r->speed[axis] = wanted;
        }
    }
    const double turned = r->speed[1] * dt;
    const double way = r->speed[0] * dt;
    r->x_m += way * cos(r->theta_rad + turned / 2);
    r->y_m += way * sin(r->theta_rad + turned / 2);
    r->theta_rad += turned;
    r->distance_m += way;
    const double seen = r->odometry_theta_rad + r->scale_angle * turned / 2;
    r->odometry_x_m += r->scale_distance * way * cos(seen);
    r->odometry_y_m += r->scale_distance * way * sin(seen);
    r->odometry_theta_rad += r->scale_angle * turned;
    if (r->now_ms % r->is.odometry_ms == 0 && !r->frozen) {
        r->pose[0] = r->odometry_x_m;
        r->pose[1] = r->odometry_y_m;
        r->pose[2] = r->odometry_theta_rad;
    }
    if (r->now_ms % r->is.odometry_ms == 0 || !r->speeds_stand) {
        r->reported[0] = r->speed[0] * r->scale_speeds;
        r->reported[1] = r->speed[1] * r->scale_speeds;
    }
}

static uint64_t cycles_of(const family_robot *r) {
    return (r->now_ms - r->boot_ms) / 10 + 1;
}

static float seen_by(const family_robot *r, uint32_t telemeter) {
    const double heading = r->telemeter_rad[telemeter];
    const double away = r->wall_x_m - r->x_m;
    if (r->wall_x_m == 0 || (away > 0) != (cos(heading) > 0)) {
        return 6;
    }
    return (float)fmin(6, fabs(away));
}

static roburoc4_result status_of(family_robot *r, uint32_t service, uint8_t *out, size_t size) {
    const uint64_t cycles = cycles_of(r);
    const uint16_t id = (uint16_t)service;
    if (service == ROBUROC4_SERVICE_IOCARD) {
        const float analog[9] = {0};
        const uint8_t digital[3] = {(uint8_t)r->inputs, (uint8_t)(r->inputs >> 8),
                                    (uint8_t)(r->inputs >> 16)};
        return roburoc4_encode_iocard_status(out, size, id, cycles, analog, 9, digital, 22);
    }
    if (service == ROBUROC4_SERVICE_TELEMETER) {
        float distances[FAMILY_TELEMETERS];
        for (uint32_t i = 0; i < r->distances; i++) {
            distances[i] = seen_by(r, i);
        }
        return roburoc4_encode_telemeter_status(out, size, id, cycles, distances, r->distances);
    }
    if (service == ROBUROC4_SERVICE_BATTERY) {
        const roburoc4_battery_status battery = {cycles, ROBUROC4_BATTERY_OK, 90, id, 0};
        return roburoc4_encode_battery_status(out, size, &battery);
    }
    if (service == ROBUROC4_SERVICE_LOCALIZATION) {
        const roburoc4_localization_status pose = {cycles,   r->pose[0], r->pose[1], r->pose[2],
                                                   r->flags, id,         0};
        return roburoc4_encode_localization_status(out, size, &pose);
    }
    const double noise[2] = {r->is.noise_m_s * normal(&r->random),
                             2 * r->is.noise_m_s * normal(&r->random)};
    const roburoc4_differential_status speed = {cycles,
                                                (float)r->target[0],
                                                (float)(r->reported[0] + noise[0]),
                                                (float)r->target[1],
                                                (float)(r->reported[1] + noise[1]),
                                                id,
                                                {0, 0, 0}};
    return roburoc4_encode_differential_status(out, size, &speed);
}

static roburoc4_result properties_of(const family_robot *r, uint8_t id, uint16_t service,
                                     uint8_t *out, size_t size) {
    static const roburoc4_directory_entry entries[] = {{0, 0},
                                                       {0, 1},
                                                       {ROBUROC4_TYPE_IOCARD, 2},
                                                       {ROBUROC4_TYPE_TELEMETER, 3},
                                                       {0x7777, 4},
                                                       {ROBUROC4_TYPE_LOCALIZATION, 5},
                                                       {ROBUROC4_TYPE_DIFFERENTIAL, 6}};
    if (service == ROBUROC4_SERVICE_DIRECTORY) {
        return roburoc4_encode_directory(out, size, id, 0, entries, 7);
    }
    if (service == ROBUROC4_SERVICE_IOCARD) {
        const roburoc4_iocard_properties card = {9, 0, 22, 8, service, 0};
        return roburoc4_encode_iocard_properties(out, size, id, &card);
    }
    if (service == ROBUROC4_SERVICE_TELEMETER) {
        roburoc4_telemeter telemeters[FAMILY_TELEMETERS];
        for (uint32_t i = 0; i < r->telemeters; i++) {
            const roburoc4_telemeter t = {0, 0, r->telemeter_rad[i], 0.5F, 0.2F, 6, seen_by(r, i)};
            telemeters[i] = t;
        }
        return roburoc4_encode_telemeter_properties(out, size, id, service, telemeters,
                                                    r->telemeters);
    }
    if (service == ROBUROC4_SERVICE_BATTERY) {
        const roburoc4_battery_properties battery = {24, 60, 20, 0, service};
        return roburoc4_encode_battery_properties(out, size, id, &battery);
    }
    if (service == ROBUROC4_SERVICE_LOCALIZATION) {
        const roburoc4_localization_properties pose = {0, 0, 0, r->flags, service, 0};
        return roburoc4_encode_localization_properties(out, size, id, &pose);
    }
    const roburoc4_differential_properties drive = {0, 0,  0, 0,  2.6F,  -2.6F,   6.5F, -6.5F,
                                                    3, -3, 8, -8, 0.68F, service, 0};
    return roburoc4_encode_differential_properties(out, size, id, &drive);
}

/** The answer to a request, or 0. */
static roburoc4_result answer_to(family_robot *r, const roburoc4_request *q, uint8_t *out,
                                 size_t size) {
    switch (q->action) {
    case ROBUROC4_ACTION_GET:
        return (r->unanswered >> q->service & 1) != 0
                   ? 0
                   : properties_of(r, q->id, q->service, out, size);
    case ROBUROC4_ACTION_QUERY:
        if (q->service == ROBUROC4_SERVICE_IOCARD && q->io_type == ROBUROC4_IO_DIGITAL_INPUT &&
            q->index < 22 && r->texts[q->index] != NULL) {
            return roburoc4_encode_text(out, size, q->id, q->service, r->texts[q->index],
                                        strlen(r->texts[q->index]));
        }
        return roburoc4_encode_answer(out, size, q->id, q->action, q->service,
                                      ROBUROC4_ERROR_UNSUPPORTED);
    case ROBUROC4_ACTION_INSERT:
        r->period_cycles[q->subject & 7] = q->period_cycles;
        break;
    case ROBUROC4_ACTION_DELETE:
        r->period_cycles[q->subject & 7] = 0;
        break;
    default: /* REPLACE */
        r->odometry_x_m = q->x_m;
        r->odometry_y_m = q->y_m;
        r->odometry_theta_rad = q->theta_rad;
    }
    return roburoc4_encode_answer(out, size, q->id, q->action, q->service, ROBUROC4_ERROR_NONE);
}

/* ------------------------------------------------------------------------------ the network --- */

static int lost(family_rig *rig) {
    return uniform(&rig->robot.random) < rig->loss;
}

static void send_to_client(family_rig *rig, const uint8_t *data, roburoc4_result size) {
    if (size > 0 && !lost(rig)) {
        (void)roburoc4_client_receive(&rig->client, data, (size_t)size, family_now_us(rig));
    }
}

/** A command was put on the wire. */
static void note_command(family_rig *rig, const double *speed) {
    const double most = rig->robot.is.turn ? speed[1] : speed[0];
    const double span_s = fmax(1e-3 * (rig->now_ms - rig->sent_ms), 0.01);
    if (rig->commands++ > 0) {
        rig->steepest[0] = fmax(rig->steepest[0], fabs(speed[0] - rig->last_sent[0]) / span_s);
        rig->steepest[1] = fmax(rig->steepest[1], fabs(speed[1] - rig->last_sent[1]) / span_s);
    }
    if (most * rig->last_sign < 0) {
        rig->reversals++;
    }
    rig->last_sign = most != 0 ? most : rig->last_sign;
    if (speed[0] != 0 || speed[1] != 0) {
        rig->first_ms = rig->first_ms != 0 ? rig->first_ms : rig->now_ms;
        rig->last_ms = rig->now_ms;
    }
    rig->last_sent[0] = speed[0];
    rig->last_sent[1] = speed[1];
    rig->sent_ms = rig->now_ms;
}

static void send_to_robot(family_rig *rig, const uint8_t *data, roburoc4_result size) {
    family_robot *r = &rig->robot;
    roburoc4_differential_command command;
    roburoc4_request request;
    uint8_t out[256];
    const int is_command = roburoc4_decode_differential_command(data, (size_t)size, &command) >= 0;
    if (is_command) {
        const double speed[2] = {(double)command.linear_m_s, (double)command.angular_rad_s};
        note_command(rig, speed);
    }
    if (lost(rig)) {
        return;
    }
    if (is_command) {
        r->target[0] = (double)command.linear_m_s;
        r->target[1] = (double)command.angular_rad_s;
        r->commanded_ms = r->now_ms;
    } else if (roburoc4_decode_request(data, (size_t)size, &request) >= 0) {
        send_to_client(rig, out, answer_to(r, &request, out, sizeof out));
    }
}

void family_reboot(family_rig *rig) {
    family_robot *r = &rig->robot;
    r->boot_ms = r->now_ms;
    r->odometry_x_m = r->odometry_y_m = r->odometry_theta_rad = 0;
    r->target[0] = r->target[1] = 0;
    memset(r->pose, 0, sizeof r->pose);
    memset(r->period_cycles, 0, sizeof r->period_cycles);
}

uint64_t family_now_us(const family_rig *rig) {
    return (uint64_t)rig->now_ms * 1000;
}

void family_pass(family_rig *rig, uint32_t span_ms) {
    uint8_t data[256];
    for (; span_ms > 0; span_ms--) {
        roburoc4_result size = 0;
        family_robot *r = &rig->robot;
        while ((size = roburoc4_client_poll_transmit(&rig->client, data, sizeof data,
                                                     family_now_us(rig))) > 0) {
            send_to_robot(rig, data, size);
        }
        rig->now_ms++;
        r->now_ms++;
        roll(r);
        for (uint32_t service = ROBUROC4_SERVICE_IOCARD;
             r->now_ms % 10 == 0 && service <= ROBUROC4_SERVICE_DIFFERENTIAL; service++) {
            const uint8_t period = r->period_cycles[service];
            if (period > 0 && (r->now_ms / 10) % period == 0 && (r->silent >> service & 1) == 0) {
                send_to_client(rig, data, status_of(r, service, data, sizeof data));
            }
        }
    }
}

void family_prepare(family_rig *rig, const family_member *member, uint64_t seed) {
    family_robot *r = &rig->robot;
    memset(rig, 0, sizeof *rig);
    rig->now_ms = 5000;
    r->is = *member;
    r->now_ms = 3000 + (uint32_t)(family_random(&seed) % 1000); /* the phases of its periods */
    r->random = seed;
    r->scale_distance = r->scale_angle = r->scale_speeds = 1;
    r->flags = ROBUROC4_LOCALIZATION_PROPRIOCEPTIVE;
    r->telemeters = r->distances = 2;
    r->telemeter_rad[1] = (float)PI;
}

void family_connect(family_rig *rig, const roburoc4_config *given) {
    roburoc4_config config;
    const uint16_t period_ms = (uint16_t)rig->robot.is.status_ms;
    roburoc4_config_init(&config, sizeof config);
    if (given != NULL) {
        config = *given;
    }
    config.period_ms[ROBUROC4_SERVICE_LOCALIZATION] =
        rig->pose_ms > 0 ? (uint16_t)rig->pose_ms : period_ms;
    config.period_ms[ROBUROC4_SERVICE_DIFFERENTIAL] = period_ms;
    if (rig->robot.is.loss > 0) {
        config.fresh_ms = 1000; /* else several losses in a row disarm now and then */
    }
    (void)roburoc4_client_init(&rig->client, sizeof rig->client, &config);
    (void)roburoc4_client_start(&rig->client, family_now_us(rig));
}

int family_arm(family_rig *rig) {
    for (int i = 0; i < 1000; i++) {
        family_pass(rig, 5);
        if (roburoc4_client_arm(&rig->client, family_now_us(rig)) == ROBUROC4_OK) {
            return 1;
        }
    }
    return 0;
}

int family_open(family_rig *rig, const family_member *member, uint64_t seed) {
    family_prepare(rig, member, seed);
    family_connect(rig, NULL);
    const int armed = family_arm(rig);
    family_pass(rig, 1000);
    rig->loss = member->loss;
    return armed;
}

int32_t family_go(family_rig *rig, roburoc4_move *move, uint32_t most_ms,
                  void (*meanwhile)(void *user), void *user) {
    const uint32_t begun_ms = rig->now_ms;
    rig->reversals = rig->commands = rig->first_ms = rig->last_ms = 0;
    rig->last_sign = rig->steepest[0] = rig->steepest[1] = 0;
    while (rig->now_ms - begun_ms < most_ms &&
           roburoc4_move_step(move, &rig->client, family_now_us(rig)) == ROBUROC4_MOVE_RUNNING) {
        const roburoc4_result driven = roburoc4_client_drive(
            &rig->client, move->linear_m_s, move->angular_rad_s, 0, family_now_us(rig));
        (void)driven; /* where it is refused, the next step ends the move */
        if (meanwhile != NULL) {
            meanwhile(user);
        }
        family_pass(rig, 10);
    }
    return move->outcome;
}

/* ------------------------------------------------------------------------------- the judge ---- */

typedef struct watcher {
    const family_rig *rig;
    double begin[3], way, furthest;
} watcher;

static double covered(const watcher *w) {
    const family_robot *r = &w->rig->robot;
    return r->is.turn ? r->theta_rad - w->begin[2]
                      : (r->x_m - w->begin[0]) * cos(w->begin[2]) +
                            (r->y_m - w->begin[1]) * sin(w->begin[2]);
}

static void watch(void *user) {
    watcher *w = user;
    w->furthest = fmax(w->furthest, covered(w));
}

/** The time of a profile with constant acceleration. */
static double profile_s(double way, double speed, double slope) {
    return speed * speed / slope <= way ? way / speed + speed / slope : 2 * sqrt(way / slope);
}

family_verdict family_judge(const family_member *m, uint64_t seed, int strict) {
    family_rig rig;
    family_verdict v;
    roburoc4_move move;
    roburoc4_move_options options;
    watcher w = {&rig, {0, 0, 0}, m->turn ? PI / 2 : 1, 0};
    const double slope = m->turn ? ANGULAR_RAD_S2 : LINEAR_M_S2;
    const double response_s =
        (m->natural_rad_s > 0 ? 2 * m->damping / m->natural_rad_s : 0) + 1e-3 * m->dead_ms;
    memset(&v, 0, sizeof v);
    v.ideal_s = profile_s(w.way, m->speed, slope) + response_s;
    v.allowed_s = (strict ? 1.1 : 2) * v.ideal_s;
    v.result = ROBUROC4_MOVE_CANCELLED;
    if (!family_open(&rig, m, seed)) {
        v.fault = "not armed";
        return v;
    }
    roburoc4_move_options_init(&options, sizeof options);
    options.max_linear_m_s = options.max_angular_rad_s = (float)m->speed;
    w.begin[0] = rig.robot.x_m;
    w.begin[1] = rig.robot.y_m;
    w.begin[2] = rig.robot.theta_rad;
    const uint32_t begun_ms = rig.now_ms;
    (void)roburoc4_move_by(&move, m->turn ? 0 : 1, m->turn ? (float)(PI / 2) : 0, &options);
    v.result = family_go(&rig, &move, 60000, watch, &w);
    v.took_s = 1e-3 * (rig.now_ms - begun_ms);
    for (int i = 0; i < 200; i++) { /* it must stay there */
        watch(&w);
        family_pass(&rig, 10);
    }
    v.error = fabs(covered(&w) - w.way);
    v.aside = m->turn ? 0 : fabs(wrapped(rig.robot.theta_rad - w.begin[2]));
    v.overshoot = w.furthest - w.way;
    v.reversals = rig.reversals;
    v.steepest = rig.steepest[m->turn ? 1 : 0] / slope;
    const double error = m->turn ? (strict ? 1 : 2) * DEGREE : strict ? 0.01 : 0.02;
    v.fault = v.result != ROBUROC4_MOVE_REACHED             ? "not reached"
              : v.error > error                             ? "error"
              : v.aside > (strict ? 1 : 2) * DEGREE         ? "heading"
              : v.reversals > 2                             ? "reversals"
              : v.overshoot > (m->turn ? 5 * DEGREE : 0.05) ? "overshoot"
              : v.took_s > v.allowed_s                      ? "time"
              : v.steepest > 1.02                           ? "acceleration"
                                                            : NULL;
    return v;
}

void family_print(const family_member *m, const family_verdict *v) {
    printf("natural %.2f damping %.2f gain %.2f dead %u noise %.2f odometry %u status %u %s %.1f "
           "loss %.2f: %s, error %.4f overshoot %.4f reversals %u time %.2f of %.2f steepest %.2f",
           m->natural_rad_s, m->damping, m->gain, m->dead_ms, m->noise_m_s, m->odometry_ms,
           m->status_ms, m->turn ? "turn" : "straight", m->speed, m->loss,
           v->fault != NULL ? v->fault : "fine", v->error, v->overshoot, v->reversals, v->took_s,
           v->allowed_s, v->steepest);
    if (v->result != ROBUROC4_MOVE_REACHED) {
        printf(" (%s)", roburoc4_move_outcome_text(v->result));
    }
    printf("\n");
}
