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

#include "answers.h"
#include "commands.h"
#include "fail.h"
#include "handles.h"

#define TABLES 4

static const command *const tables[TABLES] = {robot_drive_commands, robot_look_commands,
                                              robot_life_commands, simulator_commands};

static void at_exit(void) {
    close_robots();
    close_simulators();
}

static const command *find(const char *name) {
    const command *found;
    int i;
    for (i = 0; i < TABLES; i++) {
        for (found = tables[i]; found->name != NULL; found++) {
            if (strcmp(found->name, name) == 0) {
                return found;
            }
        }
    }
    return NULL;
}

/* living(): how many robots and simulators there are */
static mxArray *living(void) {
    answer out;
    answer_begin(&out);
    answer_number(&out, "robots", handles_count(HANDLE_ROBOT));
    answer_number(&out, "simulators", handles_count(HANDLE_SIMULATOR));
    return answer_finish(&out);
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
    call told = {results, count - 1, arguments + 1};
    if (count < 1 || !take_text(arguments[0], "command", name)) {
        return fail(FAIL_ARGUMENT, "a command is needed: use roburoc4.Robot");
    }
    if (result_count > 1) {
        return fail(FAIL_ARGUMENT, "%s: it has one result at most", name);
    }
    if (strcmp(name, "living") == 0) {
        results[0] = living();
        return 1;
    }
    found = find(name);
    if (found == NULL) {
        return fail(FAIL_ARGUMENT, "there is no command '%s'", name);
    }
    if (found->arguments >= 0 ? told.count != found->arguments : told.count < -found->arguments) {
        return fail(FAIL_ARGUMENT, "%s: %d arguments are too few or too many", name, told.count);
    }
    return found->run(&told);
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
