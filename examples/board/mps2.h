/* SPDX-License-Identifier: MIT
 *
 * Registers of Arm's MPS2 boards with a Cortex-M3 or M7 (application notes 385 and 500), as far as
 * this example uses them. For another board, delete this file and use the vendor's header.
 */
#ifndef MPS2_H
#define MPS2_H
#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))

#define CLOCK_HZ 25000000u

/* A serial port: the example's joystick. */
#define UART_DATA REGISTER(0x40004000)
#define UART_STATE REGISTER(0x40004004)
#define UART_RECEIVED 2u
#define UART_CONTROL REGISTER(0x40004008)
#define UART_RECEIVE 2u
#define UART_DIVIDER REGISTER(0x40004010)

/* A counter of 32 bits that counts each (prescaler + 1) clocks. */
#define COUNTER REGISTER(0x40028018)
#define COUNTER_PRESCALER REGISTER(0x4002801C)

/* The Ethernet controller, an SMSC LAN9118. */
#ifdef __ARM_ARCH_7EM__
#define LAN9118 0xA0000000u
#else
#define LAN9118 0x40200000u
#endif

/* Of every Cortex-M. */
#define SYSTICK_CONTROL REGISTER(0xE000E010)
#define SYSTICK_RUN 7u /* on, with an interrupt, from the processor's clock */
#define SYSTICK_RELOAD REGISTER(0xE000E014)
#define FPU_ACCESS REGISTER(0xE000ED88)
#define FPU_FULL_ACCESS (0xFu << 20)
#endif
