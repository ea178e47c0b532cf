/* SPDX-License-Identifier: MIT
 *
 * The configuration: its defaults, which values are refused, and the members of the family.
 */
#include <string.h>

#include "model.h"
#include "settings.h"

static void store(roburoc4_sim_config *config, const sim_setting *setting, double value) {
    (void)sim_value_store((uint8_t *)config + setting->offset, setting->kind, value);
}

static void set_defaults(roburoc4_sim_config *config) {
    const sim_setting *setting;
    memset(config, 0, sizeof *config);
    config->size = sizeof *config;
    config->service_ids[ROBUROC4_SERVICE_NOTIFICATION] = ROBUROC4_SERVICE_NOTIFICATION;
    config->service_types[ROBUROC4_SERVICE_NOTIFICATION] = ROBUROC4_SERVICE_NOTIFICATION;
    for (uint32_t index = 0; (setting = sim_setting_at(index)) != NULL; index++) {
        store(config, setting, setting->usual);
    }
}

/* With the caller's size of the struct. */
static roburoc4_result give(const roburoc4_sim_config *all, roburoc4_sim_config *config,
                            size_t size) {
    if (!sim_size_is_valid(size, sizeof *all)) {
        return ROBUROC4_ERR_SIZE;
    }
    memcpy(config, all, size);
    config->size = (uint32_t)size;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_sim_config_init(roburoc4_sim_config *config, size_t size) {
    roburoc4_sim_config defaults;
    set_defaults(&defaults);
    return give(&defaults, config, size);
}

bool sim_config_take(roburoc4_sim_config *out, const roburoc4_sim_config *config) {
    if (!sim_size_is_valid(config->size, sizeof *out)) {
        return false;
    }
    set_defaults(out);
    memcpy(out, config, config->size);
    out->size = sizeof *out;
    return true;
}

/* ----------------------------------------------------------------------------- what is valid ---
 */

static const char *ids_error(const roburoc4_sim_config *config) {
    if (config->service_ids[ROBUROC4_SERVICE_DIRECTORY] != ROBUROC4_SERVICE_DIRECTORY ||
        config->service_ids[ROBUROC4_SERVICE_NOTIFICATION] != ROBUROC4_SERVICE_NOTIFICATION) {
        return "service_ids: the directory's is always 0 and the notification's 1";
    }
    for (uint32_t one = 0; one < ROBUROC4_SERVICE_COUNT; one++) {
        for (uint32_t two = one + 1; two < ROBUROC4_SERVICE_COUNT; two++) {
            if (config->service_ids[one] == config->service_ids[two]) {
                return "service_ids: two services share an id; give each its own";
            }
        }
    }
    if ((config->hidden_services & 3u) != 0) {
        return "hidden_services: the directory and the notification cannot be hidden";
    }
    return NULL;
}

const char *roburoc4_sim_config_error(const roburoc4_sim_config *given) {
    roburoc4_sim_config config;
    const sim_setting *setting;
    if (!sim_config_take(&config, given)) {
        return "size: fill the configuration with roburoc4_sim_config_init() of this library";
    }
    const char *error = ids_error(&config);
    for (uint32_t index = 0; error == NULL && (setting = sim_setting_at(index)) != NULL; index++) {
        error = sim_setting_error(setting, sim_setting_get(&config, setting));
    }
    return error;
}

/* ------------------------------------------------------------------------------- the family --- */

/* One of the services with statuses, as a mask. */
static double a_service(uint64_t *random) {
    return 1u << (ROBUROC4_SERVICE_IOCARD + sim_random(random) % (ROBUROC4_SERVICE_COUNT - 2));
}

/* A value of the family: often an end of its range, where faults are likely. */
static double draw(const sim_setting *setting, uint64_t *random) {
    uint64_t end = sim_random(random) % 8;
    double share = sim_random_unit(random);
    bool whole = setting->kind != SIM_FLOAT && setting->kind != SIM_DOUBLE;
    double span = setting->to - setting->from + (whole ? 1.0 : 0.0);
    bool wide = setting->from > 0.0 && setting->to >= 100.0 * setting->from;
    double between = wide ? setting->from * pow(setting->to / setting->from, share)
                          : setting->from + share * span;
    between = whole ? floor(between) : floor(between * 1000.0 + 0.5) / 1000.0;
    return end == 0 ? setting->from : end == 1 ? setting->to : fmin(between, setting->to);
}

roburoc4_result roburoc4_sim_config_family(roburoc4_sim_config *config, size_t size,
                                           uint64_t seed) {
    roburoc4_sim_config drawn;
    const sim_setting *setting;
    uint64_t random = seed;
    set_defaults(&drawn);
    drawn.seed = seed;
    /* How much differs from the defaults differs from member to member, too. */
    double strangeness = sim_random_unit(&random);
    for (uint32_t index = 0; (setting = sim_setting_at(index)) != NULL; index++) {
        double value = draw(setting, &random);
        if (sim_random_unit(&random) < strangeness && setting->from < setting->to) {
            store(&drawn, setting, value);
        }
    }
    drawn.hidden_services = drawn.hidden_services != 0 ? (uint32_t)a_service(&random) : 0;
    drawn.refused_inserts = drawn.refused_inserts != 0 ? (uint32_t)a_service(&random) : 0;
    for (uint16_t service = ROBUROC4_SERVICE_IOCARD; ids_error(&drawn) != NULL;) {
        drawn.service_ids[service] = service; /* two drew the same id: give both back */
        service++;
    }
    return give(&drawn, config, size);
}

/* ---------------------------------------------------------------------- channels of the card ---
 */

int32_t sim_channel_meaning(const roburoc4_sim *sim, uint32_t io_type, uint32_t index) {
    bool analog = io_type == ROBUROC4_IO_ANALOG_INPUT;
    if ((!analog && io_type != ROBUROC4_IO_DIGITAL_INPUT) || index < 2) {
        return (int32_t)index;
    }
    /* The manual's tables skip number 02; on a card with one more channel it is an unused input. */
    bool literal = analog ? sim->config.analog_inputs == ROBUROC4_AI_COUNT + 1
                          : sim->config.digital_inputs == ROBUROC4_DI_COUNT + 1;
    uint32_t shift = sim->config.input_shift + (literal ? 1u : 0u);
    return index < 2 + shift ? -1 : (int32_t)(index - shift);
}
