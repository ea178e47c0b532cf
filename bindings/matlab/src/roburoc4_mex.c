/* SPDX-License-Identifier: MIT
 *
 * roburoc4_mex(COMMAND, ...): the one door between MATLAB or Octave and the C libraries. See
 * roburoc4_mex.m; users call roburoc4.Robot and roburoc4.Simulator.
 *
 * While anything lives the MEX file is locked, as threads run in it; when the program ends, or
 * clears it by force, all robots are stopped. Only real arrays and functions that are the same
 * under -R2017b and -R2018a are used.
 */
#include <string.h>

#include "commands.h"
#include "fail.h"

static void at_exit(void) {
    close_robots();
    close_simulators();
}

/* living(): how many robots and simulators there are */
static int look_living(const call *in) {
    answer out;
    answer_begin(&out);
    answer_number(&out, "robots", handles_count(HANDLE_ROBOT));
    answer_number(&out, "simulators", handles_count(HANDLE_SIMULATOR));
    in->results[0] = answer_finish(&out);
    return 1;
}

static const command own_commands[] = {{"living", NO_ID, 0, look_living}, {NULL, NO_ID, 0, NULL}};

static const command *find(const char *name) {
    static const command *const tables[] = {robot_drive_commands, robot_look_commands,
                                            robot_life_commands, simulator_commands, own_commands};
    const command *found;
    size_t i;
    for (i = 0; i < COUNT_OF(tables); i++) {
        for (found = tables[i]; found->name != NULL; found++) {
            if (strcmp(found->name, name) == 0) {
                return found;
            }
        }
    }
    return NULL;
}

/* The robot or simulator of an id. */
static int take_object(subject of, const mxArray *value, void **out) {
    const int simulated = of == SIMULATOR || of == ANY_SIMULATOR;
    double id;
    if (!take_number(value, "id", &id)) {
        return 0;
    }
    *out = handles_find(simulated ? HANDLE_SIMULATOR : HANDLE_ROBOT, id);
    if (of == ANY_ROBOT || of == ANY_SIMULATOR) {
        return 1;
    }
    if (*out == NULL) {
        return simulated ? fail(FAIL_CLOSED, "this simulator was deleted; make a new one with "
                                             "roburoc4.Simulator")
                         : fail(FAIL_CLOSED,
                                "this robot was deleted; make a new one with roburoc4.Robot");
    }
    return simulated || robot_can(*out, of == OPEN_ROBOT);
}

/* Lock the MEX file while there is anything, once. */
static void lock_while_living(void) {
    static int locked;
    const int wanted = handles_count(HANDLE_ROBOT) + handles_count(HANDLE_SIMULATOR) > 0;
    if (wanted && !locked) {
        mexLock();
    } else if (!wanted && locked) {
        mexUnlock();
    }
    locked = wanted;
}

static int run(int result_count, mxArray **results, int count, const mxArray **arguments) {
    char name[TEXT_SIZE] = "";
    const command *found;
    call in = {results, count - 1, arguments + 1, NULL};
    int wanted;
    if (count < 1 || !take_text(arguments[0], "command", name)) {
        return fail(FAIL_ARGUMENT, "this is no command; use roburoc4.Robot");
    }
    found = find(name);
    if (found == NULL) {
        return fail(FAIL_ARGUMENT, "there is no command '%s'; use roburoc4.Robot", name);
    }
    if (result_count > 1) {
        return fail(FAIL_ARGUMENT, "%s: it has one result at most", name);
    }
    wanted =
        (found->arguments < 0 ? -found->arguments - 1 : found->arguments) + (found->of != NO_ID);
    if (in.count < wanted || (in.count > wanted && found->arguments >= 0)) {
        return fail(FAIL_ARGUMENT, "%s: %d arguments are too few or too many", name, in.count);
    }
    if (found->of != NO_ID) {
        if (!take_object(found->of, in.arguments[0], &in.object)) {
            return 0;
        }
        in.arguments++;
        in.count--;
    }
    return found->run(&in);
}

#ifdef __GNUC__
__attribute__((visibility("default")))
#endif
void mexFunction(int result_count, mxArray *results[], int count, const mxArray *arguments[]) {
    int fine;
    mexAtExit(at_exit);
    fine = run(result_count, results, count, arguments);
    lock_while_living();
    if (!fine) {
        mexErrMsgIdAndTxt(fail_id(), "%s", fail_text());
    }
}
