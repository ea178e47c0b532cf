/* SPDX-License-Identifier: MIT
 *
 * roburoc4_codec.h - the telegrams of the RobuROC4's UDP protocol, in both directions: bytes to
 * values and back.
 *
 * Every function is pure: no input or output, no memory of its own, callable from any thread. A
 * program that drives a robot uses the client of roburoc4.h, which includes this header; this one
 * alone is for analysers, loggers, simulators, and robots.
 *
 *   Results     int32_t: 0 or more is success (often a length), negative is one of ROBUROC4_ERR_*.
 *   Lifetime    views (lists, texts, channels) point into the decoded datagram and are valid as
 *               long as it is.
 *
 * Section numbers are those of the RobuROC4 user manual, revision A.
 */
#ifndef ROBUROC4_CODEC_H
#define ROBUROC4_CODEC_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifndef ROBUROC4_API
#define ROBUROC4_API
#endif

/** Before functions whose result a program must look at: compilers that can do so warn where it is
 *  ignored. May be defined beforehand, for example as nothing. */
#ifndef ROBUROC4_MUST_CHECK
#if defined(SWIG)
#define ROBUROC4_MUST_CHECK
#elif defined(__cplusplus) && __cplusplus >= 201703L
#define ROBUROC4_MUST_CHECK [[nodiscard]]
#elif defined(__GNUC__)
#define ROBUROC4_MUST_CHECK __attribute__((warn_unused_result))
#elif defined(_MSC_VER) && defined(_Check_return_)
#define ROBUROC4_MUST_CHECK _Check_return_
#else
#define ROBUROC4_MUST_CHECK
#endif
#endif

/* -------------------------------------------------------------------------------- results --- */

/** 0 or more: success, often a length. Negative: one of ROBUROC4_ERR_*. */
typedef int32_t roburoc4_result;

#define ROBUROC4_OK 0
/* of the codec */
#define ROBUROC4_ERR_ARGUMENT (-1) /* an argument is outside its documented range */
#define ROBUROC4_ERR_BUFFER (-2)   /* the buffer is too small; nothing was written */
#define ROBUROC4_ERR_SHORT (-3)    /* the datagram is shorter than its layout */
#define ROBUROC4_ERR_KIND (-4)     /* the datagram is of another kind */
#define ROBUROC4_ERR_VALUE (-5)    /* impossible value in a datagram; a name of several channels */
#define ROBUROC4_ERR_ROBOT (-6)    /* the answer carries one of the robot's error codes */
/* of the client */
#define ROBUROC4_ERR_SIZE (-7)        /* a struct's size is not the library's */
#define ROBUROC4_ERR_CONFIG (-8)      /* a configuration value; see roburoc4_config_error() */
#define ROBUROC4_ERR_STATE (-9)       /* the client was not started, or is closing */
#define ROBUROC4_ERR_NOT_KNOWN (-10)  /* not reported by the robot yet */
#define ROBUROC4_ERR_INDEX (-11)      /* no channel, entry or control has this number or name */
#define ROBUROC4_ERR_RESERVED (-12)   /* digital output 0 is the robot's own watchdog */
#define ROBUROC4_ERR_NOT_FINITE (-13) /* NaN or infinity */
#define ROBUROC4_ERR_UNMATCHED (-14)  /* an answer to no open request: late, duplicate, not ours */
#define ROBUROC4_ERR_UNEXPECTED_STATUS (-15) /* a status without a subscription */
#define ROBUROC4_ERR_OLD (-16)               /* a status not newer than the last of its service */
#define ROBUROC4_ERR_TIMEOUT (-17)           /* none of a request's tries was answered */
/* why a client is not armed, or arm() or drive() was refused */
#define ROBUROC4_ERR_DISARMED (-20)           /* never armed, or closed */
#define ROBUROC4_ERR_NOT_READY (-21)          /* the client is not in ROBUROC4_STATE_READY */
#define ROBUROC4_ERR_NO_DIFFERENTIAL (-22)    /* no differential service with full properties */
#define ROBUROC4_ERR_LIMITS (-23)             /* the robot's speed limits are not usable */
#define ROBUROC4_ERR_STALE_DIFFERENTIAL (-24) /* no recent differential status */
#define ROBUROC4_ERR_STALE_IOCARD (-25)       /* no recent IO card status */
#define ROBUROC4_ERR_OVERRIDE_UNKNOWN (-26)   /* the input of game pad [A] is not known */
#define ROBUROC4_ERR_OVERRIDE (-27)           /* somebody holds [A] on the game pad */
#define ROBUROC4_ERR_MOVING (-28)             /* the robot moves without a command */
#define ROBUROC4_ERR_OTHER_COMMANDER (-29)    /* another client commands the robot */
#define ROBUROC4_ERR_LOST (-30)               /* the robot fell silent */
#define ROBUROC4_ERR_REBOOT (-31)             /* the robot restarted */
#define ROBUROC4_ERR_CLOCK (-32)              /* the clock went back */
#define ROBUROC4_ERR_INHIBITED (-33)          /* the robot does not follow its commands */
#define ROBUROC4_ERR_STOP_CALLED (-34)        /* stop() was called */
#define ROBUROC4_ERR_LAPSED (-35) /* a lease expired, and the program did not renew it */
#define ROBUROC4_ERR_UPLINK (-36) /* commands reach the robot late, or not at all */
#define ROBUROC4_ERR_UNITS (-37)  /* a speed or angle that looks like mm/s or degrees */
#define ROBUROC4_ERR_SUBSCRIPTION_REFUSED (-38) /* the robot refused a subscription for driving */
/* of the UDP adapter and the pump (roburoc4_udp.h, roburoc4_pump.h) */
#define ROBUROC4_ERR_SYSTEM (-40)  /* the operating system refused: see the function */
#define ROBUROC4_ERR_RESOLVE (-41) /* a host name has no address */
#define ROBUROC4_ERR_CLOSED (-42)  /* closed, made before a fork(), or without an address */
#define ROBUROC4_ERR_BUSY (-43)    /* another thread drives a move with this pump */
#define ROBUROC4_ERR_ADDRESS (-44) /* not an address, as a text or as a struct */

/** One English sentence for a result, without a full stop: the cause, and often after a colon what
 *  to do. "ok" for 0 and more, "unknown error" for an invalid value. Valid as long as the program
 *  runs. */
ROBUROC4_API const char *roburoc4_result_text(roburoc4_result result);

/* ---------------------------------------------------- the manual's enumerations and tables --- */

/** Services, named by their ids on a RobuROC4 (4.2.1). Other robots number all but the first two
 *  differently, so the client takes a service's id from the directory; in its functions these
 *  constants name the service, whatever its id. */
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

/** What roburoc4_name() names. */
#define ROBUROC4_NAME_SERVICE 0 /* ROBUROC4_SERVICE_*, as the manual (4.2.1): "IOCard" */
#define ROBUROC4_NAME_BATTERY 1 /* ROBUROC4_BATTERY_*, as the manual (4.2.4.6): "Charging" */
#define ROBUROC4_NAME_STATE 2   /* ROBUROC4_STATE_* of a client, in lower case: "connecting" */
#define ROBUROC4_NAME_EVENT 3   /* one bit ROBUROC4_EVENT_*, as a sentence */
/** Likewise, of an event whose condition began or ended: _OVERRIDE, _OTHER_COMMANDER, _INHIBITED.
 */
#define ROBUROC4_NAME_EVENT_BEGAN 4
#define ROBUROC4_NAME_EVENT_ENDED 5

/** The name of a number, by what the number is (ROBUROC4_NAME_*); NULL where it has none. */
ROBUROC4_API const char *roburoc4_name(uint32_t what, uint32_t number);

/** The robot's factory-default address (4.2.1). */
#define ROBUROC4_DEFAULT_HOST "192.168.0.2"
#define ROBUROC4_DEFAULT_PORT 60000
/** One low level cycle of the robot in microseconds (4.2.4). */
#define ROBUROC4_CYCLE_US 10000

/* ---------------------------------------------------------------------------------- codec --- */
/*
 * Decoders read `size` bytes, write all of *out or (on an error) nothing, and return the number of
 * surplus bytes after the layout (0 for the manual's length) or
 *     ROBUROC4_ERR_SHORT   shorter than the layout,
 *     ROBUROC4_ERR_KIND    another header or action,
 *     ROBUROC4_ERR_VALUE   an impossible value (a negative count),
 *     ROBUROC4_ERR_ROBOT   (answers) a non-zero error byte: read it with roburoc4_decode_answer().
 * They do not compare the service's id: it is in *out. Floats are passed on as they are, NaN too.
 *
 * Encoders write one telegram and return its length, or ROBUROC4_ERR_BUFFER (nothing written), or
 * ROBUROC4_ERR_ARGUMENT for a value that cannot be sent.
 */

/** Any request of a client, with the fields of its action (the others are not sent). */
typedef struct roburoc4_request {
    uint8_t id;                 /* 1 to 254, echoed in the answer */
    uint8_t action;             /* ROBUROC4_ACTION_* */
    uint16_t service;           /* target; INSERT and DELETE go to the notification service */
    uint16_t subject;           /* INSERT, DELETE: the service whose statuses are meant */
    uint8_t period_cycles;      /* INSERT: period in cycles of 10 ms, 1 to 255 */
    uint8_t io_type;            /* QUERY of the IO card: ROBUROC4_IO_* */
    int32_t index;              /* QUERY: entry of the directory (0 to 65535) or IO channel */
    uint64_t timestamp;         /* REPLACE: "not used but mandatory" (4.2.6.5) */
    double x_m, y_m, theta_rad; /* REPLACE: the new pose */
} roburoc4_request;

/*
 *  action    length  fields used                                            manual
 *  GET            4  service                                                4.2.2.1
 *  QUERY          6  service 0 (the directory), index                       4.2.3.1
 *  QUERY          9  service (an IO card), io_type, index                   4.2.3.3
 *  INSERT         7  service, subject, period_cycles                        4.2.4.1
 *  DELETE         6  service, subject              (known from other robots of the family)
 *  REPLACE       36  service (localization), timestamp, x_m, y_m, theta_rad 4.2.6.5
 */
/** ROBUROC4_ERR_ARGUMENT: an id or a period of 0, id 255, an index of the directory beyond 16 bits,
 *  or an action that has no layout in this table. */
ROBUROC4_API roburoc4_result roburoc4_encode_request(uint8_t *buffer, size_t capacity,
                                                     const roburoc4_request *request);
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
    float min_distance_m, max_distance_m; /* range that it can measure; the simulator reports the
                                             maximum where it sees nothing, the manual is silent */
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

/** The head of a status: `0xFF service timestamp`. */
typedef struct roburoc4_status_header {
    uint64_t robot_cycles;
    uint16_t service;
    uint16_t reserved[3];
} roburoc4_status_header;
/** 11 bytes or more; the rest counts as surplus. (The head of any command, 3 bytes or more, is read
 *  by roburoc4_decode_iocard_command() with counts of 0.) */
ROBUROC4_API roburoc4_result roburoc4_decode_status_header(const uint8_t *data, size_t size,
                                                           roburoc4_status_header *out);

/** The channels of an IO card's status (its inputs, 4.2.4.4) or command (its outputs, 4.2.5.2): a
 *  view on the datagram. */
typedef struct roburoc4_channels {
    uint64_t robot_cycles;  /* of a status; a command has none */
    const uint8_t *analog;  /* for roburoc4_floats(); generally volts */
    const uint8_t *digital; /* channel 8 k + b is bit b of byte k */
    uint32_t analog_count, digital_count;
    uint16_t service;
    uint16_t reserved[3];
} roburoc4_channels;
/** The first floats of a view of `count` floats, at most `capacity` of them into `out`; how many
 * were copied. */
ROBUROC4_API uint32_t roburoc4_floats(const uint8_t *view, uint32_t count, float *out,
                                      uint32_t capacity);
/** IO card status. The counts are those of the card's properties. One block too many, or any longer
 *  tail, is surplus. */
ROBUROC4_API roburoc4_result roburoc4_decode_iocard_status(const uint8_t *data, size_t size,
                                                           uint32_t analog_inputs,
                                                           uint32_t digital_inputs,
                                                           roburoc4_channels *out);
/** digital: (digital_inputs + 7) / 8 bytes; channel 8 k + b is bit b of byte k. */
ROBUROC4_API roburoc4_result roburoc4_encode_iocard_status(
    uint8_t *buffer, size_t capacity, uint16_t service, uint64_t robot_cycles, const float *analog,
    size_t analog_inputs, const uint8_t *digital, size_t digital_inputs);

/** Telemeter status (4.2.4.5): a view on the datagram. */
typedef struct roburoc4_telemeter_status {
    uint64_t robot_cycles;
    const uint8_t *distances; /* for roburoc4_floats(), in metres */
    uint32_t count;
    uint16_t service;
    uint16_t reserved;
} roburoc4_telemeter_status;
ROBUROC4_API roburoc4_result roburoc4_decode_telemeter_status(const uint8_t *data, size_t size,
                                                              roburoc4_telemeter_status *out);
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
    double x_m, y_m, theta_rad; /* in the main frame, that of the odometry */
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

/** IO card command: all outputs at once, as a robot reads it. The counts are those of the card's
 *  properties. */
ROBUROC4_API roburoc4_result roburoc4_decode_iocard_command(const uint8_t *data, size_t size,
                                                            uint32_t analog_outputs,
                                                            uint32_t digital_outputs,
                                                            roburoc4_channels *out);
/** digital: (digital_outputs + 7) / 8 bytes; channel 8 k + b is bit b of byte k. */
ROBUROC4_API roburoc4_result roburoc4_encode_iocard_command(uint8_t *buffer, size_t capacity,
                                                            uint16_t service, const float *analog,
                                                            size_t analog_outputs,
                                                            const uint8_t *digital,
                                                            size_t digital_outputs);

#ifdef __cplusplus
}
#endif

#endif
