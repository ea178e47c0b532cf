/* SPDX-License-Identifier: MIT
 *
 * What drive_square tells a person: a live line while it drives, a summary at the end, and the path
 * as a file of comma-separated values.
 */
#ifndef DRIVE_REPORT_H
#define DRIVE_REPORT_H

#include <stdio.h>

#include "roburoc4.h"

typedef struct drive_report {
    FILE *csv;         /* NULL: not wanted */
    int terminal;      /* 1: the live line is overwritten in place */
    unsigned poses;    /* so far */
    double distance_m; /* along the odometry's path */
    roburoc4_localization_status first, last;
    uint64_t shown_cycles;
} drive_report;

/** csv_path may be NULL. Returns 0, with a message, where the file cannot be written. */
int drive_report_begin(drive_report *report, const char *csv_path);
/** One pose and motion. */
void drive_report_pose(drive_report *report, const roburoc4_client *client,
                       const roburoc4_localization_status *pose,
                       const roburoc4_differential_status *motion);
/** Begin a new line, if the live line stands there. */
void drive_report_break(const drive_report *report);
/** The summary. */
void drive_report_end(drive_report *report, const roburoc4_client *client);

#endif
