/* SPDX-License-Identifier: MIT
 *
 * What an AVR (ATmega1284P, by simavr) lends to the runner: the serial port prints, and sleeping
 * with interrupts off ends the simulation.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

#include "check.h"

void port_begin(void) {
    UCSR0B = 1U << TXEN0;
}

void port_put(char character) {
    while ((UCSR0A & 1U << UDRE0) == 0) {
    }
    UDR0 = (uint8_t)character;
}

void port_end(int status) {
    (void)status; /* the last line tells */
    cli();
    for (;;) {
        sleep_mode();
    }
}
