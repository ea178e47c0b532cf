/* SPDX-License-Identifier: MIT */
#include "mapping.h"

#include <math.h>
#include <string.h>

#include "text.h"

/* --------------------------------------------------------------------------- channel names --- */

/* Index of the first name of each ROBUROC4_IO_* type. */
static const uint32_t first_name[] = {
    0,
    ROBUROC4_MAX_ANALOG_INPUTS,
    ROBUROC4_MAX_ANALOG_INPUTS + ROBUROC4_MAX_ANALOG_OUTPUTS,
    ROBUROC4_MAX_ANALOG_INPUTS + ROBUROC4_MAX_ANALOG_OUTPUTS + ROBUROC4_MAX_DIGITAL_INPUTS,
    MAPPING_NAMES,
};

void mapping_names_set(mapping_names *names, int32_t io_type, uint32_t index, const uint8_t *text,
                       uint32_t length) {
    if (io_type < 0 || io_type > ROBUROC4_IO_DIGITAL_OUTPUT || length == 0 ||
        index >= first_name[io_type + 1] - first_name[io_type]) {
        return;
    }
    text_copy(names->text[first_name[io_type] + index], MAPPING_NAME_SIZE, text, length);
}

char **mapping_names_of(mapping_names *names, const roburoc4_client *client, int32_t io_type) {
    for (uint32_t at = first_name[io_type]; at < first_name[io_type + 1]; at++) {
        const char *name = names->text[at];
        if (name[0] == '\0') {
            name =
                roburoc4_client_channel_name(client, (uint32_t)io_type, at - first_name[io_type]);
        }
        names->list[at] = (char *)(name != NULL ? name : ""); /* LCM's encoders only read */
    }
    return names->list + first_name[io_type];
}

/* -------------------------------------------------------------------------------- statuses --- */

void mapping_differential(const roburoc4_differential_status *in, int64_t utime,
                          roburoc4_lcm_differential_status_t *out) {
    out->utime = utime;
    out->robot_cycles = (int64_t)in->robot_cycles;
    out->target_linear_m_s = in->target_linear_m_s;
    out->current_linear_m_s = in->current_linear_m_s;
    out->target_angular_rad_s = in->target_angular_rad_s;
    out->current_angular_rad_s = in->current_angular_rad_s;
}

void mapping_localization(const roburoc4_localization_status *in, int64_t utime,
                          roburoc4_lcm_localization_status_t *out) {
    out->utime = utime;
    out->robot_cycles = (int64_t)in->robot_cycles;
    out->x_m = in->x_m;
    out->y_m = in->y_m;
    out->theta_rad = in->theta_rad;
    out->flags = (int32_t)in->flags;
}

void mapping_battery(const roburoc4_battery_status *in, int64_t utime,
                     roburoc4_lcm_battery_status_t *out) {
    out->utime = utime;
    out->robot_cycles = (int64_t)in->robot_cycles;
    out->state = in->state;
    out->remaining_percent = in->remaining_percent;
}

static void map_telemeter(const roburoc4_telemeter *known, float distance_m,
                          roburoc4_lcm_telemeter_t *out) {
    out->distance_m = distance_m;
    out->x_m = known->x_m;
    out->y_m = known->y_m;
    out->theta_rad = known->theta_rad;
    out->field_of_view_rad = known->field_of_view_rad;
    out->min_distance_m = known->min_distance_m;
    out->max_distance_m = known->max_distance_m;
}

void mapping_telemeter(const roburoc4_distances *in, const roburoc4_telemeter *known,
                       uint32_t known_count, int64_t utime, roburoc4_lcm_telemeter_t *storage,
                       roburoc4_lcm_telemeter_status_t *out) {
    static const roburoc4_telemeter unknown = {NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    for (uint32_t at = 0; at < in->count; at++) {
        map_telemeter(at < known_count ? &known[at] : &unknown, in->distances_m[at], &storage[at]);
    }
    out->utime = utime;
    out->robot_cycles = (int64_t)in->robot_cycles;
    out->telemeter_count = (int32_t)in->count;
    out->telemeters = storage;
}

void mapping_iocard(const roburoc4_inputs *in, const roburoc4_client *client, mapping_names *names,
                    int64_t utime, int8_t *storage, roburoc4_lcm_iocard_status_t *out) {
    for (uint32_t at = 0; at < in->digital_count; at++) {
        storage[at] = (int8_t)(in->digital >> at & 1);
    }
    out->utime = utime;
    out->robot_cycles = (int64_t)in->robot_cycles;
    out->analog_input_count = (int32_t)in->analog_count;
    out->analog_inputs = (float *)in->analog; /* LCM's encoders only read */
    out->analog_input_names = mapping_names_of(names, client, ROBUROC4_IO_ANALOG_INPUT);
    out->digital_input_count = (int32_t)in->digital_count;
    out->digital_inputs = storage;
    out->digital_input_names = mapping_names_of(names, client, ROBUROC4_IO_DIGITAL_INPUT);
}

void mapping_pose(const roburoc4_localization_status *in,
                  const roburoc4_differential_status *speeds, int64_t utime, bot_core_pose_t *out) {
    memset(out, 0, sizeof *out);
    out->utime = utime;
    out->pos[0] = in->x_m;
    out->pos[1] = in->y_m;
    out->orientation[0] = cos(in->theta_rad / 2);
    out->orientation[3] = sin(in->theta_rad / 2);
    if (speeds != NULL) {
        out->vel[0] = (double)speeds->current_linear_m_s * cos(in->theta_rad);
        out->vel[1] = (double)speeds->current_linear_m_s * sin(in->theta_rad);
        out->rotation_rate[2] = (double)speeds->current_angular_rad_s;
    }
}

/* ------------------------------------------------------------------------------ properties --- */

static void map_differential_properties(const roburoc4_client *client,
                                        roburoc4_lcm_robot_properties_t *out) {
    roburoc4_differential_properties in;
    if (roburoc4_client_differential_properties(client, &in) < 0) {
        return;
    }
    out->differential_known = 1;
    out->max_linear_m_s = in.max_linear_m_s;
    out->min_linear_m_s = in.min_linear_m_s;
    out->max_angular_rad_s = in.max_angular_rad_s;
    out->min_angular_rad_s = in.min_angular_rad_s;
    out->max_linear_m_s2 = in.max_linear_m_s2;
    out->min_linear_m_s2 = in.min_linear_m_s2;
    out->max_angular_rad_s2 = in.max_angular_rad_s2;
    out->min_angular_rad_s2 = in.min_angular_rad_s2;
    out->width_m = in.width_m;
}

static void map_small_properties(const roburoc4_client *client,
                                 roburoc4_lcm_robot_properties_t *out) {
    roburoc4_localization_properties pose;
    roburoc4_battery_properties battery;
    if (roburoc4_client_localization_properties(client, &pose) >= 0) {
        out->localization_known = 1;
        out->power_on_x_m = pose.x_m;
        out->power_on_y_m = pose.y_m;
        out->power_on_theta_rad = pose.theta_rad;
        out->power_on_flags = (int32_t)pose.flags;
    }
    if (roburoc4_client_battery_properties(client, &battery) >= 0) {
        out->battery_known = 1;
        out->nominal_voltage_v = battery.nominal_voltage_v;
        out->capacity_ah = battery.capacity_ah;
        out->minimum_percent = battery.minimum_percent;
    }
}

static void map_telemeter_properties(const roburoc4_client *client, mapping_services *storage,
                                     roburoc4_lcm_robot_properties_t *out) {
    roburoc4_telemeter in;
    for (uint32_t at = 0; roburoc4_client_telemeter(client, at, &in) >= 0; at++) {
        map_telemeter(&in, in.distance_m, &storage->telemeters[at]);
        out->telemeter_count++;
    }
    out->telemeter_known = out->telemeter_count > 0;
    out->telemeters = storage->telemeters;
}

static int32_t at_most(int32_t count, int32_t max) {
    return count < max ? count : max;
}

static void map_iocard_properties(const roburoc4_client *client, mapping_names *names,
                                  roburoc4_lcm_robot_properties_t *out) {
    roburoc4_iocard_properties in;
    out->analog_input_names = mapping_names_of(names, client, ROBUROC4_IO_ANALOG_INPUT);
    out->analog_output_names = mapping_names_of(names, client, ROBUROC4_IO_ANALOG_OUTPUT);
    out->digital_input_names = mapping_names_of(names, client, ROBUROC4_IO_DIGITAL_INPUT);
    out->digital_output_names = mapping_names_of(names, client, ROBUROC4_IO_DIGITAL_OUTPUT);
    if (roburoc4_client_iocard_properties(client, &in) < 0) {
        return;
    }
    out->iocard_known = 1;
    out->analog_input_count = at_most(in.analog_inputs, ROBUROC4_MAX_ANALOG_INPUTS);
    out->analog_output_count = at_most(in.analog_outputs, ROBUROC4_MAX_ANALOG_OUTPUTS);
    out->digital_input_count = at_most(in.digital_inputs, ROBUROC4_MAX_DIGITAL_INPUTS);
    out->digital_output_count = at_most(in.digital_outputs, ROBUROC4_MAX_DIGITAL_OUTPUTS);
}

/* The manual's name of the service with this id on the wire, or "". */
static const char *name_of_id(const roburoc4_client *client, uint16_t id) {
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (roburoc4_client_service_id(client, service) == (roburoc4_result)id) {
            return roburoc4_name(ROBUROC4_NAME_SERVICE, service);
        }
    }
    return "";
}

static void map_services(const roburoc4_client *client, mapping_services *storage,
                         roburoc4_lcm_robot_properties_t *out) {
    roburoc4_directory_entry entry;
    for (uint32_t at = 0; roburoc4_client_service_at(client, at, &entry) >= 0; at++) {
        const char *name = name_of_id(client, entry.id);
        storage->ids[at] = entry.id;
        storage->types[at] = entry.type;
        text_copy(storage->names[at], MAPPING_NAME_SIZE, (const uint8_t *)name, strlen(name));
        storage->list[at] = storage->names[at];
        out->service_count++;
    }
    out->service_ids = storage->ids;
    out->service_types = storage->types;
    out->service_names = storage->list;
}

void mapping_properties(const roburoc4_client *client, const roburoc4_config *config,
                        mapping_names *names, char *robot, int64_t utime, mapping_services *storage,
                        roburoc4_lcm_robot_properties_t *out) {
    memset(out, 0, sizeof *out);
    out->utime = utime;
    out->robot = robot;
    out->ceiling_linear_m_s = config->max_linear_m_s;
    out->ceiling_angular_rad_s = config->max_angular_rad_s;
    out->scale_linear = config->scale_linear;
    out->scale_angular = config->scale_angular;
    map_differential_properties(client, out);
    map_small_properties(client, out);
    map_telemeter_properties(client, storage, out);
    map_iocard_properties(client, names, out);
    map_services(client, storage, out);
}
