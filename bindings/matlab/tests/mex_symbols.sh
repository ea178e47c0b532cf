#!/bin/sh
# SPDX-License-Identifier: MIT
#
# mex_symbols.sh MEX LIST: the MEX file asks MATLAB for what is in LIST only, functions that are
# documented for both of its APIs; it shows mexFunction only; and it needs no C++ library.
set -eu
LC_ALL=C
export LC_ALL

fail() {
    echo "$*" >&2
    exit 1
}

asked=$(nm -D --undefined-only "$1" | awk '{ print $2 }' | sed 's/@.*//' | grep -E '^mx|^mex' | sort -u)
[ -n "$asked" ] || fail "$1 asks MATLAB for nothing: is it a MEX file?"
for symbol in $asked; do
    grep -qx "$symbol" "$2" || fail "$symbol is not in $2: use a documented function of both APIs"
done
grep -v '^#' "$2" | while read -r symbol; do
    echo "$asked" | grep -qx "$symbol" || fail "$symbol is in $2, but is not used: take it out"
done
shown=$(nm -D --defined-only "$1" | awk '{ print $3 }' | grep -vE '^(_init|_fini|__bss_start|_edata|_end)$' | sort)
[ "$shown" = mexFunction ] || fail "$1 shows more than mexFunction: $shown"
needed=$(objdump -p "$1" | awk '/NEEDED/ { print $2 }')
echo "$needed"
case $needed in
*stdc++* | *libgcc_s*) fail "$1 needs a C++ library" ;;
esac
echo "$(echo "$asked" | wc -l) functions of the C Matrix API, all documented"
