#!/bin/sh
# SPDX-License-Identifier: MIT
#
# packaging.sh CMAKE CC ROOT BUILD: what is installed from BUILD can be used: by a CMake project, by
# pkg-config with shared and with static libraries, and after the tree was moved.
set -eu
cmake=$1
cc=$2
root=$3
build=$4

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$cmake" --install "$build" --config RelWithDebInfo --prefix "$folder/first" >"$folder/log"
mv "$folder/first" "$folder/moved"
prefix=$folder/moved
libraries=$(dirname "$(find "$prefix" -name libroburoc4.a)")

echo "-- find_package"
"$cmake" -S "$root/tests/adapters/packaging" -B "$folder/consumer" -DCMAKE_C_COMPILER="$cc" \
    -DCMAKE_PREFIX_PATH="$prefix" >>"$folder/log"
"$cmake" --build "$folder/consumer" >>"$folder/log"
"$folder/consumer/with_shared"
"$folder/consumer/with_static"

PKG_CONFIG_PATH=$libraries/pkgconfig
LD_LIBRARY_PATH=$libraries
export PKG_CONFIG_PATH LD_LIBRARY_PATH
# pkg_config_build NAME FLAG...
pkg_config_build() {
    program=$folder/pkg_config_$1
    shift
    "$cc" -std=c99 -o "$program" "$root/tests/adapters/packaging/consumer.c" "$@"
    "$program"
}
modules="roburoc4 roburoc4-udp roburoc4-sim"
echo "-- pkg-config, shared"
# What pkg-config prints is a list of words.
# shellcheck disable=SC2046,SC2086
pkg_config_build shared $(pkg-config --cflags --libs $modules)
echo "-- pkg-config, static"
# shellcheck disable=SC2046,SC2086
pkg_config_build static -static $(pkg-config --static --cflags --libs $modules)
for module in $modules; do
    pkg-config --modversion "$module"
done

echo "-- the program and its page"
"$prefix/bin/roburoc4-sim" --version
for file in share/man/man1/roburoc4-sim.1 share/doc/roburoc4/LICENSE; do
    test -s "$prefix/$file"
done
