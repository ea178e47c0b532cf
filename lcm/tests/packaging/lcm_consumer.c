/* SPDX-License-Identifier: MIT
 *
 * A program that needs the installed LCM types: it writes a drive command to its standard output.
 */
#include <stdio.h>

#include <roburoc4_lcm.h>

int main(void) {
    unsigned char bytes[256];
    char sender[] = "consumer";
    roburoc4_lcm_drive_command_t command = {
        .utime = 1, .sender = sender, .linear_m_s = 0.25, .lease_us = -1};
    int size = roburoc4_lcm_drive_command_t_encode(bytes, 0, sizeof bytes, &command);
    return size > 0 && fwrite(bytes, 1, (size_t)size, stdout) == (size_t)size ? 0 : 1;
}
