/* SPDX-License-Identifier: MIT
 *
 * The start of a program on a Cortex-M. For another board, use the vendor's.
 */
#include <string.h>

#include "mps2.h"

/* From mps2.ld. */
extern uint32_t data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];

int main(void);

static void on_reset(void) {
#ifdef __ARM_FP
    FPU_ACCESS |= FPU_FULL_ACCESS;
    __asm__ volatile("dsb\n isb");
#endif
    memcpy(data_begin, data_from, (size_t)(data_end - data_begin) * sizeof *data_begin);
    memset(bss_begin, 0, (size_t)(bss_end - bss_begin) * sizeof *bss_begin);
    main();
}

/* A board that hangs sends nothing, so the robot stops itself. A real one restarts here, by its
 * watchdog. */
static void on_fault(void) {
    for (;;) {
    }
}

static void on_tick(void) {} /* only ends the main loop's wait */

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    void (*handlers[15])(void);
} vectors = {stack_top,
             {on_reset, on_fault, on_fault, on_fault, on_fault, on_fault, NULL, NULL, NULL, NULL,
              on_fault, on_fault, NULL, on_fault, on_tick}};
