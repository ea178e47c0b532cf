#!/bin/sh
# SPDX-License-Identifier: MIT
#
# amalgamation.sh CC ROOT: the two files of scripts/amalgamate compile without a warning, alone,
# with the UDP adapter, and optimized together with a program (which warns of more), and the walk of
# tests/verify/portable passes on them.
set -eu
cc=$1
root=$2
portable=$root/tests/verify/portable

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
sh "$root/scripts/amalgamate" "$folder"
warnings='-std=c99 -Wall -Wextra -Wshadow -Werror -I'"$folder"
# The flags and the files are lists of words.
# shellcheck disable=SC2086
{
    "$cc" $warnings -O2 -c "$folder/roburoc4.c" -o "$folder/core.o"
    "$cc" $warnings -O2 -DROBUROC4_WITH_UDP -DROBUROC4_WITH_ROBOT_FILE -c "$folder/roburoc4.c" -o "$folder/udp.o"
    "$cc" $warnings -Os -flto "$portable/walk.c" "$portable/robot.c" "$portable/port_hosted.c" \
        "$folder/roburoc4.c" -o "$folder/walk"
}
"$folder/walk"
