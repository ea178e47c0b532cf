#!/bin/sh
# SPDX-License-Identifier: MIT
#
# firmware.sh CC ROOT SIM-LIBRARY...: the files printed in docs/firmware.md compile with the two files
# of scripts/amalgamate, and drive and stop the simulated robot.
set -eu
cc=$1
root=$2
shift 2

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# block NAME: the file that begins with a comment of this name.
block() {
    awk -v first="/* $1 */" '
        /^```/ { inside = 0 }
        $0 == first { inside = 1; found = 1 }
        inside
        END { exit !found }
    ' "$root/docs/firmware.md" >"$folder/$1"
}

block board.h
block main.c
sh "$root/scripts/amalgamate" "$folder"
cp "$root/tests/adapters/firmware_board.c" "$folder"
"$cc" -std=c99 -Wall -Wextra -Werror -O1 -I"$folder" -I"$root/include" "$folder/main.c" \
    "$folder/firmware_board.c" "$folder/roburoc4.c" "$@" -lm -o "$folder/firmware"
"$folder/firmware"
