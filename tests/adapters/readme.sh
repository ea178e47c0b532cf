#!/bin/sh
# SPDX-License-Identifier: MIT
#
# readme.sh CASE ROOT BUILD [ARGUMENT...]: the C program of README.md, compiled as it says there, against
# the simulator as real processes. CASE is what happens: drives, interrupted; or installed: the
# example of docs/c.md is built as it says there from what is installed; or pump: the example at the top of
# roburoc4_pump.h drives; or newer: compiled with shared libraries, it runs with later ones.
set -eu
case_name=$1
root=$2
build=$3
older_libraries=${4:-}
newer_libraries=${5:-}
cmake=${4:-}
# shellcheck source=tests/adapters/simulator.sh
. "$(dirname "$0")/simulator.sh"

# block NAME PAGE: the file of that name, or the first block of code in that language.
block() {
    awk -v want="$1" -f "$root/scripts/pages.awk" "$2"
}

# As in a checkout: build/drive.
compile() {
    mkdir examples
    ln -s "$root/include" include
    mkdir build
    for library in roburoc4_udp roburoc4; do
        ln -s "$build/lib$library.a" build/
    done
    block c "$root/README.md" >examples/drive.c
    sed '1,/^ \*\/$/d' "$root/examples/drive.c" | cmp - examples/drive.c
    line=$(grep '^cc -Iinclude ' "$root/README.md")
    eval "$line -std=c99 -Wall -Wextra -Werror"
}

stands_after_a_drive() {
    state | tee state
    grep -q 'target 0.000 m/s 0.000 rad/s' state
    grep -q 'odometry 0\.[4-7]' state
}

case $case_name in
drives)
    compile
    start "$build/bin/roburoc4-sim"
    drive 0 build/drive "$robot"
    stands_after_a_drive
    ;;
interrupted)
    compile
    start "$build/bin/roburoc4-sim"
    drive_off env --default-signal build/drive "$robot"
    kill -INT "$driver"
    end_of_drive 1
    grep -q 'cancelled' said
    state | grep -q 'target 0.000 m/s 0.000 rad/s'
    ;;
pump)
    # The example at the top of roburoc4_pump.h, in a program that wants it to drive for 2 s.
    {
        cat <<'END'
#define _POSIX_C_SOURCE 200809L
#include <roburoc4_pump.h>
#include <stdio.h>
#include <time.h>

static int wanted(void) {
    static int times;
    return times++ < 20;
}

static void work_for_less_than_250_ms(void) {
    const struct timespec pause = {0, 100000000};
    nanosleep(&pause, NULL);
}

int main(int argc, char **argv) {
    roburoc4_address address;
    roburoc4_result result = roburoc4_udp_resolve(argv[argc - 1], 0, &address);
END
        sed -n '1,/WHAT IT PROMISES/s/^ \*     //p' "$root/include/roburoc4_pump.h"
        echo '    fputs(roburoc4_result_text(result), stderr);'
        echo '    return result < 0; }'
    } >pump.c
    cat pump.c
    cc -I"$root/include" pump.c "$build/libroburoc4_udp.a" "$build/libroburoc4.a" -pthread -o pump \
        -std=c99 -Wall -Wextra -Werror
    start "$build/bin/roburoc4-sim"
    drive 0 ./pump "$robot"
    state | tee state
    grep -q 'target 0.000 m/s 0.000 rad/s' state
    grep -q 'odometry [0-9]*\.[0-9]*[1-9]' state
    ;;
newer)
    cc -std=c99 -I"$root/include" "$root/examples/drive.c" -o drive -L"$older_libraries" \
        -lroburoc4_udp -lroburoc4
    LD_LIBRARY_PATH=$newer_libraries
    export LD_LIBRARY_PATH
    ldd drive | grep -F "$newer_libraries"
    start "$build/bin/roburoc4-sim"
    drive 0 ./drive "$robot"
    stands_after_a_drive
    ;;
installed)
    "$cmake" --install "$build" --config "$CONFIG" --prefix "$attempt/installed" >install.log
    mkdir project
    cp "$root/examples/drive_loop.c" project
    block CMakeLists.txt "$root/docs/c.md" >project/CMakeLists.txt
    "$cmake" -S project -B project/build "-DCMAKE_PREFIX_PATH=$attempt/installed" >cmake.log
    "$cmake" --build project/build >>cmake.log
    PKG_CONFIG_PATH=$(dirname "$(find "$attempt/installed" -name roburoc4-udp.pc)")
    LD_LIBRARY_PATH=$(dirname "$PKG_CONFIG_PATH")
    export PKG_CONFIG_PATH LD_LIBRARY_PATH
    line=$(grep '^cc drive_loop.c ' "$root/docs/c.md")
    (cd project && eval "$line -std=c99 -Wall -Wextra -Werror")
    start "$build/bin/roburoc4-sim"
    drive 0 project/build/first "$robot"
    state | tee state
    grep -q 'target 0.000 m/s 0.000 rad/s' state
    grep -qE 'odometry (0\.9[89]|1\.0[01])' state
    drive 0 project/drive_loop "$robot"
    ;;
*)
    echo "no such case: $case_name"
    exit 1
    ;;
esac
