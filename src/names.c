/* SPDX-License-Identifier: MIT
 *
 * The manual's names and this library's words: numbers to text. Nothing else of the core uses this
 * file, so a linker leaves it out where nobody asks for a name.
 */
#include "roburoc4.h"

uint32_t roburoc4_version(void) {
    return ROBUROC4_VERSION;
}

uint32_t roburoc4_abi_version(void) {
    return ROBUROC4_ABI_VERSION;
}

/** Entry `index` of texts joined by NUL, which cost no pointer each; NULL beyond the last. */
static const char *nth(const char *joined, uint32_t count, uint32_t index) {
    if (index >= count) {
        return NULL;
    }
    while (index > 0) {
        index -= *joined++ == '\0';
    }
    return joined;
}

const char *roburoc4_result_text(roburoc4_result result) {
    static const char codec_and_client[] = "argument out of range\0"
                                           "buffer too small\0"
                                           "datagram shorter than its layout\0"
                                           "datagram of another kind\0"
                                           "impossible value in datagram\0"
                                           "the robot answered with an error\0"
                                           "struct size differs from the library's\0"
                                           "configuration value out of range\0"
                                           "client not started, or closing\0"
                                           "not known yet\0"
                                           "the robot has no such channel\0"
                                           "output 0 belongs to the robot\0"
                                           "NaN or infinity\0"
                                           "answer to no open request\0"
                                           "status not subscribed to\0"
                                           "status not newer than the last\0"
                                           "no answer in all tries";
    static const char motion[] = "disarmed: call arm\0"
                                 "not ready: wait for the robot\0"
                                 "no usable differential service\0"
                                 "the robot's speed limits are not usable\0"
                                 "no recent differential status\0"
                                 "no recent IO card status\0"
                                 "game pad input unknown: set its index or allow it\0"
                                 "game pad override: release [A]\0"
                                 "the robot is moving: wait until it stands\0"
                                 "another client commands the robot\0"
                                 "the robot fell silent\0"
                                 "the robot restarted\0"
                                 "the clock went back\0"
                                 "first drive(0, 0) or pause for a lease";
    static const char adapter[] = "the operating system refused\0"
                                  "host name has no address\0"
                                  "already closed";
    const char *text = NULL;
    if (result >= 0) {
        return "ok";
    }
    const uint32_t code = 0U - (uint32_t)result;
    if (code < 20) {
        text = nth(codec_and_client, 17, code - 1);
    } else if (code < 40) {
        text = nth(motion, 14, code - 20);
    } else {
        text = nth(adapter, 3, code - 40);
    }
    return text != NULL ? text : "unknown error";
}

const char *roburoc4_service_name(uint32_t service) {
    return nth("Directory\0Notification\0IOCard\0Telemeter\0Battery\0Localization\0Differential",
               ROBUROC4_SERVICE_COUNT, service);
}

const char *roburoc4_battery_state_name(uint32_t state) {
    return nth("Charging\0Charged\0Ok\0Critical", 4, state);
}

const char *roburoc4_state_name(uint32_t state) {
    return nth("idle\0connecting\0discovering\0subscribing\0ready\0lost\0closing", 7, state);
}

const char *roburoc4_error_name(uint32_t error) {
    const char *name = nth("no error\0no such service\0action not supported by the service\0"
                           "no such action\0wrong length\0wrong value",
                           6, error);
    if (name == NULL) {
        name = error >= ROBUROC4_ERROR_SERVICE ? "error of the service" : "unknown error";
    }
    return name;
}

const char *roburoc4_channel_name(uint32_t io_type, uint32_t index) {
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
        return NULL; /* analog outputs: the robot has none */
    }
}
