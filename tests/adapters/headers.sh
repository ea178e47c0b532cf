#!/bin/sh
# SPDX-License-Identifier: MIT
#
# headers.sh CC ROOT: each public header compiles alone, without a warning, in every version of
# C from C99 and of C++ from C++98.
set -eu
cc=$1
root=$2

for header in "$root"/include/*.h; do
    for standard in c99 c11 c17; do
        "$cc" -std=$standard -Wall -Wextra -Wpedantic -Werror -fsyntax-only -x c "$header"
    done
    for standard in c++98 c++11 c++14 c++17 c++20; do
        "$cc" -std=$standard -Wall -Wextra -Wpedantic -Werror -fsyntax-only -x c++ "$header"
    done
    echo "$(basename "$header") compiles alone"
done
