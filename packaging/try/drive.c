/* SPDX-License-Identifier: MIT
 *
 * drive ADDRESS: drive forward for three seconds, and fail unless the robot reports that it did.
 */
#include <roburoc4_pump.h>
#include <stdio.h>
#include <time.h>

int main(int argc, char **argv) {
    roburoc4_address address;
    roburoc4_config config;
    roburoc4_localization_status pose = {0};
    roburoc4_pump_reader reader = {0};
    roburoc4_result result = roburoc4_udp_resolve(argc > 1 ? argv[1] : "127.0.0.1", 0, &address);
    roburoc4_config_init(&config, sizeof config);
    config.fresh_ms = 1000; /* for a simulator on a busy machine */
    roburoc4_pump *pump =
        result < 0 ? NULL : roburoc4_pump_create(&address, &config, 0, NULL, &result);
    result = pump == NULL ? result : roburoc4_pump_arm(pump, 10000000);
    (void)roburoc4_pump_reader_init(pump, &reader);
    for (time_t end = time(NULL) + 4; result == 0 && time(NULL) < end;) {
        roburoc4_client *client = roburoc4_pump_lock(pump);
        result = roburoc4_client_drive(client, 0.5f, 0.0f, 0, roburoc4_udp_now_us());
        (void)roburoc4_client_localization(client, &pose, NULL);
        roburoc4_pump_unlock(pump);
        (void)roburoc4_pump_wait_events(pump, &reader, ROBUROC4_EVENT_LOCALIZATION, 50000);
        (void)roburoc4_pump_take_events(pump, &reader);
    }
    roburoc4_pump_destroy(pump);
    printf("%s, x %.2f m\n", roburoc4_result_text(result), pose.x_m);
    return result < 0 || pose.x_m < 0.5;
}
