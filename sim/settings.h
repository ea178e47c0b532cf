/* SPDX-License-Identifier: MIT
 *
 * The settings of a simulated robot: all members of its configuration but `size`, as a table.
 */
#ifndef ROBUROC4_SIM_SETTINGS_H
#define ROBUROC4_SIM_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>

#include "roburoc4_sim.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum sim_kind {
    SIM_SHORT,
    SIM_WHOLE,
    SIM_WHOLE_64,
    SIM_SIGNED,
    SIM_FLOAT,
    SIM_DOUBLE
} sim_kind;

typedef struct sim_setting {
    const char *name;
    size_t offset;
    sim_kind kind;
    double usual;
    double low, high;   /* what is valid; low > high: anything, not finite numbers too */
    double from, to;    /* within the family; from == to: always the usual value */
    const char *remedy; /* "NAME: give LOW to HIGH" */
} sim_setting;

/* The table's row, from index 0 on; NULL beyond the last. */
const sim_setting *sim_setting_at(uint32_t index);
/* The row of a member; NULL: none has this name. */
const sim_setting *sim_setting_named(const char *name);
/* What is wrong with a value, by itself; NULL: nothing. */
const char *sim_setting_error(const sim_setting *setting, double value);
double sim_setting_get(const roburoc4_sim_config *config, const sim_setting *setting);
/* A number of this kind, of settings and of controls. False if it cannot hold the value. */
double sim_value_get(const void *at, sim_kind kind);
bool sim_value_store(void *at, sim_kind kind, double value);

/* Set the member with this name. ROBUROC4_ERR_INDEX: there is none; ROBUROC4_ERR_ARGUMENT: it
 * cannot hold the value. Nothing was changed then. Whether the configuration is valid, only
 * roburoc4_sim_config_error() checks. */
roburoc4_result sim_config_set(roburoc4_sim_config *config, const char *name, double value);
/* The name of a member, from index 0 on; NULL beyond the last. */
const char *sim_config_name(uint32_t index);

#ifdef __cplusplus
}
#endif

#endif
