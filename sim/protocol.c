/* SPDX-License-Identifier: MIT
 *
 * Received datagrams: a request, which is answered here, a command, or neither. No content and no
 * length may do harm.
 */

#include "model.h"

static void answer(roburoc4_sim *sim, uint64_t peer, const roburoc4_request *request,
                   const uint8_t *datagram, roburoc4_result length) {
    bool text = request->action == ROBUROC4_ACTION_QUERY;
    bool twice = text && (sim->config.texts & ROBUROC4_SIM_TEXTS_DOUBLED) != 0;
    for (int sent = 0; sent < (twice ? 2 : 1); sent++) {
        uint64_t due_us = sim_queue_due_us(sim, text ? SIM_DELAY_TEXT : SIM_DELAY_ANSWER);
        if (length <= 0 || !sim_queue_push(&sim->queue, peer, datagram, (size_t)length, due_us)) {
            sim->counts.dropped++;
        }
    }
}

/* The plain answer of 5 bytes; any error counts. */
static void answer_plain(roburoc4_sim *sim, uint64_t peer, const roburoc4_request *request,
                         uint8_t error) {
    uint8_t buffer[8];
    bool bare = error != ROBUROC4_ERROR_NONE && sim->config.error_header != 0;
    uint8_t id = bare ? ROBUROC4_HEADER_ERROR : request->id;
    sim->counts.errors += error != ROBUROC4_ERROR_NONE ? 1u : 0u;
    if (error != ROBUROC4_ERROR_NONE && sim->config.error_code != 0) {
        error = (uint8_t)sim->config.error_code;
    }
    roburoc4_result length =
        roburoc4_encode_answer(buffer, sizeof buffer, id, request->action, request->service, error);
    answer(sim, peer, request, buffer, bare && sim->config.error_header == 2 ? 1 : length);
}

static void answer_get(roburoc4_sim *sim, uint64_t peer, const roburoc4_request *request,
                       uint32_t service) {
    uint8_t buffer[ROBUROC4_SIM_MAX_TRANSMIT];
    answer(sim, peer, request, buffer,
           sim_service_properties(sim, sim_peers_find(sim, peer), service, request->id, buffer,
                                  sizeof buffer));
}

static void answer_query(roburoc4_sim *sim, uint64_t peer, const roburoc4_request *request,
                         uint32_t service) {
    uint8_t buffer[ROBUROC4_SIM_MAX_TRANSMIT];
    uint32_t mode = sim->config.query_mode;
    bool of_a =
        service == ROBUROC4_SERVICE_IOCARD && request->index >= 0 &&
        request->io_type == ROBUROC4_IO_DIGITAL_INPUT &&
        sim_channel_meaning(sim, request->io_type, (uint32_t)request->index) == ROBUROC4_DI_PAD_A;
    if (mode == ROBUROC4_SIM_QUERY_SILENT || (mode == ROBUROC4_SIM_QUERY_A_SILENT && of_a)) {
        return;
    }
    roburoc4_result length =
        service == ROBUROC4_SERVICE_DIRECTORY
            ? sim_directory_text(sim, (uint32_t)request->index, request->id, buffer, sizeof buffer)
            : sim_iocard_text(sim, request->io_type, request->index, request->id, buffer,
                              sizeof buffer);
    if (length == ROBUROC4_ERR_INDEX || (mode == ROBUROC4_SIM_QUERY_A_REFUSED && of_a)) {
        answer_plain(sim, peer, request, ROBUROC4_ERROR_DATA);
    } else {
        answer(sim, peer, request, buffer, length);
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
    return sim_peers_subscribe(sim, key, (uint32_t)service, request->period_cycles);
}

static uint8_t unsubscribe(roburoc4_sim *sim, uint64_t key, const roburoc4_request *request) {
    int32_t service = sim_service_of_id(sim, request->subject);
    return service >= 0 && sim_peers_unsubscribe(sim, key, (uint32_t)service) ? ROBUROC4_ERROR_NONE
                                                                              : ROBUROC4_ERROR_DATA;
}

static uint8_t replace(roburoc4_sim *sim, const roburoc4_request *request) {
    if (!sim_is_finite(request->x_m) || !sim_is_finite(request->y_m) ||
        !sim_is_finite(request->theta_rad)) {
        return ROBUROC4_ERROR_DATA;
    }
    if (sim->config.replace_mode == ROBUROC4_SIM_REPLACE_IGNORED) {
        return ROBUROC4_ERROR_NONE;
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
        return service == ROBUROC4_SERVICE_LOCALIZATION &&
                       sim->config.replace_mode != ROBUROC4_SIM_REPLACE_REFUSED
                   ? ROBUROC4_ERROR_NONE
                   : ROBUROC4_ERROR_UNSUPPORTED;
    case ROBUROC4_ACTION_DELETE:
        if (sim->config.delete_refused != 0) {
            return ROBUROC4_ERROR_UNSUPPORTED;
        }
        return service == ROBUROC4_SERVICE_NOTIFICATION ? ROBUROC4_ERROR_NONE
                                                        : ROBUROC4_ERROR_UNSUPPORTED;
    case ROBUROC4_ACTION_INSERT:
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

/* False if it does not obey them, at least not now. */
static bool take_speeds(roburoc4_sim *sim, double linear_m_s, double angular_rad_s) {
    const roburoc4_sim_config *config = &sim->config;
    if (!sim_is_finite(linear_m_s) || !sim_is_finite(angular_rad_s) ||
        (config->commands_need_motors != 0 && !sim->motors) ||
        (config->over_limit_refused != 0 && sim_motion_is_beyond(sim, linear_m_s, angular_rad_s))) {
        return false;
    }
    if (!sim_pad_drives(sim) || config->pad_keeps_target == ROBUROC4_SIM_OVERRIDE_STORES) {
        sim_motion_command(sim, linear_m_s, angular_rad_s);
    } else if (config->ignored_commands_feed != 0) {
        sim_motion_feed(sim);
    }
    return !sim_pad_drives(sim);
}

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
    if (!take_speeds(sim, (double)command.linear_m_s, (double)command.angular_rad_s)) {
        counts->refused_speed_commands++;
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
