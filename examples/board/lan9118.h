/* SPDX-License-Identifier: MIT
 *
 * lwIP's driver of an SMSC LAN9118, an Ethernet controller with FIFOs, without interrupts.
 */
#ifndef LAN9118_H
#define LAN9118_H
#include "lwip/netif.h"

/* For netif_add(). */
err_t lan9118_init(struct netif *netif);
/* Hand what was received to lwIP, and report a cable that was plugged in or out. */
void lan9118_poll(struct netif *netif);
#endif
