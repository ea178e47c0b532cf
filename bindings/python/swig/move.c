/* SPDX-License-Identifier: MIT
 *
 * Moves of roburoc4_move.h: one step, with the drive command that it proposes.
 */
#include "native.h"

#include <stdlib.h>

roburoc4_move *new_move(void) {
    return calloc(1, sizeof(roburoc4_move));
}

roburoc4_move_options *new_move_options(void) {
    roburoc4_move_options *options = calloc(1, sizeof *options);
    if (options != NULL) {
        (void)roburoc4_move_options_init(options, sizeof *options);
    }
    return options;
}

PyObject *move_step(connection *c, roburoc4_move *move) {
    roburoc4_client *client = connection_enter(c, 1);
    uint64_t now_us;
    if (client == NULL) {
        return NULL;
    }
    now_us = connection_entered_us();
    if (roburoc4_move_step(move, client, now_us) == ROBUROC4_MOVE_RUNNING) {
        (void)roburoc4_client_drive(client, move->linear_m_s, move->angular_rad_s, 0, now_us);
    }
    connection_leave();
    return PyLong_FromLong(move->result);
}

PyObject *move_values(const roburoc4_move *move) {
    return Py_BuildValue("(iidddd)", (int)move->result, (int)move->cause,
                         shortest(move->distance_m), shortest(move->angle_rad),
                         shortest(move->left_m), shortest(move->left_rad));
}
