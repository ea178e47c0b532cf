/* SPDX-License-Identifier: MIT
 *
 * Discovery: which id on the wire is which service, which input is the game pad's [A], and which
 * texts are still missing. Nothing is sent here: schedule.c sends the requests.
 */
#include "machines.h"

/* Only this much of a text is searched, as it may be as long as a datagram. */
#define TEXT_SEARCHED 255U

void roburoc4_discovery_clear(discovery *d) {
    memset(d, 0, sizeof *d);
    roburoc4_discovery_read_texts_again(d);
}

void roburoc4_discovery_restart(discovery *d) {
    d->identified = 0;
    d->known = 0;
    d->refused = 0;
    d->texts_done = 0;
    d->doubted = 0;
    memset(d->given_up, 0, sizeof d->given_up);
}

void roburoc4_discovery_forget_inputs(discovery *d) {
    memset(d->described, 0, LIST_DIRECTORY * sizeof d->described[0]);
    memset(d->given_up, 0, LIST_DIRECTORY * sizeof d->given_up[0]);
    memset(d->role_texts, 0xFF, sizeof d->role_texts); /* ROLE_TEXT_NONE */
    memset(d->bumpers, 0, sizeof d->bumpers);
    d->table_refused = 0;
    d->doubted = 0;
    d->texts_done = 0;
}

void roburoc4_discovery_read_texts_again(discovery *d) {
    roburoc4_discovery_forget_inputs(d);
    memset(d->claims, CLAIM_NONE, sizeof d->claims);
    d->described[LIST_DIRECTORY] = 0;
    d->given_up[LIST_DIRECTORY] = 0;
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
    roburoc4_directory_entry entry = {0, 0}; /* always written below, but gcc cannot see that */
    d->service_count = (uint8_t)at_most(directory->count, ROBUROC4_MAX_SERVICES);
    for (uint32_t i = 0; i < d->service_count; i++) {
        roburoc4_directory_at(directory, i, &entry);
        d->types[i] = entry.type;
        d->ids[i] = entry.id;
    }
    d->truncated = directory->count > ROBUROC4_MAX_SERVICES;
    return d->truncated != 0;
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
        return ROBUROC4_SERVICE_DIRECTORY; /* known, but not one that the client uses */
    default:
        return CLAIM_NONE;
    }
}

/** The id that the program set for a service, or ROBUROC4_ID_AUTO. */
static int32_t set_id(const roburoc4_config *config, uint32_t kind) {
    return kind == ROBUROC4_SERVICE_IOCARD         ? config->iocard_id
           : kind == ROBUROC4_SERVICE_DIFFERENTIAL ? config->differential_id
                                                   : ROBUROC4_ID_AUTO;
}

/** The service for which the program set this id, or CLAIM_NONE. */
static uint8_t kind_set(const roburoc4_config *config, uint16_t id) {
    return id == config->iocard_id         ? ROBUROC4_SERVICE_IOCARD
           : id == config->differential_id ? ROBUROC4_SERVICE_DIFFERENTIAL
                                           : CLAIM_NONE;
}

bool roburoc4_discovery_may_drive(const discovery *d, const roburoc4_config *config, uint16_t id) {
    for (uint32_t i = 0; i < d->service_count; i++) {
        const uint8_t kind = config->differential_id >= 0 || kind_set(config, id) != CLAIM_NONE
                                 ? kind_set(config, id)
                                 : kind_of_type(d->types[i]);
        if (d->ids[i] == id && (kind == ROBUROC4_SERVICE_DIFFERENTIAL ||
                                (kind == CLAIM_NONE && config->differential_id < 0))) {
            return true;
        }
    }
    return false;
}

/** Whether only a text can identify the service of entry i, and it has none yet. */
static bool unseen(const discovery *d, uint32_t i) {
    return d->ids[i] > ROBUROC4_SERVICE_NOTIFICATION && kind_of_type(d->types[i]) == CLAIM_NONE &&
           d->claims[i] == CLAIM_NONE;
}

static bool any_unseen(const discovery *d) {
    uint32_t i = 0;
    while (i < d->service_count && !unseen(d, i)) {
        i++;
    }
    return i < d->service_count;
}

bool roburoc4_discovery_doubtful(const discovery *d, const roburoc4_config *config) {
    for (uint32_t i = 0; i < d->service_count; i++) {
        if (kind_set(config, d->ids[i]) == CLAIM_NONE &&
            (unseen(d, i) || d->claims[i] == CLAIM_DOUBT)) {
            return true;
        }
    }
    return false;
}

/** How well entry i matches a service: 4 by the program's setting, 3 by type, 2 by text, 1 by the
 * manual's id, else 0. */
static uint32_t claim_strength(const discovery *d, const roburoc4_config *config, uint32_t i,
                               uint32_t kind) {
    const uint8_t type = kind_of_type(d->types[i]);
    if (d->ids[i] <= ROBUROC4_SERVICE_NOTIFICATION) {
        return 0;
    }
    if (set_id(config, kind) >= 0 || kind_set(config, d->ids[i]) != CLAIM_NONE) {
        return set_id(config, kind) == d->ids[i] ? 4 : 0;
    }
    if (type != CLAIM_NONE) {
        return type == kind ? 3 : 0;
    }
    if (d->claims[i] < ROBUROC4_SERVICE_COUNT) {
        return d->claims[i] == kind ? 2 : 0;
    }
    /* not while a text is missing that may give this service to another id */
    return d->ids[i] == kind && !any_unseen(d) ? 1 : 0;
}

bool roburoc4_discovery_identify(discovery *d, const roburoc4_config *config) {
    bool changed = false;
    d->listed = 0;
    for (uint32_t kind = ROBUROC4_SERVICE_IOCARD; kind < ROBUROC4_SERVICE_COUNT; kind++) {
        uint32_t best = 0;
        uint16_t id = 0;
        for (uint32_t i = 0; i < d->service_count; i++) {
            const uint32_t strength = claim_strength(d, config, i, kind);
            /* among equals the one with the manual's id, else the first */
            if (strength > best || (strength == best && strength > 0 && d->ids[i] == kind)) {
                best = strength;
                id = d->ids[i];
            }
        }
        changed = changed || (d->service_ids[kind] != 0 && id != d->service_ids[kind]);
        d->service_ids[kind] = id;
        d->listed = (uint8_t)(d->listed | (best > 0 ? 1U << kind : 0U));
    }
    d->identified = 1;
    return changed; /* a service that is not listed has id 0 */
}

/* ---- texts ---- */

static char lower(char c) {
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool is_letter(char c) {
    const char small = lower(c);
    return (small >= 'a' && small <= 'z') || (c >= '0' && c <= '9') || (uint8_t)c >= 0xC0U;
}

/** Whether a text goes on with a letter, in Latin-1, Windows-1252 or UTF-8. 0x80 to 0xBF is one
 * only within a letter of UTF-8, and 0xE2 0x80 begins punctuation; `before` is the byte of the word
 * before this one, or 0. */
static bool at_letter(piece text, char before) {
    const uint8_t byte = (uint8_t)text.text[0];
    if (byte >= 0x80U && byte < 0xC0U) {
        return (uint8_t)before >= 0x80U;
    }
    return is_letter(text.text[0]) &&
           !(byte == 0xE2U && text.length > 1 && (uint8_t)text.text[1] == 0x80U);
}

static bool same_word(piece a, piece b) {
    uint32_t i = 0;
    while (i < a.length && i < b.length && lower(a.text[i]) == lower(b.text[i])) {
        i++;
    }
    return i == a.length && i == b.length;
}

static void skip(piece *text) {
    text->text++;
    text->length--;
}

/** The next run of letters; *rest is moved behind it. Length 0 at the end. */
static piece next_run(piece *rest) {
    piece run;
    while (rest->length > 0 && !at_letter(*rest, 0)) {
        skip(rest);
    }
    run = *rest;
    while (rest->length > 0 && at_letter(*rest, rest->text == run.text ? 0 : rest->text[-1])) {
        skip(rest);
    }
    run.length -= rest->length;
    return run;
}

piece roburoc4_next_word(piece *rest) {
    static const piece button = {"button", 6}, game = {"game", 4}, pad = {"pad", 3},
                       joystick = {"joystick", 8}, gamepad = {"gamepad", 7};
    piece found = next_run(rest);
    while (same_word(found, button)) {
        found = next_run(rest);
    }
    if (same_word(found, game)) {
        piece behind = *rest;
        if (same_word(next_run(&behind), pad)) {
            *rest = behind;
            return gamepad;
        }
    }
    return same_word(found, joystick) ? gamepad : found;
}

uint32_t roburoc4_count_word(piece text, const piece *wanted) {
    uint32_t count = 0;
    for (piece found = roburoc4_next_word(&text); found.length > 0;
         found = roburoc4_next_word(&text)) {
        count += wanted == NULL || same_word(found, *wanted);
    }
    return count;
}

/** Whether the letters of a text contain these, ignoring everything else. */
static bool contains_letters(piece text, const char *wanted) {
    for (; text.length > 0; skip(&text)) {
        piece rest = text;
        uint32_t i = 0;
        if (!is_letter(*text.text)) {
            continue; /* else a text of blanks would take time proportional to its length squared */
        }
        for (; rest.length > 0; skip(&rest)) {
            if (!is_letter(*rest.text)) {
                continue;
            }
            if (lower(*rest.text) != wanted[i]) {
                break;
            }
            i++;
        }
        if (wanted[i] == '\0') {
            return true;
        }
    }
    return false;
}

static uint8_t kind_of_text(piece text) {
    static const char names[][13] = {"iocard", "telemeter", "battery", "locali", "differential"};
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        if (contains_letters(text, names[i])) {
            return (uint8_t)(ROBUROC4_SERVICE_IOCARD + i);
        }
    }
    return text.length == 0 ? CLAIM_REFUSED : CLAIM_OTHER; /* an empty one says nothing */
}

/** Whether a text has all words of a role. That of [A] has no others: "Game pad A LED" is not [A],
 * nor is "Game pad battery A". */
static bool is_role(uint32_t role, piece text) {
    static const piece words[ROBUROC4_ROLE_COUNT][2] = {{{"gamepad", 7}, {"a", 1}},
                                                        {{"front", 5}, {"bumper", 6}},
                                                        {{"rear", 4}, {"bumper", 6}},
                                                        {{"battery", 7}, {"voltage", 7}}};
    return roburoc4_count_word(text, &words[role][0]) > 0 &&
           roburoc4_count_word(text, &words[role][1]) > 0 &&
           (role != ROBUROC4_ROLE_OVERRIDE || roburoc4_count_word(text, NULL) == 2);
}

static bool is_bumper(uint32_t role) {
    return role == ROBUROC4_ROLE_FRONT_BUMPER || role == ROBUROC4_ROLE_REAR_BUMPER;
}

int32_t roburoc4_table_index(uint32_t io_type, int32_t count, int32_t place) {
    static const uint8_t places[] = {ROBUROC4_AI_COUNT, ROBUROC4_AO_COUNT, ROBUROC4_DI_COUNT,
                                     ROBUROC4_DO_COUNT};
    const int32_t more = count - places[io_type];
    if (more != 0 && more != 1) {
        return -1;
    }
    return place > 1 ? place + more : place;
}

static int32_t role_by_table(uint32_t role, int32_t count) {
    return roburoc4_table_index(role_type(role), count, role_place(role));
}

/** The input that is [A] by the manual's table, on a card like the manual's; else -1. */
static int32_t pad_by_table(const int32_t *io_counts) {
    if (roburoc4_table_index(ROBUROC4_IO_ANALOG_INPUT, io_counts[ROBUROC4_IO_ANALOG_INPUT], 0) <
            0 ||
        io_counts[ROBUROC4_IO_ANALOG_OUTPUT] != ROBUROC4_AO_COUNT ||
        io_counts[ROBUROC4_IO_DIGITAL_OUTPUT] != ROBUROC4_DO_COUNT) {
        return -1;
    }
    return role_by_table(ROBUROC4_ROLE_OVERRIDE, io_counts[ROBUROC4_IO_DIGITAL_INPUT]);
}

static piece searched(const uint8_t *text, uint32_t length) {
    return (piece){(const char *)text, length < TEXT_SEARCHED ? length : TEXT_SEARCHED};
}

uint8_t roburoc4_discovery_roles(uint32_t list, const uint8_t *text, uint32_t length) {
    uint8_t roles = 0;
    for (uint32_t role = 0; role < ROBUROC4_ROLE_COUNT; role++) {
        if (role_type(role) == list && is_role(role, searched(text, length))) {
            roles |= (uint8_t)(1U << role);
        }
    }
    return roles;
}

/** The text of a channel names its input for these roles. */
static void assign_roles(discovery *d, uint32_t list, uint32_t index, uint8_t roles) {
    d->described[list] |= (uint64_t)1 << index;
    for (uint32_t role = 0; role < ROBUROC4_ROLE_COUNT; role++) {
        if ((roles >> role & 1) == 0) {
            continue;
        }
        if (is_bumper(role)) {
            d->bumpers[role - ROBUROC4_ROLE_FRONT_BUMPER] |= (uint64_t)1 << index;
            continue;
        }
        const bool first = d->role_texts[role] == ROLE_TEXT_NONE;
        d->role_texts[role] =
            first || d->role_texts[role] == (int16_t)index ? (int16_t)index : ROLE_TEXT_AMBIGUOUS;
    }
}

bool roburoc4_discovery_text(discovery *d, uint32_t list, uint32_t index, const uint8_t *text,
                             uint32_t length) {
    if (list == LIST_DIRECTORY) {
        d->described[list] |= (uint64_t)1 << index;
        d->claims[index] = kind_of_text(searched(text, length));
        return false;
    }
    const uint8_t roles = roburoc4_discovery_roles(list, text, length);
    assign_roles(d, list, index, roles);
    return roles != 0;
}

void roburoc4_discovery_doubt(discovery *d, uint32_t list, uint32_t index, uint8_t roles) {
    d->doubted = 1;
    d->doubted_list = (uint8_t)list;
    d->doubted_index = (uint16_t)index;
    d->doubted_roles = roles;
}

bool roburoc4_discovery_believe(discovery *d, const int32_t *io_counts) {
    d->doubted = 0;
    if (d->doubted_roles == TEXT_REFUSED) {
        roburoc4_discovery_text_refused(d, io_counts, d->doubted_list, d->doubted_index);
        return false;
    }
    assign_roles(d, d->doubted_list, d->doubted_index, d->doubted_roles);
    return d->doubted_roles != 0;
}

void roburoc4_discovery_doubtful_text(discovery *d, uint32_t index) {
    d->described[LIST_DIRECTORY] |= (uint64_t)1 << index;
    d->claims[index] = CLAIM_DOUBT;
}

void roburoc4_discovery_text_refused(discovery *d, const int32_t *io_counts, uint32_t list,
                                     uint32_t index) {
    d->described[list] |= (uint64_t)1 << index;
    if (list == LIST_DIRECTORY) {
        d->claims[index] = CLAIM_REFUSED;
    } else if (list == ROBUROC4_IO_DIGITAL_INPUT) {
        for (uint32_t role = 0; role <= ROBUROC4_ROLE_REAR_BUMPER; role++) {
            const int32_t place = role == ROBUROC4_ROLE_OVERRIDE
                                      ? pad_by_table(io_counts)
                                      : role_by_table(role, io_counts[list]);
            d->table_refused |= (uint8_t)((place == (int32_t)index) << role);
        }
    }
}

void roburoc4_discovery_text_given_up(discovery *d, uint32_t list, uint32_t index) {
    d->given_up[list] |= (uint64_t)1 << index;
}

static uint32_t list_length(const discovery *d, const int32_t *io_counts, uint32_t list) {
    static const uint8_t capacity[4] = {ROBUROC4_MAX_ANALOG_INPUTS, ROBUROC4_MAX_ANALOG_OUTPUTS,
                                        ROBUROC4_MAX_DIGITAL_INPUTS, ROBUROC4_MAX_DIGITAL_OUTPUTS};
    if (list == LIST_DIRECTORY) {
        return d->service_count;
    }
    return io_counts[list] < capacity[list] ? (uint32_t)io_counts[list] : capacity[list];
}

/** Whether these bits are set for every element of a list. */
static bool complete(const discovery *d, const int32_t *io_counts, uint32_t list, uint64_t bits) {
    return (~bits & lowest_bits(list_length(d, io_counts, list))) == 0;
}

bool roburoc4_discovery_next_text(const discovery *d, const requests *r, const int32_t *io_counts,
                                  text_choice choice, ask *out) {
    /* what driving depends on comes first; then the rest of the directory */
    static const uint8_t order[] = {
        LIST_DIRECTORY,           ROBUROC4_IO_DIGITAL_INPUT,  LIST_DIRECTORY,
        ROBUROC4_IO_ANALOG_INPUT, ROBUROC4_IO_DIGITAL_OUTPUT, ROBUROC4_IO_ANALOG_OUTPUT};
    static const uint8_t lists[] = {1, 2, sizeof order}; /* by choice */
    for (uint32_t i = 0; i < lists[choice]; i++) {
        const uint8_t list = order[i];
        const uint32_t length = list_length(d, io_counts, list);
        const uint64_t passed = d->described[list] | d->given_up[list];
        const bool directory = list == LIST_DIRECTORY;
        for (uint32_t index = 0; index < length; index++) {
            if ((passed >> index & 1) != 0 || (i == 0 && !unseen(d, index))) {
                continue;
            }
            out->action = ROBUROC4_ACTION_QUERY;
            out->kind = directory ? ROBUROC4_SERVICE_DIRECTORY : ROBUROC4_SERVICE_IOCARD;
            out->detail = list;
            out->max_tries = TEXT_TRIES;
            out->target =
                directory ? ROBUROC4_SERVICE_DIRECTORY : d->service_ids[ROBUROC4_SERVICE_IOCARD];
            out->subject = (uint16_t)index;
            if (!roburoc4_requests_is_open(r, out)) {
                return true;
            }
        }
    }
    return false;
}

bool roburoc4_discovery_texts_passed(const discovery *d, const int32_t *io_counts) {
    for (uint32_t list = 0; list <= LIST_DIRECTORY; list++) {
        if (!complete(d, io_counts, list, d->described[list] | d->given_up[list])) {
            return false;
        }
    }
    return true;
}

bool roburoc4_discovery_inputs_passed(const discovery *d, const int32_t *io_counts) {
    const uint32_t list = ROBUROC4_IO_DIGITAL_INPUT;
    return d->texts_done || complete(d, io_counts, list, d->described[list] | d->given_up[list]);
}

bool roburoc4_discovery_services_passed(const discovery *d) {
    for (uint32_t i = 0; i < d->service_count; i++) {
        if (unseen(d, i) && (d->given_up[LIST_DIRECTORY] >> i & 1) == 0) {
            return false;
        }
    }
    return true;
}

void roburoc4_discovery_ask_again(discovery *d, const int32_t *io_counts) {
    if (d->texts_done && roburoc4_discovery_texts_passed(d, io_counts)) {
        memset(d->given_up, 0, sizeof d->given_up);
    }
    d->text_due = d->texts_done;
}

/** Whether the robot gave or refused the text of every digital input. */
static bool inputs_described(const discovery *d, const int32_t *io_counts) {
    const int32_t count = io_counts[ROBUROC4_IO_DIGITAL_INPUT];
    return count <= ROBUROC4_MAX_DIGITAL_INPUTS &&
           (~d->described[ROBUROC4_IO_DIGITAL_INPUT] & lowest_bits((uint32_t)count)) == 0;
}

/** Which input is [A]. In fixed-id mode, where a late text may be another input's, text and table
 * must agree. */
static int32_t find_pad(const discovery *d, const int32_t *io_counts, uint8_t fixed_id) {
    const int32_t index = d->role_texts[ROBUROC4_ROLE_OVERRIDE];
    if (!inputs_described(d, io_counts)) {
        return ROLE_TEXT_NONE;
    }
    if (index == ROLE_TEXT_NONE && (d->table_refused & 1U << ROBUROC4_ROLE_OVERRIDE) != 0) {
        return pad_by_table(io_counts);
    }
    return fixed_id && index != pad_by_table(io_counts) ? ROLE_TEXT_NONE : index;
}

/** Which input has another role: by its text, else by the table, as a wrong guess is harmless. */
static int32_t find_input(const discovery *d, const int32_t *io_counts, uint32_t role) {
    int32_t index = d->role_texts[role];
    if (is_bumper(role) && d->bumpers[role - ROBUROC4_ROLE_FRONT_BUMPER] != 0) {
        index = 0;
        while ((d->bumpers[role - ROBUROC4_ROLE_FRONT_BUMPER] >> index & 1) == 0) {
            index++;
        }
    }
    return index == ROLE_TEXT_NONE ? role_by_table(role, io_counts[role_type(role)]) : index;
}

uint64_t roburoc4_discovery_bumper(const discovery *d, const roburoc4_config *config,
                                   const int32_t *io_counts, uint32_t role, bool *certain) {
    const bool automatic = config->role_index[role] == ROBUROC4_INDEX_AUTO;
    const uint64_t named = d->bumpers[role - ROBUROC4_ROLE_FRONT_BUMPER];
    const roburoc4_result index = roburoc4_discovery_role(d, config, io_counts, role, 0);
    *certain = index >= 0 && (!automatic || (inputs_described(d, io_counts) &&
                                             (named != 0 || (d->table_refused >> role & 1) != 0)));
    if (index < 0) {
        return 0;
    }
    return automatic && named != 0 ? named : (uint64_t)1 << index;
}

roburoc4_result roburoc4_discovery_role(const discovery *d, const roburoc4_config *config,
                                        const int32_t *io_counts, uint32_t role, uint8_t fixed_id) {
    int32_t index = config->role_index[role];
    if (index == ROBUROC4_INDEX_AUTO) {
        index = role == ROBUROC4_ROLE_OVERRIDE ? find_pad(d, io_counts, fixed_id)
                                               : find_input(d, io_counts, role);
    }
    /* below 64, as the setting and the stored texts are */
    return index >= 0 && index < io_counts[role_type(role)] ? index : ROBUROC4_ERR_NOT_KNOWN;
}
