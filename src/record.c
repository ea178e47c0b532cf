/* SPDX-License-Identifier: MIT
 *
 * record.c - the flight recorder. The thread that sends or receives a datagram appends it, as a
 * whole block of pcapng, to one of two buffers; a thread swaps them and writes the other one. The
 * lock is held for a copy and for the swap, never while the disk is waited for.
 */
#include "record_internal.h"

#include "bytes.h"
#include "os.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BUFFER_BYTES_DEFAULT (256u * 1024u)
#define BUFFER_BYTES_MIN 4096u
/* A killed process loses at most this plus the time of a write. */
#define FLUSH_US 50000u
/* Pause before a retry after the disk accepted nothing. */
#define RETRY_US 100000u
#define FINISH_US 2000000u
#define IDLE_US 1000000u
/* Size of a file's header: section, interface and a name. */
#define HEAD_BYTES 512u
#define ROBOT_BYTES_MAX 255u
#define STATISTICS_BYTES 64u
#define HIGHEST_NUMBER 999999u

/* Datagrams so far. */
typedef struct totals {
    uint64_t recorded, dropped;
} totals;

struct roburoc4_recorder {
    int64_t process; /* the process that made it: a forked child has no writer */
    roburoc4_thread thread;
    uint64_t max_file_bytes, max_file_us;
    char wanted[ROBUROC4_RECORDER_PATH_SIZE]; /* the file's or folder's path */
    int kind;                                 /* ROBUROC4_OS_FILE, ... */
    char robot[ROBOT_BYTES_MAX + 1];

    roburoc4_lock lock; /* protects everything below except the writer's own members */
    roburoc4_signal changed;
    uint8_t *buffer; /* being filled */
    size_t capacity, filled;
    uint32_t gap; /* datagrams dropped since the last one in the buffer */
    int ending, ended;
    roburoc4_recorder_state state;

    /* The writer's own. */
    uint8_t *out; /* the other buffer */
    size_t size;  /* its content */
    int64_t file;
    uint64_t head_bytes, file_bytes; /* complete blocks in the file */
    uint64_t begun_us, begun_calendar_us;
    totals earlier; /* before this file */
    totals filed;   /* up to what was written last */
    totals swapped; /* up to what is in `out` */
    int gave_up;    /* closed while the disk was full */
};

/* ---------------------------------------------------------------------------------- pcapng --- */

#define BLOCK_SECTION 0x0A0D0D0Au
#define BLOCK_INTERFACE 1u
#define BLOCK_STATISTICS 5u
#define BLOCK_PACKET 6u
#define LINK_TYPE_RAW_IP 101u
#define INBOUND 1u
#define OUTBOUND 2u
#define MICROSECONDS 6u
#define UDP_BYTES 8u
#define IPV4_BYTES 20u
#define IPV6_BYTES 40u

typedef struct cursor {
    uint8_t *at;
} cursor;

static void put_byte(cursor *c, uint32_t value) {
    *c->at++ = (uint8_t)value;
}

static void put_16(cursor *c, uint32_t value) {
    put_byte(c, value);
    put_byte(c, value >> 8);
}

static void put_32(cursor *c, uint32_t value) {
    put_16(c, value);
    put_16(c, value >> 16);
}

static void put_64(cursor *c, uint64_t value) {
    put_32(c, (uint32_t)value);
    put_32(c, (uint32_t)(value >> 32));
}

/* The high half of a time comes first in every byte order. */
static void put_time(cursor *c, uint64_t calendar_us) {
    put_32(c, (uint32_t)(calendar_us >> 32));
    put_32(c, (uint32_t)calendar_us);
}

/* Big-endian, as in IP. */
static void put_net_16(cursor *c, uint32_t value) {
    put_byte(c, value >> 8);
    put_byte(c, value);
}

static void put_padded(cursor *c, const void *bytes, size_t size) {
    memcpy(c->at, bytes, size);
    c->at += size;
    while (size++ % 4 != 0) {
        put_byte(c, 0);
    }
}

static void put_option(cursor *c, uint32_t code, const void *value, size_t size) {
    put_16(c, code);
    put_16(c, (uint32_t)size);
    put_padded(c, value, size);
}

static uint8_t *begin_block(cursor *c, uint32_t type) {
    uint8_t *begin = c->at;
    put_32(c, type);
    put_32(c, 0);
    return begin;
}

/* Fills in both lengths of a block. */
static void end_block(cursor *c, uint8_t *begin) {
    const uint32_t length = (uint32_t)(c->at - begin) + 4u;
    cursor first;
    first.at = begin + 4;
    put_32(&first, length);
    put_32(c, length);
}

/* The section header and the interface block, at most HEAD_BYTES. */
static size_t encode_head(uint8_t *buffer, const char *robot) {
    char program[32];
    const uint8_t resolution = MICROSECONDS;
    cursor c;
    uint8_t *begin;
    c.at = buffer;
    begin = begin_block(&c, BLOCK_SECTION);
    put_32(&c, 0x1A2B3C4Du);
    put_16(&c, 1);
    put_16(&c, 0);
    put_64(&c, UINT64_MAX); /* unknown length of the section */
    (void)snprintf(program, sizeof program, "roburoc4 %d.%d.%d", ROBUROC4_VERSION_MAJOR,
                   ROBUROC4_VERSION_MINOR, ROBUROC4_VERSION_PATCH);
    put_option(&c, 4, program, strlen(program));
    put_32(&c, 0);
    end_block(&c, begin);
    begin = begin_block(&c, BLOCK_INTERFACE);
    put_16(&c, LINK_TYPE_RAW_IP);
    put_16(&c, 0);
    put_32(&c, 0); /* datagrams are not cut */
    put_option(&c, 2, robot, strlen(robot));
    put_option(&c, 9, &resolution, 1);
    put_32(&c, 0);
    end_block(&c, begin);
    return (size_t)(c.at - buffer);
}

static size_t encode_statistics(uint8_t *buffer, uint64_t begun_us, uint64_t now_us,
                                uint64_t recorded, uint64_t dropped) {
    cursor c;
    uint8_t *begin;
    c.at = buffer;
    begin = begin_block(&c, BLOCK_STATISTICS);
    put_32(&c, 0);
    put_time(&c, now_us);
    put_16(&c, 2);
    put_16(&c, 8);
    put_time(&c, begun_us);
    put_16(&c, 4);
    put_16(&c, 8);
    put_64(&c, recorded + dropped); /* all datagrams */
    put_16(&c, 5);
    put_16(&c, 8);
    put_64(&c, dropped);
    put_32(&c, 0);
    end_block(&c, begin);
    return (size_t)(c.at - buffer);
}

static uint32_t sum_16(uint32_t sum, const uint8_t *bytes, size_t size) {
    size_t i;
    for (i = 0; i < size; i++) {
        sum += i % 2 == 0 ? (uint32_t)bytes[i] << 8 : bytes[i];
    }
    return sum;
}

static void set_checksum(uint8_t *at, uint32_t sum) {
    cursor c;
    c.at = at;
    while (sum > 0xFFFFu) {
        sum = (sum & 0xFFFFu) + (sum >> 16);
    }
    put_net_16(&c, sum == 0xFFFFu ? 0xFFFFu : ~sum);
}

static void put_ipv4(cursor *c, const roburoc4_address *from, const roburoc4_address *to,
                     size_t udp_size) {
    uint8_t *begin = c->at;
    put_byte(c, 0x45); /* version 4, five words */
    put_byte(c, 0);
    put_net_16(c, (uint32_t)(IPV4_BYTES + udp_size));
    put_net_16(c, 0);
    put_net_16(c, 0x4000); /* not a fragment */
    put_byte(c, 64);
    put_byte(c, 17);
    put_net_16(c, 0);
    memcpy(c->at, from->ip, 4);
    memcpy(c->at + 4, to->ip, 4);
    c->at += 8;
    set_checksum(begin + 10, sum_16(0, begin, IPV4_BYTES));
}

static void put_ipv6(cursor *c, const roburoc4_address *from, const roburoc4_address *to,
                     size_t udp_size) {
    put_32(c, 0x60); /* version 6 */
    put_net_16(c, (uint32_t)udp_size);
    put_byte(c, 17);
    put_byte(c, 64);
    memcpy(c->at, from->ip, 16);
    memcpy(c->at + 16, to->ip, 16);
    c->at += 32;
}

static void put_udp(cursor *c, const roburoc4_address *from, const roburoc4_address *to,
                    const uint8_t *datagram, size_t size) {
    uint8_t *begin = c->at;
    const size_t udp_size = UDP_BYTES + size;
    put_net_16(c, from->port);
    put_net_16(c, to->port);
    put_net_16(c, (uint32_t)udp_size);
    put_net_16(c, 0); /* no checksum, which IPv6 does not allow */
    if (size > 0) {   /* an empty one may have no bytes at all */
        memcpy(c->at, datagram, size);
        c->at += size;
    }
    if (to->family == 6) {
        uint32_t sum = sum_16(17u + (uint32_t)udp_size, from->ip, 16);
        sum = sum_16(sum, to->ip, 16);
        set_checksum(begin + 6, sum_16(sum, begin, udp_size));
    }
}

/* The most bytes of a block in addition to its datagram. */
#define PACKET_BYTES (28u + IPV6_BYTES + UDP_BYTES + 3u + 8u + 12u + 4u + 4u)

static size_t encode_packet(uint8_t *buffer, uint64_t calendar_us, uint32_t gap, int inbound,
                            const roburoc4_address *from, const roburoc4_address *to,
                            const uint8_t *datagram, size_t size) {
    const size_t ip_bytes = to->family == 4 ? IPV4_BYTES : IPV6_BYTES;
    const uint32_t length = (uint32_t)(ip_bytes + UDP_BYTES + size);
    cursor c;
    uint8_t *begin;
    c.at = buffer;
    begin = begin_block(&c, BLOCK_PACKET);
    put_32(&c, 0);
    put_time(&c, calendar_us);
    put_32(&c, length);
    put_32(&c, length);
    (to->family == 4 ? put_ipv4 : put_ipv6)(&c, from, to, UDP_BYTES + size);
    put_udp(&c, from, to, datagram, size);
    while ((c.at - begin) % 4 != 0) {
        put_byte(&c, 0);
    }
    put_16(&c, 2);
    put_16(&c, 4);
    put_32(&c, inbound ? INBOUND : OUTBOUND);
    if (gap > 0) {
        put_16(&c, 4);
        put_16(&c, 8);
        put_64(&c, gap);
    }
    put_32(&c, 0);
    end_block(&c, begin);
    return (size_t)(c.at - buffer);
}

/* ------------------------------------------------------------------------------- datagrams --- */

void roburoc4_recorder_take(roburoc4_recorder *r, int inbound, const roburoc4_address *from,
                            const roburoc4_address *to, const uint8_t *datagram, size_t size) {
    if (r->process != roburoc4_process_id()) {
        return; /* the fork may have copied the lock in any state */
    }
    roburoc4_lock_take(&r->lock);
    if (r->ending) {
        /* nothing more is written */
    } else if (r->capacity - r->filled < PACKET_BYTES + size) {
        r->gap++;
        r->state.dropped++;
    } else {
        const size_t before = r->filled;
        r->filled += encode_packet(r->buffer + r->filled, roburoc4_os_calendar_us(), r->gap,
                                   inbound, from, to, datagram, size);
        r->gap = 0;
        r->state.recorded++;
        if (before == 0 || (before < r->capacity / 2 && r->filled >= r->capacity / 2)) {
            roburoc4_signal_wake_all(&r->changed);
        }
    }
    roburoc4_lock_give(&r->lock);
}

/* ----------------------------------------------------------------------------------- files --- */

/* The n-th name for a file, "run.pcapng", "run.2.pcapng", ...; 0 if it is too long. */
static int name_file(const roburoc4_recorder *r, uint32_t n,
                     char path[ROBUROC4_RECORDER_PATH_SIZE]) {
    char whole[ROBUROC4_RECORDER_PATH_SIZE], number[16] = "";
    const char *dot, *slash, *backslash;
    int length = snprintf(whole, sizeof whole, "%s", r->wanted);
    if (r->kind == ROBUROC4_OS_FOLDER) {
        char time[17];
        roburoc4_os_calendar_text(roburoc4_os_calendar_us(), time);
        length = snprintf(whole, sizeof whole, "%s/roburoc4-%s.pcapng", r->wanted, time);
    }
    if (length < 0 || (size_t)length >= sizeof whole) {
        return 0;
    }
    dot = strrchr(whole, '.');
    slash = strrchr(whole, '/');
    backslash = strrchr(whole, '\\');
    if (dot == NULL || dot < slash || dot < backslash) {
        dot = whole + length;
    }
    if (n > 1) {
        (void)snprintf(number, sizeof number, ".%lu", (unsigned long)n);
    }
    length = snprintf(path, ROBUROC4_RECORDER_PATH_SIZE, "%.*s%s%s", (int)(dot - whole), whole,
                      number, dot);
    return length >= 0 && length < ROBUROC4_RECORDER_PATH_SIZE;
}

/* Creates the first file whose name is free. */
static int64_t create_file(const roburoc4_recorder *r, char path[ROBUROC4_RECORDER_PATH_SIZE]) {
    uint32_t n;
    for (n = 1; n <= HIGHEST_NUMBER; n++) {
        int64_t file;
        if (!name_file(r, n, path)) {
            errno = ENAMETOOLONG;
            break;
        }
        file = roburoc4_os_file_create(path);
        if (file != ROBUROC4_OS_NO_FILE || errno != EEXIST) {
            return file;
        }
    }
    return ROBUROC4_OS_NO_FILE;
}

/* Writes what the disk accepts now; 1 if that is everything. */
static int write_now(roburoc4_recorder *r, const uint8_t *bytes, size_t size, size_t *done) {
    size_t written = 1;
    while (*done < size && written > 0) {
        written = roburoc4_os_file_write(r->file, bytes + *done, size - *done);
        *done += written;
        roburoc4_lock_take(&r->lock);
        r->state.bytes += written;
        r->state.system_error = written > 0 ? 0 : errno;
        roburoc4_lock_give(&r->lock);
    }
    return *done == size;
}

/* Waits before the next try; 0 if there is none because the recording is ending. */
static int may_try_again(roburoc4_recorder *r) {
    int may;
    roburoc4_lock_take(&r->lock);
    if (!r->ending) {
        roburoc4_signal_wait(&r->changed, &r->lock, RETRY_US);
    }
    may = !r->ending;
    roburoc4_lock_give(&r->lock);
    return may;
}

/* Writes everything, however long the disk is full; *done is less than size if the recording ended
 * first. */
static void write_until_done(roburoc4_recorder *r, const uint8_t *bytes, size_t size,
                             size_t *done) {
    *done = 0;
    while (!write_now(r, bytes, size, done) && may_try_again(r)) {
    }
}

/* ------------------------------------------------------------------------------------ file --- */

static void begin_file(roburoc4_recorder *r) {
    uint8_t head[HEAD_BYTES];
    const size_t size = encode_head(head, r->robot);
    size_t done;
    write_until_done(r, head, size, &done);
    r->gave_up = done < size;
    r->head_bytes = r->file_bytes = size;
    r->begun_us = roburoc4_udp_now_us();
    r->begun_calendar_us = roburoc4_os_calendar_us();
    r->earlier = r->filed;
}

static void end_file(roburoc4_recorder *r) {
    uint8_t statistics[STATISTICS_BYTES];
    const size_t size = encode_statistics(
        statistics, r->begun_calendar_us, roburoc4_os_calendar_us(),
        r->filed.recorded - r->earlier.recorded, r->filed.dropped - r->earlier.dropped);
    size_t done;
    if (!r->gave_up) {
        write_until_done(r, statistics, size, &done);
        r->gave_up = done < size;
    }
    if (r->gave_up && r->kind != ROBUROC4_OS_STREAM) {
        roburoc4_os_file_truncate(r->file, r->file_bytes);
    }
    roburoc4_os_file_close(r->file);
}

static int is_rotation_due(const roburoc4_recorder *r) {
    if (r->kind == ROBUROC4_OS_STREAM || r->size == 0 || r->file_bytes <= r->head_bytes) {
        return 0;
    }
    return (r->max_file_bytes > 0 &&
            r->file_bytes + r->size + STATISTICS_BYTES > r->max_file_bytes) ||
           (r->max_file_us > 0 && roburoc4_udp_now_us() - r->begun_us >= r->max_file_us);
}

/* If the next file cannot be created, this one continues. */
static void rotate(roburoc4_recorder *r) {
    char path[ROBUROC4_RECORDER_PATH_SIZE];
    int64_t file = create_file(r, path);
    if (file == ROBUROC4_OS_NO_FILE) {
        return;
    }
    end_file(r);
    r->file = file;
    roburoc4_lock_take(&r->lock);
    r->state.files++;
    memcpy(r->state.path, path, sizeof path);
    roburoc4_lock_give(&r->lock);
    begin_file(r);
}

/* ---------------------------------------------------------------------------------- writer --- */

/* How many of the first `size` bytes are complete blocks; the blocks after them are added to *rest.
 */
static size_t whole_blocks(const uint8_t *blocks, size_t size, size_t done, uint64_t *rest) {
    size_t at = 0, whole = 0;
    while (at < size) {
        const uint8_t *length = blocks + at + 4;
        at += (size_t)length[0] | (size_t)length[1] << 8 | (size_t)length[2] << 16;
        if (at <= done) {
            whole = at;
        } else {
            ++*rest;
        }
    }
    return whole;
}

static void write_buffer(roburoc4_recorder *r) {
    size_t done = 0;
    uint64_t rest = 0;
    if (is_rotation_due(r)) {
        rotate(r);
    }
    if (!r->gave_up) {
        write_until_done(r, r->out, r->size, &done);
    }
    r->file_bytes += whole_blocks(r->out, r->size, done, &rest);
    r->filed = r->swapped;
    if (rest > 0) {
        r->gave_up = 1;
        roburoc4_lock_take(&r->lock);
        r->state.recorded -= rest;
        r->state.dropped += rest;
        roburoc4_lock_give(&r->lock);
    }
}

/* Waits for datagrams, and a while for more of them, but not until the buffer is full; with the
 * lock. */
static void swap_buffers(roburoc4_recorder *r) {
    uint8_t *full;
    while (r->filled == 0 && !r->ending) {
        roburoc4_signal_wait(&r->changed, &r->lock, IDLE_US);
    }
    if (!r->ending && r->filled < r->capacity / 2) {
        roburoc4_signal_wait(&r->changed, &r->lock, FLUSH_US);
    }
    full = r->buffer;
    r->buffer = r->out;
    r->out = full;
    r->size = r->filled;
    r->filled = 0;
    r->swapped.recorded = r->state.recorded;
    r->swapped.dropped = r->state.dropped;
}

static void run_recorder(void *argument) {
    roburoc4_recorder *r = argument;
    roburoc4_lock_take(&r->lock);
    do {
        swap_buffers(r);
        roburoc4_lock_give(&r->lock);
        write_buffer(r);
        roburoc4_lock_take(&r->lock);
    } while (!r->ending || r->filled > 0);
    roburoc4_lock_give(&r->lock);
    end_file(r);
    roburoc4_lock_take(&r->lock);
    r->ended = 1;
    roburoc4_signal_wake_all(&r->changed);
    roburoc4_lock_give(&r->lock);
}

/* ------------------------------------------------------------------------------- lifecycle --- */

static void free_recorder(roburoc4_recorder *r) {
    if (r != NULL) {
        free(r->buffer);
        free(r->out);
    }
    free(r);
}

/* Options of this or an older size, 0 where they have none. */
static int take_options(roburoc4_recorder_options *out, const roburoc4_recorder_options *options) {
    memset(out, 0, sizeof *out);
    if (options == NULL) {
        return 1;
    }
    if (options->size < offsetof(roburoc4_recorder_options, robot) + sizeof options->robot ||
        !size_known(options->size, sizeof *out)) {
        return 0;
    }
    memcpy(out, options, options->size);
    return 1;
}

/* NULL for invalid options, or without memory; *result says which. */
static roburoc4_recorder *allocate(const char *path, const roburoc4_recorder_options *options,
                                   roburoc4_result *result) {
    const size_t capacity =
        options->buffer_bytes > 0 ? options->buffer_bytes : BUFFER_BYTES_DEFAULT;
    const char *robot = options->robot != NULL ? options->robot : "roburoc4";
    roburoc4_recorder *r = NULL;
    *result = ROBUROC4_ERR_ARGUMENT;
    if (path != NULL && path[0] != '\0' && strlen(path) < sizeof r->wanted &&
        capacity >= BUFFER_BYTES_MIN) {
        *result = ROBUROC4_ERR_SYSTEM;
        r = calloc(1, sizeof *r);
    }
    if (r == NULL) {
        return NULL;
    }
    r->process = roburoc4_process_id();
    r->capacity = capacity;
    r->buffer = malloc(capacity);
    r->out = malloc(capacity);
    r->max_file_bytes = options->max_file_bytes;
    r->max_file_us = options->max_file_s * 1000000u;
    memcpy(r->wanted, path, strlen(path));
    r->kind = roburoc4_os_path_kind(path);
    memcpy(r->robot, robot, strlen(robot) < ROBOT_BYTES_MAX ? strlen(robot) : ROBOT_BYTES_MAX);
    if (r->buffer == NULL || r->out == NULL) {
        free_recorder(r);
        errno = ENOMEM; /* also where free() changes it */
        return NULL;
    }
    return r;
}

/* Lock, signal, file and thread: all or none. */
static int begin_recording(roburoc4_recorder *r) {
    if (!roburoc4_lock_create(&r->lock)) {
        return 0;
    }
    if (roburoc4_signal_create(&r->changed)) {
        r->file = create_file(r, r->state.path);
        if (r->file != ROBUROC4_OS_NO_FILE) {
            r->ending = 1; /* until the thread runs: a full disk is an error now */
            begin_file(r);
            r->ending = 0;
            r->state.files = 1;
            if (!r->gave_up && roburoc4_thread_start(&r->thread, run_recorder, r)) {
                return 1;
            }
            if (r->gave_up) {
                errno = r->state.system_error;
            }
            roburoc4_os_file_close(r->file);
        }
        roburoc4_signal_destroy(&r->changed);
    }
    roburoc4_lock_destroy(&r->lock);
    return 0;
}

roburoc4_recorder *roburoc4_recorder_open(const char *path,
                                          const roburoc4_recorder_options *options,
                                          roburoc4_result *result) {
    roburoc4_recorder_options all;
    roburoc4_result outcome = ROBUROC4_ERR_SIZE;
    roburoc4_recorder *r = NULL;
    if (take_options(&all, options)) {
        r = allocate(path, &all, &outcome);
    }
    if (r != NULL && begin_recording(r)) {
        outcome = ROBUROC4_OK;
    } else {
        int error = errno;
        free_recorder(r);
        r = NULL;
        errno = error;
    }
    if (result != NULL) {
        *result = outcome;
    }
    return r;
}

void roburoc4_recorder_get_state(roburoc4_recorder *r, roburoc4_recorder_state *out) {
    memset(out, 0, sizeof *out);
    if (r->process == roburoc4_process_id()) {
        roburoc4_lock_take(&r->lock);
        *out = r->state;
        roburoc4_lock_give(&r->lock);
    }
}

int roburoc4_recorder_finish(roburoc4_recorder *r) {
    const uint64_t begun_us = roburoc4_udp_now_us();
    int ended;
    if (r->process != roburoc4_process_id()) {
        return 1;
    }
    if (roburoc4_thread_is_over(&r->thread)) {
        return r->ended; /* Windows may have ended it, with the lock */
    }
    roburoc4_lock_take(&r->lock);
    r->ending = 1;
    roburoc4_signal_wake_all(&r->changed);
    while (!r->ended && roburoc4_udp_now_us() - begun_us < FINISH_US) {
        roburoc4_signal_wait(&r->changed, &r->lock, RETRY_US);
    }
    ended = r->ended;
    roburoc4_lock_give(&r->lock);
    return ended;
}

roburoc4_result roburoc4_recorder_close(roburoc4_recorder *r, roburoc4_recorder_state *last) {
    roburoc4_result result = ROBUROC4_OK;
    int is_mine;
    if (r == NULL) {
        return ROBUROC4_OK;
    }
    is_mine = r->process == roburoc4_process_id();
    if (!roburoc4_recorder_finish(r)) {
        if (last != NULL) {
            roburoc4_recorder_get_state(r, last);
            last->system_error = ETIMEDOUT;
        }
        return ROBUROC4_ERR_SYSTEM; /* the thread still uses the memory, perhaps forever */
    }
    if (last != NULL) {
        roburoc4_recorder_get_state(r, last);
    }
    if (is_mine) {
        roburoc4_thread_join(&r->thread);
        roburoc4_signal_destroy(&r->changed);
        roburoc4_lock_destroy(&r->lock);
        result = r->gave_up ? ROBUROC4_ERR_SYSTEM : ROBUROC4_OK;
    }
    free_recorder(r);
    return result;
}
