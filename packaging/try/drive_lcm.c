/* SPDX-License-Identifier: MIT
 *
 * drive_lcm: drive forward through roburoc4-lcm, and fail unless the robot reports that it did.
 */
#include <lcm/lcm.h>
#include <roburoc4_lcm.h>
#include <stdio.h>
#include <sys/time.h>

static double x_m;

static void on_pose(const lcm_recv_buf_t *buffer, const char *channel,
                    const roburoc4_lcm_localization_status_t *pose, void *user) {
    (void)buffer, (void)channel, (void)user;
    x_m = pose->x_m;
}

int main(void) {
    lcm_t *lcm = lcm_create(NULL);
    roburoc4_lcm_localization_status_t_subscribe(lcm, "ROBUROC4_LOCALIZATION", on_pose, NULL);
    for (int statuses = 0; statuses < 200 && x_m < 0.5; statuses++) {
        struct timeval now;
        (void)gettimeofday(&now, NULL);
        roburoc4_lcm_drive_command_t command = {
            .utime = (int64_t)now.tv_sec * 1000000 + now.tv_usec,
            .sender = "drive_lcm",
            .linear_m_s = statuses < 40 ? 0.0 : 0.5}; /* a new bridge wants a pause first */
        roburoc4_lcm_drive_command_t_publish(lcm, "ROBUROC4_DRIVE_CMD", &command);
        lcm_handle_timeout(lcm, 1000);
    }
    printf("x %.2f m\n", x_m);
    lcm_destroy(lcm);
    return x_m < 0.5;
}
