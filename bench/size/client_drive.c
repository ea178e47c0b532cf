/* SPDX-License-Identifier: MIT
 *
 * For its size only: a bare loop that drives and reads the statuses, and nothing else; WITH_MOVE:
 * that drives by a move of a metre.
 */
#include "roburoc4_move.h"

static roburoc4_client client;
#ifdef WITH_MOVE
static roburoc4_move move;
#endif
static uint8_t datagram[ROBUROC4_MAX_TRANSMIT];
static volatile uint64_t clock_us;
static volatile size_t received;
static volatile int32_t result;

int main(void) {
    roburoc4_differential_status differential;
    roburoc4_battery_status battery;
    roburoc4_inputs inputs;
    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, clock_us);
#ifdef WITH_MOVE
    roburoc4_move_by(&move, 1.0f, 0, NULL);
#endif
    for (;;) {
        if (received > 0) {
            result = roburoc4_client_receive(&client, datagram, received, clock_us);
        }
        while (roburoc4_client_poll_transmit(&client, datagram, sizeof datagram, clock_us) > 0) {
            received = 0;
        }
        if (roburoc4_client_arm(&client, clock_us) == ROBUROC4_OK) {
#ifdef WITH_MOVE
            roburoc4_move_step(&move, &client, clock_us);
            result =
                roburoc4_client_drive(&client, move.linear_m_s, move.angular_rad_s, 0, clock_us);
#else
            result = roburoc4_client_drive(&client, 0.5f, 0, 0, clock_us);
#endif
        }
        result = roburoc4_client_differential(&client, &differential, NULL);
        result = roburoc4_client_battery(&client, &battery, NULL);
        result = roburoc4_client_inputs(&client, &inputs, NULL);
        result = (int32_t)roburoc4_client_take_events(&client);
    }
}
