/* SPDX-License-Identifier: MIT
 *
 * roburoc4_mex(COMMAND, ...): the one way from MATLAB or Octave to the C libraries. See
 * roburoc4_mex.m; users call roburoc4.Robot and roburoc4.Simulator.
 *
 * While there is a robot or simulator the MEX file is locked, as threads run in it; when the
 * program ends, or clears the file by force, all robots are stopped. Only real arrays and functions
 * that are the same under -R2017b and -R2018a are used.
 */
#include <string.h>

#include "commands.h"
#include "fail.h"

static void at_exit(void) {
    robots_close();
    close_simulators();
}

/* living(): how many robots and simulators there are */
static int count_living(call *in) {
    answer_number(&in->out, "robots", handles_count(HANDLE_ROBOT));
    answer_number(&in->out, "simulators", handles_count(HANDLE_SIMULATOR));
    return 1;
}

static const command own_commands[] = {{"living", NO_ID, 0, STRUCT, count_living},
                                       {NULL, NO_ID, 0, NOTHING, NULL}};

static const command *find(const char *name) {
    static const command *const tables[] = {robot_drive_commands, robot_move_commands,
                                            robot_read_commands,  robot_life_commands,
                                            simulator_commands,   own_commands};
    const command *found;
    for (size_t i = 0; i < COUNT_OF(tables); i++) {
        for (found = tables[i]; found->name != NULL; found++) {
            if (strcmp(found->name, name) == 0) {
                return found;
            }
        }
    }
    return NULL;
}

/* The robot or simulator of an id. */
static int take_object(call *in, subject of) {
    const int simulated = of == SIMULATOR || of == ANY_SIMULATOR;
    double id;
    if (!take_number(in->arguments[0], "id", &id)) {
        return 0;
    }
    in->object = handles_find(simulated ? HANDLE_SIMULATOR : HANDLE_ROBOT, id);
    in->arguments++;
    in->count--;
    if (of == ANY_ROBOT || of == ANY_SIMULATOR) {
        return 1;
    }
    if (in->object == NULL) {
        return fail(FAIL_CLOSED, "this %s was deleted; make a new one with roburoc4.%s",
                    simulated ? "simulator" : "robot", simulated ? "Simulator" : "Robot");
    }
    return simulated || robot_can(in->object, of != READ_ROBOT);
}

/* Run a command with the client that it needs. */
static int run_with_client(const command *found, call *in) {
    int fine;
    if (found->of == READ_ROBOT) {
        in->client = robot_copy(in->object, &in->now_us);
    } else if (found->of == CONTROL_ROBOT) {
        in->client = robot_lock(in->object, &in->now_us);
    }
    fine = found->run(in);
    if (found->of == CONTROL_ROBOT) {
        robot_unlock(in->object);
    }
    return fine;
}

static void give_result(const call *in, result_kind kind) {
    if (kind == NUMBER) {
        in->results[0] = mxCreateDoubleScalar(in->number);
    } else if (kind == FLAG) {
        in->results[0] = mxCreateLogicalScalar(in->number != 0.0);
    } else if (kind == STRUCT) {
        in->results[0] = answer_finish(&in->out);
    }
}

/* Lock the MEX file while there is any robot or simulator, once. */
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
    call in = {.results = results, .count = count - 1, .arguments = arguments + 1};
    int least, fine;
    if (count < 1 || !take_text(arguments[0], "command", name)) {
        return fail(FAIL_ARGUMENT, "this is not a command; use roburoc4.Robot");
    }
    found = find(name);
    if (found == NULL || result_count > 1) {
        return fail(FAIL_ARGUMENT, "there is no command '%s' with %d results; use roburoc4.Robot",
                    name, result_count);
    }
    least =
        (found->arguments < 0 ? -found->arguments - 1 : found->arguments) + (found->of != NO_ID);
    if (in.count < least || (in.count > least && found->arguments >= 0)) {
        return fail(FAIL_ARGUMENT, "%s: %d arguments are too few or too many", name, in.count);
    }
    fine = (found->of == NO_ID || take_object(&in, found->of)) && run_with_client(found, &in);
    if (fine) {
        give_result(&in, found->result);
    }
    return fine;
}

/* In Octave, mexErrMsgIdAndTxt() would put the name of this file before the message. */
static void raise_error(void) {
    mxArray *arguments[] = {mxCreateString(fail_id()), mxCreateString("%s"),
                            mxCreateString(fail_text())};
    (void)mexCallMATLAB(0, NULL, (int)COUNT_OF(arguments), arguments, "error");
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
        raise_error();
    }
}
