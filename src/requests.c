/* SPDX-License-Identifier: MIT
 *
 * Requests: all tries of a request share its id, so a slow answer to any of them counts; a few
 * requests are open at once. A robot that answers everything with 0x01, as the manual prints it, is
 * recognised after three tries and served one request at a time. A bad link can look like such a
 * robot: the probe of the directory tries another id first, and an answer to it ends the mode.
 */
#include "machines.h"

#define SLOTS 4
#define MAX_WAIT_US SECOND
#define FIRST_ID 2 /* 0x01 is reserved for robots that answer no other id */
#define LAST_ID 254
#define FIXED_AFTER 3
/* Texts wait this long after an error that does not name its request: a late copy would refuse the
 * wrong text. */
#define QUIET_US (700 * MS)
/* In fixed-id mode they wait after each answer for twice the slowest recent one, at least this. */
#define SHORTEST_QUIET_US (250 * MS)
/* Once a text has come twice, answers count as at least this slow. */
#define COPY_MS (QUIET_US / MS / 2)
/* After several tries they wait as long as the answer took, but no longer than this. */
#define LONGEST_QUIET_US (5 * SECOND)
/* If answers do not name their request, a text is repeated after this many of the usual waits. */
#define PATIENCE 5
/* A request is repeated after four of the shortest round trip, but not earlier than this. */
#define SHORTEST_RETRY_US (20 * MS)
/* sent_us stays that of the first try, unless the program paused for longer than this. */
#define LONGEST_PAUSE_US (100 * SECOND)
/* Every this many tries to connect, 0x01 is used: some robots answer no other id. */
#define MANUAL_ID_EVERY 6
/* A robot that is known to echo ids must answer 0x01 after this many tries before it counts:
 * another robot may have answered. */
#define DOUBT_AFTER (2 * MANUAL_ID_EVERY)
/* Values of quiet, each of which includes the one before: what has to wait. ALL holds back more
 * than texts only in fixed-id mode. */
enum { QUIET_NOTHING, QUIET_TEXTS, QUIET_ALL };
/* Values of id_mode: which ids the robot has answered so far. If a robot that answered any may be
 * another one now, the next connection will tell. */
enum { ANSWERED_NONE, ANSWERED_MANUAL_ID, ANSWERED_ANY_ID, ANSWERED_PERHAPS_ANY_ID };

void roburoc4_requests_clear(requests *r) {
    const uint8_t last_id = r->last_id; /* continues: late answers must not match */
    const bool any_id = r->id_mode == ANSWERED_ANY_ID;
    memset(r, 0, sizeof *r);
    r->last_id = last_id;
    r->id_mode = any_id ? ANSWERED_ANY_ID : ANSWERED_NONE;
}

static bool is_text(const slot *s) {
    return s->ask.action == ROBUROC4_ACTION_QUERY;
}

/** Whether answers do not tell which text they are, or which one they refuse. */
static bool texts_are_doubtful(const requests *r) {
    return in_fixed_id_mode(r) || r->single_texts;
}

bool roburoc4_requests_text_open(const requests *r) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        if (r->slots[i].open && is_text(&r->slots[i])) {
            return true;
        }
    }
    return false;
}

static void wait_for_copies(requests *r, uint8_t what, uint32_t wait_us, uint32_t now_us) {
    const uint32_t passed_us = now_us - r->quiet_since_us;
    const bool longer =
        r->quiet && passed_us < r->quiet_span_us && r->quiet_span_us - passed_us > wait_us;
    if (!longer) {
        r->quiet_since_us = now_us;
        r->quiet_span_us = wait_us;
    }
    r->quiet = r->quiet > what ? r->quiet : what;
}

void roburoc4_requests_abandon(requests *r, slot *s, uint32_t now_us) {
    if (in_fixed_id_mode(r) && is_text(s)) {
        roburoc4_requests_be_quiet(r, NULL, now_us);
    } else if (r->single_texts) {
        wait_for_copies(r, QUIET_TEXTS, LONGEST_QUIET_US, now_us);
    }
    s->open = 0;
}

void roburoc4_requests_cancel_all(requests *r, uint32_t now_us) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        if (r->slots[i].open) {
            roburoc4_requests_abandon(r, &r->slots[i], now_us);
        }
    }
}

bool roburoc4_requests_has_room(const requests *r, uint32_t keep) {
    uint32_t open = 0;
    for (uint32_t i = 0; i < SLOTS; i++) {
        open += r->slots[i].open;
    }
    if (in_fixed_id_mode(r)) {
        return open == 0 && r->quiet < QUIET_ALL;
    }
    return open + keep < SLOTS;
}

bool roburoc4_requests_has_room_for_text(const requests *r) {
    /* texts leave one request free for urgent ones */
    return roburoc4_requests_has_room(r, r->single_texts ? SLOTS - 1 : 1) && !r->quiet;
}

bool roburoc4_requests_is_open(const requests *r, const ask *a) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        /* the number of tries does not matter here */
        if (r->slots[i].open && memcmp(&r->slots[i].ask, a, offsetof(ask, max_tries)) == 0) {
            return true;
        }
    }
    return false;
}

bool roburoc4_requests_begin(requests *r, const ask *a) {
    uint32_t i = 0;
    while (i < SLOTS && r->slots[i].open) {
        i++;
    }
    if (i == SLOTS || roburoc4_requests_is_open(r, a)) {
        return false;
    }
    memset(&r->slots[i], 0, sizeof r->slots[i]);
    r->slots[i].ask = *a;
    r->slots[i].open = 1;
    return true;
}

void roburoc4_requests_cancel(requests *r, uint8_t action, uint8_t kind, uint32_t now_us) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        slot *s = &r->slots[i];
        if (s->open && s->ask.action == action && s->ask.kind == kind) {
            roburoc4_requests_abandon(r, s, now_us);
        }
    }
}

/* The count of tries has 8 bits. Here it goes back, so that 0x01 keeps its turn. */
#define TRIES_WRAP (41 * MANUAL_ID_EVERY)

static bool id_in_use(const requests *r, uint8_t id) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        if (r->slots[i].open && r->slots[i].id == id) {
            return true;
        }
    }
    return false;
}

static uint8_t unused_id(requests *r) {
    do {
        r->last_id =
            r->last_id >= FIRST_ID && r->last_id < LAST_ID ? (uint8_t)(r->last_id + 1) : FIRST_ID;
    } while (id_in_use(r, r->last_id));
    return r->last_id;
}

/** Whether it is the turn of 0x01 after so many tries. */
static bool manual_id_is_next(uint32_t tries) {
    while (tries >= MANUAL_ID_EVERY) {
        tries -= MANUAL_ID_EVERY;
    }
    return tries == MANUAL_ID_EVERY - 1;
}

/** The id of the next try. */
static uint8_t next_id(requests *r, const slot *s) {
    const bool directory =
        s->ask.action == ROBUROC4_ACTION_GET && s->ask.kind == ROBUROC4_SERVICE_DIRECTORY;
    const bool connecting = directory && s->ask.max_tries == REQUEST_FOREVER;
    const bool doubting = directory && s->tries == 0;
    const bool manual_id = WITH_FIXED_ID && connecting && manual_id_is_next(s->tries);
    if ((in_fixed_id_mode(r) && !doubting) || manual_id) {
        return ROBUROC4_HEADER_MANUAL;
    }
    return s->tries > 0 && s->id != ROBUROC4_HEADER_MANUAL ? s->id : unused_id(r);
}

/** Use only 0x01 from now on, and close all requests but this one. A text is closed, too, as the
 * answer may be another one's; then NULL. */
static slot *go_to_fixed_id(requests *r, const slot *only, uint32_t now_us) {
    const slot kept = *only;
    const bool texts = roburoc4_requests_text_open(r);
    roburoc4_requests_clear(r);
    r->fixed_id = 1;
    r->announce = 1;
    if (texts) {
        roburoc4_requests_be_quiet(r, NULL, now_us);
    }
    if (is_text(&kept)) {
        return NULL;
    }
    r->slots[0] = kept;
    return &r->slots[0];
}

static uint32_t retry_us(uint32_t first_us, uint32_t doublings) {
    const uint32_t doubled_us = first_us << (doublings < 8 ? doublings : 8);
    return at_most(doubled_us, MAX_WAIT_US);
}

/** The wait where answers name their request. */
static uint32_t usual_wait_us(const slot *s, uint32_t longest_us, uint32_t round_trip_us) {
    if (round_trip_us == 0 || round_trip_us >= longest_us / 4 ||
        s->ask.max_tries == REQUEST_FOREVER) {
        return retry_us(longest_us, s->tries);
    }
    const uint32_t first_us = 4 * round_trip_us;
    return retry_us(
        at_most(first_us > SHORTEST_RETRY_US ? first_us : SHORTEST_RETRY_US, longest_us),
        s->tries / 2U);
}

static void begin_try(requests *r, slot *s, uint32_t wait_us, uint32_t now_us) {
    const uint8_t id = next_id(r, s);
    const uint32_t elapsed_us = now_us - s->sent_us;
    if (s->tries == 0 || id != s->id || elapsed_us > LONGEST_PAUSE_US) {
        s->sent_us = now_us;
    }
    s->wait_us = now_us - s->sent_us + wait_us;
    s->id = id;
    s->ones &= 0x7F; /* no answer with 0x01 to this try yet */
    s->tries = s->tries < TRIES_WRAP ? s->tries + 1U : TRIES_WRAP + 1 - MANUAL_ID_EVERY;
}

/** The time of all tries at the configured pace; the request is not given up earlier. */
static uint32_t longest_try_us(const slot *s, uint32_t longest_us) {
    uint32_t sum_us = 0;
    for (uint32_t i = 0; i < s->ask.max_tries; i++) {
        sum_us += retry_us(longest_us, i);
    }
    return sum_us;
}

/** In fixed-id mode an answer after a repetition proves nothing, so slow robots get more time. */
static uint32_t slower(uint32_t longest_us, const requests *r) {
    const uint32_t twice_us = 2 * MS * r->slowest_ms;
    return twice_us > longest_us ? twice_us : longest_us;
}

/** The first open request whose wait has ended, or NULL. */
static slot *first_due(requests *r, timer *t) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        if (r->slots[i].open && due(t, r->slots[i].sent_us, r->slots[i].wait_us)) {
            return &r->slots[i];
        }
    }
    return NULL;
}

/** How long to wait for an answer to the next try. */
static uint32_t wait_us(const requests *r, const slot *s, uint32_t longest_us,
                        uint32_t round_trip_us) {
    if (texts_are_doubtful(r) && is_text(s)) {
        return retry_us(PATIENCE * longest_us, s->tries);
    }
    return in_fixed_id_mode(r) ? retry_us(slower(longest_us, r), s->tries)
                               : usual_wait_us(s, longest_us, round_trip_us);
}

static bool tries_used_up(const slot *s, uint32_t end_us, uint32_t now_us) {
    return s->ask.max_tries != REQUEST_FOREVER && s->tries >= s->ask.max_tries &&
           now_us - s->sent_us >= end_us;
}

static bool fixed_id_is_next(const requests *r, const slot *s) {
    return WITH_FIXED_ID && !in_fixed_id_mode(r) && r->id_mode == ANSWERED_MANUAL_ID &&
           s->tries >= FIXED_AFTER;
}

slot *roburoc4_requests_due(requests *r, uint32_t first_retry_ms, uint32_t round_trip_us, timer *t,
                            slot **given_up) {
    const uint32_t longest_us = first_retry_ms * MS;
    *given_up = NULL;
    if (r->quiet && due(t, r->quiet_since_us, r->quiet_span_us)) {
        r->quiet = QUIET_NOTHING;
    }
    slot *s = first_due(r, t);
    if (s == NULL) {
        return NULL;
    }
    const uint32_t end_us = longest_try_us(s, longest_us);
    if (tries_used_up(s, end_us, t->now_us)) {
        roburoc4_requests_abandon(r, s, t->now_us);
        *given_up = s;
        return NULL;
    }
    if (fixed_id_is_next(r, s)) {
        s = go_to_fixed_id(r, s, t->now_us); /* only 0x01 was answered so far */
        if (s == NULL) {
            return NULL;
        }
    }
    begin_try(r, s, wait_us(r, s, longest_us, round_trip_us), t->now_us);
    if (t->now_us - s->sent_us < end_us) {
        s->wait_us = at_most(s->wait_us, end_us);
    }
    return s;
}

/** Whether an error telegram, which may be cut short, matches this request. */
static bool error_fits(const slot *s, const uint8_t *datagram, size_t size) {
    return (size < 2 || datagram[1] == s->ask.action) &&
           (size < 4 || (uint16_t)(datagram[2] | datagram[3] << 8) == s->ask.target);
}

/** Once the robot echoed another id, loss must not make it look as if it knew only 0x01. */
static void note_answered_id(requests *r, const slot *s) {
    if (s->id != ROBUROC4_HEADER_MANUAL) {
        r->id_mode = ANSWERED_ANY_ID;
        r->fixed_id = 0;
    } else if (r->id_mode < ANSWERED_ANY_ID || s->tries >= DOUBT_AFTER) {
        r->id_mode = ANSWERED_MANUAL_ID;
    } else {
        r->id_mode = ANSWERED_PERHAPS_ANY_ID;
    }
}

/** Another try of this request was answered with 0x01; true once that is proof enough. */
static bool only_manual_id(slot *s) {
    if ((s->ones & 0x80) == 0) {
        s->ones = (uint8_t)(0x80 | (s->ones + 1));
    }
    return (s->ones & 0x7F) >= FIXED_AFTER;
}

void roburoc4_requests_be_quiet(requests *r, const slot *s, uint32_t now_us) {
    uint32_t quiet_us = QUIET_US;
    if (s != NULL && s->tries > 1) {
        const uint32_t took_us = now_us - s->sent_us;
        quiet_us = at_most(s->wait_us, MAX_WAIT_US);
        if (took_us > quiet_us) {
            quiet_us = at_most(took_us, LONGEST_QUIET_US);
        }
    }
    wait_for_copies(r, QUIET_ALL, quiet_us, now_us);
}

/** Wait twice the slowest recent answer before the next text: the right one may come after the one
 * that was taken for it. */
static void be_quiet_after_text(requests *r, uint32_t now_us) {
    wait_for_copies(r, QUIET_TEXTS, slower(SHORTEST_QUIET_US, r), now_us);
}

/** Of at most four seconds. Dividing is a large function on small machines. */
static uint32_t ms_of(uint32_t us) {
    return (us >> 3) * 8389 >> 20;
}

/** The slowest answer of the last ones in fixed-id mode, as an upper bound of the round trip. */
static void note_slowest(requests *r, const slot *s, uint32_t now_us) {
    const uint32_t took_us = now_us - s->sent_us;
    const uint32_t took_ms = ms_of(at_most(took_us, LONGEST_QUIET_US / 2)) + 1;
    const uint32_t before_ms = r->slowest_ms * 7U / 8U;
    r->slowest_ms = (uint16_t)(took_ms > before_ms ? took_ms : before_ms);
}

void roburoc4_requests_cancel_texts(requests *r, uint32_t lists, uint32_t now_us) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        slot *s = &r->slots[i];
        if (s->open && is_text(s) && s->ask.detail < lists) {
            s->open = 0;
            roburoc4_requests_be_quiet(r, s, now_us);
        }
    }
}

/** An error telegram does not name the text that it refuses: from now on request one text at a
 * time, once all that was requested before must have been answered. */
static void ask_single_texts(requests *r, uint32_t now_us) {
    r->single_texts = 1;
    roburoc4_requests_cancel_texts(r, LIST_DIRECTORY + 1, now_us);
    if (!in_fixed_id_mode(r)) {
        wait_for_copies(r, QUIET_TEXTS, LONGEST_QUIET_US, now_us);
    }
}

/** The open requests to which a datagram without their id may belong: how many, and the oldest. */
typedef struct candidates {
    slot *oldest;
    uint32_t count;
} candidates;

/** The request with the id of this datagram, or NULL and the candidates. */
static slot *find_id(requests *r, const uint8_t *datagram, size_t size, uint32_t now_us,
                     candidates *others) {
    others->oldest = NULL;
    others->count = 0;
    for (uint32_t i = 0; i < SLOTS; i++) {
        slot *s = &r->slots[i];
        if (!s->open || s->tries == 0 || !error_fits(s, datagram, size)) {
            continue;
        }
        if (datagram[0] == s->id) {
            return s;
        }
        others->count++;
        if (others->oldest == NULL || now_us - s->sent_us > now_us - others->oldest->sent_us) {
            others->oldest = s;
        }
    }
    return NULL;
}

/** The request that an error without an id refuses: the oldest; a text only if it fits no other
 * request and none was abandoned lately. */
static slot *match_error(requests *r, const candidates *found, size_t size, uint32_t now_us) {
    slot *s = found->oldest;
    if (is_text(s) && (found->count > 1 || !r->single_texts || r->quiet)) {
        ask_single_texts(r, now_us);
        return NULL;
    }
    if (is_text(s) || size < 4) { /* its copies must not refuse a text */
        roburoc4_requests_be_quiet(r, s, now_us);
        note_slowest(r, s, now_us);
        be_quiet_after_text(r, now_us);
    }
    return s;
}

/** A datagram belongs to no open request: what it is a copy of may come once more. */
static void note_copy(requests *r, const uint8_t *datagram, size_t size, uint32_t now_us) {
    const bool text = size < 2 || datagram[1] == ROBUROC4_ACTION_QUERY;
    if (r->quiet && (r->quiet == QUIET_ALL || text)) {
        wait_for_copies(r, r->quiet, QUIET_US, now_us);
    }
    if (text && r->slowest_ms < COPY_MS) {
        r->slowest_ms = COPY_MS; /* others may come as late, without this warning */
    }
}

slot *roburoc4_requests_match(requests *r, const uint8_t *datagram, size_t size, uint32_t now_us) {
    candidates found;
    slot *s = find_id(r, datagram, size, now_us, &found);
    if (s != NULL) {
        note_answered_id(r, s);
        return s;
    }
    if (found.oldest == NULL) {
        note_copy(r, datagram, size, now_us);
        return NULL;
    }
    if (datagram[0] == ROBUROC4_HEADER_ERROR) {
        return match_error(r, &found, size, now_us);
    }
    if (datagram[0] != ROBUROC4_HEADER_MANUAL) {
        return NULL;
    }
    if (in_fixed_id_mode(r)) {
        return found.oldest; /* it was sent with another id, to check the mode */
    }
    return WITH_FIXED_ID && only_manual_id(found.oldest) ? go_to_fixed_id(r, found.oldest, now_us)
                                                         : NULL;
}

void roburoc4_requests_close(requests *r, slot *s, uint32_t now_us) {
    s->open = 0;
    if (r->single_texts && is_text(s)) {
        note_slowest(r, s, now_us);
    }
    if (!in_fixed_id_mode(r)) {
        return;
    }
    if (s->ask.max_tries != REQUEST_FOREVER) {
        note_slowest(r, s, now_us);
    }
    if (is_text(s) && s->ask.detail != LIST_DIRECTORY) {
        be_quiet_after_text(r, now_us);
    } else if (s->tries > 1) {
        roburoc4_requests_be_quiet(r, s, now_us);
    }
}

void roburoc4_requests_rebase(requests *r, uint32_t now_us) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        r->slots[i].sent_us = now_us - r->slots[i].wait_us;
    }
}
