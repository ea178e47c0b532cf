#!/bin/sh
# SPDX-License-Identifier: MIT
#
# monitor.sh SIMULATOR MONITOR: the example monitor against the simulator as real processes: a line
# each second, every status with --all, and the reason at once where nobody listens.
set -eu
simulator_program=$1
monitor=$2
# shellcheck source=tests/adapters/simulator.sh
. "$(dirname "$0")/simulator.sh"
start "$simulator_program"

"$monitor" --seconds 4 "$robot" >lines
cat lines
lines=$(wc -l <lines)
test "$lines" -ge 2
test "$lines" -le 6
grep -q 'x 0.00 m, y 0.00 m, 0.0 deg; 0.00 m/s, 0.00 rad/s; front .* battery 100 %' lines

"$monitor" --all --seconds 2 "$robot" >all
test "$(wc -l <all)" -ge 30
for service in IOCard Telemeter Battery Localization Differential; do
    grep -q "$service" all
done

# Port 9 of this machine: nobody listens there. A loaded machine may be late: the shortest of some tries
# counts.
for _ in 1 2 3 4 5; do
    status=0
    begun=$(date +%s)
    "$monitor" 127.0.0.1:9 2>errors || status=$?
    test "$status" -eq 3
    took=$(($(date +%s) - begun))
    test "$took" -gt 4 || break
done
test "$took" -le 4
grep 'no robot answers at 127.0.0.1:9: .*nothing listens on this port' errors
