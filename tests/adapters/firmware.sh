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

for file in board.h main.c; do
    awk -v want=$file -f "$root/scripts/pages.awk" "$root/docs/firmware.md" >"$folder/$file"
done
sh "$root/scripts/amalgamate" "$folder"
cp "$root/tests/adapters/firmware_board.c" "$folder"
"$cc" -std=c99 -Wall -Wextra -Werror -O1 -I"$folder" -I"$root/include" "$folder/main.c" \
    "$folder/firmware_board.c" "$folder/roburoc4.c" "$@" -lm -o "$folder/firmware"
"$folder/firmware"
