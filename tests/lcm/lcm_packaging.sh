#!/bin/sh
# SPDX-License-Identifier: MIT
#
# lcm_packaging.sh CMAKE CC PYTHON ROOT BUILD: what is installed of the LCM bridge from BUILD is all
# there and can be used: from C, from Python and, where BUILD has the jar, from Java.
set -eu
cmake=$1
cc=$2
python=$3
root=$4
build=$5

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$cmake" --install "$build" --prefix "$folder/first" >"$folder/log"
mv "$folder/first" "$folder/moved"
prefix=$folder/moved

# found NAME: the one file of this name below the prefix.
found() {
    found_file=$(find "$prefix" -name "$1")
    if [ ! -s "$found_file" ]; then
        echo "$1 is not installed once: '$found_file'" >&2
        return 1
    fi
    echo "$found_file"
}

echo "-- the bridge, its page, and how to run it always"
"$prefix/bin/roburoc4-lcm" --version
for file in roburoc4-lcm.1 roburoc4-lcm.service roburoc4.pmd; do
    found "$file" >/dev/null
done

echo "-- types"
for file in "$root"/lcm/types/*.lcm; do
    cmp "$file" "$prefix/share/lcmtypes/roburoc4_lcm/$(basename "$file")"
done

echo "-- C, by pkg-config"
PKG_CONFIG_PATH=$(dirname "$(found roburoc4-lcm.pc)")
export PKG_CONFIG_PATH
# What pkg-config prints is a list of words.
# shellcheck disable=SC2046
"$cc" -std=c99 -o "$folder/consumer" "$root/tests/adapters/packaging/lcm_consumer.c" \
    $(pkg-config --cflags --libs roburoc4-lcm)
"$folder/consumer" >"$folder/message"

echo "-- Python reads what C wrote"
PYTHONPATH=$(dirname "$(dirname "$(found drive_command_t.py)")") "$python" -c '
import sys
from roburoc4_lcm import drive_command_t
message = drive_command_t.decode(sys.stdin.buffer.read())
assert (message.sender, message.linear_m_s, message.lease_us) == ("consumer", 0.25, -1), message
' <"$folder/message"

if [ -e "$build/lcm/lcmtypes_roburoc4.jar" ]; then
    echo "-- Java"
    "$python" -m zipfile -l "$prefix/share/java/lcmtypes_roburoc4.jar" >"$folder/classes"
    for file in "$root"/lcm/types/*.lcm; do
        grep -q "roburoc4_lcm/$(basename "$file" .lcm).class" "$folder/classes"
    done
fi
