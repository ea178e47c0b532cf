/* SPDX-License-Identifier: MIT
 *
 * A program that needs something of each library: the core, the adapter with its thread, and the
 * simulator with its mathematics.
 */
#include <stdio.h>

#include <roburoc4.h>
#include <roburoc4_pump.h>
#include <roburoc4_sim.h>
#include <roburoc4_udp.h>

int main(void) {
    static roburoc4_client client;
    roburoc4_address address;
    roburoc4_result result = roburoc4_client_init(&client, sizeof client, NULL);
    if (result < 0 || roburoc4_version() != ROBUROC4_VERSION ||
        roburoc4_abi_version() != ROBUROC4_ABI_VERSION) {
        printf("the core is not the header's: %s\n", roburoc4_result_text(result));
        return 1;
    }

    result = roburoc4_udp_resolve("127.0.0.1:9", 0, &address);
    roburoc4_pump *pump =
        result == 0 ? roburoc4_pump_create(&address, NULL, 0, NULL, &result) : NULL;
    if (pump == NULL || roburoc4_pump_running(pump) != 1) {
        printf("no pump: %s\n", roburoc4_result_text(result));
        return 1;
    }
    roburoc4_pump_destroy(pump);

    roburoc4_sim *robot = roburoc4_sim_create(NULL);
    if (robot == NULL) {
        printf("no simulated robot\n");
        return 1;
    }
    roburoc4_sim_advance(robot, 0);
    roburoc4_sim_advance(robot, 1000000);
    roburoc4_sim_destroy(robot);
    printf("core, adapter and simulator work\n");
    return 0;
}
