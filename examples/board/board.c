/* SPDX-License-Identifier: MIT
 *
 * The board of docs/firmware.md with lwIP and without an operating system. It runs in QEMU, too:
 * see that page. The keys of its serial port are the joystick: 0 to 9 hold the switch and drive
 * forward with as many tenths of a metre per second; any other key releases the switch.
 */
#include "board.h"

#include <string.h>

#include "lan9118.h"
#include "lwip/etharp.h"
#include "lwip/init.h"
#include "lwip/timeouts.h"
#include "lwip/udp.h"
#include "mps2.h"

#ifndef ROBOT_PORT
#define ROBOT_PORT 60000
#endif

static struct netif network;
static ip4_addr_t robot_address;
static struct udp_pcb *robot;
static struct pbuf *arrived[4];
static unsigned arrived_count;

/* Counts the wraps of a 32-bit timer: call it more often than that wraps, and not from interrupts.
 */
uint64_t board_now_us(void) {
    static uint32_t before, wraps;
    const uint32_t now = COUNTER;
    wraps += now < before;
    before = now;
    return (uint64_t)wraps << 32 | now;
}

u32_t sys_now(void) {
    return (u32_t)(board_now_us() / 1000);
}

/* From the robot only, as `robot` is connected. */
static void on_datagram(void *argument, struct udp_pcb *pcb, struct pbuf *datagram,
                        const ip_addr_t *from, u16_t port) {
    (void)argument, (void)pcb, (void)from, (void)port;
    if (arrived_count == sizeof arrived / sizeof *arrived) {
        pbuf_free(datagram);
    } else {
        arrived[arrived_count++] = datagram;
    }
}

size_t board_udp_receive(uint8_t *datagram, size_t capacity) {
    size_t size = 0;
    if (arrived_count == 0) {
        lan9118_poll(&network);
        sys_check_timeouts();
    }
    while (arrived_count > 0 && size == 0) {
        struct pbuf *next = arrived[0];
        memmove(arrived, arrived + 1, --arrived_count * sizeof *arrived);
        if (next->tot_len <= capacity) { /* else it is dropped */
            size = pbuf_copy_partial(next, datagram, next->tot_len, 0);
        }
        pbuf_free(next);
    }
    return size;
}

/* What cannot be sent now is dropped. lwIP would keep a datagram until it knows the robot's
 * Ethernet address, and a command that comes late is worse than none. */
void board_udp_send(const uint8_t *datagram, size_t size) {
    struct eth_addr *ethernet;
    const ip4_addr_t *address;
    struct pbuf *copy;
    if (etharp_find_addr(&network, &robot_address, &ethernet, &address) < 0) {
        etharp_request(&network, &robot_address);
        return;
    }
    copy = pbuf_alloc(PBUF_TRANSPORT, (u16_t)size, PBUF_RAM);
    if (copy != NULL) {
        pbuf_take(copy, datagram, (u16_t)size);
        udp_send(robot, copy);
        pbuf_free(copy);
    }
}

int board_drive_wanted(float *linear_m_s, float *angular_rad_s) {
    static uint32_t key;
    if (UART_STATE & UART_RECEIVED) {
        key = UART_DATA;
    }
    *linear_m_s = (float)(key - '0') * 0.1f;
    *angular_rad_s = 0;
    return key >= '0' && key <= '9';
}

static void set_up_board(void) {
    COUNTER = 0u - 5000000u; /* wraps for the first time after 5 s, where a mistake is seen */
    COUNTER_PRESCALER = CLOCK_HZ / 1000000 - 1;
    UART_DIVIDER = CLOCK_HZ / 115200;
    UART_CONTROL = UART_RECEIVE;
    SYSTICK_RELOAD = CLOCK_HZ / 1000 - 1;
    SYSTICK_CONTROL = SYSTICK_RUN;
}

static void set_up_network(void) {
    ip4_addr_t own, mask;
    IP4_ADDR(&own, 192, 168, 0, 5);
    IP4_ADDR(&mask, 255, 255, 255, 0);
    IP4_ADDR(&robot_address, 192, 168, 0, 2);
    lwip_init();
    netif_add(&network, &own, &mask, NULL, NULL, lan9118_init, netif_input);
    netif_set_default(&network);
    netif_set_up(&network);
    robot = udp_new();
    udp_recv(robot, on_datagram, NULL);
    udp_connect(robot, &robot_address, ROBOT_PORT);
}

int main(void) {
    set_up_board();
    set_up_network();
    robot_begin();
    for (;;) {
        robot_poll();
        __asm__ volatile("wfi"); /* for a millisecond at most */
    }
}
