#!/bin/sh
# SPDX-License-Identifier: MIT
#
# installed.sh CMAKE BUILD FOLDER OCTAVE: what `cmake --install` puts into FOLDER of a prefix is a
# package that works without the build.
set -eu

prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
"$1" --install "$2" --component matlab --prefix "$prefix"
cd "$prefix"
"$4" --quiet --no-gui --no-init-file --no-history --eval "
    addpath('$prefix/$3', '$prefix/$3/examples');
    sim = roburoc4.Simulator(); r = sim.connect(); r.arm(); r.move(0.5);
    assert(abs(sim.state.true_x_m - 0.5) < 0.02);
    assert(strncmp(which('roburoc4_mex'), '$prefix', $(printf %s "$prefix" | wc -c)));
    assert(exist('drive_square') == 2);
    delete(r); delete(sim);"
[ ! -e "$prefix/$3/tests" ]
