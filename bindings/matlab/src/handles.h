/* SPDX-License-Identifier: MIT
 *
 * handles.h - MATLAB's references to robots and simulators: numbers, never pointers.
 *
 * An id is a slot in a table and a generation that is used only once. So an id of something that
 * was closed, of a MEX file that was cleared, or an invented one, finds nothing.
 */
#ifndef ROBUROC4_MEX_HANDLES_H
#define ROBUROC4_MEX_HANDLES_H

#include <stdint.h>

#define HANDLE_ROBOT 1
#define HANDLE_SIMULATOR 2
/** Robots and simulators at a time. */
#define HANDLES_MAX 64

/** Add an object. Returns its id (more than 0), or 0 after noting that the table is full. */
double handles_add(int kind, void *object);
/** The object of this id and kind, or NULL. */
void *handles_find(int kind, double id);
/** Forget an object. */
void handles_remove(const void *object);
/** Do this with each object of a kind; it may remove the object. */
void handles_each(int kind, void (*act)(void *object));
/** How many there are of a kind. */
uint32_t handles_count(int kind);

#endif
