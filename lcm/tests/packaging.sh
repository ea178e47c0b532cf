#!/bin/sh
# SPDX-License-Identifier: MIT
#
# packaging.sh CMAKE CC CXX PYTHON ROOT BUILD: what is installed of the LCM bridge from BUILD is all
# there and can be used: from C, C++, Python and, where BUILD has the jar, from Java.
set -eu
cmake=$1
cc=$2
cxx=$3
python=$4
root=$5
build=$6

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
"$prefix/bin/roburoc4-lcm" --config "$(found roburoc4-lcm.ini)" --check | grep -q "obeys stop only"
test "$(grep -c '"roburoc4-lcm' "$(found roburoc4.pmd)")" = 1 # two bridges would share a robot

echo "-- types"
for file in "$root"/lcm/types/*.lcm; do
    cmp "$file" "$prefix/share/lcmtypes/roburoc4_lcm_$(basename "$file")"
done

echo "-- C, by pkg-config"
PKG_CONFIG_PATH=$(dirname "$(found roburoc4-lcm.pc)")
export PKG_CONFIG_PATH
# What pkg-config prints is a list of words.
# shellcheck disable=SC2046
"$cc" -std=c99 -o "$folder/consumer" "$root/lcm/tests/packaging/lcm_consumer.c" \
    $(pkg-config --cflags --libs roburoc4-lcm)
"$folder/consumer" >"$folder/message"

echo "-- C++, by pkg-config and by CMake"
# shellcheck disable=SC2046
"$cxx" -o "$folder/consumer" "$root/lcm/tests/packaging/lcm_consumer.cpp" \
    $(pkg-config --cflags --libs roburoc4-lcm)
"$folder/consumer" | cmp "$folder/message"
mkdir "$folder/project"
cp "$root"/lcm/tests/packaging/lcm_consumer.* "$folder/project"
cat >"$folder/project/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.20)
project(consumer C CXX)
find_package(roburoc4 REQUIRED COMPONENTS lcm_types)
add_executable(c_consumer lcm_consumer.c)
add_executable(cpp_consumer lcm_consumer.cpp)
target_link_libraries(c_consumer PRIVATE roburoc4::lcm_types)
target_link_libraries(cpp_consumer PRIVATE roburoc4::lcm_types)
END
"$cmake" -S "$folder/project" -B "$folder/project/build" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" >>"$folder/log"
"$cmake" --build "$folder/project/build" >>"$folder/log" || { cat "$folder/log" && exit 1; }
"$folder/project/build/c_consumer" | cmp "$folder/message"
"$folder/project/build/cpp_consumer" | cmp "$folder/message"

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
