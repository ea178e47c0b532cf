# shellcheck shell=sh
# SPDX-License-Identifier: MIT
#
# Shared by the scripts: installing packages, configuring build folders of any generator, and
# running stages.
#
# Lists of packages are split into words; apt-get's formats contain dollar signs:
# shellcheck disable=SC2016,SC2086

LC_ALL=C
export LC_ALL

say() {
    printf '%s\n' "$*"
}

fail() {
    printf '%s: %s\n' "$(basename "$0")" "$*" >&2
    exit 1
}

have() {
    command -v "$1" >/dev/null 2>&1
}

jobs() {
    getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2
}

# only_help ARGUMENT...: for scripts whose only option is --help; they define help().
only_help() {
    case ${1:-} in
    -h | --help)
        help
        exit 0
        ;;
    ?*)
        echo "$(basename "$0"): cannot use '$1'; see scripts/$(basename "$0") --help" >&2
        exit 2
        ;;
    esac
}

# ------------------------------------------------------------------------------- packages

missing=

# need PACKAGE COMMAND...: note PACKAGE as missing if COMMAND fails.
need() {
    need_package=$1
    shift
    case " $missing " in
    *" $need_package "*) return 0 ;;
    esac
    "$@" >/dev/null 2>&1 || missing="$missing $need_package"
}

c_compiles() {
    printf '#include <stdio.h>\nint main(void) { return 0; }\n' | "$1" -x c -c -o /dev/null -
}

cxx_includes() {
    printf '#include <%s>\n' "$2" | "$1" -x c++ -E -o /dev/null -
}

sanitizes() {
    printf 'int main(void) { return 0; }\n' | "$1" -fsanitize=address -x c -o /dev/null -
}

# Needed by several scripts.
need_build() {
    need cmake have cmake
    need ninja-build have ninja
    need gcc have gcc
    need libc6-dev c_compiles gcc
}

need_tests() {
    need g++ have g++
    need libgtest-dev cxx_includes g++ gtest/gtest.h
    need pkg-config have pkg-config
}

need_lcm() {
    need liblcm-bin have lcm-gen
    need liblcm-dev cxx_includes g++ lcm/lcm.h
    need libglib2.0-dev test -d /usr/include/glib-2.0
}

need_octave() {
    need octave have octave-cli
    need octave-dev have mkoctfile
    # Octave needs it to draw pictures without a display.
    need gnuplot-nox have gnuplot
    need ghostscript have gs
    need fonts-freefont-otf test -e /usr/share/fonts/opentype/freefont/FreeSans.otf
}

need_python() {
    need python3 have "${PYTHON:-python3}"
    need python3-venv "${PYTHON:-python3}" -c 'import venv, ensurepip'
}

# Needed by pip to build bindings/python.
need_python_build() {
    need gcc have gcc
    need libc6-dev c_compiles gcc
    need_python
    need python3-dev "${PYTHON:-python3}" -c \
        'import os, sysconfig; os.stat(sysconfig.get_config_h_filename())'
}

need_python_tests() {
    need_python_build
    # lcm-gen of pip's LCM links it.
    need libglib2.0-0 "${PYTHON:-python3}" -c 'import ctypes; ctypes.CDLL("libglib-2.0.so.0")'
    need binutils have readelf
}

# Install what need() found missing, after printing how much it is; or print what to install, and fail.
install_missing() {
    [ -n "$missing" ] || return 0
    have apt-get || fail "missing here (by their Debian names):$missing"
    install="apt-get install --no-install-recommends$missing"
    as_root=
    if [ "$(id -u)" -ne 0 ]; then
        have sudo || fail "packages are missing; as root (apt-get update first, if that fails):
$install"
        as_root=sudo
    fi
    mkdir -p build
    say "installing:$missing"
    $as_root apt-get update >build/packages.log 2>&1 </dev/null || :
    $as_root $install --assume-no 2>/dev/null </dev/null | sed -n 's/^Need to get \(.*\) of archives.*/downloading \1/p'
    if ! $as_root env DEBIAN_FRONTEND=noninteractive $install -y >>build/packages.log 2>&1 </dev/null; then
        tail -n 20 build/packages.log >&2
        fail "could not install these packages (all of it: build/packages.log)"
    fi
    missing=
}

# debian_source FOLDER PACKAGE: unpack a Debian package's upstream source in FOLDER. The lists of sources
# are fetched into it, as the system's seldom include them; nothing is installed.
debian_source() {
    have apt-get || fail "needs apt-get to download Debian's source of $2"
    source_folder=$(mkdir -p "$1" && cd "$1" && pwd)
    mkdir -p "$source_folder/parts" "$source_folder/lists/partial" "$source_folder/cache/archives/partial"
    for origin in Debian Ubuntu; do
        apt-get indextargets --format 'deb-src $(REPO_URI) $(RELEASE) $(COMPONENT)' "Origin: $origin"
    done | sort -u >"$source_folder/parts/sources.list"
    [ -s "$source_folder/parts/sources.list" ] || fail "apt-get has no lists of packages: run apt-get update first"
    source_apt update
    (cd "$source_folder" && source_apt source --download-only "$2")
    for archive in "$source_folder/$2"_*.orig.tar.*; do
        tar -xf "$archive" -C "$source_folder"
    done
}

source_apt() {
    apt-get -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$source_folder/parts" \
        -o "Dir::State::lists=$source_folder/lists" -o "Dir::Cache=$source_folder/cache" \
        -o APT::Sandbox::User= "$@"
}

# ---------------------------------------------------------------------- tests and builds

# The time limit of a test: one that hangs fails, and the log shows where.
longest_test_s=1800

# heeding COMMAND...: run it with signals enabled that nohup and a shell's & leave ignored, because
# tests send them to their processes.
heeding() {
    if env --default-signal true 2>/dev/null; then
        env --default-signal "$@"
    else
        "$@"
    fi
}

# Tests draw from the seed in ROBUROC4_SEED. Unless it is set, it is a number of what HEAD contains: each
# change draws anew, and a commit that passed passes again.
set_seed() {
    if [ -z "${ROBUROC4_SEED:-}" ] && content=$(git rev-parse 'HEAD^{tree}' 2>/dev/null); then
        ROBUROC4_SEED=$((0x$(printf %.8s "$content")))
        export ROBUROC4_SEED
    fi
    echo "seed ${ROBUROC4_SEED:-of each test is in its output}"
}

# run_ctest DIR [ARGUMENT...]: more tests than cores, as some only wait. A test begins again only where
# it has measured that the machine stalled.
run_ctest() {
    tree=$1
    shift
    set_seed
    ctest --test-dir "$tree" -C RelWithDebInfo --parallel $(($(jobs) + 2)) --timeout "$longest_test_s" \
        --output-on-failure --no-tests=error "$@"
    grep '^not judged: ' "$tree/Testing/Temporary/LastTest.log" || :
    ctest_again=$(grep -c '^begins again:' "$tree/Testing/Temporary/LastTest.log") || return 0
    echo "$ctest_again tests began again because this machine stalled"
}

# run_pytest PYTHON ARGUMENT...; a thread watches the time limit, as tests use signals themselves.
# A test that failed is run again, and listed, only where bindings/python/tests/strain.py measured a stall;
# after the third long one it counts as not judged.
# With $CI, pytest's summary has each failure's whole message.
run_pytest() {
    pytest_python=$1
    shift
    heeding env CI=true "$pytest_python" -m pytest -q -p no:cacheprovider \
        --timeout "$longest_test_s" --timeout-method thread --reruns 2 --reruns-delay 2 \
        --only-rerun MachineTooBusyError "$@"
}

# pinned_venv DIR REQUIREMENTS: a virtual environment with these, recreated if they changed.
pinned_venv() {
    if ! cmp -s "$2" "$1/requirements.txt"; then
        rm -rf "$1"
        "${PYTHON:-python3}" -m venv "$1"
        "$1/bin/pip" install -q --disable-pip-version-check -r "$2"
        cp "$2" "$1/requirements.txt"
    fi
}

# The files of the core, and of the simulator's library.
core_sources() {
    cat cmake/core_sources.txt
}

sim_sources() {
    cat cmake/sim_sources.txt
}

# The value of a variable in a build folder's cache.
cached() {
    sed -n "s/^$2:[A-Z]*=//p" "$1/CMakeCache.txt" 2>/dev/null
}

# Whether a build folder can be reused: made from this checkout, with tools that still exist.
usable_tree() {
    [ "$(cached "$1" CMAKE_HOME_DIRECTORY)" = "$(pwd -P)" ] || return 1
    for tree_tool in CMAKE_COMMAND CMAKE_MAKE_PROGRAM CMAKE_C_COMPILER; do
        have "$(cached "$1" "$tree_tool")" || return 1
    done
}

# configure DIR NEW-ARGUMENTS -- ARGUMENTS: configure a new DIR with all arguments, an existing one
# with its own generator and compiler and only the later arguments.
configure() {
    tree=$1
    shift
    if [ -f "$tree/CMakeCache.txt" ] && usable_tree "$tree"; then
        while [ "$1" != -- ]; do
            shift
        done
        shift
        cmake -S . -B "$tree" -G "$(cached "$tree" CMAKE_GENERATOR)" "$@"
        return
    fi
    rm -rf "$tree/CMakeCache.txt" "$tree/CMakeFiles"
    for argument in "$@"; do
        shift
        [ "$argument" = -- ] || set -- "$@" "$argument"
    done
    if [ -z "${CMAKE_GENERATOR:-}" ]; then
        if have ninja; then
            set -- -G Ninja "$@"
        else
            set -- -G 'Unix Makefiles' "$@"
        fi
    fi
    cmake -S . -B "$tree" "$@"
}

# compile DIR [TARGET...]
compile() {
    tree=$1
    shift
    if [ $# -gt 0 ]; then
        set -- --target "$@"
    fi
    $aside cmake --build "$tree" --config RelWithDebInfo --parallel "$(jobs)" "$@"
}

# build_preset NAME [TARGET...]: one of CMakePresets.json, in its folder build/NAME.
build_preset() {
    preset=$1
    shift
    configure "build/$preset" -- --preset "$preset"
    compile "build/$preset" "$@"
}

# logged LOG COMMAND...: run it with its output in LOG; its exit status is $logged_status.
logged() {
    logged_log=$1
    shift
    # Not in a condition, so that -e works inside.
    set +e
    (
        set -e
        "$@"
    ) >"$logged_log" 2>&1 </dev/null
    logged_status=$?
    set -e
}

# begin_beside SCRIPT [ARGUMENT...]: run it beside the stages that follow; its lines appear among theirs.
# It may run in real time, so they compute mostly what it leaves: $aside.
# end_beside: wait for it, and fail if it failed.
aside=
begin_beside() {
    aside='nice -n 2' # on a busy machine, more would leave it little
    beside_script="$*"
    # In a session of its own, so that all of it can be ended.
    ROBUROC4_BESIDE=yes env --default-signal setsid "$@" </dev/null &
    beside_pid=$!
    trap 'kill -- "-$beside_pid" 2>/dev/null || :' EXIT
    trap 'exit 130' INT
    trap 'exit 143' TERM HUP
}

end_beside() {
    wait "$beside_pid" || fail "$beside_script failed: see above"
    aside=
    trap - EXIT INT TERM HUP
}

# Whether the line of progress is ours: not that of a script beside another one.
on_terminal() {
    [ -t 1 ] && [ -z "${ROBUROC4_BESIDE:-}" ]
}

# progress NAME LOG: print how far a stage is: each second on a terminal, otherwise each minute.
progress() {
    progress_s=0
    while sleep 1 >/dev/null 2>&1 && kill -0 $$ 2>/dev/null; do
        progress_s=$((progress_s + 1))
        on_terminal || [ $((progress_s % 60)) -eq 0 ] || continue
        progress_step=$(tail -c 2000 "$2" 2>/dev/null | tr '\r' '\n' |
            grep -oE '[0-9]+/[0-9]+|[0-9]+%' | tail -n 1)
        if on_terminal; then
            printf '       %-18s %4d s  %-12s\r' "$1" "$progress_s" "$progress_step"
        else
            printf '       %-18s %4d s  %s\n' "$1" "$progress_s" "$progress_step"
        fi
    done
}

# stage NAME COMMAND...: run it with its output in build/logs/NAME.log; print one line with the
# result, the duration, and a summary (of ctest, or the last line). A failure ends the script.
stage() {
    stage_name=$1
    stage_log=build/logs/$stage_name.log
    stage_begun=$(date +%s)
    shift
    mkdir -p build/logs
    progress "$stage_name" "$stage_log" &
    stage_progress=$!
    logged "$stage_log" "$@"
    kill "$stage_progress" 2>/dev/null || :
    wait "$stage_progress" 2>/dev/null || :
    [ ! -t 1 ] || printf '%60s\r' ''
    stage_word=ok
    [ "$logged_status" -eq 0 ] || stage_word=FAILED
    printf '%-6s %-18s %4d s  %s\n' "$stage_word" "$stage_name" $(($(date +%s) - stage_begun)) \
        "$(stage_summary "$stage_log")"
    if [ "$logged_status" -ne 0 ]; then
        stage_failure "$stage_log"
        fail "$stage_name failed; all of its output is in $stage_log"
    fi
}

# What failed: pytest's summary; or else the end of the log, and the first failures in C++ with their seed.
stage_failure() {
    sed '1,/^=* short test summary info/d; /^SKIPPED /d' "$1" | head -n 60 | grep . && return
    grep -v -e ' Passed ' -e '^ *Start ' "$1" | tail -n 60
    grep -m 1 '^seed ' "$1" || :
    grep -E -A 5 ': Failure$|runtime error: |ERROR: [A-Z][a-z]*Sanitizer|^\[  FAILED  \].* ms\)$' "$1" | head -n 20 || :
}

stage_summary() {
    ctest_line "$1" | grep . || tail -n 1 "$1" | cut -c 1-120
    if stage_unjudged=$(grep -c 'not judged: ' "$1"); then
        echo "NOT JUDGED: $stage_unjudged, because this machine stalled"
    fi
    stage_again=$(grep -c '^RERUN ' "$1") || return 0
    echo "$stage_again tests of pytest began again because this machine stalled"
}

ctest_line() {
    grep 'tests passed' "$1" | tail -n 1
    grep 'tests began again' "$1" || :
}
