/* SPDX-License-Identifier: MIT
 *
 * What a target with a C library and a terminal lends to the walk.
 */
#include <stdio.h>
#include <stdlib.h>

#include "port.h"

void port_begin(void) {}

void port_put(char character) {
    (void)putchar(character);
}

void port_end(int status) {
    (void)fflush(stdout);
    exit(status);
}
