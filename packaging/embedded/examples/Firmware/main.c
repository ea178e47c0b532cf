/* SPDX-License-Identifier: MIT
 *
 * A firmware's main loop: drive slowly forward while a button is held; released, the robot stops.
 * Your board has the four functions below.
 */
#include <roburoc4.h>

uint64_t board_now_us(void);
int board_button(void);
size_t board_receive(uint8_t *datagram, size_t capacity); /* whole, from the robot; 0: none */
void board_send(const uint8_t *datagram, size_t size);

static roburoc4_client client;

int main(void) {
    static uint8_t datagram[512];
    int held = 0;
    roburoc4_result result = ROBUROC4_OK;

    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, board_now_us());
    for (;;) {
        const int was_held = held;
        size_t received;
        roburoc4_result size;

        while ((received = board_receive(datagram, sizeof datagram)) > 0) {
            roburoc4_client_receive(&client, datagram, received, board_now_us());
        }
        held = board_button();
        if (held && !was_held) {
            result = roburoc4_client_arm(&client, board_now_us()); /* refused with a reason */
        } else if (!held && was_held) {
            result = roburoc4_client_stop(&client, board_now_us());
        }
        if (held) {
            result = roburoc4_client_drive(&client, 0.2f, 0.0f, 0, board_now_us()); /* 250 ms */
        }
        (void)result; /* below 0 if refused: a display could show roburoc4_result_text(result) */
        while ((size = roburoc4_client_poll_transmit(&client, datagram, sizeof datagram,
                                                     board_now_us())) > 0) {
            board_send(datagram, (size_t)size);
        }
    }
}
