/* SPDX-License-Identifier: MIT
 *
 * drive_pump [ROBOT] >poses.csv: a figure of eight, with the pump, which keeps every status
 * meanwhile: the poses are written after each circle. Ctrl-C stops the robot.
 */
#include <roburoc4_pump.h>
#include <signal.h>
#include <stdio.h>

#define RADIUS_M 0.25f
#define TURN_RAD 6.2831853f
#define TURN_RATE_RAD_S 1.0f
#define AT_ONCE 64

static roburoc4_pump *pump;

static void on_signal(int number) {
    (void)number;
    roburoc4_pump_request_stop(pump);
}

static void write_poses(roburoc4_pump_reader *reader, FILE *file) {
    roburoc4_sample samples[AT_ONCE];
    roburoc4_result count;
    while ((count = roburoc4_pump_read_samples(pump, reader, samples, AT_ONCE)) > 0) {
        for (int i = 0; i < count; i++) {
            const roburoc4_localization_status *pose = &samples[i].value.localization;
            if (samples[i].service == ROBUROC4_SERVICE_LOCALIZATION) {
                fprintf(file, "%.3f,%.3f,%.3f,%.3f\n", (double)samples[i].made_us * 1e-6, pose->x_m,
                        pose->y_m, pose->theta_rad);
            }
        }
    }
}

int main(int argc, char **argv) {
    const float turns_rad[] = {TURN_RAD, -TURN_RAD}; /* to the left, then to the right */
    roburoc4_move_options options;
    roburoc4_pump_reader reader = {0};
    roburoc4_address robot;
    roburoc4_result result = roburoc4_udp_resolve(argc > 1 ? argv[1] : "127.0.0.1", 0, &robot);
    if (result < 0 || (pump = roburoc4_pump_create(&robot, NULL, 0, NULL, &result)) == NULL) {
        fprintf(stderr, "drive_pump: %s\n", roburoc4_result_text(result));
        return 1;
    }
    signal(SIGINT, on_signal);
    signal(SIGTERM, on_signal);
    result = roburoc4_pump_arm(pump, 10000000);
    if (result < 0) {
        fprintf(stderr, "drive_pump: %s\n", roburoc4_result_text(result));
    }
    roburoc4_move_options_init(&options, sizeof options);
    options.max_angular_rad_s = TURN_RATE_RAD_S;
    puts("seconds,x_m,y_m,theta_rad");
    for (int turn = 0; result >= 0 && turn < 2; turn++) {
        roburoc4_move move;
        int32_t ended;
        roburoc4_move_by(&move, RADIUS_M * TURN_RAD, turns_rad[turn], &options);
        ended = roburoc4_pump_move(pump, &move);
        write_poses(&reader, stdout); /* what the pump has kept meanwhile: 10,000 samples */
        if (ended != ROBUROC4_MOVE_REACHED) {
            fprintf(stderr, "drive_pump: %s\n", roburoc4_move_outcome_text(ended));
            result = ROBUROC4_ERR_STOP_CALLED;
        }
    }
    roburoc4_pump_destroy(pump); /* stops the robot, where it drives */
    return result < 0;
}
