/* SPDX-License-Identifier: MIT
 *
 * For its size only: ../client_drive.c with lwIP's UDP/IP.
 */
#include "lwip/udp.h"
#include "network.h"
#include "roburoc4.h"

static roburoc4_client client;
static uint8_t datagram[ROBUROC4_MAX_TRANSMIT];
static volatile int32_t result;

static void on_datagram(void *arg, struct udp_pcb *socket, struct pbuf *p, const ip_addr_t *from,
                        u16_t port) {
    (void)arg;
    (void)socket;
    (void)from;
    (void)port;
    /* A robot's datagrams fit into one buffer. */
    result = roburoc4_client_receive(&client, p->payload, p->len, (uint64_t)clock_ms * 1000);
    pbuf_free(p);
}

static void send_what_is_due(struct udp_pcb *socket, const ip_addr_t *robot) {
    roburoc4_result size;
    while ((size = roburoc4_client_poll_transmit(&client, datagram, sizeof datagram,
                                                 (uint64_t)clock_ms * 1000)) > 0) {
        struct pbuf *p = pbuf_alloc(PBUF_TRANSPORT, (u16_t)size, PBUF_RAM);
        if (p != NULL) {
            pbuf_take(p, datagram, (u16_t)size);
            udp_sendto(socket, p, robot, 60000);
            pbuf_free(p);
        }
    }
}

int main(void) {
    roburoc4_differential_status differential;
    roburoc4_battery_status battery;
    roburoc4_inputs inputs;
    ip_addr_t robot;
    struct udp_pcb *socket;
    IP_ADDR4(&robot, 192, 168, 0, 2);
    start_network();
    socket = udp_new();
    udp_bind(socket, IP_ADDR_ANY, 0);
    udp_recv(socket, on_datagram, NULL);
    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, (uint64_t)clock_ms * 1000);
    for (;;) {
        const uint64_t now_us = (uint64_t)clock_ms * 1000;
        poll_network();
        send_what_is_due(socket, &robot);
        if (roburoc4_client_arm(&client, now_us) == ROBUROC4_OK) {
            result = roburoc4_client_drive(&client, 0.5f, 0, 0, now_us);
        }
        result = roburoc4_client_differential(&client, &differential, NULL);
        result = roburoc4_client_battery(&client, &battery, NULL);
        result = roburoc4_client_inputs(&client, &inputs, NULL);
        result = (int32_t)roburoc4_client_take_events(&client);
    }
}
