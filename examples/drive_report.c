/* SPDX-License-Identifier: MIT
 *
 * What drive_square tells a person. See drive_report.h.
 */
#define _POSIX_C_SOURCE 200809L

#include "drive_report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "roburoc4_udp.h"

#ifdef _WIN32
#include <io.h>
#define isatty _isatty
#define fileno _fileno
#else
#include <unistd.h>
#endif

#define DEGREES_PER_RADIAN 57.29577951308232

int drive_report_begin(drive_report *report, const char *csv_path) {
    memset(report, 0, sizeof *report);
    report->terminal = isatty(fileno(stdout));
    if (csv_path != NULL) {
        report->csv = fopen(csv_path, "w");
        if (report->csv == NULL) {
            fprintf(stderr, "drive_square: cannot write '%s'\n", csv_path);
            return 0;
        }
        fprintf(report->csv, "robot_s,x_m,y_m,theta_rad,linear_m_s,angular_rad_s\n");
    }
    return 1;
}

static void show(drive_report *report, const roburoc4_client *client,
                 const roburoc4_localization_status *pose,
                 const roburoc4_differential_status *motion) {
    printf("%sx %6.2f m  y %6.2f m  %7.1f deg | %5.2f m/s %6.2f rad/s",
           report->terminal ? "\r" : "", pose->x_m, pose->y_m, pose->theta_rad * DEGREES_PER_RADIAN,
           (double)motion->current_linear_m_s, (double)motion->current_angular_rad_s);

    roburoc4_battery_status battery;
    if (roburoc4_client_battery(client, &battery, NULL) == 0) {
        printf(" | battery %3u %%", (unsigned)battery.remaining_percent);
    }
    roburoc4_distances telemeters;
    if (roburoc4_client_distances(client, &telemeters, NULL) == 0 && telemeters.count >= 2) {
        printf(" | front %.2f m rear %.2f m",
               (double)telemeters.distance_m[ROBUROC4_TELEMETER_FRONT],
               (double)telemeters.distance_m[ROBUROC4_TELEMETER_REAR]);
    }
    printf(report->terminal ? "  " : "\n");
    fflush(stdout);
}

void drive_report_pose(drive_report *report, const roburoc4_client *client,
                       const roburoc4_localization_status *pose,
                       const roburoc4_differential_status *motion) {
    if (report->poses == 0) {
        report->first = *pose;
    } else {
        report->distance_m += hypot(pose->x_m - report->last.x_m, pose->y_m - report->last.y_m);
    }
    report->last = *pose;

    if (report->csv != NULL) {
        fprintf(report->csv, "%.2f,%.4f,%.4f,%.4f,%.3f,%.3f\n", (double)pose->robot_cycles * 0.01,
                pose->x_m, pose->y_m, pose->theta_rad, (double)motion->current_linear_m_s,
                (double)motion->current_angular_rad_s);
    }

    /* A terminal is refreshed ten times a second, a file or pipe gets a line each second. */
    uint64_t step_cycles = report->terminal ? 10 : 100;
    if (report->poses == 0 || pose->robot_cycles - report->shown_cycles >= step_cycles) {
        report->shown_cycles = pose->robot_cycles;
        show(report, client, pose, motion);
    }
    report->poses++;
}

void drive_report_break(const drive_report *report) {
    if (report->terminal && report->poses > 0) {
        printf("\n");
    }
    fflush(stdout);
}

void drive_report_end(drive_report *report, const roburoc4_client *client) {
    roburoc4_link link;
    link.size = sizeof link;
    if (report->poses > 0) {
        printf("distance    %.2f m by odometry\n", report->distance_m);
        printf("final pose  x %.3f m, y %.3f m, %.1f deg by odometry: %.3f m from the start\n",
               report->last.x_m, report->last.y_m, report->last.theta_rad * DEGREES_PER_RADIAN,
               hypot(report->last.x_m - report->first.x_m, report->last.y_m - report->first.y_m));
    }
    if (roburoc4_client_link(client, roburoc4_udp_now_us(), &link) == 0) {
        printf("statuses    %" PRIu32 " received, %" PRIu32 " lost (%.1f %%)\n", link.received,
               link.lost, 100.0 * link.lost / fmax(1.0, (double)link.received + link.lost));
        printf("round trip  %.2f ms\n", link.round_trip_us * 1e-3);
    }
    if (report->csv != NULL && fclose(report->csv) != 0) {
        fprintf(stderr, "drive_square: the path's file is not complete: is the disk full?\n");
    }
    report->csv = NULL;
}
