# shellcheck shell=sh
# SPDX-License-Identifier: MIT
#
# Sourced by scripts that run a program against the simulator as real processes, each in a new folder.
LC_ALL=C
export LC_ALL

# A program gives up when it has heard no status for 300 ms, or has not driven for 250, as it should. A
# loaded machine may not run it for that long: only where such a stall was measured, a script that fails
# begins again. One that stalls for so long in the last try, too, cannot judge it: the test was not run.
hopeless_ms=200
if [ -z "${attempt:-}" ]; then
    folders=$(mktemp -d)
    trap 'rm -rf "$folders"' EXIT
    for try in 1 2 3 4 5; do
        attempt=$folders/$try
        mkdir "$attempt"
        "${STALLS:-:}" >"$attempt.stalls" &
        status=0
        attempt=$attempt sh "$0" "$@" || status=$?
        kill $! 2>/dev/null || :
        stall_ms=$(sort -n "$attempt.stalls" | tail -n 1)
        [ "$status" -ne 0 ] || exit 0
        cat "$attempt/said" 2>/dev/null || :
        [ -n "$stall_ms" ] || exit "$status"
        echo "begins again: this machine stalled for $stall_ms ms"
    done
    [ "$stall_ms" -ge "$hopeless_ms" ] || exit "$status"
    echo "not judged: this machine stalled for $stall_ms ms"
    exit 77
fi

simulator=
trap '[ -z "$simulator" ] || kill "$simulator" 2>/dev/null || :' EXIT
cd "$attempt" || exit 1

# start PROGRAM OPTION...: the simulator, whose panel is file descriptor 3; sets $robot.
# shellcheck disable=SC2034
start() {
    mkfifo panel
    exec 3<>panel
    "$@" --port 0 --panel <&3 >log &
    simulator=$!
    until grep -q ready log; do
        kill -0 "$simulator"
        sleep 1
    done
    robot=$(sed -n 's/.* \([0-9.]*:[0-9]*\)$/\1/p' log)
}

# ended WANTED STATUS: of a program.
ended() {
    [ "$2" -eq "$1" ] || {
        echo "exit status $2, not $1"
        exit 1
    }
}

# drive STATUS PROGRAM ARGUMENT...: it ends with this exit status.
drive() {
    wanted=$1
    shift
    status=0
    "$@" >said 2>&1 || status=$?
    ended "$wanted" "$status"
}

# Waits for the simulator's next line, and prints it.
state() {
    lines=$(wc -l <log)
    echo status >&3
    while [ "$(wc -l <log)" -le "$lines" ]; do
        kill -0 "$simulator"
        sleep 0.2 2>/dev/null || sleep 1
    done
    tail -n 1 log
}

# drive_off PROGRAM ARGUMENT...: in the background, until the robot moves; sets $driver.
drive_off() {
    "$@" >said 2>&1 &
    driver=$!
    until state | grep -q ' target [0-9.]*[1-9]'; do
        kill -0 "$driver"
    done
}

# end_of_drive STATUS: the program of drive_off ends with this exit status.
end_of_drive() {
    status=0
    wait "$driver" || status=$?
    ended "$1" "$status"
}
