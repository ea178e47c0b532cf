#!/bin/sh
# SPDX-License-Identifier: MIT
#
# core_symbols.sh CC NM ROOT FILE... [-- FLAG...]: the core's files, compiled with FLAGs, need
# nothing but each other, memcpy, memset, memcmp, memmove and the compiler's own arithmetic, and
# have no variable that can be written: no heap, no input or output, no state outside a client.
set -eu
cc=$1
nm=$2
root=$3
shift 3

files=
while [ $# -gt 0 ] && [ "$1" != -- ]; do
    case $1 in
    *.c) files="$files $1" ;;
    esac
    shift
done
if [ $# -gt 0 ]; then
    shift
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# Files of the project have no spaces in their names.
# shellcheck disable=SC2086
for file in $files; do
    # Position-independent code would move constant tables of pointers into writable sections.
    "$cc" -std=c99 "$@" -fno-pic -fno-stack-protector -U_FORTIFY_SOURCE -I"$root/include" \
        -c "$root/$file" -o "$folder/$(basename "$file" .c).o"
done

"$nm" -A -P "$folder"/*.o | awk -v what="$cc $*" '
    { file = $1; sub(/.*\//, "", file); sub(/:$/, "", file) }
    $3 ~ /^[Uwv]$/ { wanted[$2] = wanted[$2] " " file; next }
    $3 ~ /^[BbCDdGgSsVu]$/ { print "writable variable " $2 " in " file; bad = 1 }
    { given[$2] = 1 }
    END {
        for (name in wanted) {
            # bcmp is what clang makes of memcmp(...) == 0 where the system has it.
            if (name in given || name ~ /^(mem(cpy|set|cmp|move)|bcmp)$/ ||
                name ~ /^__aeabi_[a-z0-9_]+$/ || name ~ /^__gnu_thumb1_case_[a-z0-9]+$/ ||
                name ~ /^__(u?(div|mod)|mul|ash[lr]|lshr|u?cmp|neg|clz|ctz)[sd]i[234]$/ ||
                name ~ /^__(add|sub|mul|div|eq|ne|lt|le|gt|ge|unord|neg)[sd]f[23]$/ ||
                name ~ /^__(fix(uns)?[sd]f[sd]i|float(un)?[sd]i[sd]f)$/)
                continue
            print "asks for " name " in" wanted[name]
            bad = 1
        }
        if (!bad)
            print what ": the core asks for nothing of the system and keeps no variables"
        exit bad
    }'
