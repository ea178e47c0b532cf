/* SPDX-License-Identifier: MIT
 *
 * What the server needs of the operating system: UDP sockets, a clock, lines from standard input
 * and the request to stop. Implemented by os_posix.c and os_windows.c. Not part of src/os.h: a
 * robot's sockets are bound, serve any peer, and are waited for together, while a client has one
 * connected socket; the two would share only a clock.
 */
#ifndef ROBUROC4_SIM_NET_H
#define ROBUROC4_SIM_NET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct net_sockets net_sockets;

/* Room for `sockets` sockets, all closed. NULL: no memory, or the system refuses so many. */
net_sockets *net_create(size_t sockets);
void net_destroy(net_sockets *net);

/* Open socket `index` on an IPv4 address and port (0: any free one), and store the port. Returns 0
 * or the system's error number. */
int net_bind(net_sockets *net, size_t index, const char *address, uint16_t port, uint16_t *bound);
void net_error_text(int error, char *text, size_t capacity);
/* Whether `address` is a numeric IPv4 address. */
bool net_is_address(const char *address);

/* Sleep until a datagram is there, or input if `input`, or timeout_us has passed. */
void net_wait(net_sockets *net, bool input, uint64_t timeout_us);
/* Whether socket `index` had something at the last net_wait(). */
bool net_is_ready(const net_sockets *net, size_t index);

/* Take a datagram of socket `index` and its sender; -1 when there is none. */
ptrdiff_t net_receive(net_sockets *net, size_t index, uint64_t *peer, uint8_t *buffer,
                      size_t capacity);
/* Send a datagram, or drop it where the system cannot take it now. */
void net_send(net_sockets *net, size_t index, uint64_t peer, const uint8_t *data, size_t size);
/* Take a report that a peer's port is closed; false when there is none. */
bool net_refused(net_sockets *net, size_t index, uint64_t *peer);

/* Read standard input without waiting: the length, 0 for nothing yet, -1 at the end. To be called
 * after net_wait(net, true, ...). */
ptrdiff_t net_read_input(net_sockets *net, char *buffer, size_t capacity);

/* A clock in microseconds that never goes back. */
uint64_t net_now_us(void);
/* Take SIGINT, SIGTERM and Ctrl-C as a request to stop from now on: for programs, not libraries. */
void net_listen_for_stop(void);
/* Whether a stop was requested. */
bool net_stop_wanted(void);

#endif
