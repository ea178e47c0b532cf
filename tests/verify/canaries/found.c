/* SPDX-License-Identifier: MIT
 *
 * A fault on purpose that every analyser of the sources must find: memory is freed twice.
 */
#include <stdlib.h>

void freed_twice(int again);

void freed_twice(int again) {
    char *memory = malloc(16);
    if (memory == NULL) {
        return;
    }
    free(memory);
    if (again != 0) {
        free(memory);
    }
}
