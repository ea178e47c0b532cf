/* SPDX-License-Identifier: MIT
 *
 * What a bare Cortex-M under qemu lends to the walk: a vector table, memory made ready, and
 * semihosting, by which a debugger or an emulator prints and ends the program. A fault ends it too.
 */
#include <stdint.h>
#include <string.h>

#include "port.h"

#define SYS_WRITEC 0x03
#define SYS_EXIT_EXTENDED 0x20
#define APPLICATION_EXIT 0x20026U

/* From cortex_m.ld. */
extern uint32_t data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];

int main(void);

static void semihost(uint32_t operation, const void *argument) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

void port_begin(void) {}

void port_put(char character) {
    semihost(SYS_WRITEC, &character);
}

void port_end(int status) {
    const uint32_t reason[2] = {APPLICATION_EXIT, (uint32_t)status};
    for (;;) {
        semihost(SYS_EXIT_EXTENDED, reason);
    }
}

static void on_reset(void) {
    memcpy(data_begin, data_from, (size_t)(data_end - data_begin) * sizeof *data_begin);
    memset(bss_begin, 0, (size_t)(bss_end - bss_begin) * sizeof *bss_begin);
    port_end(main());
}

static void on_fault(void) {
    port_end(1);
}

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    void (*handlers[6])(void); /* reset, then all fault handlers */
} vectors = {stack_top, {on_reset, on_fault, on_fault, on_fault, on_fault, on_fault}};
