#!/bin/sh
# SPDX-License-Identifier: MIT
#
# newer.sh CC ROOT SHARED NEWER: make libraries in NEWER in which each kind of change was made that
# docs/ABI.md allows, and run a program with them that was compiled for those in SHARED.
#
# awk's programs contain dollar signs:
# shellcheck disable=SC2016
set -eu
cc=$1
root=$2
shared=$3
newer=$4

rm -rf "$newer"
mkdir -p "$newer/lib" "$newer/recordings"
cp -R "$root/include" "$root/src" "$root/sim" "$newer/"
cp "$root/tests/abi/newer.c" "$newer/src/"

fail() {
    echo "$1"
    exit 1
}

# change FILE PROGRAM: by awk; it has to find what it changes, as often as it counts `left` down.
change() {
    awk "$2"' { print } END { exit left != 0 }' "$newer/$1" >"$newer/changed" ||
        fail "newer.sh no longer finds what it changes in $1: correct the pattern"
    mv "$newer/changed" "$newer/$1"
}

# A later version, with a new function and a new counter.
change include/roburoc4.h 'BEGIN { left = 3 }
    /^#define ROBUROC4_VERSION_MINOR / { $3++; left-- }
    /^#define ROBUROC4_COUNTERS / { print "#define ROBUROC4_COUNT_NEW " $3; $3++; left-- }
    /^typedef struct roburoc4_client roburoc4_client;/ {
        $0 = $0 "\nROBUROC4_API uint32_t roburoc4_client_new(const roburoc4_client *client);"; left--
    }'
# A field at the end of each struct that begins with its size.
structs=0
for header in roburoc4 roburoc4_move roburoc4_record roburoc4_sim; do
    count=$(grep -c '^    uint32_t size;' "$newer/include/$header.h")
    change "include/$header.h" "BEGIN { left = $count }"'
        /^    uint32_t size;/ { sized = 1 }
        /^}/ && sized { print "    uint32_t new_field;"; sized = 0; left-- }'
    structs=$((structs + count))
done
all=$(cat "$root"/include/*.h | grep -c '^    uint32_t size;')
[ "$structs" -eq "$all" ] ||
    fail "$structs of $all structs that begin with their size were changed: name all headers above"
# What a program passes may end before the new field; the library has to see the default.
inputs=0
for file in src/config.c src/move.c src/record.c sim/config.c sim/network.c; do
    count=$(grep -c 'memcpy(.*->size);' "$newer/$file" || true)
    change "$file" "BEGIN { left = $count }"'
        /^#include/ && !included { print "#include <assert.h>"; included = 1 }
        /memcpy\(.*->size\);/ {
            split($0, part, /memcpy\(|, /)
            field = sub(/^&/, "", part[2]) ? ".new_field" : "->new_field"
            $0 = $0 "\nassert(" part[2] field " == 0 && \"read beyond an older struct\");"; left--
        }'
    inputs=$((inputs + count))
done
[ "$inputs" -eq 6 ] || fail "only $inputs structs are copied by their size: correct the pattern"
# A client and a move hold such structs: they take the space from their reserves, in another order.
change include/roburoc4.h 'BEGIN { left = 3 }
    /^    uint32_t private_counters\[/ { left--; next }
    /^    uint32_t private_reserved\[[0-9]+\];/ {
        split($0, part, /[][]/)
        left--
        if (part[2] == 2)
            next
        $0 = "    uint32_t private_reserved[" part[2] - 2 "];"
    }
    /^    roburoc4_config private_config;/ {
        $0 = $0 "\n    uint32_t private_counters[ROBUROC4_COUNTERS];"; left--
    }'
change include/roburoc4_move.h 'BEGIN { left = 3 }
    /^    roburoc4_move_options private_options;/ { left--; next }
    /^    uint32_t private_timeout_ms, private_duration_ms, private_relocalized;/ {
        $0 = "    uint32_t private_relocalized;"
        left--
    }
    /^    uint32_t private_spare\[5\];/ {
        $0 = "    uint32_t private_spare[4], private_timeout_ms, private_duration_ms;"
        $0 = $0 "\n    roburoc4_move_options private_options;"
        left--
    }'
# States of the socket, and a counter of them.
change include/roburoc4_udp.h 'BEGIN { left = 3 }
    /^    uint32_t private_spare\[6\];/ { $0 = "    uint32_t private_newer, private_spare[5];"; left-- }
    /^#define ROBUROC4_UDP_COUNTERS / { print "#define ROBUROC4_UDP_COUNT_NEW " $3; $3++; left-- }
    /^    uint8_t private_connected, private_broken, private_reserved\[2\];/ {
        $0 = "    uint8_t private_new, private_reserved, private_broken, private_connected;"; left--
    }'
change src/udp.c 'BEGIN { left = 1 }
    /^    udp->counters\[counter\]\+\+;/ {
        print "    udp->private_new = 1;\n    udp->private_newer++;"
        print "    udp->counters[ROBUROC4_UDP_COUNT_NEW]++;"; left--
    }'
# A state of a reader, which a program may have set to 0 itself.
change include/roburoc4_pump.h 'BEGIN { left = 1 }
    /^    uint64_t private_spare\[2\];/ { $0 = "    uint64_t private_spare, private_new;"; left-- }'
change src/pump_store.c 'BEGIN { left = 2 }
    /^    reader->private_next_event = / { print "    reader->private_new++;"; left-- }'
# What checks offsets inside of a client does so for one version of the library.
change src/lifecycle.c 'BEGIN { left = 1 }
    /^LAYOUT\(client, / { left-- }
    /^LAYOUT\((config|client_)/ { next }'

abi=$(sed -n 's/^#define ROBUROC4_ABI_VERSION //p' "$newer/include/roburoc4.h")
sed "s/@ROBUROC4_ABI_VERSION@/$abi/" "$root/cmake/roburoc4.map.in" >"$newer/map"

# library NAME FILE...: with the flags in $flags and the libraries in $uses.
public='__attribute__((visibility("default")))'
library() {
    name=$1
    shift
    # Flags and files are lists of words.
    # shellcheck disable=SC2086
    "$cc" -std=c99 -O1 -fPIC -shared -fvisibility=hidden "-DROBUROC4_API=$public" \
        "-DROBUROC4_SIM_API=$public" $flags -Iinclude "$@" -o "lib/lib$name.so.$abi" \
        "-Wl,-soname,lib$name.so.$abi,--version-script=map" $uses
    ln -s "lib$name.so.$abi" "lib/lib$name.so"
}
cd "$newer"
flags=
for function in client_arm client_state client_take_events refusal_may_pass; do
    flags="$flags -Droburoc4_$function=inner_$function"
done
uses='inner.o'
"$cc" -std=c99 -O1 -fPIC "-DROBUROC4_API=$public" -Iinclude -c src/newer.c -o inner.o
# shellcheck disable=SC2046
library roburoc4 $(cat "$root/cmake/core_sources.txt" "$root/cmake/move_sources.txt") src/robot_file.c
flags=
uses='-Llib -lroburoc4 -pthread'
library roburoc4_udp src/pump.c src/pump_store.c src/record.c src/udp.c src/os_posix.c
uses='-Llib -lroburoc4 -lm'
# shellcheck disable=SC2046
library roburoc4_sim $(cat "$root/cmake/sim_sources.txt")

"$cc" -std=c99 -Wall -Wextra -Werror -I"$root/include" "$root/tests/abi/program.c" -o program \
    -L"$shared" -lroburoc4_sim -lroburoc4_udp -lroburoc4
LD_LIBRARY_PATH=$shared ./program recordings >same
LD_LIBRARY_PATH=$newer/lib ./program recordings >other
cat same other
! cmp -s same other || fail "that was the same library"
# Only the core is newer.
mkdir mixed
cp "lib/libroburoc4.so.$abi" mixed/
LD_LIBRARY_PATH=$newer/mixed:$shared ./program recordings
# A newer program uses what is new.
"$cc" -std=c99 -DNEWER -Wall -Wextra -Werror -Iinclude "$root/tests/abi/program.c" -o newer_program \
    -Llib -lroburoc4_sim -lroburoc4_udp -lroburoc4
LD_LIBRARY_PATH=$newer/lib ./newer_program recordings
