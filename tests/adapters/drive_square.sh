#!/bin/sh
# SPDX-License-Identifier: MIT
#
# drive_square.sh CASE SIMULATOR DRIVE_SQUARE: the example drive_square against the simulator as real
# processes. CASE is what happens: estop, interrupted.
set -eu
case_name=$1
simulator_program=$2
drive_square=$3
# shellcheck source=tests/adapters/simulator.sh
. "$(dirname "$0")/simulator.sh"

case $case_name in
estop)
    start "$simulator_program"
    drive_off "$drive_square" "$robot"
    echo estop local press >&3
    end_of_drive 1
    grep -q 'move 1: the robot does not follow' said
    ;;
interrupted)
    # A background job of a script ignores SIGINT unless the program itself takes it.
    start "$simulator_program"
    drive_off "$drive_square" "$robot"
    kill -INT "$driver"
    end_of_drive 130
    until state | grep 'target 0.000 m/s 0.000 rad/s'; do
        sleep 1
    done
    ;;
*)
    echo "no such case: $case_name"
    exit 1
    ;;
esac
