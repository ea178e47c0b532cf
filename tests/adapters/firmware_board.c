/* SPDX-License-Identifier: MIT
 *
 * The board of docs/firmware.md, with the simulator in place of network, clock and joystick: the
 * switch is held from 5 s to 8 s. Ends with 0 if the robot stood, drove, and stands again.
 */
#include "board.h"

#include <stdio.h>

#include "roburoc4_sim.h"

static roburoc4_sim *robot;
static uint64_t now_us;

uint64_t board_now_us(void) {
    return now_us;
}

size_t board_udp_receive(uint8_t *datagram, size_t capacity) {
    uint64_t peer;
    return (size_t)roburoc4_sim_poll_transmit(robot, &peer, datagram, capacity);
}

void board_udp_send(const uint8_t *datagram, size_t size) {
    roburoc4_sim_receive(robot, 1, datagram, size);
}

int board_drive_wanted(float *linear_m_s, float *angular_rad_s) {
    *linear_m_s = 0.5f;
    *angular_rad_s = 0.0f;
    return now_us >= 5000000u && now_us < 8000000u;
}

static double x_after(uint64_t until_us) {
    roburoc4_sim_state state;
    for (; now_us < until_us; now_us += 1000) {
        roburoc4_sim_advance(robot, now_us);
        robot_poll();
    }
    (void)roburoc4_sim_get_state(robot, ROBUROC4_SIZED(&state));
    return state.true_x_m;
}

int main(void) {
    double stood, drove, stopped, later;
    robot = roburoc4_sim_create(NULL);
    if (robot == NULL) {
        return 1;
    }
    robot_begin();
    stood = x_after(5000000u);
    drove = x_after(8000000u);
    stopped = x_after(12000000u);
    later = x_after(20000000u);
    printf("x: %.3f m, %.3f m, %.3f m, %.3f m\n", stood, drove, stopped, later);
    roburoc4_sim_destroy(robot);
    return stood == 0.0 && drove > 1.0 && stopped < 3.0 && later == stopped ? 0 : 1;
}
