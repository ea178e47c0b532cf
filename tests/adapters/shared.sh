#!/bin/sh
# SPDX-License-Identifier: MIT
#
# shared.sh CMAKE CC ROOT BUILD: shared libraries, and a program that uses them, are built in BUILD.
set -eu
"$1" -S "$3" -B "$4" -DCMAKE_C_COMPILER="$2" -DBUILD_SHARED_LIBS=ON -DROBUROC4_EXAMPLES=OFF \
    -DROBUROC4_WITH_LCM=OFF -DCMAKE_BUILD_TYPE="$CONFIG"
"$1" --build "$4" --config "$CONFIG"
"$4/bin/roburoc4-sim" --version
