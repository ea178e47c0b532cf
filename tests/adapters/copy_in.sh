#!/bin/sh
# SPDX-License-Identifier: MIT
#
# copy_in.sh CC ROOT FILE...: the core's files, copied flat into somebody's project beside
# roburoc4.h, compile with nothing but a C99 compiler, and a program links with them.
set -eu
cc=$1
root=$2
shift 2

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp "$root/include/roburoc4.h" "$root/include/roburoc4_codec.h" "$folder"
for file in "$@"; do
    cp "$root/$file" "$folder"
done
cd "$folder"
cat >main.c <<'END'
#include "roburoc4.h"
int main(void) {
    static roburoc4_client client;
    return roburoc4_client_init(&client, sizeof client, NULL);
}
END
"$cc" -std=c99 -c ./*.c
"$cc" -o program ./*.o
./program
echo "copied $# files: compiled, linked, ran"
