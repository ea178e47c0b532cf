# shellcheck shell=sh
# SPDX-License-Identifier: MIT
#
# Sourced by scripts that run a program against the simulator as real processes, in a new folder.
# They define restart(), which begins the whole script again.
LC_ALL=C
export LC_ALL

folder=$(mktemp -d)
simulator=
stall_watch=
clean_up() {
    [ -z "$simulator" ] || kill "$simulator" 2>/dev/null || :
    [ -z "$stall_watch" ] || kill "$stall_watch" 2>/dev/null || :
    rm -rf "$folder"
}
trap clean_up EXIT
cd "$folder" || exit 1

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

# A program gives up when it has heard no status for 300 ms, or has not driven for 250, as it should. A
# loaded machine may not run it for that long: then, and only where such a stall was measured, the whole
# test begins again. One that stalls for so long in the last try, too, cannot judge it: the test was not run.
hopeless_ms=200
if [ -n "${STALLS:-}" ]; then
    "$STALLS" >stalls_ms &
    stall_watch=$!
fi
starved() {
    [ -s stalls_ms ] && grep -E 'no (recent|fresh) .*status|do not arrive|not connected|not known|in time:|lease expired' said
}
tries=$((${tries:-0} + 1))
export tries
again() {
    stall_ms=$(sort -n stalls_ms | tail -n 1)
    if [ "$tries" -ge 5 ]; then
        [ "$stall_ms" -ge "$hopeless_ms" ]
        echo "not judged: this machine stalled for $stall_ms ms"
        exit 77
    fi
    echo "begins again: this machine stalled for $stall_ms ms"
    cd /
    clean_up
    trap - EXIT
    restart
}

# ended WANTED STATUS: of a program.
ended() {
    cat said
    if [ "$2" -ne "$1" ]; then
        ! starved || again
        echo "exit status $2, not $1; stalls measured, in ms: $(cat stalls_ms 2>/dev/null)"
        exit 1
    fi
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
        kill -0 "$driver" 2>/dev/null || {
            cat said
            starved && again
            exit 1
        }
    done
}

# end_of_drive STATUS: the program of drive_off ends with this exit status.
end_of_drive() {
    status=0
    wait "$driver" || status=$?
    ended "$1" "$status"
}
