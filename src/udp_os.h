/* SPDX-License-Identifier: MIT
 *
 * udp_os.h - what udp.c and pump.c need of the operating system's sockets: implemented by
 * udp_posix.c and by udp_winsock.c, of which a build has one. Not public.
 */
#ifndef ROBUROC4_UDP_OS_H
#define ROBUROC4_UDP_OS_H

#include "roburoc4_udp.h"

#define ROBUROC4_OS_NO_SOCKET (-1)

/** What a socket call came to: a ROBUROC4_FAULT_* and the system's number for it. */
typedef struct roburoc4_os_outcome {
    uint32_t fault;
    int32_t system_error;
} roburoc4_os_outcome;

/** Results of roburoc4_os_receive(). */
#define ROBUROC4_OS_DATAGRAM 0
#define ROBUROC4_OS_EMPTY 1     /* nothing is there */
#define ROBUROC4_OS_OVERSIZED 2 /* one was there, longer than the buffer: it is gone */
#define ROBUROC4_OS_FAULT 3     /* the network's answer to something sent before */
#define ROBUROC4_OS_BROKEN 4    /* this is no socket any more */

/** The numeric address of a name or address; port and all other fields of *out are set too. */
roburoc4_result roburoc4_os_resolve(const char *host, uint16_t port, roburoc4_address *out);
/** The IP address alone, without zone and port, with a NUL. 0 where it does not fit. */
int roburoc4_os_ip_text(const roburoc4_address *address, char *buffer, size_t capacity);

/** A non-blocking datagram socket of the address's family, or ROBUROC4_OS_NO_SOCKET. */
int64_t roburoc4_os_socket(const roburoc4_address *address, roburoc4_os_outcome *outcome);
void roburoc4_os_close(int64_t socket);
/** Connect, or connect anew: the system chooses this end's address again. */
roburoc4_os_outcome roburoc4_os_connect(int64_t socket, const roburoc4_address *address);
roburoc4_os_outcome roburoc4_os_send(int64_t socket, const uint8_t *datagram, size_t size);
/** One of ROBUROC4_OS_DATAGRAM ...; *outcome is set for _FAULT and _BROKEN. */
int roburoc4_os_receive(int64_t socket, uint8_t *buffer, size_t capacity, size_t *size,
                        roburoc4_os_outcome *outcome);
/** Wait until one of the two (each may be ROBUROC4_OS_NO_SOCKET) can be read, the time is over, or
 *  a signal handler ran. ROBUROC4_ERR_SYSTEM where one of them is unusable. */
roburoc4_result roburoc4_os_wait(int64_t socket, int64_t wake, uint64_t timeout_us);

#endif
