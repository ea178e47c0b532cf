#!/bin/sh
# SPDX-License-Identifier: MIT
#
# symbols.sh CC ROOT LIBRARY NAME MACRO HEADER...: what the shared LIBRARY exports, the committed
# list cmake/symbols/NAME.txt, and the functions that its headers declare with MACRO are the same.
set -eu
LC_ALL=C
export LC_ALL
cc=$1
root=$2
library=$3
name=$4
macro=$5
shift 5

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# The names of the functions that a header declares itself, without those of what it includes.
declared() {
    sed 's/^#include "roburoc4.*//' "$root/include/$1" |
        "$cc" -E -P -D"$macro"=DECLARED -x c - |
        tr '\n' ' ' | tr ';' '\n' |
        sed -n 's/.*DECLARED [^(]*\(roburoc4_[a-z0-9_]*\)(.*/\1/p'
}

for header in "$@"; do
    declared "$header"
done | sort >"$folder/declared"
nm -D --defined-only "$library" | awk '$2 == "T" { sub(/@.*/, "", $3); print $3 }' |
    sort >"$folder/exported"
nm -D --defined-only "$library" | awk '$2 != "T" && $2 != "A"' >"$folder/others"

sed -e '/^#/d' -e 's/ .*//' "$root/cmake/symbols/$name.txt" >"$folder/listed"
status=0
diff -u "$folder/listed" "$folder/exported" || {
    echo "the list and what $name exports differ: a change of the ABI, to be made on purpose"
    status=1
}
diff -u "$folder/declared" "$folder/exported" || {
    echo "the headers and what $name exports differ"
    status=1
}
if [ -s "$folder/others" ] || [ ! -s "$folder/exported" ]; then
    cat "$folder/others"
    echo "$name exports data, or nothing at all"
    status=1
fi
echo "$(wc -l <"$folder/exported") functions"
exit $status
