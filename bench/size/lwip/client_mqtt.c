/* SPDX-License-Identifier: MIT
 *
 * For its size only: lwIP's MQTT client connects, subscribes, receives and publishes, alone or with
 * lwIP's TCP/IP (WITH_STACK).
 */
#include "lwip/apps/mqtt_priv.h"
#ifdef WITH_STACK
#include "network.h"
#else
#define start_network() ((void)0)
#define poll_network() ((void)0)
#endif

static mqtt_client_t client;
static volatile int32_t result;
static float speeds[2];

static void on_topic(void *arg, const char *topic, u32_t size) {
    (void)arg;
    (void)topic;
    result = (int32_t)size;
}

static void on_data(void *arg, const u8_t *data, u16_t size, u8_t flags) {
    (void)arg;
    (void)flags;
    result = size > 0 ? data[0] : 0;
}

static void on_done(void *arg, err_t error) {
    (void)arg;
    result = error;
}

static void on_connection(mqtt_client_t *connected_client, void *arg,
                          mqtt_connection_status_t status) {
    (void)arg;
    if (status == MQTT_CONNECT_ACCEPTED) {
        result = mqtt_subscribe(connected_client, "status/#", 0, on_done, NULL);
    }
}

int main(void) {
    struct mqtt_connect_client_info_t own = {"robot", NULL, NULL, 10, NULL, NULL, 0, 0};
    ip_addr_t broker;
    IP_ADDR4(&broker, 192, 168, 0, 2);
    start_network();
    mqtt_set_inpub_callback(&client, on_topic, on_data, NULL);
    result = mqtt_client_connect(&client, &broker, MQTT_PORT, on_connection, NULL, &own);
    for (;;) {
        poll_network();
        if (mqtt_client_is_connected(&client)) {
            result = mqtt_publish(&client, "drive", speeds, sizeof speeds, 1, 0, on_done, NULL);
        }
    }
}
