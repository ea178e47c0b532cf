/* SPDX-License-Identifier: MIT
 *
 * roburoc4_udp.h - a roburoc4_client on a UDP socket and a clock: Linux, macOS, BSD, Windows.
 *
 * A program is a loop around one call:
 *
 *     roburoc4_address address;
 *     roburoc4_udp udp;
 *     roburoc4_client client;
 *
 *     roburoc4_udp_resolve("192.168.0.2", ROBUROC4_DEFAULT_PORT, &address);
 *     roburoc4_udp_open(&udp, sizeof udp, &address);
 *     roburoc4_client_init(&client, sizeof client, NULL);
 *     roburoc4_client_start(&client, roburoc4_udp_now_us());
 *     while (running) {
 *         roburoc4_udp_wait(&udp, &client, 50000);
 *         uint32_t events = roburoc4_client_take_events(&client);
 *         ...
 *     }
 *     roburoc4_client_close(&client, roburoc4_udp_now_us());
 *     while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE)
 *         roburoc4_udp_wait(&udp, &client, 50000);
 *     roburoc4_udp_close(&udp);
 *
 * A program with its own event loop (poll, epoll, select, Qt, libuv) watches roburoc4_udp_fd() and
 * roburoc4_client_next_deadline(), and calls roburoc4_udp_wait() with a time-out of 0 when either
 * is due.
 *
 * WHAT IT PROMISES
 *
 *   Whose datagrams   the socket is connected, so only datagrams from the robot's own address and
 *                     port are received.
 *   Fresh commands    the clock is read right before each roburoc4_client_poll_transmit(), and the
 *                     datagram is sent at once. What the socket does not accept is dropped and
 *                     counted, never queued. The send buffer is small for the same reason.
 *   An absent robot   closed port, no route, unplugged cable, firewall: all of these are states
 *                     (the field fault), not errors, and the client keeps trying. When the
 *                     machine's own address changes, the socket is connected again.
 *   A flood           of datagrams does not delay what is due to be sent.
 *
 * Results, units and conventions are those of roburoc4.h. One roburoc4_udp is used by one thread at
 * a time; roburoc4_pump.h serves many threads.
 */
#ifndef ROBUROC4_UDP_H
#define ROBUROC4_UDP_H

#include "roburoc4.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------- addresses --- */

/** A numeric address and port (frozen: this struct never changes). */
typedef struct roburoc4_address {
    uint8_t ip[16];   /* in network order; IPv4 uses the first four bytes, the others are 0 */
    uint32_t scope;   /* IPv6: the zone (interface number) of a link-local address, else 0 */
    uint16_t port;    /* 1 to 65535, in the host's byte order */
    uint8_t family;   /* 4 or 6 */
    uint8_t reserved; /* 0 */
} roburoc4_address;

/** Enough for every text of roburoc4_udp_address_text(), including its NUL. */
#define ROBUROC4_ADDRESS_TEXT_SIZE 72

/** Resolve "HOST", "HOST:PORT", "[IPV6]", "[IPV6]:PORT" or a bare IPv6 address. HOST is a name or
 *  an address; a name with IPv4 and IPv6 addresses resolves to IPv4, as the robot has that.
 *  default_port (0: ROBUROC4_DEFAULT_PORT) is used if the text has no port. THIS CALL BLOCKS for
 *  names (for seconds, with a slow name server), never for addresses: call it once, before driving.
 *  ROBUROC4_ERR_ADDRESS: the text has none of these forms, or its port is not 1 to 65535.
 *  ROBUROC4_ERR_RESOLVE: the name has no address. *out is then not written. Any thread. */
ROBUROC4_API roburoc4_result roburoc4_udp_resolve(const char *host, uint16_t default_port,
                                                  roburoc4_address *out);
/** The address as NUL-terminated text, "192.168.0.2:60000" or "[fe80::1%2]:60000". Returns its
 *  length, or ROBUROC4_ERR_BUFFER, or ROBUROC4_ERR_ADDRESS for an address of neither family. */
ROBUROC4_API roburoc4_result roburoc4_udp_address_text(const roburoc4_address *address,
                                                       char *buffer, size_t capacity);

/* ----------------------------------------------------------------------------------- clock --- */

/** Microseconds of a clock that never goes back and runs while the machine sleeps: the now_us of
 *  all client calls. Its origin is arbitrary. Linux: CLOCK_BOOTTIME; macOS: mach_continuous_time;
 *  Windows: QueryInterruptTimePrecise, or GetTickCount64 (10 to 16 ms steps) before Windows 10;
 *  elsewhere CLOCK_MONOTONIC. Any thread. */
ROBUROC4_API uint64_t roburoc4_udp_now_us(void);

/* ---------------------------------------------------------------------------------- socket --- */

/** Why the network did not accept or deliver a datagram: the last reason, 0 again as soon as a
 *  datagram is received. */
#define ROBUROC4_FAULT_NONE 0
#define ROBUROC4_FAULT_REFUSED 1     /* the host answers, but nothing listens on the port */
#define ROBUROC4_FAULT_UNREACHABLE 2 /* no route to the host or its network */
#define ROBUROC4_FAULT_DOWN 3        /* this machine's interface is down, or its address is gone */
#define ROBUROC4_FAULT_DENIED 4      /* this machine's firewall or rights forbid it */
#define ROBUROC4_FAULT_FULL 5        /* the socket's or the system's buffers are full */
#define ROBUROC4_FAULT_OTHER 6       /* see the field system_error */

/** What a ROBUROC4_FAULT_* means and what to check, one English sentence without a full stop;
 *  "no fault" for 0, "unknown fault" for an invalid number. Valid as long as the program runs. */
ROBUROC4_API const char *roburoc4_udp_fault_text(uint32_t fault);

/** Indices of roburoc4_udp.counters, which wrap around. */
#define ROBUROC4_UDP_COUNT_SENT 0       /* datagrams that the system accepted */
#define ROBUROC4_UDP_COUNT_RECEIVED 1   /* datagrams given to the client */
#define ROBUROC4_UDP_COUNT_DROPPED 2    /* datagrams to send that the system did not accept */
#define ROBUROC4_UDP_COUNT_REFUSED 3    /* times that the robot's host reported a closed port */
#define ROBUROC4_UDP_COUNT_FAULTS 4     /* errors of the network of any other kind */
#define ROBUROC4_UDP_COUNT_OVERSIZED 5  /* discarded: over ROBUROC4_UDP_MAX_RECEIVE */
#define ROBUROC4_UDP_COUNT_RECONNECTS 6 /* times that the socket was connected again */
#define ROBUROC4_UDP_COUNTERS 7

/** The longest datagram that is received: more than ROBUROC4_MAX_RECEIVE, so that recordings have
 *  what the client cannot use, too. */
#define ROBUROC4_UDP_MAX_RECEIVE 2048
/** The most datagrams that one roburoc4_udp_receive() or _wait() reads. */
#define ROBUROC4_UDP_BURST 64

/** A connected socket. Declare one, and read the first fields once roburoc4_udp_open() was called;
 * the others are private. It may be moved but not copied. */
typedef struct roburoc4_udp {
    uint32_t fault;           /* ROBUROC4_FAULT_* */
    int32_t system_error;     /* the system's own number of the last fault or error (errno, or
                                 WSAGetLastError()), else 0 */
    roburoc4_address address; /* the robot's */
    uint32_t counters[8];     /* ROBUROC4_UDP_COUNT_* */

    uint32_t private_size;
    uint8_t private_connected, private_broken, private_reserved[2];
    int64_t private_socket;
    uint64_t private_tried_us;
    struct roburoc4_recorder *private_recorder;
    roburoc4_address private_own_address;
    uint8_t private_datagram[2048];
    uint32_t private_spare[6];
} roburoc4_udp;

/** Open a non-blocking socket that is connected to `address`. udp_size is sizeof(roburoc4_udp).
 *  An unreachable network is not an error: the field fault says why, and later calls connect again,
 *  at most once a second. The socket is not inherited by child programs. ROBUROC4_ERR_SIZE: header
 *  and library differ. ROBUROC4_ERR_ADDRESS: not an address of roburoc4_udp_resolve().
 *  ROBUROC4_ERR_SYSTEM: no socket; the field system_error says why. After any other error than
 *  _SIZE the socket counts as closed. */
ROBUROC4_API roburoc4_result roburoc4_udp_open(roburoc4_udp *udp, size_t udp_size,
                                               const roburoc4_address *address);
/** The same, sending from this local address and port: for a computer with several networks, or a
 *  firewall that lets one port through. `local` is of the same family (else
 *  ROBUROC4_ERR_ADDRESS), or NULL for roburoc4_udp_open(). An address of all zeros and a port of 0
 *  leave that part to the system, so roburoc4_udp_resolve("192.168.0.5", 0, &local) is followed by
 *  local.port = 0 where the port does not matter. ROBUROC4_ERR_SYSTEM also if this machine does not
 *  have the address, or another program has the port. */
ROBUROC4_API roburoc4_result roburoc4_udp_open_from(roburoc4_udp *udp, size_t udp_size,
                                                    const roburoc4_address *address,
                                                    const roburoc4_address *local);
/** Close the socket. It sends nothing: close the client first, as in the loop at the top.
 *  ROBUROC4_ERR_CLOSED if it is closed already. */
ROBUROC4_API roburoc4_result roburoc4_udp_close(roburoc4_udp *udp);

/** The descriptor to watch for reading (Windows: the SOCKET), or -1 when closed. It stays the same
 *  from open to close. Only watch it; do not read, write or close it. */
ROBUROC4_API intptr_t roburoc4_udp_fd(const roburoc4_udp *udp);

/* ------------------------------------------------------------------------------ datagrams --- */

/** What roburoc4_udp_receive() calls after it passed a datagram to the client, with the `context`
 *  that it was given. The datagram is valid until the function returns. It may call the client, and
 *  roburoc4_udp_transmit_all(). */
typedef void (*roburoc4_udp_seen)(void *context, const uint8_t *datagram, size_t size);

/** Pass the datagrams that are waiting to the client: up to ROBUROC4_UDP_BURST, or until the client
 *  has something to send; never waits. To see every status, read the client's values in `seen`
 *  (which may be NULL). Returns how many datagrams the client used. ROBUROC4_ERR_CLOSED;
 *  ROBUROC4_ERR_SYSTEM: the socket itself is unusable (not: the network). */
ROBUROC4_API roburoc4_result roburoc4_udp_receive(roburoc4_udp *udp, roburoc4_client *client,
                                                  roburoc4_udp_seen seen, void *context);
/** Send everything that the client has to send; never waits. Returns how many datagrams the system
 *  accepted. ROBUROC4_ERR_CLOSED. Call it after every client call that changes something (drive(),
 *  stop(), set_digital_outputs() ...), or let roburoc4_udp_wait() do it. */
ROBUROC4_API roburoc4_result roburoc4_udp_transmit_all(roburoc4_udp *udp, roburoc4_client *client);

/** Send what is due; wait until a datagram arrives, the client's deadline is reached, timeout_us
 *  has passed or a signal handler ran (timeout_us 0 does not wait); receive as
 *  roburoc4_udp_receive(), whose results these are; and send what is due then. With
 *  ROBUROC4_ERR_SYSTEM it did not wait. Windows rounds waiting times up to its timer's resolution
 *  (at most 16 ms). */
ROBUROC4_API roburoc4_result roburoc4_udp_wait(roburoc4_udp *udp, roburoc4_client *client,
                                               uint32_t timeout_us);

#ifdef __cplusplus
}
#endif

#endif
