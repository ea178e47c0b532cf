/* SPDX-License-Identifier: MIT
 *
 * abi.c - compiles only if the headers have everything that an earlier version released, as it was
 * (scripts/abi writes released.inc): each function with its type, each public field with its type
 * and place, each constant with its value, on machines of 32 and of 64 bits. docs/ABI.md says what
 * may change, and what to do if it must.
 */
#include <stddef.h>

#include "roburoc4_pump.h"

#include "roburoc4_move.h"
#include "roburoc4_robot_file.h"
#include "roburoc4_sim.h"

#define SAME(condition, text) _Static_assert(condition, text "; docs/ABI.md says what may change")
/* On machines of 64 bits, of 32, and on those of 32 that align 64-bit numbers to 4 bytes (i386). */
#define ON(bits_64, bits_32, bits_32_align_4)                                                      \
    (sizeof(void *) == 8                           ? (bits_64)                                     \
     : offsetof(struct alignment, number) % 8 == 0 ? (bits_32)                                     \
                                                   : (bits_32_align_4))
struct alignment {
    char first;
    uint64_t number;
};
#define IS(object, type) _Generic(&(object), type : 1, default : 0)
#define FUNCTION(name, result, arguments)                                                          \
    SAME(IS(name, result(*) arguments), #name "() has other parameters or another result");
#define FROZEN(type, bytes) SAME(sizeof(type) == (bytes), #type " has another size");
#define GROWS(type, bytes) SAME(sizeof(type) >= (bytes), #type " has lost a field at its end");
#define FIELD(type, field, pointer, at)                                                            \
    SAME(IS(((type *)0)->field, pointer), #type "." #field " has another type");                   \
    SAME(offsetof(type, field) == (at), #type "." #field " is at another place");
#define CONSTANT(name, value)                                                                      \
    SAME((uint32_t)(name) == (uint32_t)(value), #name " has another value");
#define AT_LEAST(name, value) SAME((name) >= (value), #name " is less than it was");

#include "released.inc"
