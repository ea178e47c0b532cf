#!/bin/sh
# SPDX-License-Identifier: MIT
#
# packaging.sh CMAKE CC ROOT STATIC SHARED: what is installed from these two builds can be used: by
# a CMake project, by pkg-config, after the tree was moved, and with both of them in one place.
set -eu
cmake=$1
cc=$2
root=$3
static=$4
shared=$5
modules="roburoc4 roburoc4-udp roburoc4-sim"

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# install_from BUILD...: sets $prefix and the environment of pkg-config and of programs.
install_from() {
    rm -rf "$folder/first" "$folder/moved"
    for build in "$@"; do
        "$cmake" --install "$build" --config "$CONFIG" --prefix "$folder/first" >"$folder/log"
    done
    mv "$folder/first" "$folder/moved"
    prefix=$folder/moved
    PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name roburoc4.pc)")
    LD_LIBRARY_PATH=$(dirname "$PKG_CONFIG_PATH")
    export PKG_CONFIG_PATH LD_LIBRARY_PATH
}

use_by_cmake() {
    rm -rf "$folder/consumer"
    "$cmake" -S "$root/tests/adapters/packaging" -B "$folder/consumer" \
        -DCMAKE_C_COMPILER="$cc" -DCMAKE_PREFIX_PATH="$prefix" \
        -DVERSION="$(pkg-config --modversion roburoc4)" >>"$folder/log"
    "$cmake" --build "$folder/consumer" >>"$folder/log"
    "$folder/consumer/consumer"
}

# use_by_pkg_config [FLAG...]
use_by_pkg_config() {
    # What pkg-config prints is a list of words.
    # shellcheck disable=SC2046,SC2086
    "$cc" -std=c99 -o "$folder/program" "$root/tests/adapters/packaging/consumer.c" "$@" \
        $(pkg-config --cflags --libs $modules)
    "$folder/program"
}

for build in "$static" "$shared"; do
    install_from "$build"
    echo "-- find_package"
    use_by_cmake
    echo "-- pkg-config"
    use_by_pkg_config
    echo "-- the program, its page and the dissector"
    "$prefix/bin/roburoc4-sim" --version
    for file in share/man/man1/roburoc4-sim.1 share/doc/roburoc4/LICENSE; do
        test -s "$prefix/$file"
    done
    test -s "$LD_LIBRARY_PATH/wireshark/plugins/roburoc4.lua"
done
echo "-- both, as a distribution has them"
install_from "$shared" "$static"
use_by_cmake
use_by_pkg_config
use_by_pkg_config -static
# shellcheck disable=SC2086
pkg-config --modversion $modules
