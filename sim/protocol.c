/* SPDX-License-Identifier: MIT
 *
 * Received datagrams: a request, which is answered here, a command, or neither. No content and no
 * length may do harm.
 */

#include "model.h"

static void answer(roburoc4_sim *sim, uint64_t peer, const uint8_t *datagram,
                   roburoc4_result length) {
    if (length <= 0 || !sim_queue_push(&sim->queue, peer, datagram, (size_t)length)) {
        sim->counts.dropped++;
    }
}

/* The plain answer of 5 bytes; any error counts. */
static void answer_plain(roburoc4_sim *sim, uint64_t peer, const roburoc4_request *request,
                         uint8_t error) {
    uint8_t buffer[8];
    bool bare = error != ROBUROC4_ERROR_NONE && sim->config.error_header != 0;
    uint8_t id = bare ? ROBUROC4_HEADER_ERROR : request->id;
    sim->counts.errors += error != ROBUROC4_ERROR_NONE ? 1u : 0u;
    answer(sim, peer, buffer,
           roburoc4_encode_answer(buffer, sizeof buffer, id, request->action, request->service,
                                  error));
}

static void answer_get(roburoc4_sim *sim, uint64_t peer, const roburoc4_request *request,
                       uint32_t service) {
    uint8_t buffer[ROBUROC4_SIM_MAX_TRANSMIT];
    answer(sim, peer, buffer,
           sim_service_properties(sim, sim_peers_find(sim, peer), service, request->id, buffer,
                                  sizeof buffer));
}

static void answer_query(roburoc4_sim *sim, uint64_t peer, const roburoc4_request *request,
                         uint32_t service) {
    uint8_t buffer[ROBUROC4_SIM_MAX_TRANSMIT];
    if (sim->config.query_mode == ROBUROC4_SIM_QUERY_SILENT) {
        return;
    }
    roburoc4_result length =
        service == ROBUROC4_SERVICE_DIRECTORY
            ? sim_directory_text(sim, (uint32_t)request->index, request->id, buffer, sizeof buffer)
            : sim_iocard_text(sim, request->io_type, request->index, request->id, buffer,
                              sizeof buffer);
    if (length == ROBUROC4_ERR_INDEX) {
        answer_plain(sim, peer, request, ROBUROC4_ERROR_DATA);
    } else {
        answer(sim, peer, buffer, length);
    }
}

static uint8_t insert(roburoc4_sim *sim, uint64_t key, const roburoc4_request *request) {
    int32_t service = sim_service_of_id(sim, request->subject);
    if (service <= ROBUROC4_SERVICE_NOTIFICATION || request->period_cycles == 0) {
        return ROBUROC4_ERROR_DATA;
    }
    if ((sim->config.refused_inserts >> service & 1u) != 0) {
        return ROBUROC4_ERROR_SERVICE;
    }
    sim_peer *peer = sim_peers_find(sim, key);
    peer = peer != NULL ? peer : sim_peers_heard(sim, key, true);
    if (peer == NULL) {
        return ROBUROC4_ERROR_SERVICE; /* the table is full of active subscribers */
    }
    sim_subscription *wish = &peer->subscriptions[service];
    if (wish->period_cycles != request->period_cycles) {
        /* A repeated request must not shift the phase of a running subscription. */
        wish->period_cycles = request->period_cycles;
        wish->phase_cycles = sim->cycles;
    }
    return ROBUROC4_ERROR_NONE;
}

static uint8_t unsubscribe(roburoc4_sim *sim, uint64_t key, const roburoc4_request *request) {
    int32_t service = sim_service_of_id(sim, request->subject);
    sim_peer *peer = sim_peers_find(sim, key);
    if (service < 0 || peer == NULL || peer->subscriptions[service].period_cycles == 0) {
        return ROBUROC4_ERROR_DATA;
    }
    peer->subscriptions[service].period_cycles = 0;
    return ROBUROC4_ERROR_NONE;
}

static uint8_t replace(roburoc4_sim *sim, const roburoc4_request *request) {
    if (!sim_is_finite(request->x_m) || !sim_is_finite(request->y_m) ||
        !sim_is_finite(request->theta_rad)) {
        return ROBUROC4_ERROR_DATA;
    }
    sim->odometry.x_m = request->x_m;
    sim->odometry.y_m = request->y_m;
    sim->odometry.theta_rad = sim_wrap(request->theta_rad);
    return ROBUROC4_ERROR_NONE;
}

/* The error of a request, as far as its header shows. */
static uint8_t refusal(const roburoc4_sim *sim, const roburoc4_request *request, int32_t service) {
    if (service < 0) {
        return ROBUROC4_ERROR_TARGET;
    }
    switch (request->action) {
    case ROBUROC4_ACTION_GET:
        return ROBUROC4_ERROR_NONE;
    case ROBUROC4_ACTION_QUERY:
        return sim->config.query_mode != ROBUROC4_SIM_QUERY_REFUSED &&
                       (service == ROBUROC4_SERVICE_DIRECTORY || service == ROBUROC4_SERVICE_IOCARD)
                   ? ROBUROC4_ERROR_NONE
                   : ROBUROC4_ERROR_UNSUPPORTED;
    case ROBUROC4_ACTION_REPLACE:
        return service == ROBUROC4_SERVICE_LOCALIZATION ? ROBUROC4_ERROR_NONE
                                                        : ROBUROC4_ERROR_UNSUPPORTED;
    case ROBUROC4_ACTION_INSERT:
    case ROBUROC4_ACTION_DELETE:
        return service == ROBUROC4_SERVICE_NOTIFICATION ? ROBUROC4_ERROR_NONE
                                                        : ROBUROC4_ERROR_UNSUPPORTED;
    case ROBUROC4_ACTION_UPDATE:
    case ROBUROC4_ACTION_SUBMIT:
        return ROBUROC4_ERROR_UNSUPPORTED;
    default:
        return ROBUROC4_ERROR_ACTION;
    }
}

static void obey(roburoc4_sim *sim, uint64_t peer, const roburoc4_request *request,
                 uint32_t service) {
    switch (request->action) {
    case ROBUROC4_ACTION_GET:
        answer_get(sim, peer, request, service);
        break;
    case ROBUROC4_ACTION_QUERY:
        answer_query(sim, peer, request, service);
        break;
    case ROBUROC4_ACTION_REPLACE:
        answer_plain(sim, peer, request, replace(sim, request));
        break;
    case ROBUROC4_ACTION_INSERT:
        answer_plain(sim, peer, request, insert(sim, peer, request));
        break;
    default:
        answer_plain(sim, peer, request, unsubscribe(sim, peer, request));
        break;
    }
}

static void receive_request(roburoc4_sim *sim, uint64_t peer, const uint8_t *data, size_t size) {
    if (sim->config.only_id_fixed != 0 && data[0] != ROBUROC4_HEADER_MANUAL) {
        sim->counts.ignored++;
        return;
    }
    sim->counts.requests++;
    (void)sim_peers_heard(sim, peer, false);

    roburoc4_request head = {0};
    bool fixed = sim->config.answer_id_fixed != 0 || sim->config.as_manual != 0;
    head.id = fixed ? ROBUROC4_HEADER_MANUAL : data[0];
    head.action = size > 1 ? data[1] : 0;
    head.service = size > 3 ? (uint16_t)(data[2] | data[3] << 8) : 0;
    int32_t service = sim_service_of_id(sim, head.service);
    uint8_t error = size < 4 ? ROBUROC4_ERROR_LENGTH : refusal(sim, &head, service);
    if (error != ROBUROC4_ERROR_NONE) {
        answer_plain(sim, peer, &head, error);
        return;
    }
    roburoc4_request request = {0};
    roburoc4_result result = roburoc4_decode_request(data, size, &request);
    if (result < 0) {
        answer_plain(sim, peer, &head,
                     result == ROBUROC4_ERR_SHORT ? ROBUROC4_ERROR_LENGTH : ROBUROC4_ERROR_DATA);
        return;
    }
    request.id = head.id;
    obey(sim, peer, &request, (uint32_t)service);
}

/* -------------------------------------------------------------------------------- commands --- */

static bool command_differential(roburoc4_sim *sim, const uint8_t *data, size_t size) {
    roburoc4_differential_command command;
    if (roburoc4_decode_differential_command(data, size, &command) < 0) {
        return false;
    }
    roburoc4_sim_state *counts = &sim->counts;
    counts->speed_commands++;
    if (command.linear_m_s != 0.0f || command.angular_rad_s != 0.0f) {
        counts->nonzero_speed_commands++;
    }
    counts->last_linear_m_s = (double)command.linear_m_s;
    counts->last_angular_rad_s = (double)command.angular_rad_s;
    counts->last_command_us = sim->now_us;
    if (!sim_is_finite((double)command.linear_m_s) ||
        !sim_is_finite((double)command.angular_rad_s) || sim_pad_drives(sim)) {
        counts->refused_speed_commands++;
    } else {
        sim_motion_command(sim, (double)command.linear_m_s, (double)command.angular_rad_s);
    }
    return true;
}

static bool command_iocard(roburoc4_sim *sim, const uint8_t *data, size_t size) {
    uint32_t analog_outputs = (uint32_t)sim->config.analog_outputs;
    uint32_t digital_outputs = (uint32_t)sim->config.digital_outputs;
    roburoc4_channels command;
    if (roburoc4_decode_iocard_command(data, size, analog_outputs, digital_outputs, &command) < 0) {
        return false;
    }
    sim->counts.io_commands++;
    (void)roburoc4_floats(command.analog, command.analog_count, sim->analog_outputs,
                          ROBUROC4_SIM_MAX_ANALOG);
    for (uint32_t index = 0; index < digital_outputs; index++) {
        sim->digital_outputs[index] = command.digital[index / 8] >> (index % 8) & 1;
    }
    return true;
}

static void receive_command(roburoc4_sim *sim, uint64_t peer, const uint8_t *data, size_t size) {
    roburoc4_channels head;
    bool understood = false;
    if (roburoc4_decode_iocard_command(data, size, 0, 0, &head) >= 0) {
        int32_t service = sim_service_of_id(sim, head.service);
        if (service == ROBUROC4_SERVICE_DIFFERENTIAL) {
            understood = command_differential(sim, data, size);
        } else if (service == ROBUROC4_SERVICE_IOCARD) {
            understood = command_iocard(sim, data, size);
        }
    }
    if (understood) {
        (void)sim_peers_heard(sim, peer, false);
    } else {
        sim->counts.ignored++;
    }
}

void sim_protocol_receive(roburoc4_sim *sim, uint64_t peer, const uint8_t *data, size_t size) {
    if (size == 0 || data[0] == ROBUROC4_HEADER_ERROR) {
        sim->counts.ignored++;
    } else if (data[0] == ROBUROC4_HEADER_STATUS) {
        receive_command(sim, peer, data, size);
    } else {
        receive_request(sim, peer, data, size);
    }
}
