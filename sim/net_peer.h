/* SPDX-License-Identifier: MIT
 *
 * A peer's number from its IPv4 address and port, and back; behind the system's own headers.
 */
#ifndef ROBUROC4_SIM_NET_PEER_H
#define ROBUROC4_SIM_NET_PEER_H

#include <stdint.h>
#include <string.h>

static inline uint64_t net_peer_of(const struct sockaddr_in *address) {
    return (uint64_t)ntohl(address->sin_addr.s_addr) << 16 | ntohs(address->sin_port);
}

static inline struct sockaddr_in net_address_of(uint64_t peer) {
    struct sockaddr_in address;
    memset(&address, 0, sizeof address);
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl((uint32_t)(peer >> 16));
    address.sin_port = htons((uint16_t)(peer & 0xFFFFU));
    return address;
}

#endif
