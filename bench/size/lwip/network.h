/* SPDX-License-Identifier: MIT
 *
 * An Ethernet interface whose driver does nothing, for programs that are measured with lwIP's
 * stack.
 */
#ifndef SIZE_LWIP_NETWORK_H
#define SIZE_LWIP_NETWORK_H
#include "lwip/etharp.h"
#include "lwip/init.h"
#include "lwip/timeouts.h"
#include "netif/ethernet.h"

static struct netif interface;
static struct pbuf *volatile arrived;
static volatile err_t sent;
static volatile uint32_t clock_ms;

u32_t sys_now(void) {
    return clock_ms;
}

static err_t send_frame(struct netif *to, struct pbuf *frame) {
    (void)to;
    (void)frame;
    return sent;
}

static err_t set_up(struct netif *made) {
    made->output = etharp_output;
    made->linkoutput = send_frame;
    made->hwaddr_len = ETH_HWADDR_LEN;
    made->mtu = 1500;
    made->flags = NETIF_FLAG_BROADCAST | NETIF_FLAG_ETHARP | NETIF_FLAG_LINK_UP;
    return ERR_OK;
}

static void start_network(void) {
    ip4_addr_t own, mask, gateway;
    IP4_ADDR(&own, 192, 168, 0, 5);
    IP4_ADDR(&mask, 255, 255, 255, 0);
    IP4_ADDR(&gateway, 192, 168, 0, 1);
    lwip_init();
    netif_add(&interface, &own, &mask, &gateway, NULL, set_up, ethernet_input);
    netif_set_default(&interface);
    netif_set_up(&interface);
}

static void poll_network(void) {
    if (arrived != NULL) {
        interface.input(arrived, &interface);
        arrived = NULL;
    }
    sys_check_timeouts();
}
#endif
