/* SPDX-License-Identifier: MIT
 *
 * udp.c - the UDP adapter: moves a client's datagrams over one connected socket, in time, and turns
 * the network's errors into states and counters. What differs between systems is in os.h.
 */
#include "os.h"
#include "record_internal.h"

#include <stdio.h>
#include <string.h>

#define RECONNECT_US 1000000u
#define HOST_SIZE 256

/* ------------------------------------------------------------------------------- addresses --- */

/* A decimal port of 1 to 65535; 0 if it is not one. */
static uint16_t parse_port(const char *text) {
    uint32_t port = 0;
    size_t i = 0;
    for (; i < 5 && text[i] >= '0' && text[i] <= '9'; i++) {
        port = port * 10 + (uint32_t)(text[i] - '0');
    }
    return text[i] == '\0' && port <= 65535 ? (uint16_t)port : 0;
}

static int is_printable(const char *text) {
    for (; *text != '\0'; text++) {
        if ((unsigned char)*text <= ' ' || *text == '\x7f') {
            return 0;
        }
    }
    return 1;
}

/* Finds the host's name and its length, and the text of the port (NULL if none). */
static roburoc4_result split(const char *text, const char **host, size_t *length,
                             const char **port) {
    const char *first = strchr(text, ':');
    const char *end;
    *host = text;
    *port = NULL;
    if (text[0] == '[') {
        end = strchr(text, ']');
        if (end == NULL || first == NULL || first > end || (end[1] != '\0' && end[1] != ':')) {
            return ROBUROC4_ERR_ADDRESS;
        }
        *host = text + 1;
        *length = (size_t)(end - *host);
        *port = end[1] == ':' ? end + 2 : NULL;
    } else if (first != NULL && strchr(first + 1, ':') == NULL) {
        *length = (size_t)(first - text);
        *port = first + 1;
    } else {
        *length = strlen(text); /* no colon: a name; more than one: a bare IPv6 address */
    }
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_udp_resolve(const char *host, uint16_t default_port,
                                     roburoc4_address *out) {
    char name[HOST_SIZE];
    const char *start, *port_text;
    size_t length;
    uint16_t port = default_port != 0 ? default_port : ROBUROC4_DEFAULT_PORT;
    if (host == NULL || out == NULL || !is_printable(host) ||
        split(host, &start, &length, &port_text) < 0 || length == 0 || length >= sizeof name) {
        return ROBUROC4_ERR_ADDRESS;
    }
    if (port_text != NULL) {
        port = parse_port(port_text);
    }
    if (port == 0) {
        return ROBUROC4_ERR_ADDRESS;
    }
    memcpy(name, start, length);
    name[length] = '\0';
    return roburoc4_os_resolve(name, port, out);
}

roburoc4_result roburoc4_udp_address_text(const roburoc4_address *address, char *buffer,
                                          size_t capacity) {
    char ip[48], zone[12] = "";
    int length;
    if ((address->family != 4 && address->family != 6) ||
        !roburoc4_os_ip_text(address, ip, sizeof ip)) {
        return ROBUROC4_ERR_ADDRESS;
    }
    if (address->family == 4) {
        length = snprintf(buffer, capacity, "%s:%u", ip, (unsigned)address->port);
    } else {
        if (address->scope != 0) {
            (void)snprintf(zone, sizeof zone, "%%%lu", (unsigned long)address->scope);
        }
        length = snprintf(buffer, capacity, "[%s%s]:%u", ip, zone, (unsigned)address->port);
    }
    return length >= 0 && (size_t)length < capacity ? length : ROBUROC4_ERR_BUFFER;
}

static int is_usable(const roburoc4_address *address) {
    int link_local = address->ip[0] == 0xFE && (address->ip[1] & 0xC0) == 0x80;
    return address->family == 4 || (address->family == 6 && (!link_local || address->scope != 0));
}

/* ---------------------------------------------------------------------------------- faults --- */

const char *roburoc4_udp_fault_text(uint32_t fault) {
    static const char *const texts[] = {
        "no fault",
        "the host answers, but nothing listens on this port: check the port, and the robot itself",
        "no route to this address: check the address, the cable and the network's settings",
        "this computer's network interface is down or lost its address: check the cable",
        "this computer's firewall or rights forbid sending to this address",
        "this computer's send buffers are full: the network does not take what is sent",
        "the operating system reports an error of the network",
    };
    return fault < sizeof texts / sizeof texts[0] ? texts[fault] : "unknown fault";
}

static void tally(roburoc4_udp *udp, uint32_t counter) {
    udp->counters[counter]++;
}

/* Faults that may be fixed by choosing the local address again. */
static int is_of_the_path(uint32_t fault) {
    return fault == ROBUROC4_FAULT_UNREACHABLE || fault == ROBUROC4_FAULT_DOWN ||
           fault == ROBUROC4_FAULT_OTHER;
}

static void note_fault(roburoc4_udp *udp, roburoc4_os_outcome outcome) {
    udp->fault = outcome.fault;
    udp->system_error = outcome.system_error;
    tally(udp, outcome.fault == ROBUROC4_FAULT_REFUSED ? ROBUROC4_UDP_COUNT_REFUSED
                                                       : ROBUROC4_UDP_COUNT_FAULTS);
}

/* ---------------------------------------------------------------------------------- socket --- */

static int is_open(const roburoc4_udp *udp) {
    return udp->private_size == sizeof *udp;
}

/* Connects or reconnects the socket, where the system chooses this end's address again. */
static roburoc4_os_outcome connect_now(roburoc4_udp *udp) {
    roburoc4_os_outcome outcome = roburoc4_os_connect(udp->private_socket, &udp->address);
    udp->private_connected = outcome.fault == ROBUROC4_FAULT_NONE;
    if (udp->private_connected) {
        (void)roburoc4_os_own_address(udp->private_socket, &udp->private_own_address);
    }
    return outcome;
}

/* Chooses the local address again if there is none, or if it stopped working. */
static void keep_connected(roburoc4_udp *udp) {
    roburoc4_os_outcome outcome;
    uint64_t now_us;
    if (udp->private_connected && !udp->private_broken) {
        return;
    }
    now_us = roburoc4_udp_now_us();
    if (now_us - udp->private_tried_us < RECONNECT_US) {
        return;
    }
    udp->private_tried_us = now_us;
    outcome = connect_now(udp);
    if (udp->private_connected) {
        udp->private_broken = 0;
        tally(udp, ROBUROC4_UDP_COUNT_RECONNECTS);
    } else {
        note_fault(udp, outcome);
    }
}

roburoc4_result roburoc4_udp_open(roburoc4_udp *udp, size_t udp_size,
                                  const roburoc4_address *address) {
    return roburoc4_udp_open_from(udp, udp_size, address, NULL);
}

/* A socket that is bound to the local address, if there is one, and connected if possible. */
static roburoc4_os_outcome open_socket(roburoc4_udp *udp, const roburoc4_address *local) {
    roburoc4_os_outcome outcome = {ROBUROC4_FAULT_NONE, 0};
    udp->private_socket = roburoc4_os_socket(&udp->address, &outcome);
    if (udp->private_socket == ROBUROC4_OS_NO_SOCKET) {
        return outcome;
    }
    if (local != NULL) {
        outcome = roburoc4_os_bind(udp->private_socket, local);
    }
    if (outcome.fault != ROBUROC4_FAULT_NONE) {
        roburoc4_os_close(udp->private_socket);
        udp->private_socket = ROBUROC4_OS_NO_SOCKET;
        return outcome;
    }
    outcome = connect_now(udp);
    if (outcome.fault == ROBUROC4_FAULT_DENIED || outcome.fault == ROBUROC4_FAULT_OTHER) {
        roburoc4_os_close(udp->private_socket);
        udp->private_socket = ROBUROC4_OS_NO_SOCKET;
    }
    return outcome;
}

roburoc4_result roburoc4_udp_open_from(roburoc4_udp *udp, size_t udp_size,
                                       const roburoc4_address *address,
                                       const roburoc4_address *local) {
    roburoc4_os_outcome outcome;
    roburoc4_address robot = {{0}, 0, 0, 0, 0}, own = {{0}, 0, 0, 0, 0};
    if (udp_size != sizeof *udp) {
        return ROBUROC4_ERR_SIZE;
    }
    if (address != NULL) {
        robot = *address; /* it may be that of this struct, from the last time */
    }
    if (local != NULL) {
        own = *local;
    }
    memset(udp, 0, sizeof *udp);
    udp->private_socket = ROBUROC4_OS_NO_SOCKET;
    if (!is_usable(&robot) || robot.port == 0 ||
        (local != NULL && (own.family != robot.family || !is_usable(&own)))) {
        return ROBUROC4_ERR_ADDRESS;
    }
    udp->address = robot;
    outcome = open_socket(udp, local != NULL ? &own : NULL);
    if (outcome.fault != ROBUROC4_FAULT_NONE) {
        note_fault(udp, outcome);
    }
    if (udp->private_socket == ROBUROC4_OS_NO_SOCKET) {
        return ROBUROC4_ERR_SYSTEM;
    }
    udp->private_tried_us = roburoc4_udp_now_us();
    udp->private_size = sizeof *udp;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_udp_close(roburoc4_udp *udp) {
    if (!is_open(udp)) {
        return ROBUROC4_ERR_CLOSED;
    }
    roburoc4_os_close(udp->private_socket);
    udp->private_socket = ROBUROC4_OS_NO_SOCKET;
    udp->private_size = 0;
    return ROBUROC4_OK;
}

intptr_t roburoc4_udp_fd(const roburoc4_udp *udp) {
    return is_open(udp) ? (intptr_t)udp->private_socket : -1;
}

/* ------------------------------------------------------------------------------- datagrams --- */

roburoc4_result roburoc4_udp_record(roburoc4_udp *udp, roburoc4_recorder *recorder) {
    if (!is_open(udp)) {
        return ROBUROC4_ERR_CLOSED;
    }
    udp->private_recorder = recorder;
    return ROBUROC4_OK;
}

static void record(const roburoc4_udp *udp, int inbound, const uint8_t *datagram, size_t size) {
    if (udp->private_recorder != NULL) {
        roburoc4_recorder_take(udp->private_recorder, inbound,
                               inbound ? &udp->address : &udp->private_own_address,
                               inbound ? &udp->private_own_address : &udp->address, datagram, size);
    }
}

/* Takes a datagram if there is one. Faults and oversized datagrams are counted and skipped, up to a
 * limit. Before the socket is connected, datagrams from anyone would be received. */
static int take_datagram(roburoc4_udp *udp, size_t *size) {
    int skipped;
    for (skipped = 0; udp->private_connected && skipped < ROBUROC4_UDP_BURST; skipped++) {
        roburoc4_os_outcome outcome;
        int got = roburoc4_os_receive(udp->private_socket, udp->private_datagram,
                                      sizeof udp->private_datagram, size, &outcome);
        if (got == ROBUROC4_OS_DATAGRAM) {
            tally(udp, ROBUROC4_UDP_COUNT_RECEIVED);
            udp->fault = ROBUROC4_FAULT_NONE;
            udp->system_error = 0;
            record(udp, 1, udp->private_datagram, *size);
            return got;
        }
        if (got == ROBUROC4_OS_EMPTY) {
            return got;
        }
        if (got == ROBUROC4_OS_OVERSIZED) {
            tally(udp, ROBUROC4_UDP_COUNT_OVERSIZED);
        } else {
            note_fault(udp, outcome);
        }
        if (got == ROBUROC4_OS_BROKEN) {
            return got;
        }
    }
    return ROBUROC4_OS_EMPTY;
}

roburoc4_result roburoc4_udp_receive(roburoc4_udp *udp, roburoc4_client *client,
                                     roburoc4_udp_seen seen, void *context) {
    roburoc4_result used = 0;
    int taken;
    if (!is_open(udp)) {
        return ROBUROC4_ERR_CLOSED;
    }
    for (taken = 0; taken < ROBUROC4_UDP_BURST; taken++) {
        const uint8_t *datagram = udp->private_datagram;
        size_t size = 0;
        uint64_t now_us;
        int got = take_datagram(udp, &size);
        if (got != ROBUROC4_OS_DATAGRAM) {
            return got == ROBUROC4_OS_BROKEN ? ROBUROC4_ERR_SYSTEM : used;
        }
        now_us = roburoc4_udp_now_us();
        used += roburoc4_client_receive(client, datagram, size, now_us) >= 0;
        if (seen != NULL) {
            seen(context, datagram, size);
        }
        if (roburoc4_client_next_deadline(client) <= now_us) {
            break;
        }
    }
    return used;
}

/* 1 if the system accepted the datagram. */
static int send_now(roburoc4_udp *udp, const uint8_t *datagram, size_t size) {
    roburoc4_os_outcome outcome = roburoc4_os_send(udp->private_socket, datagram, size);
    if (outcome.fault == ROBUROC4_FAULT_REFUSED) {
        /* The system reports here that an earlier datagram was refused, and did not send this one.
         */
        note_fault(udp, outcome);
        outcome = roburoc4_os_send(udp->private_socket, datagram, size);
    }
    if (outcome.fault == ROBUROC4_FAULT_NONE) {
        udp->private_broken = 0;
        tally(udp, ROBUROC4_UDP_COUNT_SENT);
        record(udp, 0, datagram, size);
        return 1;
    }
    note_fault(udp, outcome);
    tally(udp, ROBUROC4_UDP_COUNT_DROPPED);
    if (is_of_the_path(outcome.fault) && !udp->private_broken) {
        udp->private_broken = 1; /* wait a second before connecting again */
        udp->private_tried_us = roburoc4_udp_now_us();
    }
    return 0;
}

roburoc4_result roburoc4_udp_transmit_all(roburoc4_udp *udp, roburoc4_client *client) {
    uint8_t datagram[ROBUROC4_MAX_TRANSMIT];
    roburoc4_result sent = 0, length;
    int rounds;
    if (!is_open(udp)) {
        return ROBUROC4_ERR_CLOSED;
    }
    keep_connected(udp);
    for (rounds = 0; rounds < ROBUROC4_UDP_BURST; rounds++) {
        length =
            roburoc4_client_poll_transmit(client, datagram, sizeof datagram, roburoc4_udp_now_us());
        if (length <= 0) {
            break;
        }
        if (udp->private_connected) {
            sent += send_now(udp, datagram, (size_t)length);
        } else {
            tally(udp, ROBUROC4_UDP_COUNT_DROPPED);
        }
    }
    return sent;
}

roburoc4_result roburoc4_udp_wait(roburoc4_udp *udp, roburoc4_client *client, uint32_t timeout_us) {
    roburoc4_result result = roburoc4_udp_transmit_all(udp, client);
    if (result >= 0 && timeout_us > 0) {
        uint64_t now_us = roburoc4_udp_now_us();
        uint64_t deadline_us = roburoc4_client_next_deadline(client);
        uint64_t wait_us = deadline_us > now_us ? deadline_us - now_us : 0;
        int64_t socket = udp->private_connected ? udp->private_socket : ROBUROC4_OS_NO_SOCKET;
        result = roburoc4_os_wait(socket, ROBUROC4_OS_NO_SOCKET,
                                  wait_us < timeout_us ? wait_us : timeout_us);
    }
    if (result >= 0) {
        result = roburoc4_udp_receive(udp, client, NULL, NULL);
    }
    if (result >= 0) {
        (void)roburoc4_udp_transmit_all(udp, client);
    }
    return result;
}
