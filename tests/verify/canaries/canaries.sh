# shellcheck shell=sh
# SPDX-License-Identifier: MIT
#
# Planted faults, sourced by scripts/verify: each kind of check is run on something that is broken,
# and must say so. One line each: name, planted fault, caught.
#
# The variables $work, $clang and $longest_input are of scripts/verify, $logged_status is of scripts/lib.sh.
# shellcheck disable=SC2154

canary_count=0

# canary NAME FAULT SIGN COMMAND...: COMMAND must fail and its output must show SIGN (a pattern),
# so that it failed for this fault and not because a tool was missing.
canary() {
    canary_name=$1
    canary_fault=$2
    canary_sign=$3
    shift 3
    canary_log=build/logs/canary-$canary_name.log
    logged "$canary_log" "$@"
    if [ "$logged_status" -ne 0 ] && grep -q -e "$canary_sign" "$canary_log"; then
        printf '%-14s %-66s caught\n' "$canary_name" "$canary_fault"
        canary_count=$((canary_count + 1))
        return 0
    fi
    printf '%-14s %-66s NOT CAUGHT\n' "$canary_name" "$canary_fault"
    tail -n 20 "$canary_log"
    fail "the check '$canary_name' did not find its planted fault; its output is in $canary_log"
}

# preset_finds NAME FAULT: a fault of tests/verify/canaries/faults.c, built by that preset as scripts/test
# does.
preset_finds() {
    configure "$work/canary-$1" -- --preset "$1"
    compile "$work/canary-$1" canary_faults
    "$work/canary-$1/bin/canary_faults" "$2"
}

msan_finds() {
    msan_tree
    compile "$work/msan" canary_faults
    "$work/msan/bin/canary_faults" memory
}

valgrind_finds() {
    # shellcheck disable=SC2086
    tree quick $quick
    compile "$work/quick" canary_faults
    $watched "$work/quick/bin/canary_faults" memory
}

tidy_finds() {
    clang-tidy-14 --quiet --warnings-as-errors='*' tests/verify/canaries/found.c -- -std=c99
}

# planted FILE SED: a copy of the core in build/verify/canary-core with one change.
planted() {
    canary_core=$work/canary-core
    rm -rf "$canary_core"
    mkdir -p "$canary_core"
    cp -R src sim include "$canary_core"
    sed "$2" "$1" >"$canary_core/$1"
    if cmp -s "$1" "$canary_core/$1"; then
        say "nothing was changed in $1: mend tests/verify/canaries/canaries.sh"
        exit 1
    fi
}

# with_planted OUT FLAGS OBJECT...: a program of these objects or sources and the changed core and
# simulator.
with_planted() {
    canary_out=$1
    canary_flags=$2
    shift 2
    rm -rf "$work/canary-objects" "$work/canary-corpus"
    mkdir "$work/canary-objects"
    for file in $(core_sources) $(sim_sources); do
        # shellcheck disable=SC2086
        "clang-$clang" -std=c99 -O1 -g $canary_flags "-I$canary_core/include" "-I$canary_core/src" \
            -c -o "$work/canary-objects/$(echo "$file" | tr / -).o" "$canary_core/$file"
    done
    # shellcheck disable=SC2086
    "clang++-$clang" -std=c++17 $canary_flags -Iinclude -o "$canary_out" "$@" \
        "$work"/canary-objects/*.o -lm
}

# life_finds FILE SED: the walk of lives on a core with that change.
life_finds() {
    planted "$1" "$2"
    build_life
    with_planted "$work/canary-life" "" "$work"/quick/tests/CMakeFiles/life.dir/*.o \
        "$work"/quick/tests/CMakeFiles/life.dir/*/*.o
    "$work/canary-life" --hours 3 --first 1
}

# fuzz_finds HARNESS FILE SED SOURCE...: that harness, for at most a minute.
fuzz_finds() {
    canary_harness=$1
    planted "$2" "$3"
    shift 3
    with_planted "$work/canary-fuzz" "-fsanitize=fuzzer,address" \
        "tests/verify/fuzz/$canary_harness.cpp" "$@"
    mkdir -p "$work/canary-corpus"
    "$work/canary-fuzz" -max_total_time=60 -seed=1 -max_len="$longest_input" \
        -artifact_prefix="$work/canary-found-" \
        "$work/canary-corpus" "tests/verify/fuzz/corpus/$canary_harness"
}

# Somebody reads all of a datagram before asking what it is.
flood_finds() {
    planted src/receive.c 's/^    count(c, ROBUROC4_COUNT_RECEIVED);$/&\
    static volatile uint8_t canary;\
    for (size_t i = 0; i < size; i++) { canary ^= datagram[i]; }/'
    bench/flood-cost --source "$canary_core" longest-nonsense
}

# What is measured is no function's any more.
flood_is_blind() {
    FLOOD_FUNCTION=roburoc4_client_is_received bench/flood-cost longest-nonsense
}

# The order of two draws is the compiler's choice.
order_finds() {
    # shellcheck disable=SC2086
    tree quick $quick
    compile "$work/quick" life
    rm -rf "$work/canary-tests"
    mkdir "$work/canary-tests"
    cp -R tests/walk* tests/referee* tests/support/hex.h tests/life "$work/canary-tests"
    sed 's/^    foreign_command(until_us, period_us);$/    foreign_command(now_us_ + dice_.between(0, 2 * second), dice_.between(20 * ms, 200 * ms));/' \
        tests/verify/soak/walk.cpp >"$work/canary-tests/verify/soak/walk.cpp"
    if cmp -s tests/verify/soak/walk.cpp "$work/canary-tests/verify/soak/walk.cpp"; then
        say "nothing was changed in tests/verify/soak/walk.cpp: mend tests/verify/canaries/canaries.sh"
        exit 1
    fi
    for compiler in "clang++-$clang" g++; do
        "$compiler" -std=c++17 -O1 -Iinclude "-I$work/canary-tests" \
            -o "$work/canary-life-$compiler" "$work/canary-tests/verify/soak/walk.cpp" \
            "$work/canary-tests/verify/soak/referee.cpp" "$work/canary-tests/life/life.cpp" \
            "$work/quick/libroburoc4_sim.a" "$work/quick/libroburoc4.a" -lm
    done
    compare_lives "$work/canary-life-clang++-$clang" "$work/canary-life-g++"
}

# The coverage of some tests is not that of all.
coverage_finds() {
    GTEST_FILTER='Lease*' coverage
}

mcdc_finds() {
    GTEST_FILTER='Lease*' mcdc
}

# Tests that test next to nothing let mutants live.
mutation_finds() {
    GTEST_FILTER='Version.*' run_mutants --sample 12 --seed 1 --files src/speeds.c --at-least 75
}

# canaries_of NAME COMMAND...: those of a check that has a script of its own, which says a line of
# each that was caught.
canaries_of() {
    canary_name=$1
    canary_log=build/logs/canary-$1.log
    shift
    if ! "$@" >"$canary_log" 2>&1 </dev/null; then
        tail -n 20 "$canary_log"
        fail "a planted fault was not found, or '$*' failed: $canary_log"
    fi
    grep -e '^caught ' -e ' caught by ' -e ' found:' "$canary_log" | sed "s/^/$canary_name: /" \
        >"$work/canary-lines"
    cat "$work/canary-lines"
    canary_lines=$(grep -c . "$work/canary-lines") ||
        fail "'$*' names no planted fault: $canary_log"
    canary_count=$((canary_count + canary_lines))
}

canaries() {
    canary asan "a byte behind a block is read" heap-buffer-overflow \
        preset_finds asan-ubsan address
    canary ubsan "a signed sum overflows" "signed integer overflow" \
        preset_finds asan-ubsan undefined
    canary tsan "two threads write without a lock" "data race" preset_finds tsan thread
    canary msan "a decision on memory that nobody wrote" "use-of-uninitialized" msan_finds
    canary valgrind "a decision on memory that nobody wrote" "uninitialised" valgrind_finds
    canary gcc-analyzer "memory is freed twice" "double-" analyse_gcc tests/verify/canaries/found.c
    canary scan-build "memory is freed twice" "bugs found\|bug found" \
        analyse_scan tests/verify/canaries/found.c
    canary clang-tidy "memory is freed twice" "clang-analyzer" tidy_finds
    canary cppcheck "memory is freed twice" doubleFree analyse_cppcheck tests/verify/canaries/found.c
    canary misra "a goto (rule 15.1)" "misra-c2012-15.1" \
        analyse_cppcheck tests/verify/canaries/misra.c
    canary life "the lease never ends" "seed [0-9]*: " life_finds src/drive.c \
        's/return d->leased && now_us - d->granted_us >= d->lease_us;/return false;/'
    canary life-train "one zero is enough for a train" "seed [0-9]*: " life_finds src/drive.c \
        's/#define TRAIN_ZEROS 3/#define TRAIN_ZEROS 1/'
    canary life-order "two draws in one list of arguments" \
        "another life with another compiler" order_finds
    canary flood "all bytes of a datagram are looked at" "longest-nonsense .*MORE THAN" flood_finds
    canary flood-blind "the function that is measured has another name" \
        "NOTHING WAS MEASURED" flood_is_blind
    canary fuzz-codec "the list of telemeters may be longer than its datagram" \
        "AddressSanitizer\|a promise is broken" fuzz_finds codec src/codec.c \
        's/count > r.left \/ SIZE_TELEMETER/count > SIZE_LIMIT/'
    canary fuzz-client "a client that is disarmed drives on" "a promise is broken" \
        fuzz_finds client src/drive.c 's/if (!d->known || !d->armed || !d->leased/if (!d->known/' \
        tests/verify/soak/referee.cpp
    canary fuzz-simulator "the watchdog of the robot lets it turn on" \
        "a promise is broken" fuzz_finds simulator sim/motion.c \
        's/    sim->target.angular_rad_s = 0.0;//'
    canary fuzz-config "a value of the configuration is not checked" "a promise is broken" \
        fuzz_finds config sim/config_file.c 's/ || cycles == 0) {/) {/'
    canary coverage "most tests are left out" "not reached" coverage_finds
    canary mcdc "most tests are left out" "of [0-9]* conditions" mcdc_finds
    canary mutation "most tests are left out" "NOT EXPLAINED" mutation_finds
    canaries_of abi tests/verify/abi/check --canaries
    if [ "$full" = yes ]; then
        canaries_of proofs tests/verify/proof/mutants
    else
        canaries_of proofs tests/verify/proof/mutants reader counts
    fi
    # Alone, "canaries" is all of them; else the stage of the model tells its own, and CI has no time
    # for those of other machines.
    case $only in
    *model*) ;;
    *)
        canaries_of model tests/verify/model/run --canaries
        canaries_of portability scripts/test-portability --canaries
        ;;
    esac
    say "$canary_count planted faults, all caught"
}
