/* SPDX-License-Identifier: MIT
 *
 * soak - drives the client through hours of virtual time with everything that can go wrong, and
 * lets the oracle judge each datagram.
 *
 *   soak --hours H [--seed S] [--jobs J]   scenarios from seed S on, until H hours have passed
 *   soak --seed N --trace                  scenario N alone, step by step
 *   soak --only N,N,...                    these scenarios, and which of them break a promise
 *   soak --survey ...                      do not stop at a violation: list and count them
 *   soak --without PROMISE ...             do not judge this promise (may be repeated)
 *   soak --canaries                        faulty clients: each must be caught
 *   soak --promises                        list all promises
 *
 * Each scenario draws a member of the family of robots (docs/PROTOCOL.md) from its seed; --trace
 * prints it.
 *
 * Exit status: 0 where every judged promise was kept.
 */
#include "faulty.h"
#include "scenario.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace {

using soak::Outcome;
using soak::Promise;
using soak::Promises;

struct Options {
    double hours = 10;
    std::uint64_t seed = 1;
    unsigned jobs = 1;
    bool trace = false, survey = false, canaries = false;
    std::vector<std::uint64_t> only;
    Promises excluded;
};

[[noreturn]] void wrong_argument(const char *argument) {
    std::fprintf(stderr, "soak: wrong argument %s (see the head of soak.cpp)\n", argument);
    std::exit(2);
}

double hours_of(std::uint64_t us) {
    return static_cast<double>(us) / 3.6e9;
}

void print_violation(const Outcome &outcome) {
    const soak::Violation &violation = outcome.violation;
    std::printf(
        "BROKEN: %s\n  %s\n  seed %llu at %.6f s: %s.\n  replay: soak --seed %llu --trace\n",
        promise_name(violation.promise), promise_sentence(violation.promise),
        static_cast<unsigned long long>(outcome.seed),
        static_cast<double>(violation.true_us - 1000000000) * 1e-6, violation.what.c_str(),
        static_cast<unsigned long long>(outcome.seed));
    std::fflush(stdout);
}

/** What all jobs share. */
class Run {
  public:
    explicit Run(const Options &options)
        : options_(options), begun_(std::chrono::steady_clock::now()) {}

    void work() {
        while (!done_) {
            const std::uint64_t number = next_++;
            if (!options_.only.empty() && number >= options_.only.size())
                break;
            const std::uint64_t seed =
                options_.only.empty() ? options_.seed + number : options_.only[number];
            soak::RealClient client;
            record(soak::run_scenario(seed, client, options_.excluded, false));
        }
    }

    bool report() {
        std::printf("%.1f virtual hours, %llu scenarios (%llu drivable), %llu armings, %llu speeds "
                    "sent, %.0f virtual hours per hour and job\n",
                    hours_of(lasted_us_), static_cast<unsigned long long>(scenarios_),
                    static_cast<unsigned long long>(friendly_),
                    static_cast<unsigned long long>(armings_),
                    static_cast<unsigned long long>(speeds_), throughput());
        for (const auto &entry : broken_)
            std::printf("%8zu scenarios broke %s, the shortest: seed %llu after %.1f s\n",
                        entry.second.size(), promise_name(entry.first),
                        static_cast<unsigned long long>(shortest(entry.second).seed),
                        static_cast<double>(shortest(entry.second).lasted_us) * 1e-6);
        return all_reached() && broken_.empty();
    }

  private:
    /* What was never reached was never judged. */
    bool all_reached() const {
        bool all = true;
        for (std::size_t i = 0; i < soak::reached_count; i++) {
            std::printf("%s%s %llu", i == 0 ? "reached: " : ", ", soak::reached_name(i),
                        static_cast<unsigned long long>(reached_[i]));
            all = all && reached_[i] != 0;
        }
        std::printf("\n");
        const bool long_enough = hours_of(lasted_us_) >= 100; /* as scripts/verify does */
        if (!all)
            std::printf(long_enough ? "NOT REACHED: a run of this length must reach each of these\n"
                                    : "too short to judge what was reached\n");
        return all || !long_enough;
    }

    static const Outcome &shortest(const std::vector<Outcome> &outcomes) {
        const Outcome *best = &outcomes.front();
        for (const Outcome &outcome : outcomes)
            if (outcome.lasted_us < best->lasted_us)
                best = &outcome;
        return *best;
    }

    double throughput() const {
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begun_;
        return hours_of(lasted_us_) / (passed.count() / 3600) / options_.jobs;
    }

    void record(const Outcome &outcome) {
        const std::lock_guard<std::mutex> lock(mutex_);
        lasted_us_ += outcome.lasted_us;
        speeds_ += outcome.speeds_sent;
        armings_ += outcome.armings;
        friendly_ += outcome.friendly;
        for (std::size_t i = 0; i < soak::reached_count; i++)
            reached_[i] += outcome.reached[i];
        scenarios_++;
        if (outcome.violation.found) {
            print_violation(outcome);
            broken_[outcome.violation.promise].push_back(outcome);
        }
        if (hours_of(lasted_us_) >= printed_hours_ + 100) {
            printed_hours_ = hours_of(lasted_us_);
            std::printf("... %.0f hours, %.0f per hour and job\n", printed_hours_, throughput());
            std::fflush(stdout);
        }
        const bool all = options_.survey || !options_.only.empty();
        if ((options_.only.empty() && hours_of(lasted_us_) >= options_.hours) ||
            (!all && !broken_.empty()))
            done_ = true;
    }

    const Options &options_;
    std::atomic<std::uint64_t> next_{0};
    std::atomic<bool> done_{false};
    std::chrono::steady_clock::time_point begun_;
    std::mutex mutex_;
    std::uint64_t lasted_us_ = 0, speeds_ = 0, armings_ = 0, scenarios_ = 0, friendly_ = 0;
    double printed_hours_ = 0;
    std::array<std::uint64_t, soak::reached_count> reached_{};
    std::map<Promise, std::vector<Outcome>> broken_;
};

int run_hours(const Options &options) {
    Run run(options);
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < options.jobs; i++)
        threads.emplace_back([&run] { run.work(); });
    for (std::thread &thread : threads)
        thread.join();
    return run.report() ? 0 : 1;
}

int run_one(const Options &options) {
    soak::RealClient client;
    const Outcome outcome = soak::run_scenario(options.seed, client, options.excluded, true);
    if (outcome.violation.found)
        print_violation(outcome);
    return outcome.violation.found ? 1 : 0;
}

std::vector<std::uint64_t> numbers(const char *list) {
    std::vector<std::uint64_t> all;
    char *end = nullptr;
    for (; *list != '\0'; list = *end == ',' ? end + 1 : end) {
        all.push_back(std::strtoull(list, &end, 10));
        if (end == list)
            wrong_argument(list);
    }
    return all;
}

/* Each faulty client must be caught breaking the promise that it breaks, by the check of this
 * promise alone, where the real client keeps it. */
bool caught(const soak::Fault &fault, const Options &options) {
    const Promises others = Promises().set().reset(soak::number(fault.promise));
    std::uint64_t lasted_us = 0;
    for (std::uint64_t seed = options.seed; seed < options.seed + 2000; seed++) {
        const std::unique_ptr<soak::Client> client = fault.make();
        const Outcome outcome = soak::run_scenario(seed, *client, others, false);
        lasted_us += outcome.lasted_us;
        if (!outcome.violation.found)
            continue;
        soak::RealClient real;
        if (soak::run_scenario(seed, real, others, false).violation.found)
            continue;
        std::printf("caught  %-26s %s: seed %llu, after %.2f hours: %s\n",
                    promise_name(fault.promise), fault.what, static_cast<unsigned long long>(seed),
                    hours_of(lasted_us), outcome.violation.what.c_str());
        return true;
    }
    std::printf("MISSED  %-26s %s\n", promise_name(fault.promise), fault.what);
    return false;
}

int run_canaries(const Options &options) {
    Promises have;
    bool all = true;
    for (const soak::Fault &fault : soak::faults()) {
        all = caught(fault, options) && all;
        have.set(soak::number(fault.promise));
        std::fflush(stdout);
    }
    for (std::size_t i = 0; i < have.size(); i++)
        if (!have.test(i))
            std::printf("NO CANARY for %s\n", promise_name(static_cast<Promise>(i)));
    return all && have.all() ? 0 : 1;
}

int list_promises() {
    for (std::size_t i = 0; i < soak::Promises().size(); i++)
        std::printf("%-26s %s\n", promise_name(static_cast<Promise>(i)),
                    promise_sentence(static_cast<Promise>(i)));
    return 0;
}

} // namespace

int main(int argc, char **argv) {
    Options options;
    for (int i = 1; i < argc; i++) {
        const std::string argument = argv[i];
        const auto value = [&]() -> const char * {
            if (i + 1 >= argc)
                wrong_argument(argv[i]);
            return argv[++i];
        };
        Promise promise = Promise::count_;
        if (argument == "--hours")
            options.hours = std::strtod(value(), nullptr);
        else if (argument == "--seed")
            options.seed = std::strtoull(value(), nullptr, 10);
        else if (argument == "--jobs")
            options.jobs = static_cast<unsigned>(std::strtoul(value(), nullptr, 10));
        else if (argument == "--without" && find_promise(value(), promise))
            options.excluded.set(soak::number(promise));
        else if (argument == "--only")
            options.only = numbers(value());
        else if (argument == "--trace")
            options.trace = true;
        else if (argument == "--survey")
            options.survey = true;
        else if (argument == "--canaries")
            options.canaries = true;
        else if (argument == "--promises")
            return list_promises();
        else
            wrong_argument(argv[i]);
    }
    if (options.jobs == 0)
        options.jobs = 1;
    if (options.trace)
        return run_one(options);
    return options.canaries ? run_canaries(options) : run_hours(options);
}
