/* SPDX-License-Identifier: MIT
 *
 * Contracts of src/codec.c and src/link.c that WP proves (wp/cursor.c, wp/gap.c) and that Eva,
 * which does not relate one value to another, believes where it analyses the client (eva/client.c).
 * To be included after codec.c and link.c.
 */
#ifndef PROOF_BELIEVED_H
#define PROOF_BELIEVED_H

/*@ ensures views_are_there: \result >= 0 ==> *analog_view != \null && *digital_view != \null; */
static roburoc4_result read_channels(reader *r, uint32_t analog, uint32_t digital,
                                     const uint8_t **analog_view, const uint8_t **digital_view);

/*@ requires newer: gap >= 1; */
static void learn_period(service *s, uint16_t gap);

#endif
