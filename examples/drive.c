/* SPDX-License-Identifier: MIT
 *
 * drive: the example of README.md, which shows this text from the first #include on.
 */
#include <roburoc4_udp.h>
#include <stdio.h>

int main(int argc, char **argv) {
    static roburoc4_client client;
    static roburoc4_udp udp;
    roburoc4_address robot;
    roburoc4_result result = roburoc4_udp_resolve(argc > 1 ? argv[1] : "127.0.0.1", 0, &robot);
    if (result < 0 || roburoc4_udp_open(&udp, sizeof udp, &robot) < 0) {
        fprintf(stderr, "drive: no address, or no socket for it\n");
        return 1;
    }
    roburoc4_client_init(&client, sizeof client, NULL);
    uint64_t now_us = roburoc4_udp_now_us(), begun_us = now_us;
    roburoc4_client_start(&client, now_us);
    do { /* connect and ask for permission to drive, for 5 s at most */
        roburoc4_udp_wait(&udp, &client, 50000);
        now_us = roburoc4_udp_now_us();
        result = roburoc4_client_arm(&client, now_us);
    } while (result < 0 && !udp.fault && now_us - begun_us < 5000000);
    for (begun_us = now_us; result == 0 && now_us - begun_us < 3000000;) {
        result = roburoc4_client_drive(&client, 0.2f, 0.0f, 0, now_us); /* holds for 250 ms */
        roburoc4_udp_wait(&udp, &client, 50000);
        now_us = roburoc4_udp_now_us();
    }
    if (result < 0) {
        fprintf(stderr, "drive: gave up: %s (network: %s)\n", roburoc4_result_text(result),
                roburoc4_udp_fault_text(udp.fault));
    }
    roburoc4_client_close(&client, now_us); /* stop the robot, then end */
    while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE) {
        roburoc4_udp_wait(&udp, &client, 50000);
    }
    return result < 0;
}
