/* SPDX-License-Identifier: MIT
 *
 * roburoc4.h - the RobuROC4 robot's UDP protocol: codec and client.
 *
 * THE MODEL
 *
 * The robot is a UDP server (192.168.0.2:60000 by default) of seven services. A client sends
 * requests (read properties, subscribe ...), each answered once; the robot sends the statuses that
 * were subscribed to; a client sends commands, which nobody answers. The robot stops by itself
 * when no speed command came for 1 s, and holding [A] on its game pad overrides every client.
 *
 * This header has two tiers, both without input/output, clock, allocation, callback or thread:
 *
 *   Codec   bytes <-> values for every telegram of the manual, both directions. Pure functions.
 *   Client  a state machine that finds the services, subscribes, keeps the link, and is the only
 *           place that lets a speed out. You move the datagrams and tell it the time:
 *
 *               roburoc4_client_receive()        a datagram came in
 *               roburoc4_client_poll_transmit()  the next datagram to send, or 0
 *               roburoc4_client_next_deadline()  when to poll again if nothing comes in
 *               roburoc4_client_take_events()    what changed since the last call
 *
 *           roburoc4_udp.h does this over a socket; examples/bare_loop.c does it by hand.
 *
 * CONVENTIONS
 *
 *   Units       SI: metres, radians, seconds; times in microseconds (_us) or milliseconds (_ms);
 *               robot time in cycles of 10 ms since power on (_cycles).
 *   Frame       X forward, Y left, Z up, angles counter-clockwise (manual 2.3).
 *   Time        now_us is any clock that never goes back and counts sleep. A clock that jumps all
 *               the same never makes the client send a motion command.
 *   Results     int32_t: 0 or more is success (often a length), less is one of ROBUROC4_ERR_*.
 *   Threads     there is no global: one client is used by one thread at a time, different clients
 *               by any threads. Codec functions can be called from anywhere.
 *   Lifetime    nothing is kept of what you pass in: neither configuration nor datagram. Views
 *               (lists, texts) point into the datagram that you decoded and live as long as it.
 *   NULL        a pointer must be valid unless its comment says that it may be NULL.
 *
 * Section numbers are those of the RobuROC4 user manual, revision A.
 */
#ifndef ROBUROC4_H
#define ROBUROC4_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifndef ROBUROC4_API
#define ROBUROC4_API
#endif

/* ------------------------------------------------------------------------------- versions --- */

/** Version of this header. Compare with roburoc4_version() of the library that runs. */
#define ROBUROC4_VERSION_MAJOR 0
#define ROBUROC4_VERSION_MINOR 1
#define ROBUROC4_VERSION_PATCH 0
#define ROBUROC4_VERSION 0x000100
/** Raised whenever a struct or a function changes in a way that old binaries would notice. */
#define ROBUROC4_ABI_VERSION 0
/** Revision of the manual that the codec follows: 1 is revision A of 2011-03-09. */
#define ROBUROC4_PROTOCOL_REVISION 1

/** The library's version as 0xMMmmpp. */
ROBUROC4_API uint32_t roburoc4_version(void);
/** The library's ABI version, ROBUROC4_ABI_VERSION of the header it was built with. */
ROBUROC4_API uint32_t roburoc4_abi_version(void);

/* -------------------------------------------------------------------------------- results --- */

/** 0 or more: success, often a length. Negative: one of ROBUROC4_ERR_*. */
typedef int32_t roburoc4_result;

#define ROBUROC4_OK 0
/* of the codec */
#define ROBUROC4_ERR_ARGUMENT (-1) /* an argument is outside its documented range */
#define ROBUROC4_ERR_BUFFER (-2)   /* the buffer is too small; nothing was written */
#define ROBUROC4_ERR_SHORT (-3)    /* the datagram is shorter than its layout */
#define ROBUROC4_ERR_KIND (-4)     /* the datagram is of another kind than asked for */
#define ROBUROC4_ERR_VALUE (-5)    /* a field of the datagram has an impossible value */
#define ROBUROC4_ERR_ROBOT (-6)    /* the answer carries one of the robot's error codes */
/* of the client */
#define ROBUROC4_ERR_SIZE (-7)          /* a struct's size is not the library's */
#define ROBUROC4_ERR_CONFIG (-8)        /* a configuration value; see roburoc4_config_error() */
#define ROBUROC4_ERR_STATE (-9)         /* the client was not started, or is closing */
#define ROBUROC4_ERR_UNKNOWN (-10)      /* not known yet: the robot has not said it */
#define ROBUROC4_ERR_INDEX (-11)        /* the robot has no such channel */
#define ROBUROC4_ERR_RESERVED (-12)     /* digital output 0 is the robot's own watchdog */
#define ROBUROC4_ERR_NOT_FINITE (-13)   /* NaN or infinity */
#define ROBUROC4_ERR_UNMATCHED (-14)    /* an answer to no open request: late, duplicate, foreign */
#define ROBUROC4_ERR_UNSUBSCRIBED (-15) /* a status of a service that was not subscribed to */
#define ROBUROC4_ERR_OLD (-16)          /* a status not newer than the last of its service */
#define ROBUROC4_ERR_TIMEOUT (-17)      /* a request was not answered in all its tries */
/* why a client is not armed, or arm() or drive() was refused */
#define ROBUROC4_ERR_DISARMED (-20)           /* never armed, or disarm() was called */
#define ROBUROC4_ERR_NOT_READY (-21)          /* the client is not in ROBUROC4_STATE_READY */
#define ROBUROC4_ERR_NO_DIFFERENTIAL (-22)    /* no differential service with full properties */
#define ROBUROC4_ERR_LIMITS (-23)             /* the robot's speed limits are not usable */
#define ROBUROC4_ERR_STALE_DIFFERENTIAL (-24) /* no recent differential status */
#define ROBUROC4_ERR_STALE_IOCARD (-25)       /* no recent IO card status */
#define ROBUROC4_ERR_OVERRIDE_UNKNOWN (-26)   /* the input of game pad [A] is not known */
#define ROBUROC4_ERR_OVERRIDE (-27)           /* somebody holds [A] on the game pad */
#define ROBUROC4_ERR_MOVING (-28)             /* the robot has a speed that was not asked for */
#define ROBUROC4_ERR_FOREIGN (-29)            /* another client commands the robot */
#define ROBUROC4_ERR_LOST (-30)               /* the robot fell silent */
#define ROBUROC4_ERR_REBOOT (-31)             /* the robot restarted */
#define ROBUROC4_ERR_CLOCK (-32)              /* the clock went back */
#define ROBUROC4_ERR_NOT_NEUTRAL (-33) /* resuming: first drive(0, 0) or a pause of a lease */
/* of the UDP adapter and the pump (roburoc4_udp.h, roburoc4_pump.h) */
#define ROBUROC4_ERR_SYSTEM (-40)  /* the operating system refused; errno says why */
#define ROBUROC4_ERR_RESOLVE (-41) /* a host name has no address */
#define ROBUROC4_ERR_CLOSED (-42)  /* already closed */

/** One English sentence for a result, without a full stop: "ok" for 0 and more, "unknown error"
 *  for a value that is none. Lives as long as the program. */
ROBUROC4_API const char *roburoc4_result_text(roburoc4_result result);

/* ---------------------------------------------------- the manual's enumerations and tables --- */

/** Services, named by their ids on a RobuROC4 (4.2.1). Other robots number all but the first two
 *  differently, so the client takes a service's id from the directory; in its functions these
 *  constants say which service is meant, whatever its id. */
#define ROBUROC4_SERVICE_DIRECTORY 0
#define ROBUROC4_SERVICE_NOTIFICATION 1
#define ROBUROC4_SERVICE_IOCARD 2
#define ROBUROC4_SERVICE_TELEMETER 3
#define ROBUROC4_SERVICE_BATTERY 4
#define ROBUROC4_SERVICE_LOCALIZATION 5
#define ROBUROC4_SERVICE_DIFFERENTIAL 6
#define ROBUROC4_SERVICE_COUNT 7

/** Type codes seen in directories of robots of this protocol family. A RobuROC4's own are not
 *  published, so an unknown code is no error. */
#define ROBUROC4_TYPE_DIAGNOSTIC 0x0002
#define ROBUROC4_TYPE_IOCARD 0x4001
#define ROBUROC4_TYPE_LASER 0x4004
#define ROBUROC4_TYPE_DIFFERENTIAL 0x4005
#define ROBUROC4_TYPE_TELEMETER 0x4008
#define ROBUROC4_TYPE_DRIVE 0x4009
#define ROBUROC4_TYPE_LOCALIZATION 0x8002

/** First byte of a telegram: a request id (1 to 254, echoed in the answer) or one of these. */
#define ROBUROC4_HEADER_ERROR 0x00  /* an error telegram */
#define ROBUROC4_HEADER_MANUAL 0x01 /* the id that the manual prints in every request */
#define ROBUROC4_HEADER_STATUS 0xFF /* a status, or a command */

/** Actions of a request (4.2.2 to 4.2.6). UPDATE, DELETE and SUBMIT are known from other robots. */
#define ROBUROC4_ACTION_GET 0
#define ROBUROC4_ACTION_QUERY 1
#define ROBUROC4_ACTION_REPLACE 2
#define ROBUROC4_ACTION_UPDATE 3
#define ROBUROC4_ACTION_INSERT 4
#define ROBUROC4_ACTION_DELETE 5
#define ROBUROC4_ACTION_SUBMIT 6

/** Error byte of an answer (4.2.2.2). The manual says only "other value: error"; the values are
 *  known from other robots of the family. 0x10 and more are the service's own. */
#define ROBUROC4_ERROR_NONE 0
#define ROBUROC4_ERROR_TARGET 1      /* no such service */
#define ROBUROC4_ERROR_UNSUPPORTED 2 /* the service does not offer the action */
#define ROBUROC4_ERROR_ACTION 3      /* no such action */
#define ROBUROC4_ERROR_LENGTH 4      /* the request has a wrong length */
#define ROBUROC4_ERROR_DATA 5        /* the request has a wrong value */
#define ROBUROC4_ERROR_SERVICE 0x10  /* and above: the service's own */

/** Battery states (4.2.4.6). */
#define ROBUROC4_BATTERY_CHARGING 0
#define ROBUROC4_BATTERY_CHARGED 1
#define ROBUROC4_BATTERY_OK 2
#define ROBUROC4_BATTERY_CRITICAL 3

/** Bits of the localization state (4.2.4.7). */
#define ROBUROC4_LOCALIZATION_INVALID 0x01
#define ROBUROC4_LOCALIZATION_METRIC 0x02
#define ROBUROC4_LOCALIZATION_DECIMETRIC 0x04
#define ROBUROC4_LOCALIZATION_CENTIMETRIC 0x08
#define ROBUROC4_LOCALIZATION_PROPRIOCEPTIVE 0x10
#define ROBUROC4_LOCALIZATION_EXTEROCEPTIVE 0x20
#define ROBUROC4_LOCALIZATION_ERROR 0x40

/** Element types of the IO card (4.2.3.3). */
#define ROBUROC4_IO_ANALOG_INPUT 0
#define ROBUROC4_IO_ANALOG_OUTPUT 1
#define ROBUROC4_IO_DIGITAL_INPUT 2
#define ROBUROC4_IO_DIGITAL_OUTPUT 3

/** Channels of the IO card by their index on the wire (5.5.1). The manual's tables skip the number
 *  02, so an index above 1 is the table's number less one. A robot may differ: prefer the texts it
 *  gives, as the client does. */
#define ROBUROC4_AI_FRONT_TELEMETER_V 0
#define ROBUROC4_AI_REAR_TELEMETER_V 1
#define ROBUROC4_AI_BATTERY_V 2
#define ROBUROC4_AI_PAD_LJ_X 3 /* left stick, left/right, -1 to 1 */
#define ROBUROC4_AI_PAD_LJ_Y 4 /* left stick, down/up */
#define ROBUROC4_AI_PAD_RJ_X 5
#define ROBUROC4_AI_PAD_RJ_Y 6
#define ROBUROC4_AI_PAD_LT 7
#define ROBUROC4_AI_PAD_RT 8
#define ROBUROC4_AI_COUNT 9
#define ROBUROC4_AO_COUNT 0

#define ROBUROC4_DI_FRONT_BUMPER 0
#define ROBUROC4_DI_REAR_BUMPER 1
/* 2 to 7 exist but are not used */
#define ROBUROC4_DI_PAD_A 8
#define ROBUROC4_DI_PAD_B 9
#define ROBUROC4_DI_PAD_X 10
#define ROBUROC4_DI_PAD_Y 11
#define ROBUROC4_DI_PAD_BACK 12
#define ROBUROC4_DI_PAD_START 13
#define ROBUROC4_DI_PAD_D_DOWN 14
#define ROBUROC4_DI_PAD_D_LEFT 15
#define ROBUROC4_DI_PAD_D_RIGHT 16
#define ROBUROC4_DI_PAD_D_UP 17
#define ROBUROC4_DI_PAD_LJ_CLICK 18
#define ROBUROC4_DI_PAD_RJ_CLICK 19
#define ROBUROC4_DI_PAD_LB 20
#define ROBUROC4_DI_PAD_RB 21
#define ROBUROC4_DI_COUNT 22

#define ROBUROC4_DO_WATCHDOG 0 /* used by the robot's low level, never by a client */
#define ROBUROC4_DO_COUNT 8

/** Telemeters in the order of their properties and statuses (5.5.2). */
#define ROBUROC4_TELEMETER_FRONT 0
#define ROBUROC4_TELEMETER_REAR 1
#define ROBUROC4_TELEMETER_COUNT 2

/** The manual's name of a service (4.2.1), "IOCard" for 2; NULL for a number that is none. */
ROBUROC4_API const char *roburoc4_service_name(uint32_t service);
/** The manual's name of a battery state (4.2.4.6); NULL for a value that is none. */
ROBUROC4_API const char *roburoc4_battery_state_name(uint32_t state);
/** The meaning of a robot's error byte; "error of the service" from 0x10, never NULL. */
ROBUROC4_API const char *roburoc4_error_name(uint32_t error);
/** The manual's name (5.5.1) of an IO channel: io_type is ROBUROC4_IO_*, index that on the wire.
 *  NULL where the manual has no such channel, "" where it "exists but is not used". */
ROBUROC4_API const char *roburoc4_channel_name(uint32_t io_type, uint32_t index);

/** The robot's address out of the box (4.2.1). */
#define ROBUROC4_DEFAULT_HOST "192.168.0.2"
#define ROBUROC4_DEFAULT_PORT 60000
/** One low level cycle of the robot in microseconds (4.2.4). */
#define ROBUROC4_CYCLE_US 10000

/* ---------------------------------------------------------------------------------- codec --- */
/*
 * Decoders look at `size` bytes, write all of *out or (on an error) nothing, and return the number
 * of surplus bytes after the layout (0 for the manual's length) or
 *     ROBUROC4_ERR_SHORT   shorter than the layout,
 *     ROBUROC4_ERR_KIND    another header or action,
 *     ROBUROC4_ERR_VALUE   an impossible value (a negative count),
 *     ROBUROC4_ERR_ROBOT   (answers) a non-zero error byte: read it with roburoc4_decode_answer().
 * They do not compare the service's id: it is in *out. Floats are passed on as they are, NaN too.
 *
 * Encoders write one telegram and return its length, or ROBUROC4_ERR_BUFFER (nothing written), or
 * ROBUROC4_ERR_ARGUMENT for a value that cannot be sent.
 */

/** Any client-to-robot request with the fields of its action (others are 0). */
typedef struct roburoc4_request {
    uint8_t id;                 /* 1 to 254 */
    uint8_t action;             /* ROBUROC4_ACTION_* */
    uint16_t service;           /* target */
    uint16_t subject;           /* INSERT, DELETE: the service whose statuses are meant */
    uint8_t period_cycles;      /* INSERT: period in cycles of 10 ms */
    uint8_t io_type;            /* QUERY of the IO card: ROBUROC4_IO_* */
    int32_t index;              /* QUERY: element of the directory (0 to 65535) or IO channel */
    uint64_t timestamp;         /* REPLACE: "not used but mandatory" (4.2.6.5) */
    double x_m, y_m, theta_rad; /* REPLACE */
} roburoc4_request;

/** GET the properties of a service (4.2.2.1), 4 bytes. */
ROBUROC4_API roburoc4_result roburoc4_encode_get(uint8_t *buffer, size_t capacity, uint8_t id,
                                                 uint16_t service);
/** QUERY the text of the directory's element `index` (4.2.3.1), 6 bytes. */
ROBUROC4_API roburoc4_result roburoc4_encode_query_directory(uint8_t *buffer, size_t capacity,
                                                             uint8_t id, uint16_t index);
/** QUERY the text of an IO channel (4.2.3.3), 9 bytes. */
ROBUROC4_API roburoc4_result roburoc4_encode_query_iocard(uint8_t *buffer, size_t capacity,
                                                          uint8_t id, uint16_t service,
                                                          uint8_t io_type, int32_t index);
/** INSERT: subscribe to the statuses of `subject` (4.2.4.1), 7 bytes. period_cycles is 1 to 255;
 *  0 has no defined meaning and is refused. */
ROBUROC4_API roburoc4_result roburoc4_encode_insert(uint8_t *buffer, size_t capacity, uint8_t id,
                                                    uint16_t subject, uint8_t period_cycles);
/** DELETE: end the subscription of `subject`, 6 bytes. Known from other robots of the family. */
ROBUROC4_API roburoc4_result roburoc4_encode_delete(uint8_t *buffer, size_t capacity, uint8_t id,
                                                    uint16_t subject);
/** REPLACE the localization (4.2.6.5), 36 bytes. */
ROBUROC4_API roburoc4_result roburoc4_encode_replace_localization(uint8_t *buffer, size_t capacity,
                                                                  uint8_t id, uint16_t service,
                                                                  uint64_t timestamp, double x_m,
                                                                  double y_m, double theta_rad);
/** Any request, as a robot reads it. A QUERY is the directory's where service is 0, else an IO
 *  card's. Actions without a layout in the manual are given with header fields only. */
ROBUROC4_API roburoc4_result roburoc4_decode_request(const uint8_t *data, size_t size,
                                                     roburoc4_request *out);

/** The part that all answers share: `id action target error`, then a payload. */
typedef struct roburoc4_answer {
    uint8_t id; /* echo of the request's; 0 for an error telegram */
    uint8_t action;
    uint8_t error; /* ROBUROC4_ERROR_* */
    uint8_t reserved;
    uint16_t service;
    uint16_t reserved2;
    const uint8_t *payload; /* what follows the error byte: a view on the datagram */
    size_t payload_size;
} roburoc4_answer;

/** The head of any answer, also of one with an error or with header 0x00 (5 bytes or more).
 *  Returns 0, or ROBUROC4_ERR_SHORT, or ROBUROC4_ERR_KIND for header 0xFF. */
ROBUROC4_API roburoc4_result roburoc4_decode_answer(const uint8_t *data, size_t size,
                                                    roburoc4_answer *out);
/** The plain answer (INSERT, DELETE, REPLACE; any error), 5 bytes. With id 0 it is an error
 *  telegram. */
ROBUROC4_API roburoc4_result roburoc4_encode_answer(uint8_t *buffer, size_t capacity, uint8_t id,
                                                    uint8_t action, uint16_t service,
                                                    uint8_t error);

/** Directory properties (4.2.2.2): a view on the datagram. */
typedef struct roburoc4_directory {
    const uint8_t *entries;
    uint32_t count;
    uint16_t service;
    uint16_t reserved;
} roburoc4_directory;
typedef struct roburoc4_directory_entry {
    uint16_t type; /* ROBUROC4_TYPE_* or unknown */
    uint16_t id;
} roburoc4_directory_entry;
ROBUROC4_API roburoc4_result roburoc4_decode_directory(const uint8_t *data, size_t size,
                                                       roburoc4_directory *out);
/** Entry `index`, which is less than count; else ROBUROC4_ERR_INDEX. */
ROBUROC4_API roburoc4_result roburoc4_directory_at(const roburoc4_directory *directory,
                                                   uint32_t index, roburoc4_directory_entry *out);
ROBUROC4_API roburoc4_result roburoc4_encode_directory(uint8_t *buffer, size_t capacity, uint8_t id,
                                                       uint16_t service,
                                                       const roburoc4_directory_entry *entries,
                                                       size_t count);

/** Notification properties (4.2.2.3), who is subscribed: a view on the datagram. */
typedef struct roburoc4_notification {
    const uint8_t *entries;
    uint32_t count;
    uint16_t service;
    uint16_t reserved;
} roburoc4_notification;
typedef struct roburoc4_subscription {
    uint16_t service;
    uint8_t period_cycles;
    uint8_t reserved;
} roburoc4_subscription;
ROBUROC4_API roburoc4_result roburoc4_decode_notification(const uint8_t *data, size_t size,
                                                          roburoc4_notification *out);
/** Subscription `index`, which is less than count; else ROBUROC4_ERR_INDEX. */
ROBUROC4_API roburoc4_result roburoc4_notification_at(const roburoc4_notification *notification,
                                                      uint32_t index, roburoc4_subscription *out);
ROBUROC4_API roburoc4_result roburoc4_encode_notification(uint8_t *buffer, size_t capacity,
                                                          uint8_t id, uint16_t service,
                                                          const roburoc4_subscription *entries,
                                                          size_t count);

/** IO card properties (4.2.2.4): how many channels of each type, 0 or more. */
typedef struct roburoc4_iocard_properties {
    int32_t analog_inputs;
    int32_t analog_outputs;
    int32_t digital_inputs;
    int32_t digital_outputs;
    uint16_t service;
    uint16_t reserved;
} roburoc4_iocard_properties;
ROBUROC4_API roburoc4_result roburoc4_decode_iocard_properties(const uint8_t *data, size_t size,
                                                               roburoc4_iocard_properties *out);
ROBUROC4_API roburoc4_result roburoc4_encode_iocard_properties(
    uint8_t *buffer, size_t capacity, uint8_t id, const roburoc4_iocard_properties *properties);
/** Blocks of 8 that hold `channels` digital channels: 0 for 0, else (channels - 1) / 8 + 1. */
ROBUROC4_API uint32_t roburoc4_digital_blocks(uint32_t channels);

/** Telemeter properties (4.2.2.5): a view on the datagram. */
typedef struct roburoc4_telemeter_list {
    const uint8_t *entries;
    uint32_t count;
    uint16_t service;
    uint16_t reserved;
} roburoc4_telemeter_list;
typedef struct roburoc4_telemeter {
    float x_m, y_m, theta_rad;            /* mounting pose in the robot's frame */
    float field_of_view_rad;              /* full opening angle */
    float min_distance_m, max_distance_m; /* range that it can measure */
    float distance_m;                     /* measured when the properties were read */
} roburoc4_telemeter;
ROBUROC4_API roburoc4_result roburoc4_decode_telemeter_properties(const uint8_t *data, size_t size,
                                                                  roburoc4_telemeter_list *out);
/** Telemeter `index`, which is less than count; else ROBUROC4_ERR_INDEX. */
ROBUROC4_API roburoc4_result roburoc4_telemeter_at(const roburoc4_telemeter_list *list,
                                                   uint32_t index, roburoc4_telemeter *out);
ROBUROC4_API roburoc4_result
roburoc4_encode_telemeter_properties(uint8_t *buffer, size_t capacity, uint8_t id, uint16_t service,
                                     const roburoc4_telemeter *telemeters, size_t count);

/** Battery properties (4.2.2.6). */
typedef struct roburoc4_battery_properties {
    float nominal_voltage_v;
    float capacity_ah;       /* when fully charged */
    uint8_t minimum_percent; /* below it the battery cannot operate */
    uint8_t reserved;
    uint16_t service;
} roburoc4_battery_properties;
ROBUROC4_API roburoc4_result roburoc4_decode_battery_properties(const uint8_t *data, size_t size,
                                                                roburoc4_battery_properties *out);
ROBUROC4_API roburoc4_result roburoc4_encode_battery_properties(
    uint8_t *buffer, size_t capacity, uint8_t id, const roburoc4_battery_properties *properties);

/** Localization properties (4.2.2.7): the pose at power on, in the main frame. */
typedef struct roburoc4_localization_properties {
    double x_m, y_m, theta_rad;
    uint32_t flags; /* ROBUROC4_LOCALIZATION_* */
    uint16_t service;
    uint16_t reserved;
} roburoc4_localization_properties;
ROBUROC4_API roburoc4_result roburoc4_decode_localization_properties(
    const uint8_t *data, size_t size, roburoc4_localization_properties *out);
ROBUROC4_API roburoc4_result
roburoc4_encode_localization_properties(uint8_t *buffer, size_t capacity, uint8_t id,
                                        const roburoc4_localization_properties *properties);

/** Differential properties (4.2.2.8). */
typedef struct roburoc4_differential_properties {
    float target_linear_m_s, target_angular_rad_s; /* when the properties were read */
    float current_linear_m_s, current_angular_rad_s;
    float max_linear_m_s, min_linear_m_s;
    float max_angular_rad_s, min_angular_rad_s;
    float max_linear_m_s2, min_linear_m_s2;
    float max_angular_rad_s2, min_angular_rad_s2;
    float width_m; /* between the left and right wheels */
    uint16_t service;
    uint16_t reserved;
} roburoc4_differential_properties;
ROBUROC4_API roburoc4_result roburoc4_decode_differential_properties(
    const uint8_t *data, size_t size, roburoc4_differential_properties *out);
ROBUROC4_API roburoc4_result
roburoc4_encode_differential_properties(uint8_t *buffer, size_t capacity, uint8_t id,
                                        const roburoc4_differential_properties *properties);

/** The text of a QUERY's answer (4.2.3): a view on the datagram, not NUL-terminated, of unknown
 *  character set, possibly empty. */
typedef struct roburoc4_text {
    const uint8_t *text;
    uint32_t length;
    uint16_t service;
    uint16_t reserved;
} roburoc4_text;
ROBUROC4_API roburoc4_result roburoc4_decode_text(const uint8_t *data, size_t size,
                                                  roburoc4_text *out);
ROBUROC4_API roburoc4_result roburoc4_encode_text(uint8_t *buffer, size_t capacity, uint8_t id,
                                                  uint16_t service, const char *text,
                                                  size_t length);

/** The head of a status (`0xFF service timestamp`), or of a command (`0xFF service`). */
typedef struct roburoc4_status_header {
    uint64_t robot_cycles; /* 0 where the telegram has no timestamp */
    uint16_t service;
    uint16_t reserved[3];
} roburoc4_status_header;
/** Of a status: 11 bytes or more; the rest counts as surplus. */
ROBUROC4_API roburoc4_result roburoc4_decode_status_header(const uint8_t *data, size_t size,
                                                           roburoc4_status_header *out);
/** Of a command, as a robot reads it: 3 bytes or more; the rest counts as surplus. */
ROBUROC4_API roburoc4_result roburoc4_decode_command_header(const uint8_t *data, size_t size,
                                                            roburoc4_status_header *out);

/** IO card status (4.2.4.4): a view on the datagram. */
typedef struct roburoc4_iocard_status {
    uint64_t robot_cycles;
    const uint8_t *analog;
    const uint8_t *digital;
    uint32_t analog_inputs, digital_inputs;
    uint16_t service;
    uint16_t reserved[3];
} roburoc4_iocard_status;
/** The counts are those of the card's properties. One block too many, or any longer tail, is
 *  surplus. */
ROBUROC4_API roburoc4_result roburoc4_decode_iocard_status(const uint8_t *data, size_t size,
                                                           uint32_t analog_inputs,
                                                           uint32_t digital_inputs,
                                                           roburoc4_iocard_status *out);
/** Analog input `index`, generally in volts; ROBUROC4_ERR_INDEX beyond the last. */
ROBUROC4_API roburoc4_result roburoc4_analog_input_at(const roburoc4_iocard_status *status,
                                                      uint32_t index, float *out);
/** Digital input `index`: 1 or 0; ROBUROC4_ERR_INDEX beyond the last. */
ROBUROC4_API roburoc4_result roburoc4_digital_input_at(const roburoc4_iocard_status *status,
                                                       uint32_t index);
/** The first analog inputs at once, at most `capacity` of them into `out`; how many were copied. */
ROBUROC4_API roburoc4_result roburoc4_analog_inputs(const roburoc4_iocard_status *status,
                                                    float *out, uint32_t capacity);
/** The first 64 digital inputs at once: bit i is input i, 0 where there is no such input. */
ROBUROC4_API uint64_t roburoc4_digital_inputs(const roburoc4_iocard_status *status);
/** digital: roburoc4_digital_blocks(digital_inputs) bytes; channel 8 k + b is bit b of byte k. */
ROBUROC4_API roburoc4_result roburoc4_encode_iocard_status(
    uint8_t *buffer, size_t capacity, uint16_t service, uint64_t robot_cycles, const float *analog,
    size_t analog_inputs, const uint8_t *digital, size_t digital_inputs);

/** Telemeter status (4.2.4.5): a view on the datagram. */
typedef struct roburoc4_telemeter_status {
    uint64_t robot_cycles;
    const uint8_t *distances;
    uint32_t count;
    uint16_t service;
    uint16_t reserved;
} roburoc4_telemeter_status;
ROBUROC4_API roburoc4_result roburoc4_decode_telemeter_status(const uint8_t *data, size_t size,
                                                              roburoc4_telemeter_status *out);
/** Distance `index` in metres; ROBUROC4_ERR_INDEX beyond the last. */
ROBUROC4_API roburoc4_result roburoc4_distance_at(const roburoc4_telemeter_status *status,
                                                  uint32_t index, float *out);
/** The first distances at once, in metres, at most `capacity` into `out`; how many were copied. */
ROBUROC4_API roburoc4_result roburoc4_telemeter_distances(const roburoc4_telemeter_status *status,
                                                          float *out, uint32_t capacity);
ROBUROC4_API roburoc4_result roburoc4_encode_telemeter_status(uint8_t *buffer, size_t capacity,
                                                              uint16_t service,
                                                              uint64_t robot_cycles,
                                                              const float *distances_m,
                                                              size_t count);

/** Battery status (4.2.4.6). */
typedef struct roburoc4_battery_status {
    uint64_t robot_cycles;
    uint8_t state;             /* ROBUROC4_BATTERY_* */
    uint8_t remaining_percent; /* 0 to 100 */
    uint16_t service;
    uint32_t reserved;
} roburoc4_battery_status;
ROBUROC4_API roburoc4_result roburoc4_decode_battery_status(const uint8_t *data, size_t size,
                                                            roburoc4_battery_status *out);
ROBUROC4_API roburoc4_result roburoc4_encode_battery_status(uint8_t *buffer, size_t capacity,
                                                            const roburoc4_battery_status *status);

/** Localization status (4.2.4.7): odometry, "highly inaccurate, especially when turning". */
typedef struct roburoc4_localization_status {
    uint64_t robot_cycles;
    double x_m, y_m, theta_rad; /* in the main frame */
    uint32_t flags;             /* ROBUROC4_LOCALIZATION_* */
    uint16_t service;
    uint16_t reserved;
} roburoc4_localization_status;
ROBUROC4_API roburoc4_result roburoc4_decode_localization_status(const uint8_t *data, size_t size,
                                                                 roburoc4_localization_status *out);
ROBUROC4_API roburoc4_result roburoc4_encode_localization_status(
    uint8_t *buffer, size_t capacity, const roburoc4_localization_status *status);

/** Differential status (4.2.4.8). */
typedef struct roburoc4_differential_status {
    uint64_t robot_cycles;
    float target_linear_m_s, current_linear_m_s;
    float target_angular_rad_s, current_angular_rad_s;
    uint16_t service;
    uint16_t reserved[3];
} roburoc4_differential_status;
ROBUROC4_API roburoc4_result roburoc4_decode_differential_status(const uint8_t *data, size_t size,
                                                                 roburoc4_differential_status *out);
ROBUROC4_API roburoc4_result roburoc4_encode_differential_status(
    uint8_t *buffer, size_t capacity, const roburoc4_differential_status *status);

/** Differential command (4.2.5.6): target speeds. The codec sends what it is given, also NaN: to
 *  drive a robot use roburoc4_client_drive(), which does not. */
typedef struct roburoc4_differential_command {
    float linear_m_s;
    float angular_rad_s;
    uint16_t service;
    uint16_t reserved;
} roburoc4_differential_command;
ROBUROC4_API roburoc4_result roburoc4_decode_differential_command(
    const uint8_t *data, size_t size, roburoc4_differential_command *out);
ROBUROC4_API roburoc4_result roburoc4_encode_differential_command(uint8_t *buffer, size_t capacity,
                                                                  uint16_t service,
                                                                  float linear_m_s,
                                                                  float angular_rad_s);

/** IO card command (4.2.5.2), all outputs at once: a view on the datagram. */
typedef struct roburoc4_iocard_command {
    const uint8_t *analog;
    const uint8_t *digital;
    uint32_t analog_outputs, digital_outputs;
    uint16_t service;
    uint16_t reserved[3];
} roburoc4_iocard_command;
/** The counts are those of the card's properties. */
ROBUROC4_API roburoc4_result roburoc4_decode_iocard_command(const uint8_t *data, size_t size,
                                                            uint32_t analog_outputs,
                                                            uint32_t digital_outputs,
                                                            roburoc4_iocard_command *out);
/** Analog output `index`, generally in volts; ROBUROC4_ERR_INDEX beyond the last. */
ROBUROC4_API roburoc4_result roburoc4_analog_output_at(const roburoc4_iocard_command *command,
                                                       uint32_t index, float *out);
/** Digital output `index`: 1 or 0; ROBUROC4_ERR_INDEX beyond the last. */
ROBUROC4_API roburoc4_result roburoc4_digital_output_at(const roburoc4_iocard_command *command,
                                                        uint32_t index);
/** digital: roburoc4_digital_blocks(digital_outputs) bytes; channel 8 k + b is bit b of byte k. */
ROBUROC4_API roburoc4_result roburoc4_encode_iocard_command(uint8_t *buffer, size_t capacity,
                                                            uint16_t service, const float *analog,
                                                            size_t analog_outputs,
                                                            const uint8_t *digital,
                                                            size_t digital_outputs);

/* --------------------------------------------------------------------------------- client --- */

/** Capacities of the client. What a robot has beyond them is reported
 *  (ROBUROC4_EVENT_CAPACITY) and not stored; the codec reads all of it. */
#define ROBUROC4_MAX_SERVICES 32
#define ROBUROC4_MAX_ANALOG_INPUTS 32
#define ROBUROC4_MAX_ANALOG_OUTPUTS 16
#define ROBUROC4_MAX_DIGITAL_INPUTS 64
#define ROBUROC4_MAX_DIGITAL_OUTPUTS 64
#define ROBUROC4_MAX_TELEMETERS 16
/** The longest datagram that a client sends: all outputs of an IO card. */
#define ROBUROC4_MAX_TRANSMIT 75

/** Life of a client. */
#define ROBUROC4_STATE_IDLE 0        /* before start(), after close() */
#define ROBUROC4_STATE_CONNECTING 1  /* asking for the directory */
#define ROBUROC4_STATE_DISCOVERING 2 /* reading texts of the directory, then properties */
#define ROBUROC4_STATE_SUBSCRIBING 3
#define ROBUROC4_STATE_READY 4
#define ROBUROC4_STATE_LOST 5    /* was connected, fell silent: asking for the directory again */
#define ROBUROC4_STATE_CLOSING 6 /* sending the last zero commands */

/** The state's name in lower case, "connecting"; NULL for a number that is none. */
ROBUROC4_API const char *roburoc4_state_name(uint32_t state);

/** Events: a set of bits, what changed since the last roburoc4_client_take_events(). */
#define ROBUROC4_EVENT_STATE 0x00000001             /* the state changed */
#define ROBUROC4_EVENT_READY 0x00000002             /* became ready */
#define ROBUROC4_EVENT_LOST 0x00000004              /* the robot fell silent */
#define ROBUROC4_EVENT_REBOOT 0x00000008            /* the robot restarted */
#define ROBUROC4_EVENT_PROPERTIES 0x00000010        /* properties of a service are new or changed */
#define ROBUROC4_EVENT_DESCRIPTION 0x00000020       /* a text came: roburoc4_client_description() */
#define ROBUROC4_EVENT_IOCARD 0x00000040            /* a new status of this service */
#define ROBUROC4_EVENT_TELEMETER 0x00000080         /* likewise */
#define ROBUROC4_EVENT_BATTERY 0x00000100           /* likewise */
#define ROBUROC4_EVENT_LOCALIZATION 0x00000200      /* likewise */
#define ROBUROC4_EVENT_DIFFERENTIAL 0x00000400      /* likewise */
#define ROBUROC4_EVENT_ARMED 0x00000800             /* became armed */
#define ROBUROC4_EVENT_DISARMED 0x00001000          /* lost its arming; see disarm_cause */
#define ROBUROC4_EVENT_LEASE_OVER 0x00002000        /* a drive lease ran out unrenewed */
#define ROBUROC4_EVENT_STOPPED 0x00004000           /* a zero train ended */
#define ROBUROC4_EVENT_OVERRIDE 0x00008000          /* game pad [A] was pressed or released */
#define ROBUROC4_EVENT_FOREIGN 0x00010000           /* another client commands, or no longer */
#define ROBUROC4_EVENT_INHIBITED 0x00020000         /* commanded but standing still, or no longer */
#define ROBUROC4_EVENT_BATTERY_LOW 0x00040000       /* remaining fell below minimum_percent */
#define ROBUROC4_EVENT_BATTERY_CRITICAL 0x00080000  /* the battery's state became Critical */
#define ROBUROC4_EVENT_RELOCALIZED 0x00100000       /* the robot took the new pose */
#define ROBUROC4_EVENT_RELOCALIZE_FAILED 0x00200000 /* it did not; see relocalize_result */
#define ROBUROC4_EVENT_SUBSCRIPTION_REFUSED 0x00400000
#define ROBUROC4_EVENT_FIXED_ID 0x00800000          /* the robot answers with 0x01 only */
#define ROBUROC4_EVENT_CLOCK 0x01000000             /* the clock went back */
#define ROBUROC4_EVENT_CAPACITY 0x02000000          /* the robot has more than the client stores */
#define ROBUROC4_EVENT_DESCRIPTIONS_DONE 0x04000000 /* every text was answered or given up */
#define ROBUROC4_EVENT_ROLE 0x08000000              /* an input of a role was found elsewhere */

/** What an IO input is for, whatever its index. */
#define ROBUROC4_ROLE_OVERRIDE 0     /* digital: game pad [A] */
#define ROBUROC4_ROLE_FRONT_BUMPER 1 /* digital */
#define ROBUROC4_ROLE_REAR_BUMPER 2  /* digital */
#define ROBUROC4_ROLE_BATTERY_V 3    /* analog, volts */
#define ROBUROC4_ROLE_COUNT 4

/** In role_index: find the input by the robot's text, else by the manual's table. */
#define ROBUROC4_INDEX_AUTO (-1)

/** Bits of roburoc4_config.resume. */
#define ROBUROC4_RESUME_OVERRIDE 0x01
#define ROBUROC4_RESUME_LOSS 0x02
#define ROBUROC4_RESUME_REBOOT 0x04

/** Bits of roburoc4_config.options. */
#define ROBUROC4_OPTION_TURN_KEEPING 0x01 /* slow down rather than turn less */
/* for a robot without the game pad's inputs; an IO card that is listed must still give its counts
 */
#define ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE 0x02
/* stay armed when somebody else commands; also for a robot that ramps the targets it reports */
#define ROBUROC4_OPTION_IGNORE_FOREIGN 0x04

/** Settings of a client. Fill it with roburoc4_config_init(), then change what you need. */
typedef struct roburoc4_config {
    uint32_t size; /* sizeof(roburoc4_config), set by roburoc4_config_init() */
    /** Bit k set: subscribe to service ROBUROC4_SERVICE_k. Default 0x7C, all five. */
    uint32_t subscriptions;
    /** Status periods by service (the first two are not used): a multiple of 10, 10 to 2550.
     *  Defaults: IO card 50, telemeter 100, battery 1000, localization 50, differential 50.
     *  Driving needs IO card and differential statuses more often than fresh_ms. */
    uint16_t period_ms[8];
    uint32_t first_retry_ms; /* a request is repeated after this, doubling to 1 s; 10 to 100;
                                default 100 */
    uint32_t lost_ms;        /* silence after which the robot is lost; 200 to 60000; default 1000;
                                never less than three of the shortest period */
    uint32_t fresh_ms;       /* age to which a status counts for driving; 50 to 1000; default 300 */
    uint32_t drive_period_ms;   /* repetition of drive commands; 10 to 500 and at most half of
                                   lease_ms; default 50 */
    uint32_t lease_ms;          /* life of a drive command; 20 to 1000; default 250 */
    uint32_t robot_watchdog_ms; /* the robot's own watchdog, bounds the zero train; 100 to 60000;
                                   default 1000 */
    float max_linear_m_s;       /* ceiling of speed; 0.001 to 20; default 2.6 */
    float max_angular_rad_s;    /* ceiling of turn rate; 0.001 to 50; default 6.5 */
    float scale_linear;         /* multiplies what drive() is given; 0.01 to 10; default 1 */
    float scale_angular;        /* likewise */
    uint32_t options;           /* ROBUROC4_OPTION_*; default 0 */
    uint32_t resume;            /* ROBUROC4_RESUME_*, after what the client arms itself again;
                                   default 0 */
    /** By ROBUROC4_ROLE_*: index of the input on the wire, or ROBUROC4_INDEX_AUTO (default);
     *  to 63 for the digital ones, 31 for the analog one. */
    int16_t role_index[4];
} roburoc4_config;

/** Set all defaults. Returns ROBUROC4_ERR_SIZE (nothing written) where `size`, which is
 *  sizeof(roburoc4_config), is not the library's. */
ROBUROC4_API roburoc4_result roburoc4_config_init(roburoc4_config *config, size_t size);
/** NULL if all values are in range, else the first bad value's name and range, for example
 *  "lease_ms: 20 to 1000". Lives as long as the program. */
ROBUROC4_API const char *roburoc4_config_error(const roburoc4_config *config);

/** Counters of what was dropped and why; they wrap around. */
#define ROBUROC4_COUNT_RECEIVED 0     /* datagrams given to receive() */
#define ROBUROC4_COUNT_SENT 1         /* datagrams given out */
#define ROBUROC4_COUNT_RETRIES 2      /* requests sent again */
#define ROBUROC4_COUNT_SHORT 3        /* dropped: shorter than their layout */
#define ROBUROC4_COUNT_MALFORMED 4    /* dropped: unknown kind or impossible value */
#define ROBUROC4_COUNT_UNMATCHED 5    /* dropped: answers to no open request */
#define ROBUROC4_COUNT_UNSUBSCRIBED 6 /* dropped: statuses nobody subscribed to */
#define ROBUROC4_COUNT_OLD 7          /* dropped: statuses not newer than the last */
#define ROBUROC4_COUNT_SURPLUS 8      /* used, with surplus bytes at their end */
#define ROBUROC4_COUNT_REFUSED 9      /* error answers */
#define ROBUROC4_COUNT_ABANDONED 10   /* requests given up after all their tries */
#define ROBUROC4_COUNT_LOST 11        /* times that the robot was lost */
#define ROBUROC4_COUNT_REBOOTS 12
#define ROBUROC4_COUNT_CLOCK_FAULTS 13
#define ROBUROC4_COUNTERS 14

/*
 * The client's memory: declare one (static, on the stack, inside your own struct), call
 * roburoc4_client_init() and use functions only. It may be moved or copied as plain bytes.
 * Everything named private may change with ROBUROC4_ABI_VERSION.
 */
typedef struct roburoc4_private_ask {
    uint16_t target, subject;
    uint8_t action, kind, detail, max_tries;
} roburoc4_private_ask;

typedef struct roburoc4_private_slot {
    roburoc4_private_ask ask;
    uint8_t open, id, tries, ones;
    uint32_t wait_us;
    uint64_t sent_us;
} roburoc4_private_slot;

typedef struct roburoc4_private_requests {
    uint8_t last_id, fixed_id, suspect, quiet, announce;
    uint8_t reserved[3];
    uint64_t quiet_us;
    roburoc4_private_slot slots[4];
} roburoc4_private_requests;

typedef struct roburoc4_private_service {
    uint8_t gap_count, asked_cycles, fresh, reserved;
    uint16_t period_cycles, gap_min;
    uint64_t robot_cycles, received_us, inserted_us, seen;
    uint32_t received, lost, late, duplicates;
    uint32_t recent_received, recent_lost;
    uint32_t transit_us, jitter_us;
} roburoc4_private_service;

typedef struct roburoc4_private_link {
    uint8_t back_count, resubscribed, mapped, reserved[5];
    uint64_t offset_since_us, newest_cycles, last_used_us;
    int64_t offset_us, offset_before_us;
    uint32_t round_trip_us, round_trip_min_us;
    roburoc4_private_service services[5];
} roburoc4_private_link;

typedef struct roburoc4_private_drive {
    uint8_t known, armed, leased, resuming, moving, spoke;
    uint8_t train, zeros, confirmed, stop_latched;
    uint8_t foreign_count, foreign, still, inhibited;
    uint8_t changed, reserved[7];
    uint16_t service;
    uint64_t granted_us, sent_us, train_us, quiet_us, still_us, envelope_us;
    uint32_t lease_us;
    int32_t disarm_cause;
    float target[2], sent[2];
    float low[2], high[2], low_before[2], high_before[2];
} roburoc4_private_drive;

typedef struct roburoc4_private_discovery {
    uint8_t service_count, listed, known, refused;
    uint8_t wanted, inserted, acked, declined;
    uint8_t leaving, identified, probe_kind, done;
    uint8_t described_kind, reserved;
    uint16_t described_index;
    uint16_t service_ids[8];
    uint64_t phase_us, probe_us;
    uint64_t described[5];
    int16_t role_texts[4];
    uint16_t types[32], ids[32];
    uint8_t claims[32];
} roburoc4_private_discovery;

typedef struct roburoc4_private_values {
    uint8_t telemeter_count, distance_count, battery_state, battery_percent;
    uint8_t minimum_percent, battery_low, overridden, override_known;
    int32_t io_counts[4];
    uint64_t digital, pose_bits[3], initial_bits[3];
    float nominal_voltage_v, capacity_ah;
    uint32_t flags, initial_flags;
    float speeds[4], limits[13];
    float analog[32], distances[16];
    float telemeters[16][6];
    uint32_t reserved;
} roburoc4_private_values;

typedef struct roburoc4_private_outputs {
    uint8_t repeats, relocalizing, reserved[2];
    int32_t relocalize_result;
    uint64_t digital, sent_us, relocalize_us, pose_bits[3];
    float analog[16];
} roburoc4_private_outputs;

typedef struct roburoc4_client {
    uint64_t private_now_us;
    uint32_t private_size, private_events, private_state, private_reserved_1;
    roburoc4_config private_config;
    roburoc4_private_drive private_drive;
    roburoc4_private_discovery private_discovery;
    roburoc4_private_requests private_requests;
    uint32_t private_counters[14];
    roburoc4_private_outputs private_outputs;
    roburoc4_private_link private_link;
    roburoc4_private_values private_values;
    uint32_t private_reserved[8];
} roburoc4_client;

/** sizeof(roburoc4_client) of the library; compare it before linking to another build. */
ROBUROC4_API size_t roburoc4_client_size(void);

/** Prepare a client, whatever was in its memory before; it is idle and disarmed.
 *  client_size is sizeof(roburoc4_client); config may be NULL for all defaults.
 *  ROBUROC4_ERR_SIZE: header and library differ. ROBUROC4_ERR_CONFIG: roburoc4_config_error()
 *  names the value. After an error it is an idle client that cannot be started, armed or driven. */
ROBUROC4_API roburoc4_result roburoc4_client_init(roburoc4_client *client, size_t client_size,
                                                  const roburoc4_config *config);
/** Begin to connect. ROBUROC4_ERR_STATE unless idle. */
ROBUROC4_API roburoc4_result roburoc4_client_start(roburoc4_client *client, uint64_t now_us);
/** Begin to leave: disarms, and stays in ROBUROC4_STATE_CLOSING until the zero train (if one is
 *  due) has ended; go on with receive() and poll_transmit() until the state is idle, at most
 *  robot_watchdog_ms or three drive periods. Subscriptions are left alone: other clients may share
 *  them. */
ROBUROC4_API roburoc4_result roburoc4_client_close(roburoc4_client *client, uint64_t now_us);

/** One datagram of the robot. That it is the robot's is the caller's duty (connect the socket).
 *  Returns 0 or more where it was used; ROBUROC4_ERR_SHORT, _KIND, _VALUE, _UNMATCHED,
 *  _UNSUBSCRIBED or _OLD where it was dropped and counted. A dropped one changes no value; it may
 *  tell that the robot restarted, or end the request that it answers in an unknown layout. */
ROBUROC4_API roburoc4_result roburoc4_client_receive(roburoc4_client *client,
                                                     const uint8_t *datagram, size_t size,
                                                     uint64_t now_us);
/** The next datagram to send: its length, or 0 when nothing is due. Call it until it gives 0, after
 *  every receive(), after every call that changes something, and at the deadline. Read the clock
 *  right before and send at once; drop what the network does not take. A buffer of
 *  ROBUROC4_MAX_TRANSMIT bytes always suffices; ROBUROC4_ERR_BUFFER sends nothing. */
ROBUROC4_API roburoc4_result roburoc4_client_poll_transmit(roburoc4_client *client, uint8_t *buffer,
                                                           size_t capacity, uint64_t now_us);
/** The time at which poll_transmit() must be called again if nothing happens before; UINT64_MAX
 *  when idle. A time in the past means now. */
ROBUROC4_API uint64_t roburoc4_client_next_deadline(const roburoc4_client *client);
/** ROBUROC4_EVENT_* bits since the last call, and clears them. */
ROBUROC4_API uint32_t roburoc4_client_take_events(roburoc4_client *client);
/** ROBUROC4_STATE_*. */
ROBUROC4_API uint32_t roburoc4_client_state(const roburoc4_client *client);
/** One of ROBUROC4_COUNT_*; 0 for another number. */
ROBUROC4_API uint32_t roburoc4_client_count(const roburoc4_client *client, uint32_t counter);

/* Motion. A drive command is a lease: the target lives for lease_us and dies unless renewed. Every
 * exit from driving (lease over, stop, disarm, override, loss, reboot, clock fault) is followed by
 * a train of zero commands: one per drive period, at least three, until a status shows both targets
 * 0 or robot_watchdog_ms has passed. A new lease waits for the end of the train. The first zero
 * after a speed leaves at once; all other commands are at least a robot cycle (10 ms) apart. */

/** Allow driving. 0, or the first reason against it: ROBUROC4_ERR_NOT_READY, _NO_DIFFERENTIAL,
 *  _LIMITS, _STALE_DIFFERENTIAL, _STALE_IOCARD, _OVERRIDE_UNKNOWN, _OVERRIDE, _FOREIGN, _MOVING.
 * The client disarms itself when one of these conditions is lost. Arming twice is fine. */
ROBUROC4_API roburoc4_result roburoc4_client_arm(roburoc4_client *client, uint64_t now_us);
/** Forbid driving and stop. Always possible. */
ROBUROC4_API roburoc4_result roburoc4_client_disarm(roburoc4_client *client, uint64_t now_us);
/** Drive at these speeds for lease_us (0: the configured lease; else 20000 to 1000000) from now.
 *  Scaled, then (by option) kept on its curve, then clamped to the robot's limits and the
 *  ceilings. ROBUROC4_ERR_NOT_FINITE, _ARGUMENT (lease), or why the client is not armed: then
 *  nothing is stored. ROBUROC4_ERR_NOT_NEUTRAL: resuming needs drive(0, 0) or a pause first. */
ROBUROC4_API roburoc4_result roburoc4_client_drive(roburoc4_client *client, float linear_m_s,
                                                   float angular_rad_s, uint32_t lease_us,
                                                   uint64_t now_us);
/** End the lease and send a zero train, armed or not, now or as soon as the differential service
 *  is known. Arming stays. ROBUROC4_ERR_STATE unless started. */
ROBUROC4_API roburoc4_result roburoc4_client_stop(roburoc4_client *client, uint64_t now_us);

/** What is true now. */
typedef struct roburoc4_facts {
    uint32_t size;          /* set it to sizeof(roburoc4_facts) before the call */
    uint32_t state;         /* ROBUROC4_STATE_* */
    uint8_t armed;          /* 1: drive() is accepted */
    uint8_t driving;        /* 1: a lease lives */
    uint8_t stopping;       /* 1: a zero train is on its way, or a stop() waits for the robot */
    uint8_t override_known; /* 1: `overridden` means something */
    uint8_t overridden;     /* 1: game pad [A] is held */
    uint8_t foreign;        /* 1: another client commands the robot */
    uint8_t inhibited;      /* 1: a speed is asked for, but the robot stands still: emergency stop,
                               brakes, bumper */
    uint8_t fixed_id;       /* 1: the robot answers every request with 0x01 */
    uint8_t front_bumper;   /* 1: pressed, by the last IO status */
    uint8_t rear_bumper;
    uint8_t descriptions_done; /* 1: every text was answered or given up */
    uint8_t battery_low;       /* 1: remaining is below minimum_percent, or the state is Critical */
    int32_t disarm_cause;      /* why it is not armed; 0 while armed */
    int32_t arm_refusal;       /* what roburoc4_client_arm() would return */
    int32_t relocalize_result; /* of the last one: 0, ROBUROC4_ERR_TIMEOUT, _ROBOT, or _UNKNOWN */
    uint32_t lease_left_us;    /* 0 when not driving */
    float linear_m_s, angular_rad_s; /* last speeds sent; 0 after a zero */
} roburoc4_facts;
/** ROBUROC4_ERR_SIZE for a size that the library does not know. */
ROBUROC4_API roburoc4_result roburoc4_client_facts(const roburoc4_client *client, uint64_t now_us,
                                                   roburoc4_facts *facts);

/* Services and properties. ROBUROC4_ERR_UNKNOWN until the robot has said it. */

/** Number of services in the directory, at most ROBUROC4_MAX_SERVICES. */
ROBUROC4_API uint32_t roburoc4_client_service_count(const roburoc4_client *client);
/** Entry `index` of the directory. */
ROBUROC4_API roburoc4_result roburoc4_client_service_at(const roburoc4_client *client,
                                                        uint32_t index,
                                                        roburoc4_directory_entry *out);
/** The id on the wire that stands for ROBUROC4_SERVICE_*, or ROBUROC4_ERR_UNKNOWN. */
ROBUROC4_API roburoc4_result roburoc4_client_service_id(const roburoc4_client *client,
                                                        uint32_t service);
ROBUROC4_API roburoc4_result roburoc4_client_iocard_properties(const roburoc4_client *client,
                                                               roburoc4_iocard_properties *out);
ROBUROC4_API roburoc4_result roburoc4_client_battery_properties(const roburoc4_client *client,
                                                                roburoc4_battery_properties *out);
ROBUROC4_API roburoc4_result roburoc4_client_localization_properties(
    const roburoc4_client *client, roburoc4_localization_properties *out);
ROBUROC4_API roburoc4_result roburoc4_client_differential_properties(
    const roburoc4_client *client, roburoc4_differential_properties *out);
/** Number of telemeters with properties, at most ROBUROC4_MAX_TELEMETERS. */
ROBUROC4_API uint32_t roburoc4_client_telemeter_count(const roburoc4_client *client);
/** Telemeter `index`: mounting, range, and the latest distance (0 before the first status). */
ROBUROC4_API roburoc4_result roburoc4_client_telemeter(const roburoc4_client *client,
                                                       uint32_t index, roburoc4_telemeter *out);

/** A text that the robot gave. */
typedef struct roburoc4_description {
    const uint8_t *text; /* a view on the datagram; not NUL-terminated */
    uint32_t length;
    int32_t io_type; /* ROBUROC4_IO_*, or -1 for a service of the directory */
    uint32_t index;  /* of the channel, or of the directory's element */
} roburoc4_description;
/** After the receive() of this datagram raised ROBUROC4_EVENT_DESCRIPTION: what it describes.
 *  ROBUROC4_ERR_UNKNOWN where the last datagram was no description. */
ROBUROC4_API roburoc4_result roburoc4_client_description(const roburoc4_client *client,
                                                         const uint8_t *datagram, size_t size,
                                                         roburoc4_description *out);

/** The index on the wire of the input with ROBUROC4_ROLE_*, or ROBUROC4_ERR_UNKNOWN. */
ROBUROC4_API roburoc4_result roburoc4_client_role_index(const roburoc4_client *client,
                                                        uint32_t role);
/** Say which input has a role (ROBUROC4_INDEX_AUTO: find it). The override is unknown until the
 *  next IO card status; a client that is armed disarms. */
ROBUROC4_API roburoc4_result roburoc4_client_set_role_index(roburoc4_client *client, uint32_t role,
                                                            int32_t index, uint64_t now_us);

/* Values: the latest status of each service. ROBUROC4_ERR_UNKNOWN before the first. host_us may be
 * NULL; else it is set to the host time at which the status was received. */

ROBUROC4_API roburoc4_result roburoc4_client_battery(const roburoc4_client *client,
                                                     roburoc4_battery_status *out,
                                                     uint64_t *host_us);
ROBUROC4_API roburoc4_result roburoc4_client_localization(const roburoc4_client *client,
                                                          roburoc4_localization_status *out,
                                                          uint64_t *host_us);
ROBUROC4_API roburoc4_result roburoc4_client_differential(const roburoc4_client *client,
                                                          roburoc4_differential_status *out,
                                                          uint64_t *host_us);
/** All inputs of the IO card (frozen: this struct never changes). */
typedef struct roburoc4_inputs {
    uint64_t robot_cycles;
    uint64_t digital;                     /* bit i is digital input i */
    float analog[32];                     /* generally volts; game pad axes -1 to 1 */
    uint32_t analog_count, digital_count; /* stored ones */
} roburoc4_inputs;
ROBUROC4_API roburoc4_result roburoc4_client_inputs(const roburoc4_client *client,
                                                    roburoc4_inputs *out, uint64_t *host_us);
/** All distances (frozen). */
typedef struct roburoc4_distances {
    uint64_t robot_cycles;
    float distance_m[16];
    uint32_t count; /* stored ones */
    uint32_t reserved;
} roburoc4_distances;
ROBUROC4_API roburoc4_result roburoc4_client_distances(const roburoc4_client *client,
                                                       roburoc4_distances *out, uint64_t *host_us);

/* Outputs. A command carries all outputs and nothing reads them back: outputs that were never set
 * are sent as 0. Each change is sent at once and twice more. */

/** Set digital output `index` (1 or more) to `on` (0 or 1). ROBUROC4_ERR_UNKNOWN before the counts
 *  are known, _RESERVED for output 0, _INDEX beyond the last, _NOT_READY. */
ROBUROC4_API roburoc4_result roburoc4_client_set_digital_output(roburoc4_client *client,
                                                                uint32_t index, int32_t on,
                                                                uint64_t now_us);
/** Set the digital outputs whose bit in `mask` is set to their bit of `values`, in one datagram;
 *  all or none. Errors as above. */
ROBUROC4_API roburoc4_result roburoc4_client_set_digital_outputs(roburoc4_client *client,
                                                                 uint64_t mask, uint64_t values,
                                                                 uint64_t now_us);
/** Set analog output `index` to `value`, generally volts. ROBUROC4_ERR_NOT_FINITE, or as above. */
ROBUROC4_API roburoc4_result roburoc4_client_set_analog_output(roburoc4_client *client,
                                                               uint32_t index, float value,
                                                               uint64_t now_us);

/** Tell the robot where it is (REPLACE, 4.2.6.5); sent until answered or refused, for at most 2 s;
 *  a later call replaces an open one. Ends in ROBUROC4_EVENT_RELOCALIZED or _RELOCALIZE_FAILED.
 *  ROBUROC4_ERR_NOT_FINITE, _NOT_READY, _UNKNOWN (no localization service). */
ROBUROC4_API roburoc4_result roburoc4_client_relocalize(roburoc4_client *client, double x_m,
                                                        double y_m, double theta_rad,
                                                        uint64_t now_us);

/** Subscribe to a service (ROBUROC4_SERVICE_IOCARD to _DIFFERENTIAL) or change its period: a
 *  multiple of 10, 10 to 2550 ms. Kept over a loss. ROBUROC4_ERR_ARGUMENT. */
ROBUROC4_API roburoc4_result roburoc4_client_subscribe(roburoc4_client *client, uint32_t service,
                                                       uint32_t period_ms, uint64_t now_us);
/** End a subscription. Statuses that the robot sends all the same are counted and dropped. */
ROBUROC4_API roburoc4_result roburoc4_client_unsubscribe(roburoc4_client *client, uint32_t service,
                                                         uint64_t now_us);

/** Figures of the link. */
typedef struct roburoc4_link {
    uint32_t size;          /* set it to sizeof(roburoc4_link) before the call */
    uint32_t round_trip_us; /* smoothed, of answered requests; 0 before the first */
    uint32_t round_trip_min_us;
    uint32_t silence_us;     /* since the last datagram that was used */
    uint32_t received, lost; /* statuses of all services since start() */
    float loss;              /* share of recent statuses that did not arrive, 0 to 1 */
    uint32_t reserved;
} roburoc4_link;
ROBUROC4_API roburoc4_result roburoc4_client_link(const roburoc4_client *client, uint64_t now_us,
                                                  roburoc4_link *link);
/** Figures of one service's statuses. */
typedef struct roburoc4_service_link {
    uint32_t size;             /* set it to sizeof(roburoc4_service_link) before the call */
    uint32_t subscribed;       /* 1: wanted, and not refused */
    uint32_t received;         /* used statuses since start() */
    uint32_t lost;             /* gaps against the observed period, less what came late */
    uint32_t late, duplicates; /* not used */
    uint32_t period_us;        /* observed; the requested one until enough came */
    uint32_t jitter_us;        /* smoothed deviation of arrival from robot time (RFC 3550, 6.4.1) */
    uint32_t age_us;           /* since the last status; UINT32_MAX before the first */
    float loss;                /* share of recent statuses that did not arrive, 0 to 1 */
} roburoc4_service_link;
ROBUROC4_API roburoc4_result roburoc4_client_service_link(const roburoc4_client *client,
                                                          uint32_t service, uint64_t now_us,
                                                          roburoc4_service_link *link);
/** When, on the host's clock, the robot's clock showed robot_cycles; estimated from the statuses of
 *  the last seconds and half of the shortest round trip. ROBUROC4_ERR_UNKNOWN before the first. */
ROBUROC4_API roburoc4_result roburoc4_client_host_time(const roburoc4_client *client,
                                                       uint64_t robot_cycles, uint64_t *host_us);

#ifdef __cplusplus
}
#endif

#endif
