/* SPDX-License-Identifier: MIT
 *
 * exit_in_mid_drive HOST:PORT: drive with a pump, and exit() as soon as the robot reports the
 * speed. pump_test.cpp runs it.
 */
#include "roburoc4_pump.h"

#include <stdlib.h>

int main(int argc, char **argv) {
    roburoc4_address address;
    roburoc4_differential_status status = {0};
    roburoc4_result result = ROBUROC4_ERR_NOT_READY;
    roburoc4_pump_reader reader = {0};
    roburoc4_client *client;
    roburoc4_pump *pump;
    if (argc != 2 || roburoc4_udp_resolve(argv[1], 0, &address) < 0) {
        return 2;
    }
    pump = roburoc4_pump_create(&address, NULL, 0, NULL, NULL);
    while (result < 0 || status.target_linear_m_s == 0.0f) {
        roburoc4_pump_wait_events(pump, &reader, ROBUROC4_EVENT_DIFFERENTIAL, 50000);
        roburoc4_pump_take_events(pump, &reader);
        client = roburoc4_pump_lock(pump);
        if (result < 0) {
            result = roburoc4_client_arm(client, roburoc4_udp_now_us());
        } else {
            result = roburoc4_client_drive(client, 0.5f, 0.0f, 1000000, roburoc4_udp_now_us());
        }
        (void)roburoc4_client_differential(client, &status, NULL);
        roburoc4_pump_unlock(pump);
    }
    exit(0);
}
