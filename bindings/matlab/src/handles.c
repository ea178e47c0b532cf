/* SPDX-License-Identifier: MIT */
#include "handles.h"

#include <stddef.h>

#include "convert.h"
#include "roburoc4_udp.h"

static struct {
    void *object; /* NULL: the slot is free */
    double id;
    int kind;
} table[HANDLES_MAX];

static uint64_t generation;

double handles_add(int kind, void *object) {
    if (generation == 0) {
        /* Milliseconds: above any generation that this MEX file used before it was cleared and
         * loaded again. */
        generation = 1 + roburoc4_udp_now_us() / 1000;
    }
    for (uint32_t place = 0; place < HANDLES_MAX; place++) {
        if (table[place].object == NULL) {
            table[place].object = object;
            table[place].kind = kind;
            table[place].id = (double)(generation++ * HANDLES_MAX + place);
            return table[place].id;
        }
    }
    return fail(FAIL_LIMIT, "there are %d robots and simulators; delete one", HANDLES_MAX);
}

void *handles_find(int kind, double id) {
    for (uint32_t place = 0; place < HANDLES_MAX; place++) {
        if (table[place].kind == kind && table[place].id == id) {
            return table[place].object;
        }
    }
    return NULL;
}

void handles_remove(const void *object) {
    for (uint32_t place = 0; place < HANDLES_MAX; place++) {
        if (table[place].object == object) {
            table[place].object = NULL;
        }
    }
}

void handles_each(int kind, void (*act)(void *object)) {
    for (uint32_t place = 0; place < HANDLES_MAX; place++) {
        if (table[place].kind == kind && table[place].object != NULL) {
            act(table[place].object);
        }
    }
}

uint32_t handles_count(int kind) {
    uint32_t place, count = 0;
    for (place = 0; place < HANDLES_MAX; place++) {
        count += table[place].kind == kind && table[place].object != NULL;
    }
    return count;
}
