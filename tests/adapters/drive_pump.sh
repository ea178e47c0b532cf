#!/bin/sh
# SPDX-License-Identifier: MIT
#
# drive_pump.sh CASE SIMULATOR DRIVE_PUMP: the example drive_pump against the simulator as real
# processes. CASE is what happens: eight, interrupted.
set -eu
case_name=$1
simulator_program=$2
drive_pump=$3
# shellcheck source=tests/adapters/simulator.sh
. "$(dirname "$0")/simulator.sh"

case $case_name in
eight)
    # Two circles of a quarter of a metre: the path reaches twice that to the left and to the right.
    start "$simulator_program"
    drive 0 "$drive_pump" "$robot"
    awk -F , 'NR > 1 { if ($3 > most) most = $3; if ($3 < least) least = $3 }
        END { exit !(NR > 100 && most > 0.4 && most < 0.6 && least < -0.4 && least > -0.6) }' said
    ;;
interrupted)
    start "$simulator_program"
    drive_off "$drive_pump" "$robot"
    kill -INT "$driver"
    end_of_drive 1
    grep -q 'drive_pump: cancelled' said
    state | grep -q 'target 0.000 m/s 0.000 rad/s'
    ;;
*)
    echo "no such case: $case_name"
    exit 1
    ;;
esac
