# shellcheck shell=sh
# SPDX-License-Identifier: MIT
#
# Shared by client-cost and flood-cost: counts the instructions of a program of this folder.
. scripts/lib.sh

for tool in gcc valgrind; do
    if ! have "$tool"; then
        echo "$(basename "$0"): $tool is missing; as root: apt-get install $tool" >&2
        exit 3
    fi
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# compile_with DIR FILE: FILE with core, simulator and UDP adapter of DIR.
compile_with() {
    sources=
    for source in $(core_sources) $(sim_sources) src/robot_file.c src/udp.c src/record.c src/os_posix.c; do
        sources="$sources $1/$source"
    done
    # shellcheck disable=SC2086 # a list of files
    gcc -std=gnu99 -O2 -g "-I$1/include" "-I$1/src" -o "$folder/program" "$2" $sources -pthread -lm
}

# count_all KIND FUNCTION COUNT: of all calls of the function, the client's start included.
count_all() {
    valgrind --tool=callgrind --callgrind-out-file="$folder/out" --collect-atstart=no \
        --toggle-collect="$2" "$folder/program" "$1" "$3" >"$folder/printed" 2>"$folder/log" || {
        cat "$folder/log" >&2
        fail "$1 could not be measured"
    }
    sed -n 's/^\(summary\|totals\): \([0-9]*\).*/\2/p' "$folder/out" | head -n 1
}

# instructions KIND FUNCTION FEW MANY: of one call. What the program printed is in $folder/printed.
instructions() {
    few=$(count_all "$1" "$2" "$3")
    many=$(count_all "$1" "$2" "$4")
    echo $(((many - few) / ($4 - $3)))
}
