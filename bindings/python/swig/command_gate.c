/* SPDX-License-Identifier: MIT
 *
 * The gate of bridges for drive commands: values of Python in, verdicts out. The interpreter's lock
 * keeps it to one thread at a time.
 */
#include "native.h"

#include <stdlib.h>

#define REASON_SIZE 300

struct command_gate {
    gate gate; /* first: see typemaps.i */
    gate_stall stall;
};

command_gate *new_command_gate(int enabled, uint32_t lease_us, uint32_t max_age_us, gate_time now) {
    command_gate *g = calloc(1, sizeof *g);
    gate_rules rules = {{0}, lease_us, max_age_us};
    rules.enabled[GATE_DRIVE] = enabled != 0;
    if (g != NULL) {
        gate_init(&g->gate, &rules, now);
    }
    return g;
}

PyObject *judge_drive(command_gate *g, PyObject *command, const gate_robot *robot, gate_time now) {
    gate_command c = {0};
    Py_ssize_t length;
    int finite, zero;
    uint32_t lease_us = 0;
    enum gate_verdict verdict;
    c.kind = GATE_DRIVE;
    if (!PyArg_ParseTuple(command, "s#LLpp", &c.sender, &length, &c.utime, &c.arrived_utime,
                          &finite, &zero)) {
        return NULL;
    }
    c.sender_length = (size_t)length;
    c.finite = finite != 0;
    c.zero = zero != 0;
    verdict = gate_judge(&g->gate, &c, robot, now, &lease_us);
    return Py_BuildValue("iI", (int)verdict, lease_us);
}

PyObject *look_for_trouble(command_gate *g, uint32_t asked_us, gate_time now) {
    uint64_t since_us = 0;
    int stalled = gate_look_for_stall(&g->stall, asked_us, now, &since_us);
    if (stalled) {
        gate_was_stalled(&g->gate, since_us, now.us);
    }
    return Py_BuildValue("NL", PyBool_FromLong(stalled),
                         (long long)gate_look_at_clock(&g->gate, now));
}

int64_t command_arrival(const command_gate *g, int64_t utime) {
    return gate_arrival(&g->stall, utime);
}

PyObject *explain_rejection(command_gate *g, enum gate_verdict verdict, const char *sender,
                            size_t length, int64_t utime, gate_time now) {
    char why[REASON_SIZE];
    const gate_rejection rejection = {verdict, GATE_DRIVE, utime, "stamp", "--max-age-ms"};
    gate_reason(why, sizeof why, &rejection, &g->gate.rules, now);
    return Py_BuildValue(
        "sN", why, PyBool_FromLong(gate_is_incident(&g->gate, verdict, sender, length, now.us)));
}

PyObject *command_counts(const command_gate *g) {
    PyObject *rejected = PyTuple_New(GATE_VERDICTS);
    for (int i = 0; rejected != NULL && i < GATE_VERDICTS; i++) {
        rejected = put_item(rejected, i, PyLong_FromLongLong(g->gate.rejected[i]));
    }
    return rejected == NULL ? NULL
                            : Py_BuildValue("LLN", (long long)g->gate.taken[GATE_DRIVE],
                                            (long long)g->gate.taken[GATE_STOP], rejected);
}
