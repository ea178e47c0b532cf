#!/bin/sh
# SPDX-License-Identifier: MIT
#
# event_loop.sh SIMULATOR EVENT_LOOP: the example event_loop against the simulator as real processes: it
# drives as long as it is told to, and stops the robot on SIGTERM.
set -eu
simulator_program=$1
event_loop=$2
# shellcheck source=tests/adapters/simulator.sh
. "$(dirname "$0")/simulator.sh"

# Once a command was answered the next one may come.
command_it() {
    answers=$(wc -l <said)
    echo "$1" >&4
    while [ "$(wc -l <said)" -le "$answers" ]; do
        kill -0 "$driver"
        sleep 0.05 2>/dev/null || sleep 1
    done
}

start "$simulator_program"
mkfifo commands
exec 4<>commands
"$event_loop" "$robot" <&4 >said 2>&1 &
driver=$!
until grep -q 'ready to arm' said; do
    kill -0 "$driver"
    sleep 0.1 2>/dev/null || sleep 1
done
command_it arm
grep -q '^arm: ok' said
until state | grep -q 'odometry 0\.[2-9]'; do
    command_it 0.5
    ! grep '^0.5: [^o]' said || exit 1
done
kill -TERM "$driver"
end_of_drive 0
state | grep 'target 0.000 m/s 0.000 rad/s'
