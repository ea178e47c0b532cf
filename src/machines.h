/* SPDX-License-Identifier: MIT
 *
 * The small machines that make up a client, and what they tell each other. Each keeps its own part
 * of roburoc4_client and reads none of another's (discovery is shown the open requests, to ask
 * nothing twice); the files of joined.h join them.
 *
 *   requests   request ids, retries, matching of answers
 *   link       statuses in order, loss, jitter, clock mapping, reboot
 *   drive      arming, lease, limits, zero train: the only place that lets a speed out
 *   discovery  which service has which id, what is still to be asked, which input is what
 */
#ifndef ROBUROC4_MACHINES_H
#define ROBUROC4_MACHINES_H

#include "roburoc4.h"

#include <stdbool.h>
#include <string.h>

#define MS 1000U
#define SECOND 1000000U
/* The five services that have a status, as index of their tables: IO card 0 to differential 4. */
#define STATUS_SERVICES 5
#define STATUS_INDEX(service) ((service)-ROBUROC4_SERVICE_IOCARD)

/** How many inputs of a role's type a client stores. */
static inline int32_t roburoc4_role_capacity(uint32_t role) {
    return role == ROBUROC4_ROLE_BATTERY_V ? ROBUROC4_MAX_ANALOG_INPUTS
                                           : ROBUROC4_MAX_DIGITAL_INPUTS;
}

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

/** Close all and leave fixed-id mode. After going to it, `announce` is 1: the client takes it. */
void roburoc4_requests_clear(requests *r);
void roburoc4_requests_cancel_all(requests *r);
/** Whether another request may be opened now, and `keep` more after it. */
bool roburoc4_requests_free(const requests *r, uint32_t keep);
/** Whether this very question is open. */
bool roburoc4_requests_open(const requests *r, const ask *a);
/** Open a request, unless this very question is open or there is no room: then false. */
bool roburoc4_requests_begin(requests *r, const ask *a);
/** Close requests of this action and kind. */
void roburoc4_requests_cancel(requests *r, uint8_t action, uint8_t kind);
/** The next request that must be (re)sent now with a new id, or NULL; *given_up is set instead to a
 *  request whose tries are used up (now closed). */
slot *roburoc4_requests_due(requests *r, uint32_t first_retry_ms, uint64_t now_us, slot **given_up);
/** The open request that this answer (5 bytes or more, or an error telegram of 1 or more) belongs
 *  to, or NULL. */
slot *roburoc4_requests_match(requests *r, const uint8_t *datagram, size_t size, uint64_t now_us);
void roburoc4_requests_close(requests *r, slot *s, uint64_t now_us);
uint64_t roburoc4_requests_deadline(const requests *r);
/** Make everything due: after a fault of the clock. */
void roburoc4_requests_rebase(requests *r, uint64_t now_us);

/* ---- link ---- */

typedef enum verdict { VERDICT_NEW, VERDICT_OLD, VERDICT_REBOOT } verdict;

/** Forget the order of statuses (of a lost or restarted robot), keep the totals. */
void roburoc4_link_restart(roburoc4_private_link *l);
/** The statuses that are there are of services that may be others now: none is fresh. */
void roburoc4_link_spoil(roburoc4_private_link *l);
/** The robot agreed to the asked period: measure loss against it until another is observed. */
void roburoc4_link_expect(roburoc4_private_link *l, uint32_t index);
/** Judge a status; a new one is taken into the figures. */
verdict roburoc4_link_status(roburoc4_private_link *l, uint32_t index, uint64_t robot_cycles,
                             uint64_t now_us);
void roburoc4_link_round_trip(roburoc4_private_link *l, uint64_t sent_us, uint64_t now_us);
/** True while the last status is younger than `limit_us`. */
bool roburoc4_link_fresh(const roburoc4_private_link *l, uint32_t index, uint32_t limit_us,
                         uint64_t now_us);
void roburoc4_link_rebase(roburoc4_private_link *l, uint64_t now_us);

/* ---- speeds ---- */

/** True where none of the values is NaN or infinite. */
bool roburoc4_all_finite(const float *values, uint32_t count);
/** The value, or the bound that it is beyond. */
float roburoc4_clamp(float value, float low, float high);
bool roburoc4_between(float value, float low, float high);

/* ---- drive ---- */

typedef roburoc4_private_drive drive;

void roburoc4_drive_start(drive *d, uint64_t now_us);
/** Whether the robot's limits can be believed. */
bool roburoc4_drive_limits_valid(const float *limits);
void roburoc4_drive_arm(drive *d, uint32_t *events);
/** Take a lease, or say why not; the caller has checked that the speeds are finite. */
roburoc4_result roburoc4_drive_grant(drive *d, const float *target, uint32_t lease_us,
                                     uint64_t now_us);
/** Leave driving for this cause: disarm, and a zero train if a speed was ever sent. */
void roburoc4_drive_interrupt(drive *d, roburoc4_result cause, uint32_t *events);
/** End the lease and send a zero train in any case. */
void roburoc4_drive_stop(drive *d);
/** Let time pass: leases that are over; conditions of driving that were lost (a refusal). */
void roburoc4_drive_tick(drive *d, roburoc4_result refusal, uint64_t now_us, uint32_t *events);
/** A speed command that must leave now: true, and the speeds. */
bool roburoc4_drive_poll(drive *d, const roburoc4_config *config, const float *limits,
                         uint64_t now_us, float *speeds, uint32_t *events);
/** A differential status: targets and currents, as in roburoc4_private_values.speeds. */
void roburoc4_drive_status(drive *d, const roburoc4_config *config, const float *speeds,
                           bool overridden, uint64_t now_us, uint32_t *events);
/** The differential service has this id and full properties, or (known false) none that can be
 *  driven: with the id of before its zero train is still sent, with another one nothing is. */
void roburoc4_drive_service(drive *d, bool known, uint16_t id);
uint64_t roburoc4_drive_deadline(const drive *d, const roburoc4_config *config);
void roburoc4_drive_rebase(drive *d, uint64_t now_us);

/* ---- discovery ---- */

typedef roburoc4_private_discovery discovery;

#define CLAIM_NONE 0xFF  /* of a service whose text was not read, or not believed */
#define CLAIM_OTHER 0xFE /* its text names none of those that a client uses */
#define ROLE_TEXT_NONE (-1)
#define ROLE_TEXT_AMBIGUOUS (-2)

/** Forget the robot. */
void roburoc4_discovery_clear(discovery *d);
/** Ask again for all but the texts. */
void roburoc4_discovery_restart(discovery *d);
/** Ask again for the texts. */
void roburoc4_discovery_read_texts_again(discovery *d);
/** Whether the directory is the one that is stored. */
bool roburoc4_discovery_same(const discovery *d, const roburoc4_directory *directory);
/** Store the directory; true if it had more services than can be stored. */
bool roburoc4_discovery_directory(discovery *d, const roburoc4_directory *directory);
/** Whether the directory lists this id for what may be the differential service. */
bool roburoc4_discovery_may_drive(const discovery *d, uint16_t id);
/** Whether the directory has a service of which neither type nor text tells what it is. */
bool roburoc4_discovery_unseen(const discovery *d);
/** Which service each id is; true if that changed. */
bool roburoc4_discovery_identify(discovery *d);
/** A text came for an element of the directory, or (io_type 0 to 3) a channel. True if an input of
 *  a role was found. */
bool roburoc4_discovery_text(discovery *d, uint32_t list, uint32_t index, const uint8_t *text,
                             uint32_t length);
void roburoc4_discovery_described(discovery *d, uint32_t list, uint32_t index);
/** The next text to ask for: false when there is none that is not open. */
bool roburoc4_discovery_next_text(const discovery *d, const requests *r, const int32_t *io_counts,
                                  bool channels, ask *out);
/** Whether every text was answered or given up. */
bool roburoc4_discovery_texts_done(const discovery *d, const int32_t *io_counts, bool channels);
/** Index of the input with a role, or ROBUROC4_ERR_UNKNOWN. */
roburoc4_result roburoc4_discovery_role(const discovery *d, const roburoc4_config *config,
                                        const int32_t *io_counts, uint32_t role);

#define LIST_DIRECTORY 4 /* as `list`; 0 to 3 are the IO card's element types */

#endif
