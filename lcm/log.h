/* SPDX-License-Identifier: MIT
 *
 * Lines for the person at the terminal, or for the journal: on stderr, each with the program's name
 * and, where there are several, the robot's.
 */
#ifndef ROBUROC4_LCM_LOG_H
#define ROBUROC4_LCM_LOG_H

enum log_level { LOG_ERROR, LOG_NOTE, LOG_DETAIL };

/* Lines above this level are not printed; LOG_NOTE at first. */
void log_set_level(enum log_level level);

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
/* robot: its name, or NULL or "" for none. */
void log_line(enum log_level level, const char *robot, const char *format, ...);

#endif
