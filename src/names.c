/* SPDX-License-Identifier: MIT
 *
 * Names: numbers to text, and the channels of a robot's IO card by name. Nothing else of the core
 * uses this file, so a linker leaves it out of programs that use no names.
 */
#include "machines.h"

/** Entry `index` of a list of texts separated by NUL, which needs no pointers; NULL beyond the
 * last. */
static const char *nth(const char *joined, uint32_t count, uint32_t index) {
    if (index >= count) {
        return NULL;
    }
    while (index > 0) {
        index -= *joined++ == '\0';
    }
    return joined;
}

static const char codec_and_client[] =
    "argument out of range\0"
    "buffer too small\0"
    "datagram shorter than its layout\0"
    "datagram of another kind\0"
    "impossible value in datagram, or several channels with this name\0"
    "the robot answered with an error\0"
    "struct size differs from the library's\0"
    "configuration value out of range\0"
    "client not started, or closing\0"
    "not reported by the robot yet: wait, then try again\0"
    "no channel, entry or control has this number or name\0"
    "output 0 belongs to the robot: use output 1 or above\0"
    "NaN or infinity: give finite numbers\0"
    "answer to no open request\0"
    "status not subscribed to\0"
    "status not newer than the last\0"
    "the robot did not answer any of the tries: check the link, then try again";

static const char motion[] =
    "not armed: call arm() before drive()\0"
    "not connected: check power, cable and address, or wait\0"
    "no usable differential service: set differential_id if you know it\0"
    "the robot's speed limits are not usable: check its properties\0"
    "no recent differential status: check the link and the status period, then arm again\0"
    "no recent IO card status: check the link and the status period, then arm again\0"
    "game pad input unknown: wait a minute for its text, else set override_index or "
    "allow_unknown_override\0"
    "game pad override: release [A] on the game pad\0"
    "the robot is moving, or has a target: wait until it is at rest, or stop it\0"
    "another client commands the robot: end the other program\0"
    "the robot fell silent: check cable and power, then arm again\0"
    "the robot restarted: check it, then arm again\0"
    "the clock went back: find out what sets this machine's clock\0"
    "the robot does not follow its commands: check emergency stops, brakes selector and "
    "bumpers\0"
    "stopped by stop(): call arm() to drive again\0"
    "the program did not renew its drive command in time: call arm() to drive again\0"
    "commands reach the robot late or not at all: check the link, then arm again\0"
    "these look like mm/s or degrees: give at most 5 m/s and 10 rad/s, and angles in radians\0"
    "no subscription to statuses that driving needs: the robot refused it (its list may be "
    "full: "
    "restart it) or has no such service";

static const char adapter[] =
    "the operating system refused\0"
    "host name has no address: check the spelling, or give the address in numbers\0"
    "already closed, or made before a fork: connect again\0"
    "another thread drives a move with this pump: wait for its end, or stop it\0"
    "not an address: give HOST or HOST:PORT, such as 192.168.0.2:60000";

const char *roburoc4_result_text(roburoc4_result result) {
    const char *text = NULL;
    if (result >= 0) {
        return "ok";
    }
    const uint32_t code = 0U - (uint32_t)result;
    if (code < 20) {
        text = nth(codec_and_client, 17, code - 1);
    } else if (code < 40) {
        text = nth(motion, 19, code - 20);
    } else {
        text = nth(adapter, 5, code - 40);
    }
    return text != NULL ? text : "unknown error";
}

/** The place of ROBUROC4_EVENT_OVERRIDE, the first of the events that begin or end a condition. */
#define FIRST_CHANGE 15

/** The place of the only bit of an event. */
static uint32_t bit_index(uint32_t event) {
    uint32_t index = 0;
    if (event == 0 || (event & (event - 1)) != 0) {
        return 32; /* not one event */
    }
    while ((event >> index & 1) == 0) {
        index++;
    }
    return index;
}

static const char events[] =
    "the state of the connection changed\0"
    "the robot is ready\0"
    "the robot fell silent: connecting again\0"
    "the robot restarted\0"
    "properties of a service are new or changed\0"
    "text for a service or channel received\0"
    "IO card status received\0"
    "telemeter status received\0"
    "battery status received\0"
    "localization status received\0"
    "differential status received\0"
    "armed: drive commands are accepted\0"
    "disarmed: drive commands are refused\0"
    "the lease expired without a new drive command: the robot is stopped\0"
    "the robot confirmed the stop\0"
    "game pad [A] was pressed or released\0"
    "another client started or stopped commanding the robot\0"
    "the robot does not follow its commands, or does again\0"
    "the battery fell below the robot's minimum\0"
    "the battery is critical\0"
    "the robot accepted the new pose\0"
    "the robot did not accept the new pose\0"
    "the robot refused a subscription\0"
    "the robot answers every request with the id 1\0"
    "the clock of this machine went back\0"
    "the robot has more services, channels or telemeters than the client stores\0"
    "every text was read or given up\0"
    "a text identified an input: a bumper, [A] or the battery voltage\0"
    "arming is possible now\0"
    "the stop sequence ended, but the robot did not confirm it";

const char *roburoc4_name(uint32_t what, uint32_t number) {
    switch (what) {
    case ROBUROC4_NAME_SERVICE:
        return nth(
            "Directory\0Notification\0IOCard\0Telemeter\0Battery\0Localization\0Differential",
            ROBUROC4_SERVICE_COUNT, number);
    case ROBUROC4_NAME_BATTERY:
        return nth("Charging\0Charged\0Ok\0Critical", 4, number);
    case ROBUROC4_NAME_STATE:
        return nth("idle\0connecting\0discovering\0subscribing\0ready\0lost\0closing", 7, number);
    case ROBUROC4_NAME_EVENT:
        return nth(events, 30, bit_index(number));
    case ROBUROC4_NAME_EVENT_BEGAN:
        return nth("[A] is held on the game pad: the pad drives the robot\0"
                   "another client commands the robot\0"
                   "motion inhibited: the robot does not follow its commands",
                   3, bit_index(number) - FIRST_CHANGE);
    case ROBUROC4_NAME_EVENT_ENDED:
        return nth("[A] on the game pad was released\0"
                   "no other client commands the robot any more\0"
                   "the robot follows its commands again, or none is given",
                   3, bit_index(number) - FIRST_CHANGE);
    default:
        return NULL;
    }
}

/** The manual's table of channels (5.5.1). */
static const char *table_name(uint32_t io_type, uint32_t index) {
    switch (io_type) {
    case ROBUROC4_IO_ANALOG_INPUT:
        return nth("Front telemeter voltage\0Rear telemeter voltage\0Battery voltage\0"
                   "Game pad \"LJ\" Left/Right\0Game pad \"LJ\" Down/Up\0"
                   "Game pad \"RJ\" Left/Right\0Game pad \"RJ\" Down/Up\0"
                   "Game pad \"LT\"\0Game pad \"RT\"",
                   ROBUROC4_AI_COUNT, index);
    case ROBUROC4_IO_DIGITAL_INPUT:
        return nth("Front bumper\0Rear bumper\0\0\0\0\0\0\0"
                   "Game pad \"A\" button\0Game pad \"B\" button\0Game pad \"X\" button\0"
                   "Game pad \"Y\" button\0Game pad \"Back\" button\0Game pad \"Start\" button\0"
                   "Game pad \"D\" down button\0Game pad \"D\" left button\0"
                   "Game pad \"D\" right button\0Game pad \"D\" up button\0"
                   "Game pad \"LJ\" click\0Game pad \"RJ\" click\0"
                   "Game pad \"LB\" button\0Game pad \"RB\" button",
                   ROBUROC4_DI_COUNT, index);
    case ROBUROC4_IO_DIGITAL_OUTPUT:
        return nth("Watchdog\0\0\0\0\0\0\0", ROBUROC4_DO_COUNT, index);
    default:
        return NULL; /* the robot has no analog outputs */
    }
}

/* ---- the channels of a robot's card ---- */

/** How many channels of a type the card has, or an error. */
static roburoc4_result channel_count(const roburoc4_client *client, uint32_t io_type) {
    if (io_type > ROBUROC4_IO_DIGITAL_OUTPUT) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    if ((client->private_discovery.known & service_bit(ROBUROC4_SERVICE_IOCARD)) == 0) {
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    return client->private_values.io_counts[io_type];
}

/** A channel's place in the manual's table, or -1. */
static int32_t manual_place(uint32_t io_type, int32_t count, uint32_t index) {
    int32_t place = 0;
    while (place < count && roburoc4_table_index(io_type, count, place) != (int32_t)index) {
        place++;
    }
    return place < count && index < (uint32_t)count ? place : -1;
}

const char *roburoc4_client_channel_name(const roburoc4_client *client, uint32_t io_type,
                                         uint32_t index) {
    if (client == NULL) {
        return table_name(io_type, index);
    }
    const int32_t count = channel_count(client, io_type);
    int32_t place = count > 0 ? manual_place(io_type, count, index) : -1;
    for (uint32_t role = 0; count > 0 && role < ROBUROC4_ROLE_COUNT; role++) {
        const int32_t found = roburoc4_client_role_index(client, role);
        if (role_type(role) != io_type || found < 0) {
            continue;
        }
        if ((uint32_t)found == index) {
            place = role_place(role);
        } else if (place == role_place(role)) {
            place = -1; /* the table's input for this place is elsewhere */
        }
    }
    return place < 0 ? NULL : table_name(io_type, (uint32_t)place);
}

/* An empty one for NULL. At most 64 KiB: without a limit, compilers call strlen, which a firmware
 * may not have. */
static piece piece_of(const char *text) {
    uint32_t length = 0;
    while (text != NULL && length < UINT16_MAX && text[length] != '\0') {
        length++;
    }
    return (piece){text, length};
}

/** Whether two texts have the same words, in any order. */
static bool same_words(piece a, piece b) {
    piece rest = a;
    for (piece found = roburoc4_next_word(&rest); found.length > 0;
         found = roburoc4_next_word(&rest)) {
        if (roburoc4_count_word(a, &found) != roburoc4_count_word(b, &found)) {
            return false;
        }
    }
    return roburoc4_count_word(a, NULL) == roburoc4_count_word(b, NULL);
}

/** A channel's own text, or else the manual's name for it. */
static const char *name_of(const roburoc4_client *client, uint32_t io_type, uint32_t index,
                           const char *const *texts, uint32_t text_count) {
    const char *own = index < text_count && texts != NULL ? texts[index] : NULL;
    return own != NULL && own[0] != '\0' ? own
                                         : roburoc4_client_channel_name(client, io_type, index);
}

/** The input with a role whose name in the manual this is, or -1. */
static int32_t find_by_role(const roburoc4_client *client, uint32_t io_type, const char *name) {
    for (uint32_t role = 0; role < ROBUROC4_ROLE_COUNT; role++) {
        const int32_t index = roburoc4_client_role_index(client, role);
        if (role_type(role) == io_type && index >= 0 &&
            same_words(piece_of(name), piece_of(table_name(io_type, (uint32_t)role_place(role))))) {
            return index;
        }
    }
    return -1;
}

roburoc4_result roburoc4_client_channel_find(const roburoc4_client *client, uint32_t io_type,
                                             const char *name, const char *const *texts,
                                             uint32_t text_count) {
    const int32_t count = channel_count(client, io_type);
    roburoc4_result found = ROBUROC4_ERR_INDEX;
    if (count < 0 || roburoc4_count_word(piece_of(name), NULL) == 0) {
        return count < 0 ? count : ROBUROC4_ERR_INDEX;
    }
    const int32_t by_role = find_by_role(client, io_type, name);
    if (by_role >= 0) {
        return by_role;
    }
    for (uint32_t index = 0; index < (uint32_t)count && index < ROBUROC4_MAX_DIGITAL_INPUTS;
         index++) {
        const char *own = name_of(client, io_type, index, texts, text_count);
        if (same_words(piece_of(name), piece_of(own))) {
            if (found >= 0) {
                return ROBUROC4_ERR_VALUE;
            }
            found = (roburoc4_result)index;
        }
    }
    return found;
}
