/* SPDX-License-Identifier: MIT
 *
 * See lan9118.h. Section numbers are those of the LAN9118's data sheet.
 */
#include "lan9118.h"

#include <string.h>

#include "lwip/etharp.h"
#include "lwip/pbuf.h"
#include "mps2.h"

/* 5.3: registers. */
#define RX_DATA REGISTER(LAN9118 + 0x00)
#define TX_DATA REGISTER(LAN9118 + 0x20)
#define RX_STATUS REGISTER(LAN9118 + 0x40)
#define TX_STATUS REGISTER(LAN9118 + 0x48)
#define TX_CONFIG REGISTER(LAN9118 + 0x70)
#define HARDWARE_CONFIG REGISTER(LAN9118 + 0x74)
#define RX_CONTROL REGISTER(LAN9118 + 0x78)
#define RX_FIFO REGISTER(LAN9118 + 0x7C)
#define TX_FIFO REGISTER(LAN9118 + 0x80)
#define MAC_COMMAND REGISTER(LAN9118 + 0xA4)
#define MAC_DATA REGISTER(LAN9118 + 0xA8)

#define TX_ON (1u << 1)
#define RESET (1u << 0)
#define DISCARD (1u << 31)
#define BUSY (1u << 31)
#define FIRST_AND_LAST (3u << 12)
#define RX_ERROR (1u << 15)
#define COUNT(fifo) ((fifo) >> 16 & 0xFFu) /* of statuses in a FIFO */

/* 5.4: registers of the MAC. */
enum { MAC_CONTROL = 1, MAC_HIGH = 2, MAC_LOW = 3, PHY_ACCESS = 6, PHY_DATA = 7 };
#define MAC_RUN ((1u << 20) | (1u << 3) | (1u << 2)) /* full duplex, sends, receives */
#define MAC_READ (1u << 30)
#define PHY_STATUS ((1u << 11) | (1u << 6)) /* its register 1 */
#define PHY_BUSY 1u
#define LINK_UP (1u << 2)

static void mac_write(uint32_t index, uint32_t value) {
    MAC_DATA = value;
    MAC_COMMAND = BUSY | index;
    while (MAC_COMMAND & BUSY) {
    }
}

static uint32_t mac_read(uint32_t index) {
    MAC_COMMAND = BUSY | MAC_READ | index;
    while (MAC_COMMAND & BUSY) {
    }
    return MAC_DATA;
}

static int link_is_up(void) {
    mac_write(PHY_ACCESS, PHY_STATUS | PHY_BUSY);
    while (mac_read(PHY_ACCESS) & PHY_BUSY) {
    }
    return (mac_read(PHY_DATA) & LINK_UP) != 0;
}

static err_t send_frame(struct netif *netif, struct pbuf *frame) {
    static uint32_t words[1518 / 4 + 1]; /* a frame can be in several pieces of any length */
    const uint32_t length = pbuf_copy_partial(frame, words, sizeof words, 0);
    (void)netif;
    while (COUNT(TX_FIFO) > 0) {
        (void)TX_STATUS;
    }
    if ((TX_FIFO & 0xFFFFu) < length + 16) {
        return ERR_MEM; /* dropped: a command must not wait behind others */
    }
    TX_DATA = FIRST_AND_LAST | length;
    TX_DATA = length;
    for (uint32_t at = 0; at < (length + 3) / 4; at++) {
        TX_DATA = words[at];
    }
    return ERR_OK;
}

static struct pbuf *receive_frame(void) {
    const uint32_t status = RX_STATUS,
                   length = status >> 16 & 0x3FFFu; /* with 4 bytes of checksum */
    struct pbuf *frame = NULL;
    uint32_t word;
    if (!(status & RX_ERROR) && length > 4) {
        frame = pbuf_alloc(PBUF_RAW, (u16_t)length, PBUF_POOL);
    }
    if (frame == NULL) {
        RX_CONTROL = DISCARD;
        while (RX_CONTROL & DISCARD) {
        }
        return NULL;
    }
    for (uint32_t at = 0; at < length; at += 4) {
        word = RX_DATA;
        pbuf_take_at(frame, &word, (u16_t)LWIP_MIN(4u, length - at), (u16_t)at);
    }
    pbuf_realloc(frame, (u16_t)(length - 4));
    return frame;
}

void lan9118_poll(struct netif *netif) {
    while (COUNT(RX_FIFO) > 0) {
        struct pbuf *frame = receive_frame();
        if (frame != NULL && netif->input(frame, netif) != ERR_OK) {
            pbuf_free(frame);
        }
    }
    if (link_is_up()) {
        netif_set_link_up(netif);
    } else {
        netif_set_link_down(netif);
    }
}

err_t lan9118_init(struct netif *netif) {
    /* Locally administered; a product has one of its own. */
    static const uint8_t address[ETH_HWADDR_LEN] = {0x02, 'r', 'o', 'b', 'o', '4'};
    HARDWARE_CONFIG = RESET;
    while (HARDWARE_CONFIG & RESET) {
    }
    mac_write(MAC_LOW, address[0] | (uint32_t)address[1] << 8 | (uint32_t)address[2] << 16 |
                           (uint32_t)address[3] << 24);
    mac_write(MAC_HIGH, address[4] | (uint32_t)address[5] << 8);
    mac_write(MAC_CONTROL, MAC_RUN);
    TX_CONFIG = TX_ON;
    memcpy(netif->hwaddr, address, sizeof address);
    netif->hwaddr_len = ETH_HWADDR_LEN;
    netif->mtu = 1500;
    netif->flags = NETIF_FLAG_BROADCAST | NETIF_FLAG_ETHARP;
    netif->output = etharp_output;
    netif->linkoutput = send_frame;
    return ERR_OK;
}
