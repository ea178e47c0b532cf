/* SPDX-License-Identifier: MIT
 *
 * roburoc4_mex(COMMAND, ...): the only connection of MATLAB and Octave to the C libraries. See
 * roburoc4_mex.m; users call roburoc4.Robot and roburoc4.Simulator.
 *
 * While there is a robot or simulator the MEX file is locked, as threads run in it; when the
 * program ends, or clears the file by force, all robots are stopped. Only real arrays and functions
 * that are the same under -R2017b and -R2018a are used.
 */
#include <string.h>

#include "commands.h"

static void at_exit(void) {
    robots_close();
    close_simulators();
}

static const command *find(const char *name) {
    static const command *const tables[] = {robot_drive_commands, robot_read_commands,
                                            robot_life_commands, simulator_commands,
                                            settings_commands};
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
    if (in->count < 1 || !take_number(in->arguments[0], "id", &id)) {
        return in->count < 1 ? fail(FAIL_ARGUMENT, "id: it is missing") : 0;
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
    if (!simulated) {
        in->out.begin_us = ((const robot *)in->object)->opened_us;
        in->out.utc_us = robot_utc_us(in->object);
    }
    return simulated || robot_can(in->object, of != READ_ROBOT);
}

static int take_argument(call *in, const argument *wanted, int i) {
    static char texts[ARGUMENTS_MAX][TEXT_SIZE];
    const mxArray *value = in->arguments[i];
    uint32_t service;
    switch (wanted->kind) {
    case TAKE_SPEED:
        if (mxIsLogical(value)) {
            return fail(FAIL_ARGUMENT, "%s: this is logical; give one real number", wanted->name);
        }
        /* fall through */
    case TAKE_RANGE:
        return take_range(value, wanted->name, wanted->least, wanted->most, &in->numbers[i]);
    case TAKE_WHOLE:
        return take_whole(value, wanted->name, wanted->least, wanted->most, &in->numbers[i]);
    case TAKE_NUMBER:
        return take_number(value, wanted->name, &in->numbers[i]);
    case TAKE_TEXT:
        in->texts[i] = texts[i];
        return take_text(value, wanted->name, texts[i]);
    case TAKE_SERVICE:
    case TAKE_SERVICES:
        if (!take_service(value, &service)) {
            return 0;
        }
        in->services |= 1u << service;
        if (wanted->kind == TAKE_SERVICE) {
            in->numbers[i] = service;
        }
        return 1;
    default:
        return 1;
    }
}

static int take_arguments(call *in, const command *found) {
    const argument *wanted = found->arguments;
    int count = 0, has_rest;
    while (count < ARGUMENTS_MAX && wanted[count].name != NULL) {
        count++;
    }
    has_rest = count > 0 && wanted[count - 1].kind == TAKE_SERVICES;
    if (in->count < count - has_rest || (in->count > count && !has_rest)) {
        return fail(FAIL_ARGUMENT, "%s: %d arguments are too few or too many", found->name,
                    in->count);
    }
    for (int i = 0; i < in->count; i++) {
        if (!take_argument(in, &wanted[i < count ? i : count - 1], i)) {
            return 0;
        }
    }
    in->services = in->services != 0 ? in->services : ALL_SERVICES;
    return 1;
}

/* Run a command with the client that it needs. */
static int run_with_client(const command *found, call *in) {
    int fine;
    if (found->of == READ_ROBOT) {
        in->client = robot_copy(in->object, &in->now_us);
    } else if (found->of == CONTROL_ROBOT) {
        in->client = robot_lock(in->object, &in->now_us);
    } else if (found->of != NO_ID && in->object == NULL) {
        return 1;
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
    int fine;
    if (count < 1 || !take_text(arguments[0], "command", name)) {
        return fail(FAIL_ARGUMENT, "this is not a command; use roburoc4.Robot");
    }
    found = find(name);
    if (found == NULL || result_count > 1) {
        return fail(FAIL_ARGUMENT, "there is no command '%s' with %d results; use roburoc4.Robot",
                    name, result_count);
    }
    fine = (found->of == NO_ID || take_object(&in, found->of)) && take_arguments(&in, found) &&
           run_with_client(found, &in);
    if (fine) {
        give_result(&in, found->result);
    }
    return fine;
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
        fail_raise();
    }
}
