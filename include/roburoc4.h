/* SPDX-License-Identifier: MIT
 *
 * roburoc4.h - a client of the RobuROC4 robot, without input or output of its own.
 *
 * THE MODEL
 *
 * The robot is a UDP server (192.168.0.2:60000 by default) of seven services. A client sends
 * requests (read properties, subscribe ...), each answered once; the robot sends statuses, which a
 * client subscribes to; a client sends commands, which are not answered. The robot stops by itself
 * when no speed command came for 1 s, and holding [A] on its game pad overrides every client.
 *
 * The client is a state machine that finds the services, subscribes, keeps the link, and decides
 * which speeds are sent. It has no socket, clock, allocation, callback or thread. You hand it
 * received datagrams and the time, and it returns datagrams to send:
 *
 *     roburoc4_client_receive()        hand over a received datagram
 *     roburoc4_client_poll_transmit()  the next datagram to send, or 0
 *     roburoc4_client_next_deadline()  when to poll again if nothing is received
 *     roburoc4_client_take_events()    what changed since the last call
 *
 * roburoc4_udp.h does this over a socket; examples/bare_loop.c does it by hand. The telegrams
 * themselves are in roburoc4_codec.h, which this header includes. A firmware compiles the sources
 * that cmake/core_sources.txt lists, for moves also those of cmake/move_sources.txt, or the two
 * files that scripts/amalgamate writes.
 *
 * CONVENTIONS
 *
 *   Units       SI: metres, radians, seconds; times in microseconds (_us) or milliseconds (_ms);
 *               robot time in cycles of 10 ms since power on (_cycles).
 *   Frame       X forward, Y left, Z up, angles counter-clockwise (manual 2.3).
 *   Main frame  the frame of the odometry (ROS: odom). The robot's pose in it at power on is in the
 *               localization properties.
 *   Time        now_us is any clock that never goes back and runs during sleep: read it for each
 *               call. A clock that jumps never makes the client send a speed; one that goes back
 *               disarms it.
 *   Results     int32_t: 0 or more is success (often a length), negative is one of ROBUROC4_ERR_*.
 *   Threads     there are no globals: use one client from one thread at a time, different clients
 *               from any threads.
 *   Lifetime    nothing that you pass in is kept, neither configuration nor datagram.
 *   Size        structs that begin with `size` can grow. A program that was compiled with an older
 *               header gets the fields that it knows; ROBUROC4_SIZED() sets the size.
 *   NULL        a pointer must be valid unless its comment says that it may be NULL.
 *   Cost        no heap, no recursion, at most 400 bytes of stack on a Cortex-M0
 *               (bench/footprint). The calls of a loop say how many instructions they take on
 *               x86-64 (bench/client-cost). No loop of theirs is longer than 64, but for the
 *               search in a text that was received.
 *
 * OPTIONS OF A BUILD
 *
 * For small firmwares: define them for every source file of the core. What an option leaves out is
 * not linked (with -Os -ffunction-sections -Wl,--gc-sections).
 *
 *   ROBUROC4_NO_TEXTS       default off: the client reads the robot's texts. If on, the
 *                           configuration must say where things are: iocard_id, differential_id,
 *                           and role_index of the override; without them, arm() is refused
 *                           (_NO_DIFFERENTIAL, _OVERRIDE_UNKNOWN). Moves with a clearance
 *                           also need the bumpers' role_index.
 *   ROBUROC4_NO_STATISTICS  default off: the client counts what it sends, receives and loses, and
 *                           measures jitter. If on, all of these stay 0.
 *   ROBUROC4_NO_FIXED_ID    default off: the client also connects to a robot that answers every
 *                           request with 0x01, as the manual prints it; none is known. If on, it
 *                           does not.
 *
 * Section numbers are those of the RobuROC4 user manual, revision A.
 */
#ifndef ROBUROC4_H
#define ROBUROC4_H

#include "roburoc4_codec.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Set the size of a struct that begins with it; the value is the struct's address.
 *  roburoc4_client_facts(&client, now_us, ROBUROC4_SIZED(&facts)) */
#define ROBUROC4_SIZED(out) ((out)->size = sizeof *(out), (out))

/* ------------------------------------------------------------------------------- versions --- */

/** Version of this header. Compare with roburoc4_version() of the library that runs. */
#define ROBUROC4_VERSION_MAJOR 1
#define ROBUROC4_VERSION_MINOR 0
#define ROBUROC4_VERSION_PATCH 0
#define ROBUROC4_VERSION                                                                           \
    (ROBUROC4_VERSION_MAJOR * 0x10000 + ROBUROC4_VERSION_MINOR * 0x100 + ROBUROC4_VERSION_PATCH)
/** Incremented by every incompatible change of a struct or a function. */
#define ROBUROC4_ABI_VERSION 1
/** Revision of the manual that the codec follows: 1 is revision A of 2011-03-09. */
#define ROBUROC4_PROTOCOL_REVISION 1

/** The library's version as 0xMMmmpp. */
ROBUROC4_API uint32_t roburoc4_version(void);
/** The library's ABI version, ROBUROC4_ABI_VERSION of the header it was built with. */
ROBUROC4_API uint32_t roburoc4_abi_version(void);

/* --------------------------------------------------------------------------------- client --- */

/** Capacities of the client: about twice what a RobuROC4 has, or more. It has 7 services, 9 analog
 *  and 22 digital inputs, 8 digital outputs, and 2 telemeters (ultrasonic rangefinders). What a
 *  robot has beyond them is reported (ROBUROC4_EVENT_CAPACITY) and not stored; the codec reads all
 *  of it. */
#define ROBUROC4_MAX_SERVICES 16
#define ROBUROC4_MAX_ANALOG_INPUTS 16
#define ROBUROC4_MAX_ANALOG_OUTPUTS 4
#define ROBUROC4_MAX_DIGITAL_INPUTS 64
#define ROBUROC4_MAX_DIGITAL_OUTPUTS 64
#define ROBUROC4_MAX_TELEMETERS 6
/** The longest datagram that a client sends. */
#define ROBUROC4_MAX_TRANSMIT 36
/** A receive buffer of this size holds all that a client can use; the longest datagram of a
 *  RobuROC4 has 65 bytes. */
#define ROBUROC4_MAX_RECEIVE 1024

/** States of a client; roburoc4_name(ROBUROC4_NAME_STATE, state) gives their names. */
#define ROBUROC4_STATE_IDLE 0        /* before start(), after close() */
#define ROBUROC4_STATE_CONNECTING 1  /* asking for the directory */
#define ROBUROC4_STATE_DISCOVERING 2 /* reading texts of the directory, then properties */
#define ROBUROC4_STATE_SUBSCRIBING 3
#define ROBUROC4_STATE_READY 4
#define ROBUROC4_STATE_LOST 5    /* was ready, fell silent: asking for the directory again */
#define ROBUROC4_STATE_CLOSING 6 /* sending the last zero commands */

/** Events are a set of bits: what changed since the last roburoc4_client_take_events(), in no order
 *  of time. roburoc4_name(ROBUROC4_NAME_EVENT, bit) explains one. For _OVERRIDE, _OTHER_COMMANDER
 *  and _INHIBITED, the facts have which way: then use ROBUROC4_NAME_EVENT_BEGAN or _ENDED.
 *  Bit 31 stays free, so that a set of events is also a roburoc4_result. */
#define ROBUROC4_EVENT_STATE 0x00000001          /* the state changed */
#define ROBUROC4_EVENT_READY 0x00000002          /* became ready */
#define ROBUROC4_EVENT_LOST 0x00000004           /* the robot fell silent */
#define ROBUROC4_EVENT_REBOOT 0x00000008         /* the robot restarted, or seems to */
#define ROBUROC4_EVENT_PROPERTIES 0x00000010     /* properties of a service are new or changed */
#define ROBUROC4_EVENT_DESCRIPTION 0x00000020    /* a text arrived: roburoc4_client_description() */
#define ROBUROC4_EVENT_IOCARD 0x00000040         /* a new status of this service */
#define ROBUROC4_EVENT_TELEMETER 0x00000080      /* likewise */
#define ROBUROC4_EVENT_BATTERY 0x00000100        /* likewise */
#define ROBUROC4_EVENT_LOCALIZATION 0x00000200   /* likewise */
#define ROBUROC4_EVENT_DIFFERENTIAL 0x00000400   /* likewise */
#define ROBUROC4_EVENT_ARMED 0x00000800          /* became armed */
#define ROBUROC4_EVENT_DISARMED 0x00001000       /* disarmed; see disarm_cause */
#define ROBUROC4_EVENT_LAPSED 0x00002000         /* a lease expired before anything else disarmed */
#define ROBUROC4_EVENT_STOP_CONFIRMED 0x00004000 /* the robot confirmed a stop */
#define ROBUROC4_EVENT_OVERRIDE 0x00008000       /* game pad [A] was pressed or released */
#define ROBUROC4_EVENT_OTHER_COMMANDER 0x00010000   /* another client commands, or no longer */
#define ROBUROC4_EVENT_INHIBITED 0x00020000         /* the robot does not follow, or does again */
#define ROBUROC4_EVENT_BATTERY_LOW 0x00040000       /* remaining fell below minimum_percent */
#define ROBUROC4_EVENT_BATTERY_CRITICAL 0x00080000  /* state became Critical; sets battery_low */
#define ROBUROC4_EVENT_RELOCALIZED 0x00100000       /* the robot accepted the new pose */
#define ROBUROC4_EVENT_RELOCALIZE_FAILED 0x00200000 /* it did not; see relocalize_result */
#define ROBUROC4_EVENT_SUBSCRIPTION_REFUSED 0x00400000 /* the robot refused to send a status */
#define ROBUROC4_EVENT_FIXED_ID 0x00800000             /* the robot answers with 0x01 only */
#define ROBUROC4_EVENT_CLOCK 0x01000000                /* the clock went back */
#define ROBUROC4_EVENT_CAPACITY 0x02000000          /* the robot has more than the client stores */
#define ROBUROC4_EVENT_DESCRIPTIONS_DONE 0x04000000 /* every text was answered or given up */
#define ROBUROC4_EVENT_ROLE 0x08000000    /* a text identified the input for a ROBUROC4_ROLE_* */
#define ROBUROC4_EVENT_ARMABLE 0x10000000 /* arm() would now be accepted */
#define ROBUROC4_EVENT_STOP_UNCONFIRMED 0x20000000 /* a stop sequence ended, not confirmed */

/** How the last stop sequence ended: stop_outcome of roburoc4_facts. */
#define ROBUROC4_STOP_NONE 0       /* none was sent yet */
#define ROBUROC4_STOP_RUNNING 1    /* not ended, or waiting for the differential service */
#define ROBUROC4_STOP_CONFIRMED 2  /* a status proven newer than the zeros shows both targets 0 */
#define ROBUROC4_STOP_TIMED_OUT 3  /* robot_watchdog_ms passed, or no service accepted zeros */
#define ROBUROC4_STOP_OVERRIDDEN 4 /* [A] was held, so the robot may have ignored the zeros */

/** What an IO input is for, independent of its index. */
#define ROBUROC4_ROLE_OVERRIDE 0     /* digital: game pad [A] */
#define ROBUROC4_ROLE_FRONT_BUMPER 1 /* digital */
#define ROBUROC4_ROLE_REAR_BUMPER 2  /* digital */
#define ROBUROC4_ROLE_BATTERY_V 3    /* analog, volts */
#define ROBUROC4_ROLE_COUNT 4

/** In role_index: find the input by the robot's texts. The override is known once the robot gave or
 *  refused the text of every digital input, and exactly one text names [A]. If none does, the
 *  manual's table is used, but only if the robot refused that input's text and has exactly the
 *  manual's channel counts. Other roles are found by their text, else by the manual's table. A
 *  bumper may have several inputs. */
#define ROBUROC4_INDEX_AUTO (-1)
/** In iocard_id and differential_id: find the service. */
#define ROBUROC4_ID_AUTO (-1)

/** Bits of roburoc4_config.options. */
/* If a speed, or the linear one at the outer wheels, exceeds its limit, reduce both speeds by the
 * same factor: the robot stays on its curve. Where the robot reports a limit of 0, that speed is 0,
 * and the other one is kept. */
#define ROBUROC4_OPTION_KEEP_CURVATURE 0x01
/* Drive a robot of which no text names [A], such as one without a game pad. YOU know that nobody
 * will press [A]: the client does not see it.
 *   - Before it arms, the client asks for the text of every input, up to 8 s each; where it finds
 *     no IO card, also for that of every service of an unknown type.
 *   - Later it asks again for those that did not come (in fixed-id mode, while it is not armed).
 *     Once a text names [A], the client disarms until that is certain, then obeys [A].
 *   - To say "there is no [A]", set an index beyond the card's inputs. If iocard_id or an index of
 *     [A] is set, the card must be listed; if an index is set, it must report its counts.
 *   - It does not arm if the robot lists more services, or has more digital inputs, than the client
 *     stores. */
#define ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE 0x02
/* Stay armed when another client commands; also for a robot that reports ramped targets. */
#define ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER 0x04

/** Settings of a client. Fill it with roburoc4_config_init(), then change what you need. */
typedef struct roburoc4_config {
    uint32_t size; /* sizeof(roburoc4_config), set by roburoc4_config_init() */
    /** The services to subscribe to: bits 1u << ROBUROC4_SERVICE_*. Default 0x7C, all five. */
    uint32_t subscriptions;
    /** Status periods by service: a multiple of 10, 10 to 2550; the first two do not count, and the
     *  last stays 0. Defaults: IO card 50, telemeter 100, battery 1000, localization 50,
     *  differential 50.
     *  Those of IO card and differential, where subscribed: at most a third of fresh_ms. (To watch
     *  a robot less often, call roburoc4_client_subscribe() later.) */
    uint16_t period_ms[8];
    uint32_t first_retry_ms; /* first repeat of a request, doubling to 1 s; sooner where the round
                                trip is known; 10 to 100; default 100 */
    uint32_t lost_ms;  /* silence after which the robot is lost; 200 to 60000; default 1000. Raised
                          at run time to three times the shortest subscribed period, 3 s at most */
    uint32_t fresh_ms; /* a status whose greatest possible age exceeds this does not count for
                          driving; 50 to 1000; default 300 */
    uint32_t drive_period_ms;   /* period of drive commands; 10 to 500, at most half of lease_ms
                                   and of robot_watchdog_ms; default 50 */
    uint32_t lease_ms;          /* how long a drive command lasts; 20 to 1000; default 250 */
    uint32_t robot_watchdog_ms; /* the robot's own watchdog, bounds the stop sequence; 100 to 60000;
                                   default 1000 */
    float max_linear_m_s;       /* ceiling of speed, before and after scale_linear; 0.001 to 5;
                                   default 1.0 */
    float max_angular_rad_s;    /* ceiling of turn rate, likewise; 0.001 to 10; default 1.5 */
    float scale_linear;         /* drive() multiplies speeds by it; for moves: reported metres per
                                  real metre; 0.01 to 10; default 1 */
    float scale_angular;        /* likewise */
    uint32_t options;           /* ROBUROC4_OPTION_*; default 0 */
    /** By ROBUROC4_ROLE_* (the last four stay as init set them): index of the input on the wire, at
     * most 63 for a digital input and 15 for the analog one; or ROBUROC4_INDEX_AUTO (default).
     * Messages, robot files and bindings call them override_index, front_bumper_index,
     * rear_bumper_index, battery_voltage_index. */
    int16_t role_index[8];
    uint32_t lapse_disarm_ms; /* a lease that expired and was not renewed for this long disarms; 0
                                 to 60000; default 1000. What pause() ended stays armed */
    /** Ids of services on the wire, for a robot whose types and texts do not identify them; they
     *  must be in its directory. ROBUROC4_ID_AUTO (default): found by type, text, or the manual's
     *  id. */
    int32_t iocard_id, differential_id;
} roburoc4_config;

/** Set all defaults; `size` is sizeof(roburoc4_config). A program that was compiled with an older
 *  header has fewer fields, and the library gives the others their defaults. ROBUROC4_ERR_SIZE
 *  (nothing written) for a size that the library does not know. */
ROBUROC4_API roburoc4_result roburoc4_config_init(roburoc4_config *config, size_t size);
/** NULL if all values are in range, else the first bad value's name and range, for example
 *  "lease_ms: 20 to 1000". Lives as long as the program. */
ROBUROC4_API const char *roburoc4_config_error(const roburoc4_config *config);

/** Counters; they wrap around. */
#define ROBUROC4_COUNT_RECEIVED 0          /* datagrams passed to receive() */
#define ROBUROC4_COUNT_SENT 1              /* datagrams returned by poll_transmit() */
#define ROBUROC4_COUNT_RETRIES 2           /* requests sent again */
#define ROBUROC4_COUNT_SHORT 3             /* dropped: shorter than their layout */
#define ROBUROC4_COUNT_MALFORMED 4         /* dropped: unknown kind or impossible value */
#define ROBUROC4_COUNT_UNMATCHED 5         /* dropped: answers to no open request */
#define ROBUROC4_COUNT_UNEXPECTED_STATUS 6 /* dropped: statuses without a subscription */
#define ROBUROC4_COUNT_OLD 7               /* dropped: statuses not newer than the last */
#define ROBUROC4_COUNT_SURPLUS 8           /* used, with surplus bytes at their end */
#define ROBUROC4_COUNT_REFUSED 9           /* error answers */
#define ROBUROC4_COUNT_ABANDONED 10        /* requests given up after all their tries */
#define ROBUROC4_COUNT_LOST 11             /* times that the robot was lost */
#define ROBUROC4_COUNT_REBOOTS 12
#define ROBUROC4_COUNT_CLOCK_FAULTS 13
#define ROBUROC4_COUNTERS 14

/** A client. Its struct is defined at the end of this header: declare one anywhere (static, on the
 *  stack, inside your own struct), call roburoc4_client_init(), and use only functions. It may be
 *  moved or copied as plain bytes. */
typedef struct roburoc4_client roburoc4_client;

/** The library's sizeof(roburoc4_client). If it differs from yours, header and library do not
 *  match. */
ROBUROC4_API size_t roburoc4_client_size(void);

/** Initialize a client in any memory; it is idle and disarmed. A client that was driving there is
 *  forgotten, and only the robot's watchdog stops the robot, 1 s after the last command: to start
 *  over, close it first and let it send its stop sequence. client_size is sizeof(roburoc4_client);
 *  config may be NULL for all defaults. ROBUROC4_ERR_SIZE: header and library differ.
 *  ROBUROC4_ERR_CONFIG: roburoc4_config_error() names the value. After an error it is an idle
 *  client that cannot be started, armed or driven. */
ROBUROC4_API roburoc4_result roburoc4_client_init(roburoc4_client *client, size_t client_size,
                                                  const roburoc4_config *config);
/** Begin to connect. Values, counters and statistics start anew. ROBUROC4_ERR_STATE unless idle. */
ROBUROC4_API roburoc4_result roburoc4_client_start(roburoc4_client *client, uint64_t now_us);
/** Begin to close: disarms, and stays in ROBUROC4_STATE_CLOSING until the stop sequence, if any,
 *  has ended. Keep calling receive() and poll_transmit() until the state is idle: it takes at most
 *  robot_watchdog_ms or three drive periods, and as long again if [A] is released meanwhile.
 *  Further calls change nothing.
 *  Subscriptions are kept, as other clients may share them: where none does, end them before with
 *  roburoc4_client_subscribe(). ROBUROC4_ERR_STATE if idle. */
ROBUROC4_API roburoc4_result roburoc4_client_close(roburoc4_client *client, uint64_t now_us);

/** Process a datagram from the robot. The caller ensures that it comes from the robot (connect the
 *  socket). Returns 0 or more if it was used; ROBUROC4_ERR_SHORT, _KIND, _VALUE, _UNMATCHED,
 *  _UNEXPECTED_STATUS or _OLD if it was dropped and counted. A dropped datagram changes no value.
 *  It can still reveal a restart, or end a request.
 *  Cost: at most 430 instructions for a status, 360 for a differential one. */
ROBUROC4_API roburoc4_result roburoc4_client_receive(roburoc4_client *client,
                                                     const uint8_t *datagram, size_t size,
                                                     uint64_t now_us);
/** The next datagram to send: its length, or 0 if nothing is due. Call it until it returns 0, after
 *  every receive(), after every call that changes something, and at the deadline. Read the clock
 *  right before and send at once; drop what the network does not accept. A buffer of
 *  ROBUROC4_MAX_TRANSMIT bytes always suffices; ROBUROC4_ERR_BUFFER sends nothing.
 *  Cost: at most 25 instructions if nothing is due. */
ROBUROC4_API roburoc4_result roburoc4_client_poll_transmit(roburoc4_client *client, uint8_t *buffer,
                                                           size_t capacity, uint64_t now_us);
/** When to call poll_transmit() again if nothing happens before, on the clock of now_us; UINT64_MAX
 *  if idle. A time in the past means now (a timerfd then needs at least 1 ns: 0 disarms it). */
ROBUROC4_API uint64_t roburoc4_client_next_deadline(const roburoc4_client *client);
/** Return and clear the ROBUROC4_EVENT_* bits since the last call. */
ROBUROC4_API uint32_t roburoc4_client_take_events(roburoc4_client *client);
/** ROBUROC4_STATE_*. */
ROBUROC4_API uint32_t roburoc4_client_state(const roburoc4_client *client);
/** One of ROBUROC4_COUNT_*; 0 for another number. */
ROBUROC4_API uint32_t roburoc4_client_count(const roburoc4_client *client, uint32_t counter);

/* Motion. A drive command is a lease: the target holds for lease_us unless it is renewed. However
 * driving ends (lease over, pause, stop, or an automatic disarm), the stop sequence follows: zero
 * commands, one per drive period and at least three. It ends when a status
 * confirms it, or when robot_watchdog_ms has passed. A status confirms it if it shows both targets
 * 0, and was made at least 160 ms after the robot answered a request that followed the first zero.
 * Nothing confirms it while [A] is held or not known yet. It is sent again when [A] is released,
 * and for as long as a status at most 2 s old shows our target without a lease. A lease that is
 * granted meanwhile runs from its grant, but its speeds are sent only after the stop sequence,
 * usually 0.3 s: repeat the command, or the lease is over by then. The first zero after a speed is
 * sent at once; all other commands are at least a robot cycle (10 ms) apart.
 */

/** Allow driving. Returns 0, or the first reason against it: ROBUROC4_ERR_NOT_READY,
 *  _NO_DIFFERENTIAL, _LIMITS, _STALE_DIFFERENTIAL, then _STALE_IOCARD (or _SUBSCRIPTION_REFUSED,
 *  where the robot refused to send these), _OVERRIDE_UNKNOWN, _OVERRIDE, _OTHER_COMMANDER, _UPLINK
 *  (it disarmed for this reason, and the robot has answered nothing since), _MOVING. While armed,
 *  the client disarms itself as soon as one of these reasons except _MOVING applies, when the robot
 *  does not follow its speeds (_INHIBITED), when commands reach it late (_UPLINK), and
 *  lapse_disarm_ms after a lease expired (_LAPSED). Arming an armed client is fine. A ready client
 *  may not be armable yet, as the first statuses come later: ROBUROC4_EVENT_ARMABLE is raised each
 *  time arming becomes possible after it was impossible for more than a few statuses;
 *  roburoc4_pump_arm() waits for it.
 *
 *  ARM ONLY WHEN A PERSON ASKS FOR IT. Arming succeeds while an emergency stop is pressed (no
 *  status reports it): a program that arms again after each disarm sets the robot off when the
 *  stop is released. */
ROBUROC4_MUST_CHECK ROBUROC4_API roburoc4_result roburoc4_client_arm(roburoc4_client *client,
                                                                     uint64_t now_us);
/** 1 if a reason against arming may go away by itself (no answer or status yet, the robot still
 *  rolls), so that trying again makes sense; else 0, also for a value that is not a reason. */
ROBUROC4_API int32_t roburoc4_refusal_may_pass(roburoc4_result refusal);
/** The greatest speeds that drive() accepts: beyond those of any RobuROC4, so a larger one is a
 *  mistake of units. */
#define ROBUROC4_MAX_DRIVE_M_S 5.0f
#define ROBUROC4_MAX_DRIVE_RAD_S 10.0f
/** The shortest and the longest lease. */
#define ROBUROC4_MIN_LEASE_US 20000
#define ROBUROC4_MAX_LEASE_US 1000000
/** Drive at these speeds for lease_us (0: the configured lease; else within these limits) from now.
 *  The speeds are scaled, then reduced together if ROBUROC4_OPTION_KEEP_CURVATURE is set, then
 *  clamped to the robot's limits and the ceilings, which bound them before scaling, too.
 *  ROBUROC4_ERR_NOT_FINITE, _UNITS (more than ROBUROC4_MAX_DRIVE_M_S or _RAD_S), _ARGUMENT (lease),
 *  or why the client is not armed; then nothing changes.
 *  Cost: at most 450 instructions to renew. */
ROBUROC4_MUST_CHECK ROBUROC4_API roburoc4_result roburoc4_client_drive(roburoc4_client *client,
                                                                       float linear_m_s,
                                                                       float angular_rad_s,
                                                                       uint32_t lease_us,
                                                                       uint64_t now_us);
/** Stop the robot, and disarm: end the lease and send a stop sequence, armed or not, now or as soon
 *  as the differential service is known. drive() is refused (ROBUROC4_ERR_STOP_CALLED) until
 *  somebody calls arm() again. ROBUROC4_ERR_STATE if idle or closing: then nothing is to be
 *  stopped, and nothing changes. */
ROBUROC4_MUST_CHECK ROBUROC4_API roburoc4_result roburoc4_client_stop(roburoc4_client *client,
                                                                      uint64_t now_us);
/** As stop(), but stay armed: the program's own end of driving, after which it may drive() again.
 *  ROBUROC4_ERR_STATE if idle or closing. */
ROBUROC4_API roburoc4_result roburoc4_client_pause(roburoc4_client *client, uint64_t now_us);

/** The client's and the robot's current state. */
typedef struct roburoc4_facts {
    uint32_t size;           /* set by ROBUROC4_SIZED() */
    uint32_t state;          /* ROBUROC4_STATE_* */
    uint8_t armed;           /* 1: drive() is accepted */
    uint8_t driving;         /* 1: a lease is active */
    uint8_t stopping;        /* 1: a stop sequence runs or is pending */
    uint8_t override_known;  /* 1: `overridden` is valid */
    uint8_t overridden;      /* 1: game pad [A] is held */
    uint8_t other_commander; /* 1: the robot reports a target that is not ours: another client
                                commands it, or has left one behind, which stop() clears */
    uint8_t inhibited;       /* 1: the robot does not follow its target (emergency stop, brakes,
                                bumper); this disarms. If the robot drops commands, the client disarms
                                for the same cause, but this stays 0 */
    uint8_t fixed_id;        /* 1: the robot answers every request with 0x01 */
    uint8_t front_bumper;    /* 1: pressed, by the last IO status; of several inputs, any */
    uint8_t rear_bumper;
    uint8_t front_bumper_known; /* 1: `front_bumper` is valid: its input is known (the program
                                    set it; or every text was given or refused, and one names it
                                    or that of the manual's input was refused), and a status has
                                    come since */
    uint8_t rear_bumper_known;  /* likewise */
    uint8_t battery_low;       /* 1: remaining is below minimum_percent, or the state is Critical */
    uint8_t battery_known;     /* 1: `battery_low` is valid, from the next status after the minimum
                                  arrived */
    uint8_t descriptions_done; /* 1: every text was answered or given up */
    uint8_t lapsed;            /* 1: the last lease expired before anything else ended it; 0 again
                                  after pause(), stop(), arm() or drive() */
    uint8_t stop_outcome;      /* ROBUROC4_STOP_* of the last stop sequence */
    uint8_t missing; /* subscriptions without data: bits 1u << ROBUROC4_SERVICE_* of services that
                        the robot does not list, or whose subscription it refused, or did not
                        acknowledge yet after five requests */
    uint8_t reserved[2];
    int32_t disarm_cause; /* why the client is not armed; 0 while armed */
    int32_t arm_refusal;  /* what roburoc4_client_arm() would return */
    /** Of roburoc4_client_relocalize(): 0, or why it failed; ROBUROC4_ERR_NOT_KNOWN before the
     * first, and until it is answered. */
    int32_t relocalize_result;
    uint32_t lease_left_us;                    /* 0 when not driving */
    float sent_linear_m_s, sent_angular_rad_s; /* sent last, scaled; 0 after a stop */
    uint32_t age_us[8]; /* by ROBUROC4_SERVICE_*: how old the last status can be at most, now;
                           UINT32_MAX if there is none, or it is from before the robot was found */
} roburoc4_facts;
/** Ages, `driving`, `lapsed` and `lease_left_us` are computed for now_us. The rest, such as
 *  `armed`, is as of the last poll_transmit(), arm() or drive(): after a hang, poll first.
 *  ROBUROC4_ERR_SIZE for a size that the library does not know.
 *  Cost: at most 950 instructions. */
ROBUROC4_API roburoc4_result roburoc4_client_facts(const roburoc4_client *client, uint64_t now_us,
                                                   roburoc4_facts *out);

/* Services and properties. ROBUROC4_ERR_NOT_KNOWN until the robot has reported it. */

/** Entry `index` of the directory; at most ROBUROC4_MAX_SERVICES are stored. ROBUROC4_ERR_INDEX
 *  beyond the last one, and before the robot has reported its directory. */
ROBUROC4_API roburoc4_result roburoc4_client_service_at(const roburoc4_client *client,
                                                        uint32_t index,
                                                        roburoc4_directory_entry *out);
/** The wire id of ROBUROC4_SERVICE_*, or ROBUROC4_ERR_NOT_KNOWN. */
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
/** Telemeter `index` of at most ROBUROC4_MAX_TELEMETERS: mounting, range, and the latest distance
 *  (before the first status, that of the properties; NaN if statuses have none for it).
 *  ROBUROC4_ERR_INDEX if there is none, as before the robot has reported its telemeters. */
ROBUROC4_API roburoc4_result roburoc4_client_telemeter(const roburoc4_client *client,
                                                       uint32_t index, roburoc4_telemeter *out);

/** A text from the robot: what the protocol calls a description (4.2.3). */
typedef struct roburoc4_description {
    const uint8_t *text; /* a view on the datagram; not NUL-terminated */
    uint32_t length;
    int32_t io_type; /* ROBUROC4_IO_*, or -1 for a service of the directory */
    uint32_t index;  /* of the channel, or of the directory's entry */
} roburoc4_description;
/** What a datagram describes, right after its receive() raised ROBUROC4_EVENT_DESCRIPTION.
 *  ROBUROC4_ERR_NOT_KNOWN if the last datagram was not a description. */
ROBUROC4_API roburoc4_result roburoc4_client_description(const roburoc4_client *client,
                                                         const uint8_t *datagram, size_t size,
                                                         roburoc4_description *out);

/** The wire index of the input with ROBUROC4_ROLE_*, the lowest if a bumper has several.
 *  ROBUROC4_ERR_NOT_KNOWN, or _ARGUMENT for no such role. */
ROBUROC4_API roburoc4_result roburoc4_client_role_index(const roburoc4_client *client,
                                                        uint32_t role);
/** The manual's name (5.5.1) of a channel of this robot's IO card, for channels without a text of
 * their own. It takes the number of channels and the roles above into account; with a NULL client
 * it is that of the manual's table. NULL if the manual has no name for it, "" if it "exists but is
 * not used". */
ROBUROC4_API const char *roburoc4_client_channel_name(const roburoc4_client *client,
                                                      uint32_t io_type, uint32_t index);
/** The index of the channel with this name. Names are compared by words, ignoring case, punctuation
 *  and order. A channel's name is the robot's text, texts[index] (NUL-terminated; NULL or "" if
 *  there is none; texts may be NULL), else the name above; the manual's name of an input with a
 *  role always finds that input. ROBUROC4_ERR_INDEX if no channel has the name, _VALUE if several
 *  do, _NOT_KNOWN before the robot has reported its channels. */
ROBUROC4_API roburoc4_result roburoc4_client_channel_find(const roburoc4_client *client,
                                                          uint32_t io_type, const char *name,
                                                          const char *const *texts,
                                                          uint32_t text_count);
/** Set which input has a role (ROBUROC4_INDEX_AUTO: find it). The override is unknown until the
 *  next IO card status, so an armed client disarms. ROBUROC4_ERR_ARGUMENT: no such role, or
 *  an index beyond the client's capacity. */
ROBUROC4_API roburoc4_result roburoc4_client_set_role_index(roburoc4_client *client, uint32_t role,
                                                            int32_t index, uint64_t now_us);

/* Values: the latest status of each service; inputs are those of the IO card, distances those of
 * the telemeters. ROBUROC4_ERR_NOT_KNOWN before the first. *host_us is set to the host time at
 * which the status was received; host_us may be NULL. */

/** Volts are no part of it: read the analog input that has ROBUROC4_ROLE_BATTERY_V. */
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
    uint64_t digital;                         /* bit i is digital input i */
    float analog[ROBUROC4_MAX_ANALOG_INPUTS]; /* generally volts; game pad axes -1 to 1 */
    uint32_t analog_count, digital_count;     /* stored channels */
} roburoc4_inputs;
ROBUROC4_API roburoc4_result roburoc4_client_inputs(const roburoc4_client *client,
                                                    roburoc4_inputs *out, uint64_t *host_us);
/** All distances (frozen). */
typedef struct roburoc4_distances {
    uint64_t robot_cycles;
    float distances_m[ROBUROC4_MAX_TELEMETERS];
    uint32_t count; /* of the telemeters; while they are not known, as many as the status holds */
    uint32_t reserved;
} roburoc4_distances;
ROBUROC4_API roburoc4_result roburoc4_client_distances(const roburoc4_client *client,
                                                       roburoc4_distances *out, uint64_t *host_us);

/* Outputs. A command carries all outputs, and the robot does not report them: outputs that were
 * not set since the client or the robot started are sent as 0. Each change is sent three times. */

/** Set the digital outputs selected by `mask` to their bits in `values`, in one datagram; all or
 *  none. ROBUROC4_ERR_NOT_KNOWN before the counts are known, _RESERVED for output 0, _NOT_READY,
 *  _INDEX beyond the last, and on a card with more outputs than the client has room for. */
ROBUROC4_API roburoc4_result roburoc4_client_set_digital_outputs(roburoc4_client *client,
                                                                 uint64_t mask, uint64_t values,
                                                                 uint64_t now_us);
/** Set analog output `index` to `value`, generally volts. ROBUROC4_ERR_NOT_FINITE, or as above. */
ROBUROC4_API roburoc4_result roburoc4_client_set_analog_output(roburoc4_client *client,
                                                               uint32_t index, float value,
                                                               uint64_t now_us);

/** Set the robot's pose (REPLACE, 4.2.6.5). The request is sent at once. While the robot is
 *  at rest by fresh statuses, it is repeated for up to 2 s. Once the robot has moved, it is not
 *  repeated, and fails unless the first one is answered within 0.25 s; the robot may have taken it.
 *  Failures (relocalize_result): ROBUROC4_ERR_MOVING, _STALE_DIFFERENTIAL (statuses were not fresh
 *  meanwhile), _TIMEOUT (no answer), _ROBOT (refused). A later call replaces it; in fixed-id mode
 *  (`fixed_id`) wait for the previous one: its late answer would count. It ends with
 *  ROBUROC4_EVENT_RELOCALIZED or _RELOCALIZE_FAILED, unless the client is closed. Repeats that are
 *  still queued in the network can set the pose again. ROBUROC4_ERR_NOT_FINITE,
 *  _UNITS (more than two turns: degrees?), _NOT_READY, _NOT_KNOWN (no localization service). */
ROBUROC4_API roburoc4_result roburoc4_client_relocalize(roburoc4_client *client, double x_m,
                                                        double y_m, double theta_rad,
                                                        uint64_t now_us);

/** Subscribe to a service (ROBUROC4_SERVICE_IOCARD to _DIFFERENTIAL) or change its period: a
 *  multiple of 10, 10 to 2550 ms. A period of 0 ends the subscription: statuses that still come
 *  are counted and dropped. The setting persists when the robot is lost and found again.
 *  ROBUROC4_ERR_ARGUMENT. */
ROBUROC4_API roburoc4_result roburoc4_client_subscribe(roburoc4_client *client, uint32_t service,
                                                       uint32_t period_ms, uint64_t now_us);

/** Statistics of the link. */
typedef struct roburoc4_link {
    uint32_t size;          /* set by ROBUROC4_SIZED() */
    uint32_t round_trip_us; /* smoothed, of answered requests; 0 before the first */
    uint32_t round_trip_min_us;
    uint32_t silence_us;     /* time since the last datagram that was used */
    uint32_t received, lost; /* statuses of all services since start() */
    float loss;              /* share of recent statuses that did not arrive, 0 to 1 */
    uint32_t reserved;
} roburoc4_link;
/** ROBUROC4_ERR_SIZE for a size that the library does not know. */
ROBUROC4_API roburoc4_result roburoc4_client_link(const roburoc4_client *client, uint64_t now_us,
                                                  roburoc4_link *out);
/** Statistics of one service's statuses. */
typedef struct roburoc4_service_link {
    uint32_t size;             /* set by ROBUROC4_SIZED() */
    uint32_t subscribed;       /* 1: wanted, and not refused */
    uint32_t received;         /* used statuses since start() */
    uint32_t lost;             /* gaps in the observed period, minus late ones */
    uint32_t late, duplicates; /* received, but dropped */
    uint32_t period_us;        /* observed; at first the requested one */
    uint32_t jitter_us;        /* smoothed deviation of arrival from robot time (RFC 3550, 6.4.1) */
    uint32_t age_us; /* upper bound of the last status's age; UINT32_MAX before the first */
    float loss;      /* share of recent statuses that did not arrive, 0 to 1 */
} roburoc4_service_link;
/** ROBUROC4_ERR_ARGUMENT: a service without statuses; ROBUROC4_ERR_SIZE as above. */
ROBUROC4_API roburoc4_result roburoc4_client_service_link(const roburoc4_client *client,
                                                          uint32_t service, uint64_t now_us,
                                                          roburoc4_service_link *out);
/** The host time at which the robot's clock showed robot_cycles, estimated from the statuses of the
 *  last seconds and half of the shortest round trip. For UTC, add what CLOCK_REALTIME is ahead of
 *  roburoc4_udp_now_us(). ROBUROC4_ERR_NOT_KNOWN before the first. */
ROBUROC4_API roburoc4_result roburoc4_client_host_time(const roburoc4_client *client,
                                                       uint64_t robot_cycles, uint64_t *host_us);

/* ------------------------------------------------------------------------- private layout --- */
/* Everything from here on may change with any version, except sizeof(roburoc4_client). */

typedef struct roburoc4_private_timer {
    uint32_t now_us, wait_us;
} roburoc4_private_timer;

typedef struct roburoc4_private_ask {
    uint16_t target, subject;
    uint8_t action, kind, detail, max_tries;
} roburoc4_private_ask;

typedef struct roburoc4_private_slot {
    roburoc4_private_ask ask;
    uint8_t open, id, tries, ones;
    uint32_t wait_us, sent_us;
} roburoc4_private_slot;

typedef struct roburoc4_private_requests {
    uint8_t last_id, fixed_id, id_mode, quiet, announce, single_texts;
    uint16_t slowest_ms;
    uint32_t quiet_span_us, quiet_since_us;
    roburoc4_private_slot slots[4];
} roburoc4_private_requests;

typedef struct roburoc4_private_service {
    uint8_t gap_count, fresh, renewed, reserved;
    uint16_t period_cycles, gap_min;
    uint64_t robot_cycles, received_us, seen;
    uint32_t received, lost, late, duplicates;
    uint16_t recent, recent_lost; /* statuses: received or lost; lost */
    uint32_t jitter_us;
} roburoc4_private_service;

typedef struct roburoc4_private_link {
    uint8_t back_count, was_lost, mapped, answered;
    uint32_t floor_age_us;
    uint64_t newest_cycles, floor_us, proven_us;
    int64_t offset_us, offset_before_us;
    uint32_t offset_since_us, last_used_us, asked_us, heard_us, card_inserted_us;
    uint8_t contradicted, reserved;
    uint16_t lowered;
    uint32_t round_trip_us, round_trip_min_us;
    uint32_t excess_us, excess_since_us, slack_us, contradicted_us;
    roburoc4_private_service services[5];
} roburoc4_private_link;

typedef struct roburoc4_private_follow {
    int32_t mean[2], low[2], high[2];
    uint16_t cycles;
    int8_t still_cycles[2];
    uint8_t fault_cycles, fault, watching, reserved;
} roburoc4_private_follow;

typedef struct roburoc4_private_drive {
    uint8_t known, armed, lease_active, stopping;
    uint8_t stop_pending, nonzero_sent, zeros_sent, confirmed;
    uint8_t other_count, other_commander, overridden, inhibited;
    uint8_t changed, lapsed, outcome, unconfirmed;
    uint8_t echo_due, in_flight;
    uint16_t service;
    uint32_t lease_us, granted_us, sent_us, stop_us, envelope_us;
    uint32_t reached_us; /* when what last reached the robot was sent */
    int32_t disarm_cause;
    uint32_t expected_us, shown_cycles;
    float target[2], sent[2];
    float low[2], high[2], low_before[2], high_before[2];
    float echoed[2], echo_low[2], echo_high[2];
    roburoc4_private_follow follow;
} roburoc4_private_drive;

typedef struct roburoc4_private_discovery {
    uint8_t service_count, listed, known, refused;
    uint8_t identified, texts_done, described_kind, table_refused;
    uint16_t described_index;
    uint16_t service_ids[7];
    uint64_t described[5], given_up[5];
    int16_t role_texts[4];
    uint16_t types[ROBUROC4_MAX_SERVICES], ids[ROBUROC4_MAX_SERVICES];
    uint8_t claims[ROBUROC4_MAX_SERVICES];
    uint8_t text_due, doubted, doubted_list, doubted_roles;
    uint16_t doubted_index;
    uint8_t truncated, reserved; /* truncated: the robot lists more services than fit */
    uint64_t bumpers[2];
} roburoc4_private_discovery;

typedef struct roburoc4_private_subscriptions {
    uint8_t inserted, acked, declined, denied, leaving, reserved[3];
    uint32_t refused_us, inserted_us[5];
} roburoc4_private_subscriptions;

typedef struct roburoc4_private_schedule {
    uint32_t phase_us, probe_us;
    uint8_t probe_kind, text_first, reserved[2];
} roburoc4_private_schedule;

typedef struct roburoc4_private_conditions {
    uint8_t override_known, overridden, armable, reserved;
} roburoc4_private_conditions;

typedef struct roburoc4_private_values {
    uint8_t battery_low, telemeter_count, distance_count, reserved[5];
    roburoc4_localization_properties localization_properties;
    roburoc4_localization_status localization;
    roburoc4_differential_status differential;
    roburoc4_battery_status battery;
    uint64_t digital;
    int32_t io_counts[4];
    roburoc4_differential_properties limits;
    roburoc4_battery_properties battery_properties;
    float analog[ROBUROC4_MAX_ANALOG_INPUTS], distances[ROBUROC4_MAX_TELEMETERS];
    float telemeters[ROBUROC4_MAX_TELEMETERS][6]; /* as roburoc4_telemeter, without distance_m */
    uint32_t padding;                             /* where a uint64_t is aligned to 4 bytes, too */
} roburoc4_private_values;

typedef struct roburoc4_private_outputs {
    uint8_t repeats, relocalizing, moved, unwatched;
    int32_t relocalize_result;
    uint32_t sent_us, relocalize_us;
    uint64_t digital;
    double x_m, y_m, theta_rad;
    float analog[ROBUROC4_MAX_ANALOG_OUTPUTS];
} roburoc4_private_outputs;

struct roburoc4_client {
    uint64_t private_now_us, private_idle_until_us;
    roburoc4_private_timer private_timer;
    uint32_t private_events;
    uint16_t private_size, private_state;
    roburoc4_config private_config;
    roburoc4_private_conditions private_conditions;
    roburoc4_private_drive private_drive;
    roburoc4_private_schedule private_schedule;
    roburoc4_private_subscriptions private_subscriptions;
    roburoc4_private_discovery private_discovery;
    roburoc4_private_requests private_requests;
    uint32_t private_counters[14];
    roburoc4_private_outputs private_outputs;
    roburoc4_private_link private_link;
    roburoc4_private_values private_values;
    uint32_t private_answered_us; /* when the last request was answered */
    uint32_t private_driven_us;   /* when a lease was last active */
    uint32_t private_reserved[4];
};

#ifdef __cplusplus
}
#endif

#endif
