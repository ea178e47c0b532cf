/* SPDX-License-Identifier: MIT
 *
 * For Frama-C's WP: a cursor of src/bytes.h never leaves its buffer, whatever is asked of it, for
 * buffers of any length; views lie in their datagram, as Eva believes (believed.h). Never compiled.
 */
#include "roburoc4.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* WP's memory has typed cells: copying bytes to bytes is told by its effect. Functions that copy
 * numbers to bytes are not among those proved here. */
/*@ requires \valid(to + (0 .. size - 1)) && \valid_read(from + (0 .. size - 1));
    assigns to[0 .. size - 1]; */
void copy_bytes(uint8_t *to, const uint8_t *from, size_t size);
#define memcpy copy_bytes

#include "codec.c"

/*@ predicate reads(reader *r) = \valid(r) && \valid_read(r->at + (0 .. r->left - 1)); */
/*@ predicate writes(writer *w) = \valid(w) && \valid(w->at + (0 .. w->left - 1)) &&
        \separated(w, w->at + (0 .. w->left - 1)); */

/*@ ensures \result.at == data && \result.left == size && !\result.failed;
    assigns \nothing; */
static inline reader reader_of(const uint8_t *data, size_t size);

/*@ requires reads(r);
    assigns *r;
    ensures reads(r);
    ensures inside: \old(r->at) <= r->at && r->at + r->left == \old(r->at) + \old(r->left);
    behavior there:
      assumes !r->failed && count <= r->left;
      ensures \result == \old(r->at) && r->at == \old(r->at) + count && !r->failed;
      ensures r->left == \old(r->left) - count;
      ensures \valid_read(\result + (0 .. count - 1));
    behavior out:
      assumes r->failed || count > r->left;
      ensures \result == \null && r->failed;
      ensures r->at == \old(r->at) && r->left == \old(r->left);
    complete behaviors;
    disjoint behaviors; */
static inline const uint8_t *read_bytes(reader *r, size_t count);

/*@ requires \valid_read(b + (0 .. 1));
    assigns \nothing; */
static inline uint16_t load_u16(const uint8_t *b);
/*@ requires \valid_read(b + (0 .. 3));
    assigns \nothing; */
static inline uint32_t load_u32(const uint8_t *b);
/*@ requires \valid_read(b + (0 .. 7));
    assigns \nothing; */
static inline uint64_t load_u64(const uint8_t *b);

/*@ requires reads(r);
    assigns *r;
    ensures reads(r);
    ensures inside: \old(r->at) <= r->at && r->at + r->left == \old(r->at) + \old(r->left); */
static inline uint8_t read_u8(reader *r);

/*@ requires reads(r);
    assigns *r;
    ensures reads(r);
    ensures inside: \old(r->at) <= r->at && r->at + r->left == \old(r->at) + \old(r->left); */
static inline uint16_t read_u16(reader *r);

/*@ requires reads(r);
    assigns *r;
    ensures reads(r);
    ensures inside: \old(r->at) <= r->at && r->at + r->left == \old(r->at) + \old(r->left); */
static inline uint32_t read_u32(reader *r);

/*@ requires reads(r);
    assigns *r;
    ensures reads(r);
    ensures inside: \old(r->at) <= r->at && r->at + r->left == \old(r->at) + \old(r->left); */
static inline uint64_t read_u64(reader *r);

/* ---- writing ---- */

/*@ requires writes(w) && \valid_read(bytes + (0 .. count - 1));
    requires \separated(w, bytes + (0 .. count - 1), w->at + (0 .. w->left - 1));
    assigns *w, w->at[0 .. count - 1];
    ensures inside: writes(w);
    behavior fits:
      assumes count <= w->left;
      assigns *w, w->at[0 .. count - 1];
      ensures exactly: w->at == \old(w->at) + count && w->left == \old(w->left) - count;
    behavior too_long:
      assumes count > w->left;
      assigns w->left;
      ensures nothing: w->at == \old(w->at) && w->left == 0;
    complete behaviors;
    disjoint behaviors; */
static inline void write_bytes(writer *w, const uint8_t *bytes, size_t count);

/* ---- codec.c: a claim is all or nothing, surplus never wraps, views lie in the datagram ---- */

/*@ requires \valid(w);
    assigns w->left;
    ensures all_or_nothing: (length <= \old(w->left) && w->left == length) ||
        (length > \old(w->left) && w->left == 0 && \result == ROBUROC4_ERR_BUFFER); */
static roburoc4_result claim(writer *w, size_t length);

/*@ requires \valid_read(r);
    assigns \nothing;
    ensures short: r->left < length <==> \result == ROBUROC4_ERR_SHORT;
    ensures else_a_number: r->left >= length ==> \result >= 0; */
static roburoc4_result surplus(const reader *r, size_t length);

/*@ assigns \nothing;
    ensures \result == (channels + 7) / 8; */
uint32_t roburoc4_digital_blocks(uint32_t channels);

/*@ requires reads(r) && !r->failed && r->at != \null;
    requires \valid(analog_view) && \valid(digital_view);
    requires \separated(r, analog_view, digital_view);
    assigns *r, *analog_view, *digital_view;
    ensures there: \result >= 0 ==> *analog_view != \null && *digital_view != \null;
    ensures inside: \result >= 0 ==> *analog_view == \old(r->at) &&
        *digital_view == \old(r->at) + 4 * analog &&
        4 * analog + (digital + 7) / 8 <= \old(r->left); */
static roburoc4_result read_channels(reader *r, uint32_t analog, uint32_t digital,
                                     const uint8_t **analog_view, const uint8_t **digital_view);
