/* SPDX-License-Identifier: MIT
 *
 * lcm_sink LCM_URL: a subscriber to all statuses of an LCM network, until it is killed.
 */
#include <lcm/lcm.h>
#include <stdio.h>

static void on_message(const lcm_recv_buf_t *buffer, const char *channel, void *user) {
    (void)buffer;
    (void)channel;
    (void)user;
}

int main(int count, char **arguments) {
    lcm_t *lcm = count == 2 ? lcm_create(arguments[1]) : NULL;
    if (lcm == NULL) {
        (void)fprintf(stderr, "usage: lcm_sink LCM_URL\n");
        return 1;
    }
    lcm_subscription_t *all = lcm_subscribe(
        lcm, ".*_(DIFFERENTIAL|LOCALIZATION|BATTERY|TELEMETER|IOCARD)", on_message, NULL);
    (void)lcm_subscription_set_queue_capacity(all, 0);
    while (lcm_handle(lcm) == 0) {
    }
    return 1;
}
