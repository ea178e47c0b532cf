#!/bin/sh
# SPDX-License-Identifier: MIT
#
# drive_square.sh CASE SIMULATOR DRIVE_SQUARE JUDGE: the example drive_square against the simulator
# as real processes. CASE is what happens: square, absent, estop, interrupted.
set -eu
LC_ALL=C
export LC_ALL
case_name=$1
simulator=$2
drive_square=$3
judge=$4

folder=$(mktemp -d)
simulator_process=
clean_up() {
    [ -z "$simulator_process" ] || kill "$simulator_process" || :
    rm -rf "$folder"
}
trap clean_up EXIT

# start OPTION...: a simulator whose panel is file descriptor 3; sets $robot.
start() {
    mkfifo "$folder/panel"
    exec 3<>"$folder/panel"
    "$simulator" --port 0 --panel "$@" <&3 >"$folder/log" &
    simulator_process=$!
    until grep -q ready "$folder/log"; do
        kill -0 "$simulator_process"
        sleep 1
    done
    robot=$(sed -n 's/.* \([0-9.]*:[0-9]*\)$/\1/p' "$folder/log")
}

# It gives up when it has heard no status for 300 ms, as it should. A loaded machine may not run it for
# that long, which proves nothing: then the whole test begins again.
starved() {
    grep -E 'no (recent|fresh) status|no recent .* status' "$folder/out"
}
again() {
    clean_up
    trap - EXIT
    tries=$((${tries:-0} + 1))
    [ "$tries" -lt 10 ]
    export tries
    exec sh "$0" "$case_name" "$simulator" "$drive_square" "$judge"
}

# The exit status of drive_square has to be $1.
drive() {
    wanted=$1
    shift
    status=0
    "$drive_square" "$@" >"$folder/out" 2>&1 || status=$?
    cat "$folder/out"
    ! starved || again
    if [ "$status" -ne "$wanted" ]; then
        echo "exit status $status, not $wanted"
        exit 1
    fi
}

# Until the robot moves.
wait_for_motion() {
    until grep -q ' target [0-9.]*[1-9]' "$folder/log"; do
        echo status >&3
        kill -0 "$simulator_process"
        sleep 0.2 2>/dev/null || sleep 1
    done
}

case $case_name in
square)
    start --loss 0.05 --jitter-ms 5 --duplicate 0.01 --reorder 0.01
    drive 0 "$robot" "$folder/path.csv"
    awk -f "$judge" "$folder/path.csv"
    ;;
absent)
    # Port 9 of this machine: nobody listens there.
    drive 3 127.0.0.1:9
    grep -q 'no robot to be driven at 127.0.0.1:9: .*network: the host answers' "$folder/out"
    ;;
estop)
    start
    (
        wait_for_motion
        echo estop local press >&3
    ) &
    drive 1 "$robot"
    grep -q 'move 1: the robot does not move' "$folder/out"
    ;;
interrupted)
    start
    # A background job of a script ignores SIGINT unless the program itself takes it.
    "$drive_square" "$robot" >"$folder/out" 2>&1 &
    driver=$!
    wait_for_motion
    kill -INT "$driver"
    status=0
    wait "$driver" || status=$?
    cat "$folder/out"
    ! starved || again
    test "$status" -eq 130
    until tail -n 1 "$folder/log" | grep 'target 0.000 m/s 0.000 rad/s'; do
        kill -0 "$simulator_process"
        echo status >&3
        sleep 1
    done
    ;;
*)
    echo "no such case: $case_name"
    exit 1
    ;;
esac
