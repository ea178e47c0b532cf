/* SPDX-License-Identifier: MIT
 *
 * The state machines of a client. Each keeps its own part of roburoc4_client and knows nothing of
 * the whole. Discovery gets the open requests, so that nothing is requested twice; drive asks
 * follow and link; subscriptions reads what discovery and link know:
 *
 *   requests.c   request ids, retries, matching of answers
 *   link.c       statuses in order, loss, jitter, clock mapping, reboot
 *   drive.c      arming, lease, limits, stop sequence: it alone decides which speeds are sent
 *   follow.c     whether the robot follows its targets
 *   discovery.c  which service has which id, which texts are missing, which input is what
 *   subscriptions.c  which are wanted, requested, accepted, refused, and which fell silent
 */
#ifndef ROBUROC4_MACHINES_H
#define ROBUROC4_MACHINES_H

#include "roburoc4.h"

#include <stdbool.h>
#include <string.h>

/* 32 bits even where int has 16: products with settings are times. */
#define MS UINT32_C(1000)
#define SECOND UINT32_C(1000000)
/* Index of the five services with a status, from IO card 0 to differential 4. */
#define STATUS_SERVICES 5
#define STATUS_INDEX(service) ((service)-ROBUROC4_SERVICE_IOCARD)

/* ---- options of a build: roburoc4.h says what each does ---- */

#ifdef ROBUROC4_NO_TEXTS
#define WITH_TEXTS false
#else
#define WITH_TEXTS true
#endif
#ifdef ROBUROC4_NO_STATISTICS
#define WITH_STATISTICS false
#else
#define WITH_STATISTICS true
#endif
#ifdef ROBUROC4_NO_FIXED_ID
#define WITH_FIXED_ID false
#else
#define WITH_FIXED_ID true
#endif

/* Seldom called, and so kept out of its caller, which would save registers for it each time. */
#if defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#define APART static __attribute__((noinline))
#else
#define APART static
#endif

/* ---- time ---- */

/* Each time this bit of the clock changes, older time stamps are pulled up to OLDEST_US, so that no
 * age ever reaches 2^31 us. */
#define AGES_BITS 29
#define OLDEST_US (UINT32_C(1) << 30)
/* Longer pauses between two calls are told to the link: the clock may have jumped. */
#define PAUSE_US (100 * MS)

/** The time of the current call, and the shortest time until something that this poll asked about
 * becomes due. A poll that sends nothing has asked about everything, so that is the client's
 * deadline.
 *
 * Inside, times have 32 bits, and how long ago something was is a difference of two of them: the
 * client sees to it that none is longer than 2^31 us (see_time). Only the link
 * maps clocks, with 64 bits. A function that asks whether something is due takes a timer; one that
 * only notes the time takes now_us; those that take a client use private_timer, whose time is that
 * of the call. */
typedef roburoc4_private_timer timer;

/** Whether so much time has passed; if not, it will be due when it has. */
static inline bool reached(timer *t, uint32_t passed_us, uint32_t span_us) {
    if (passed_us >= span_us) {
        return true;
    }
    t->wait_us = span_us - passed_us < t->wait_us ? span_us - passed_us : t->wait_us;
    return false;
}

/** Whether something is due this long after that. */
static inline bool due(timer *t, uint32_t since_us, uint32_t span_us) {
    return reached(t, t->now_us - since_us, span_us);
}

/** Of a period that is a multiple of 10 ms and at most 2550: how many cycles it is. Dividing is a
 * large function on small machines. */
static inline uint32_t cycles_of(uint32_t period_ms) {
    return period_ms * 205 >> 11;
}

static inline uint32_t clipped(uint64_t span_us) {
    return span_us < UINT32_MAX ? (uint32_t)span_us : UINT32_MAX;
}

/* ---- the inputs that the client looks for itself ---- */

/** ROBUROC4_IO_* of a role's input. */
static inline uint32_t role_type(uint32_t role) {
    return role == ROBUROC4_ROLE_BATTERY_V ? ROBUROC4_IO_ANALOG_INPUT : ROBUROC4_IO_DIGITAL_INPUT;
}

/** How many inputs of a role's type a client stores. */
static inline int32_t role_capacity(uint32_t role) {
    return role == ROBUROC4_ROLE_BATTERY_V ? ROBUROC4_MAX_ANALOG_INPUTS
                                           : ROBUROC4_MAX_DIGITAL_INPUTS;
}

/** The place of a role's input in the manual's table (5.5.1). */
static inline int32_t role_place(uint32_t role) {
    return role == ROBUROC4_ROLE_OVERRIDE       ? ROBUROC4_DI_PAD_A
           : role == ROBUROC4_ROLE_FRONT_BUMPER ? ROBUROC4_DI_FRONT_BUMPER
           : role == ROBUROC4_ROLE_REAR_BUMPER  ? ROBUROC4_DI_REAR_BUMPER
                                                : ROBUROC4_AI_BATTERY_V;
}

/** The index of the channel at a place of the manual's table, on a card with `count` channels of
 * this type; -1 unless it has exactly as many as the table, or one more: the table skips number 02,
 * so then its numbers are the indexes. */
int32_t roburoc4_table_index(uint32_t io_type, int32_t count, int32_t place);

/* ---- config.c ---- */

/** Check a program's settings (NULL for the defaults) and copy them; false if a value is out of
 * range. Fields that an older program does not know get their defaults. */
bool roburoc4_config_load(roburoc4_config *out, const roburoc4_config *config);

/* ---- requests ---- */

#define REQUEST_FOREVER 0 /* as max_tries */

/** What to ask; the id is chosen when it is sent.
 *    action              of the request
 *    kind                the service it is about, ROBUROC4_SERVICE_*
 *    detail              io_type of a QUERY, period_cycles of an INSERT
 *    max_tries           or REQUEST_FOREVER
 *    target              service id on the wire
 *    subject             index of a QUERY, service id of an INSERT or DELETE */
typedef roburoc4_private_ask ask;
typedef roburoc4_private_slot slot;
typedef roburoc4_private_requests requests;

/** Whether the robot answers every request with 0x01. */
static inline bool in_fixed_id_mode(const requests *r) {
    return WITH_FIXED_ID && r->fixed_id;
}
/** Close all requests and leave fixed-id mode. `announce` is set on entering that mode; the client
 * clears it. */
void roburoc4_requests_clear(requests *r);
void roburoc4_requests_cancel_all(requests *r, uint32_t now_us);
/** Whether another request may be opened now with `keep` left free after it. */
bool roburoc4_requests_has_room(const requests *r, uint32_t keep);
/** Whether a request for a text is open. */
bool roburoc4_requests_text_open(const requests *r);
/** Whether a text may be requested now. */
bool roburoc4_requests_has_room_for_text(const requests *r);
bool roburoc4_requests_is_open(const requests *r, const ask *a);
/** Open a request; false if it is open already or there is no room. */
bool roburoc4_requests_begin(requests *r, const ask *a);
/** End an open request without an answer. An error that does not name its request may still refuse
 * it, and must not be taken for a text's. */
void roburoc4_requests_abandon(requests *r, slot *s, uint32_t now_us);
void roburoc4_requests_cancel(requests *r, uint8_t action, uint8_t kind, uint32_t now_us);
/** The next request that must be sent or repeated now, or NULL; valid as that of match(). If its
 * tries are used up it is closed and stored in *given_up instead. */
slot *roburoc4_requests_due(requests *r, uint32_t first_retry_ms, uint32_t round_trip_us, timer *t,
                            slot **given_up);
/** The open request to which this answer (at least 5 bytes) or error telegram (at least 1) belongs,
 * or NULL. The pointer is valid until the next call that takes `requests *`: closing, cancelling
 * and fixed-id mode use the slot anew, so copy what is needed longer. */
slot *roburoc4_requests_match(requests *r, const uint8_t *datagram, size_t size, uint32_t now_us);
void roburoc4_requests_close(requests *r, slot *s, uint32_t now_us);
/** Send no text (in fixed-id mode: nothing) until no answer to another try of this request can
 * still arrive; NULL: as after an error that does not name its request. */
void roburoc4_requests_be_quiet(requests *r, const slot *s, uint32_t now_us);
/** Stop asking for texts of the first `lists` lists, and wait until no answer can still arrive. */
void roburoc4_requests_cancel_texts(requests *r, uint32_t lists, uint32_t now_us);
/** After a clock fault: make everything due. */
void roburoc4_requests_rebase(requests *r, uint32_t now_us);

/* ---- link ---- */

/* A pose that the robot accepts later than this is an old one, unless it has been at rest. */
#define POSE_TAKEN_US (250 * MS)

typedef enum verdict { VERDICT_NEW, VERDICT_OLD, VERDICT_REBOOT } verdict;

/** Expect statuses anew after a loss, and keep what was learned of clocks in case it is the same
 * robot. */
void roburoc4_link_restart(roburoc4_private_link *l, const roburoc4_config *config);
/** Forget what was learned by comparing the clocks of host and robot: it is another one now. */
void roburoc4_link_forget_times(roburoc4_private_link *l, uint32_t now_us);
/** This much time passed between two calls: the clock may have jumped by it. */
void roburoc4_link_pause(roburoc4_private_link *l, uint64_t pause_us);
/** A status of a subscription that an earlier client made: only its time is used. */
void roburoc4_link_overhear(roburoc4_private_link *l, uint64_t robot_cycles, uint64_t now_us);
/** The ids may now belong to other services: no stored status is fresh. */
void roburoc4_link_invalidate(roburoc4_private_link *l);
/** The robot accepted the requested period: measure loss against it until another is observed. */
void roburoc4_link_expect(roburoc4_private_link *l, uint32_t index, uint32_t period_ms);
/** The service was subscribed to again: whether it was heard since. */
void roburoc4_link_renewed(roburoc4_private_link *l, uint32_t index, uint32_t now_us);
bool roburoc4_link_heard(const roburoc4_private_link *l, uint32_t index);
/** Judge a status of a service; a new one is counted in the statistics. */
verdict roburoc4_link_status(roburoc4_private_link *l, roburoc4_private_service *s,
                             uint64_t robot_cycles, uint64_t now_us);
/** The answer to a request sent at `sent_us` arrived now. Texts may take long on a robot whose
 * other answers are prompt, so that they bound no age. */
void roburoc4_link_round_trip(roburoc4_private_link *l, bool text, uint32_t sent_us,
                              uint32_t now_us);
/** Upper bound of the last status's age; UINT32_MAX is longer than that. */
uint32_t roburoc4_link_age(const roburoc4_private_link *l, uint32_t index, uint64_t now_us);
/** The same when it arrived. */
uint32_t roburoc4_link_age_at_arrival(const roburoc4_private_link *l, uint32_t index);
/** Whether the last status is certainly younger than `limit_us`. */
bool roburoc4_link_fresh(const roburoc4_private_link *l, uint32_t index, uint32_t limit_us,
                         uint64_t now_us, timer *t);
/** The clock went back to now. */
void roburoc4_link_rebase(roburoc4_private_link *l, uint32_t now_us);

/* ---- drive ---- */

typedef roburoc4_private_drive drive;
typedef roburoc4_private_follow follow;

/* m/s and rad/s are treated alike, axis by axis. */
enum { LINEAR, ANGULAR, AXES };

/** Whether the robot's limits are plausible. */
bool roburoc4_drive_limits_valid(const roburoc4_differential_properties *limits);
void roburoc4_drive_arm(drive *d, uint32_t *events);
/** Grant a lease, or return why not; the caller has checked that the speeds are finite. A lease was
 * last active at `driven_us`. */
roburoc4_result roburoc4_drive_grant(drive *d, const float *target, uint32_t lease_us,
                                     uint32_t driven_us, uint32_t now_us);
/** End the lease and disarm for this cause; a stop sequence if a speed was sent. */
void roburoc4_drive_interrupt(drive *d, roburoc4_result cause, uint32_t *events);
/** End the lease and stay armed; a stop sequence in any case. */
void roburoc4_drive_pause(drive *d);
/** The same, and disarm. */
void roburoc4_drive_stop(drive *d, uint32_t *events);
/** [A] on the game pad is held, or not, by a status of this time; `known`: it can be seen. */
void roburoc4_drive_override(drive *d, bool overridden, bool known, uint32_t cycles);
/** Whether commands did not arrive, and nothing shows yet that they do again. */
bool roburoc4_drive_is_cut_off(const drive *d);
/** Whether only a request that is sent from now on can prove that the zeros arrived. */
bool roburoc4_drive_asks(const drive *d, timer *t);
/** The robot seems to have received something that was sent at this time. */
void roburoc4_drive_heard(drive *d, uint32_t sent_us);
/** The same, for certain: it is known since now_us. */
void roburoc4_drive_arrived(drive *d, uint32_t sent_us, uint32_t now_us);
/** Advance the time: end an expired lease, and disarm if `refusal` is set, or for a reason of the
 *  drive state machine's own. */
void roburoc4_drive_tick(drive *d, const roburoc4_config *config, roburoc4_result refusal, timer *t,
                         uint32_t *events);
/** Whether a speed command must be sent now, and its speeds. */
bool roburoc4_drive_poll(drive *d, const roburoc4_config *config,
                         const roburoc4_differential_properties *limits, timer *t, float *speeds,
                         uint32_t *events);
/* [A] on the game pad: released; no status of the inputs as new as that of the speeds; held. */
typedef enum pad_state { PAD_RELEASED, PAD_NOT_SEEN, PAD_HELD } pad_state;
/** A status arrived; how old it is at most, the link knows. */
void roburoc4_drive_status(drive *d, const roburoc4_config *config,
                           const roburoc4_differential_status *status, pad_state pad,
                           const roburoc4_private_link *l, uint32_t now_us, uint32_t *events);
/** Known: it can be driven at this id. Not known: a pending stop sequence still goes to the old id;
 * a changed id gets nothing. */
void roburoc4_drive_service(drive *d, bool known, uint16_t id);
/** Whether the robot moves, or is to move, by this status. */
bool roburoc4_drive_moving(const roburoc4_differential_status *status);

/* ---- follow ---- */

/** Begin to judge a robot that is at rest, unless it is judged already. */
void roburoc4_follow_begin(follow *f);
/* Values of watching: a robot that is armed is at rest, give or take the tolerance. */
enum { WATCHING_NOTHING, WATCHING_FROM_REST, WATCHING };
/** Nothing is to be judged: instead of roburoc4_follow_status(), which begins with its speed then.
 */
static inline void follow_pause(follow *f, const roburoc4_differential_status *status) {
    f->watching = WATCHING_NOTHING;
    f->cycles = (uint16_t)status->robot_cycles;
}
/** The robot has these targets from now on, which statuses may miss if they soon change again. */
void roburoc4_follow_sent(follow *f, const float *targets);
/** Judge a status: whether the robot has not followed these targets for a while. NULL: it has none
 * to follow now. */
bool roburoc4_follow_status(follow *f, const float *targets,
                            const roburoc4_differential_status *status);

/** Bits of battery_low; JUDGED: the minimum is known. */
enum {
    BATTERY_CRITICAL = 1,
    BATTERY_BELOW_MINIMUM = 2,
    BATTERY_LOW = BATTERY_CRITICAL | BATTERY_BELOW_MINIMUM,
    BATTERY_JUDGED = 4
};

/* ---- discovery ---- */

typedef roburoc4_private_discovery discovery;

#define CLAIM_NONE 0xFF  /* the text was not read, or is not trusted */
#define CLAIM_OTHER 0xFE /* the text names no service that the client uses */
#define CLAIM_DOUBT 0xFD /* the text came in fixed-id mode and may belong to another request */
#define CLAIM_REFUSED 0xFC
#define ROLE_TEXT_NONE (-1)
#define ROLE_TEXT_AMBIGUOUS (-2)

void roburoc4_discovery_clear(discovery *d);
/** Request everything again except the texts that were answered. */
void roburoc4_discovery_restart(discovery *d);
/** The IO card changed: forget its channels' texts. */
void roburoc4_discovery_forget_inputs(discovery *d);
/** Forget the texts and request them again. */
void roburoc4_discovery_read_texts_again(discovery *d);
/** Whether this directory equals the stored one. */
bool roburoc4_discovery_same(const discovery *d, const roburoc4_directory *directory);
/** Store the directory; true if it lists more services than fit. */
bool roburoc4_discovery_directory(discovery *d, const roburoc4_directory *directory);
/** Whether the directory lists this id and it may be the differential service. */
bool roburoc4_discovery_may_drive(const discovery *d, const roburoc4_config *config, uint16_t id);
/** Whether the directory has a service that neither settings, type nor text identify for certain.
 */
bool roburoc4_discovery_doubtful(const discovery *d, const roburoc4_config *config);
/** Assign ids to services; true if a known service has another id now. */
bool roburoc4_discovery_identify(discovery *d, const roburoc4_config *config);
/** A text arrived for an entry of the directory, or (io_type 0 to 3) for a channel. True if an
 * input with a role was found. */
bool roburoc4_discovery_text(discovery *d, uint32_t list, uint32_t index, const uint8_t *text,
                             uint32_t length);
/** The text of an entry of the directory arrived, but may belong to another request: it
 * identifies no service. */
void roburoc4_discovery_doubtful_text(discovery *d, uint32_t index);
/** The robot refused to give a text, which is an answer, too. */
void roburoc4_discovery_text_refused(discovery *d, const int32_t *io_counts, uint32_t list,
                                     uint32_t index);
/** The roles whose input this text of a channel names, as bits 1 << role. */
uint8_t roburoc4_discovery_roles(uint32_t list, const uint8_t *text, uint32_t length);
/** Instead of roles: the robot refused to give the text. */
#define TEXT_REFUSED 0x80
/** This answer seems to be that of a channel, but may belong to another request: it counts once it
 * is believed. */
void roburoc4_discovery_doubt(discovery *d, uint32_t list, uint32_t index, uint8_t roles);
/** Nothing contradicted the doubted answer in time. True if an input with a role was found. */
bool roburoc4_discovery_believe(discovery *d, const int32_t *io_counts);
/** No answer came: the text is missing, and is requested again later. */
void roburoc4_discovery_text_given_up(discovery *d, uint32_t list, uint32_t index);

#define TEXT_TRIES 10 /* given up after 7.5 s (at the default first_retry_ms) */
/** Texts to request: of services that nothing else identifies; also of digital inputs; all. */
typedef enum text_choice { TEXTS_OF_SERVICES, TEXTS_THAT_DECIDE, TEXTS_ALL } text_choice;
/** The next text to request; false if all that remain are open. */
bool roburoc4_discovery_next_text(const discovery *d, const requests *r, const int32_t *io_counts,
                                  text_choice choice, ask *out);
/** Whether all texts were answered or given up. */
bool roburoc4_discovery_texts_passed(const discovery *d, const int32_t *io_counts);
/** Whether all texts were answered or given up that are needed to identify services. */
bool roburoc4_discovery_services_passed(const discovery *d);
/** Whether all texts of digital inputs were answered or given up. */
bool roburoc4_discovery_inputs_passed(const discovery *d, const int32_t *io_counts);
/** Once all texts were answered or given up: allow one more request for a missing one. */
void roburoc4_discovery_ask_again(discovery *d, const int32_t *io_counts);
/** Index of the input with a role, or ROBUROC4_ERR_NOT_KNOWN. In fixed-id mode, text and table must
 * agree on [A]. */
roburoc4_result roburoc4_discovery_role(const discovery *d, const roburoc4_config *config,
                                        const int32_t *io_counts, uint32_t role, uint8_t fixed_id);
/** The inputs of a bumper as bits; *certain is false if the robot's texts neither name nor refuse
 * them for sure. */
uint64_t roburoc4_discovery_bumper(const discovery *d, const roburoc4_config *config,
                                   const int32_t *io_counts, uint32_t role, bool *certain);

/** A text or a part of one: words of letters and digits, and separators. */
typedef struct piece {
    const char *text;
    uint32_t length;
} piece;
/** The next word; *rest is moved behind it. Length 0 at the end. Different spellings become one:
 * "game pad" and "joystick" are "gamepad", and "button" is skipped. */
piece roburoc4_next_word(piece *rest);
/** How often a text contains a word; how many words it has if `wanted` is NULL. */
uint32_t roburoc4_count_word(piece text, const piece *wanted);

#define LIST_DIRECTORY 4 /* as `list`; 0 to 3 are the IO card's element types */

static inline uint8_t service_bit(uint32_t service) {
    return (uint8_t)(1U << service);
}

static inline uint32_t at_most(uint32_t value, uint32_t limit) {
    return value < limit ? value : limit;
}

/** As many bits as the count says, at most 64, from the lowest. */
static inline uint64_t lowest_bits(uint32_t count) {
    return count < 64 ? ((uint64_t)1 << count) - 1 : UINT64_MAX;
}

/* ---- subscriptions ---- */

typedef roburoc4_private_subscriptions subscriptions;

/** All subscriptions are requested again. */
void roburoc4_subscriptions_restart(subscriptions *s);
/** The services to request a subscription of now. */
uint32_t roburoc4_subscriptions_due(const subscriptions *s, const roburoc4_config *config,
                                    const discovery *d);
/** Whether the robot refused all that it lists. */
bool roburoc4_subscriptions_all_declined(const subscriptions *s, const roburoc4_config *config,
                                         const discovery *d);
/** Services that were to be subscribed to, but send nothing. */
uint8_t roburoc4_subscriptions_missing(const subscriptions *s, const roburoc4_config *config,
                                       const discovery *d);
/** The subscription is being requested. */
void roburoc4_subscriptions_inserted(subscriptions *s, uint32_t service, uint32_t now_us);
/** The robot acknowledged it, or sent a status. */
void roburoc4_subscriptions_accepted(subscriptions *s, uint32_t service);
void roburoc4_subscriptions_refused(subscriptions *s, uint32_t service, uint32_t now_us);
/** Forget what the robot answered about it. */
void roburoc4_subscriptions_forget(subscriptions *s, uint32_t service);
/** End it. */
void roburoc4_subscriptions_leave(subscriptions *s, uint32_t service);
/** Its end was confirmed, or is no longer requested. */
void roburoc4_subscriptions_left(subscriptions *s, uint32_t service);
/** Request those again that the robot refused. */
void roburoc4_subscriptions_ask_declined(subscriptions *s);
/** Request those again that fell silent. */
void roburoc4_subscriptions_renew_silent(subscriptions *s, const roburoc4_config *config,
                                         const roburoc4_private_link *l, uint64_t now_us, timer *t);

#endif
