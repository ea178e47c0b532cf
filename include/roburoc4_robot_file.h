/* SPDX-License-Identifier: MIT
 *
 * roburoc4_robot_file.h - what is known about one robot, as a small text file.
 *
 * THE FILE
 *
 *     [inputs]
 *     override_index = 8
 *
 *     [commands]
 *     robot_watchdog_ms = 1000   # a comment
 *
 * One `name = value` each line; each name occurs at most once. Leave out what is not known.
 * Sections ([inputs]) are for the reader's eye. roburoc4 first-contact measures a robot and writes
 * its file; roburoc4 calibrate adds the scales. docs/first-contact.md explains the names: most are
 * those of the family of robots in docs/PROTOCOL.md, the others those of roburoc4_config.
 *
 *     roburoc4_robot_file known;
 *     const char *remedy;
 *     uint32_t line;
 *     if (roburoc4_robot_file_read(&known, text, length, &line, &remedy) == ROBUROC4_OK) {
 *         roburoc4_robot_file_config(&known, &config);
 *     }
 *
 * CONVENTIONS
 *
 *   Those of roburoc4.h. Nothing is allocated; you read and write the file.
 */
#ifndef ROBUROC4_ROBOT_FILE_H
#define ROBUROC4_ROBOT_FILE_H

#include "roburoc4.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The most names of any version. */
#define ROBUROC4_ROBOT_FILE_NAMES 128
/** The longest file that roburoc4_robot_file_write() writes. */
#define ROBUROC4_ROBOT_FILE_SIZE 6144

/** What is known about a robot (frozen: its size never changes). Fill it with zeros, or by
 *  roburoc4_robot_file_read(). */
typedef struct roburoc4_robot_file {
    uint32_t private_known[ROBUROC4_ROBOT_FILE_NAMES / 32];
    float private_values[ROBUROC4_ROBOT_FILE_NAMES];
} roburoc4_robot_file;

/** Read the text of a file. Returns 0; or ROBUROC4_ERR_CONFIG, and then *line is the number of the
 *  first wrong line, *remedy says what is wrong and what to give instead (it lives as long as the
 *  program), and *out is unchanged. A text without any name is wrong in line 1. line and remedy may
 *  be NULL. */
ROBUROC4_API roburoc4_result roburoc4_robot_file_read(roburoc4_robot_file *out, const char *text,
                                                      size_t length, uint32_t *line,
                                                      const char **remedy);
/** Write the text of a file, without a NUL at its end: its length, or ROBUROC4_ERR_BUFFER. */
ROBUROC4_API roburoc4_result roburoc4_robot_file_write(const roburoc4_robot_file *file, char *text,
                                                       size_t capacity);
/** The name with this index, from 0 on, in the order of the file; NULL beyond the last. */
ROBUROC4_API const char *roburoc4_robot_file_name(uint32_t index);
/** The value of a name. ROBUROC4_ERR_INDEX: there is no such name; ROBUROC4_ERR_NOT_KNOWN: the
 *  file does not have it. */
ROBUROC4_API roburoc4_result roburoc4_robot_file_get(const roburoc4_robot_file *file,
                                                     const char *name, float *out);
/** Set the value of a name. ROBUROC4_ERR_INDEX: there is no such name; ROBUROC4_ERR_ARGUMENT: not
 *  in its range, or the id of another service. */
ROBUROC4_API roburoc4_result roburoc4_robot_file_set(roburoc4_robot_file *file, const char *name,
                                                     float value);
/** Change what is known of the robot in a client's configuration: ids of IO card and differential
 *  service, indices of inputs, the robot's watchdog, and scales. Nothing else changes. */
ROBUROC4_API void roburoc4_robot_file_config(const roburoc4_robot_file *file,
                                             roburoc4_config *config);

#ifdef __cplusplus
}
#endif

#endif
