/* SPDX-License-Identifier: MIT
 *
 * Discovery: which id on the wire is which service, which input is the game pad's [A], and which
 * texts are still to be asked for. Nothing here is sent: asking.c asks, this file remembers.
 */
#include "internal.h"

/* Words are looked for in so much of a text: it may be as long as a datagram. */
#define TEXT_SEARCHED 255U

void roburoc4_discovery_clear(discovery *d) {
    const uint8_t wanted = d->wanted; /* what to subscribe to is the user's, not the robot's */
    memset(d, 0, sizeof *d);
    d->wanted = wanted;
    memset(d->claims, CLAIM_NONE, sizeof d->claims);
    for (uint32_t role = 0; role < ROBUROC4_ROLE_COUNT; role++) {
        d->role_texts[role] = ROLE_TEXT_NONE;
    }
}

void roburoc4_discovery_restart(discovery *d) {
    d->identified = 0;
    d->known = 0;
    d->refused = 0;
    d->inserted = 0;
    d->acked = 0;
    d->declined = 0;
    d->leaving = 0;
    d->done = 0;
}

void roburoc4_discovery_read_texts_again(discovery *d) {
    memset(d->described, 0, sizeof d->described);
    d->done = 0;
}

/* ---- services ---- */

bool roburoc4_discovery_same(const discovery *d, const roburoc4_directory *directory) {
    roburoc4_directory_entry entry;
    uint32_t i = 0;
    while (i < d->service_count && roburoc4_directory_at(directory, i, &entry) >= 0 &&
           entry.id == d->ids[i] && entry.type == d->types[i]) {
        i++;
    }
    return i == d->service_count && (i == directory->count || i == ROBUROC4_MAX_SERVICES);
}

bool roburoc4_discovery_directory(discovery *d, const roburoc4_directory *directory) {
    roburoc4_directory_entry entry;
    uint32_t i = 0;
    for (; i < ROBUROC4_MAX_SERVICES && roburoc4_directory_at(directory, i, &entry) >= 0; i++) {
        d->types[i] = entry.type;
        d->ids[i] = entry.id;
    }
    d->service_count = (uint8_t)i;
    return directory->count > ROBUROC4_MAX_SERVICES;
}

static uint8_t kind_of_type(uint16_t type) {
    switch (type) {
    case ROBUROC4_TYPE_IOCARD:
        return ROBUROC4_SERVICE_IOCARD;
    case ROBUROC4_TYPE_TELEMETER:
        return ROBUROC4_SERVICE_TELEMETER;
    case ROBUROC4_TYPE_LOCALIZATION:
        return ROBUROC4_SERVICE_LOCALIZATION;
    case ROBUROC4_TYPE_DIFFERENTIAL:
        return ROBUROC4_SERVICE_DIFFERENTIAL;
    case ROBUROC4_TYPE_DIAGNOSTIC:
    case ROBUROC4_TYPE_LASER:
    case ROBUROC4_TYPE_DRIVE:
        return ROBUROC4_SERVICE_DIRECTORY; /* known, and none of those that a client uses */
    default:
        return CLAIM_NONE;
    }
}

bool roburoc4_discovery_may_drive(const discovery *d, uint16_t id) {
    for (uint32_t i = 0; i < d->service_count; i++) {
        const uint8_t kind = kind_of_type(d->types[i]);
        if (d->ids[i] == id && (kind == CLAIM_NONE || kind == ROBUROC4_SERVICE_DIFFERENTIAL)) {
            return true;
        }
    }
    return false;
}

/** How well element i stands for a service: by type 3, by text 2, by the manual's id 1, not 0. */
static uint32_t claim_strength(const discovery *d, uint32_t i, uint32_t kind) {
    const uint8_t type = kind_of_type(d->types[i]);
    if (d->ids[i] <= ROBUROC4_SERVICE_NOTIFICATION) {
        return 0;
    }
    if (type != CLAIM_NONE) {
        return type == kind ? 3 : 0;
    }
    if (d->claims[i] < ROBUROC4_SERVICE_COUNT) {
        return d->claims[i] == kind ? 2 : 0;
    }
    return d->ids[i] == kind ? 1 : 0;
}

bool roburoc4_discovery_unseen(const discovery *d) {
    for (uint32_t i = 0; i < d->service_count; i++) {
        if (d->ids[i] > ROBUROC4_SERVICE_NOTIFICATION && kind_of_type(d->types[i]) == CLAIM_NONE &&
            d->claims[i] == CLAIM_NONE) {
            return true;
        }
    }
    return false;
}

bool roburoc4_discovery_identify(discovery *d) {
    bool changed = false;
    d->listed = 0;
    for (uint32_t kind = ROBUROC4_SERVICE_IOCARD; kind < ROBUROC4_SERVICE_COUNT; kind++) {
        uint32_t best = 0;
        uint16_t id = 0;
        for (uint32_t i = 0; i < d->service_count; i++) {
            const uint32_t strength = claim_strength(d, i, kind);
            /* of equals the one with the manual's id, else the first */
            if (strength > best || (strength == best && strength > 0 && d->ids[i] == kind)) {
                best = strength;
                id = d->ids[i];
            }
        }
        changed = changed || id != d->service_ids[kind];
        d->service_ids[kind] = id;
        d->listed = (uint8_t)(d->listed | (best > 0 ? 1U << kind : 0U));
    }
    d->identified = 1;
    return changed; /* a service that is not listed has id 0 */
}

/* ---- texts ---- */

/** A letter (as a small one) or digit, or 0 for any other character. */
static uint8_t letter(uint8_t c) {
    if (c >= 'A' && c <= 'Z') {
        return (uint8_t)(c - 'A' + 'a');
    }
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ? c : 0;
}

/** Whether the letters and digits of a text from here on begin with `word`. */
static bool begins(const uint8_t *text, uint32_t length, uint32_t start, const char *word) {
    uint32_t i = 0;
    for (uint32_t at = start; at < length && word[i] != '\0'; at++) {
        const uint8_t c = letter(text[at]);
        if (c == 0) {
            continue;
        }
        if (c != (uint8_t)word[i]) {
            return false;
        }
        i++;
    }
    return word[i] == '\0';
}

/** Whether the letters and digits of a text contain `word`. */
static bool contains(const uint8_t *text, uint32_t length, const char *word) {
    for (uint32_t start = 0; start < length; start++) {
        if (letter(text[start]) != 0 && begins(text, length, start, word)) {
            return true;
        }
    }
    return false;
}

static uint8_t kind_of_text(const uint8_t *text, uint32_t length) {
    static const char words[][13] = {"iocard", "telemeter", "battery", "locali", "differential"};
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        if (contains(text, length, words[i])) {
            return (uint8_t)(ROBUROC4_SERVICE_IOCARD + i);
        }
    }
    return CLAIM_OTHER;
}

static bool is_role(uint32_t role, const uint8_t *text, uint32_t length) {
    static const char words[][15] = {"gamepadabutton", "frontbumper", "rearbumper",
                                     "batteryvoltage"};
    return contains(text, length, words[role]);
}

static uint32_t role_list(uint32_t role) {
    return role == ROBUROC4_ROLE_BATTERY_V ? ROBUROC4_IO_ANALOG_INPUT : ROBUROC4_IO_DIGITAL_INPUT;
}

void roburoc4_discovery_described(discovery *d, uint32_t list, uint32_t index) {
    d->described[list] |= (uint64_t)1 << index;
}

bool roburoc4_discovery_text(discovery *d, uint32_t list, uint32_t index, const uint8_t *text,
                             uint32_t length) {
    bool found = false;
    length = length < TEXT_SEARCHED ? length : TEXT_SEARCHED;
    roburoc4_discovery_described(d, list, index);
    if (list == LIST_DIRECTORY) {
        d->claims[index] = kind_of_text(text, length);
        return false;
    }
    for (uint32_t role = 0; role < ROBUROC4_ROLE_COUNT; role++) {
        if (role_list(role) == list && is_role(role, text, length)) {
            const bool first = d->role_texts[role] == ROLE_TEXT_NONE;
            d->role_texts[role] = first || d->role_texts[role] == (int16_t)index
                                      ? (int16_t)index
                                      : ROLE_TEXT_AMBIGUOUS;
            found = true;
        }
    }
    return found;
}

static uint32_t list_length(const discovery *d, const int32_t *io_counts, uint32_t list) {
    static const uint8_t capacity[4] = {ROBUROC4_MAX_ANALOG_INPUTS, ROBUROC4_MAX_ANALOG_OUTPUTS,
                                        ROBUROC4_MAX_DIGITAL_INPUTS, ROBUROC4_MAX_DIGITAL_OUTPUTS};
    if (list == LIST_DIRECTORY) {
        return d->service_count;
    }
    return io_counts[list] < capacity[list] ? (uint32_t)io_counts[list] : capacity[list];
}

bool roburoc4_discovery_next_text(const discovery *d, const requests *r, const int32_t *io_counts,
                                  bool channels, ask *out) {
    /* digital inputs first: among them is the override */
    static const uint8_t order[5] = {LIST_DIRECTORY, ROBUROC4_IO_DIGITAL_INPUT,
                                     ROBUROC4_IO_ANALOG_INPUT, ROBUROC4_IO_DIGITAL_OUTPUT,
                                     ROBUROC4_IO_ANALOG_OUTPUT};
    for (uint32_t i = 0; i < (channels ? 5U : 1U); i++) {
        const uint8_t list = order[i];
        const uint32_t length = list_length(d, io_counts, list);
        const bool directory = list == LIST_DIRECTORY;
        for (uint32_t index = 0; index < length; index++) {
            if ((d->described[list] >> index & 1) != 0) {
                continue;
            }
            out->action = ROBUROC4_ACTION_QUERY;
            out->kind = directory ? ROBUROC4_SERVICE_DIRECTORY : ROBUROC4_SERVICE_IOCARD;
            out->detail = list;
            out->max_tries = 10;
            out->target =
                directory ? ROBUROC4_SERVICE_DIRECTORY : d->service_ids[ROBUROC4_SERVICE_IOCARD];
            out->subject = (uint16_t)index;
            if (!roburoc4_requests_open(r, out)) {
                return true;
            }
        }
    }
    return false;
}

bool roburoc4_discovery_texts_done(const discovery *d, const int32_t *io_counts, bool channels) {
    for (uint32_t list = channels ? 0 : LIST_DIRECTORY; list <= LIST_DIRECTORY; list++) {
        const uint32_t length = list_length(d, io_counts, list);
        const uint64_t all = length < 64 ? ((uint64_t)1 << length) - 1 : UINT64_MAX;
        if ((d->described[list] & all) != all) {
            return false;
        }
    }
    return true;
}

/** The manual's table (5.5.1): where its rows are counted, or (one more input) its numbers. */
static int32_t role_by_table(uint32_t role, int32_t count) {
    static const uint8_t rows[ROBUROC4_ROLE_COUNT] = {ROBUROC4_DI_PAD_A, ROBUROC4_DI_FRONT_BUMPER,
                                                      ROBUROC4_DI_REAR_BUMPER,
                                                      ROBUROC4_AI_BATTERY_V};
    const int32_t table = role == ROBUROC4_ROLE_BATTERY_V ? ROBUROC4_AI_COUNT : ROBUROC4_DI_COUNT;
    if (count != table && count != table + 1) {
        return ROLE_TEXT_NONE;
    }
    return rows[role] > 1 ? rows[role] + (count - table) : rows[role];
}

roburoc4_result roburoc4_discovery_role(const discovery *d, const roburoc4_config *config,
                                        const int32_t *io_counts, uint32_t role) {
    const int32_t count = io_counts[role_list(role)];
    int32_t index = config->role_index[role];
    if (index == ROBUROC4_INDEX_AUTO) {
        index = d->role_texts[role];
    }
    if (index == ROLE_TEXT_NONE) {
        index = role_by_table(role, count);
    }
    return index >= 0 && index < count ? index : ROBUROC4_ERR_UNKNOWN; /* each is below capacity */
}
