/* SPDX-License-Identifier: MIT
 *
 * life.cpp - many hours of a client and a robot in virtual time, life after life (walk.h), until so
 * many hours were lived or a promise is broken. It can be stopped and goes on where it was.
 */
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string>

#include "walk.h"
#include "walk_sum.h"

using namespace roburoc4_tests;

namespace {

constexpr double us_per_hour = 3.6e9;
constexpr std::uint64_t lives_per_save = 500;

const char help[] =
    "Usage: life --hours H [--first SEED] [--share I/N] [--state FILE --code NAME]\n"
    "       life --seed SEED\n"
    "Live the lives SEED, SEED + 1, ... (default: from 1) until H virtual hours are full. With\n"
    "--share, only those that are I (0 to N-1) modulo N, and H/N hours of them. With --state, go "
    "on\n"
    "from what FILE says, and keep it up to date; NAME stands for the code that lives, and a FILE "
    "of\n"
    "another name is refused: its hours say nothing of this code.\n"
    "--seed: one life, told step by step.\n"
    "Exit status: 0 every promise was held, 1 one was broken, 2 bad usage.\n";

struct Options {
    double hours = 0;
    std::uint64_t first = 1, index = 0, shares = 1, seed = 0;
    std::string state, code;
};

[[noreturn]] void misused(const std::string &what) {
    std::cerr << "life: " << what << "; see life --help\n";
    std::exit(2);
}

std::uint64_t number(const std::string &text) {
    char *end = nullptr;
    const std::uint64_t value = std::strtoull(text.c_str(), &end, 10);
    if (text.empty() || *end != '\0')
        misused("cannot use '" + text + "' as a whole number");
    return value;
}

Options read_options(int argc, char **argv) {
    Options options;
    for (int i = 1; i < argc; i++) {
        const std::string name = argv[i];
        if (name == "--help") {
            std::cout << help;
            std::exit(0);
        }
        if (i + 1 == argc)
            misused("'" + name + "' lacks a value or is not known");
        const std::string value = argv[++i];
        if (name == "--hours") {
            options.hours = std::atof(value.c_str());
        } else if (name == "--first") {
            options.first = number(value);
        } else if (name == "--seed") {
            options.seed = number(value);
        } else if (name == "--state") {
            options.state = value;
        } else if (name == "--code") {
            options.code = value;
        } else if (name == "--share" && value.find('/') != std::string::npos) {
            options.index = number(value.substr(0, value.find('/')));
            options.shares = number(value.substr(value.find('/') + 1));
        } else {
            misused("cannot use '" + name + " " + value + "'");
        }
    }
    if (options.shares == 0 || options.index >= options.shares)
        misused("--share I/N needs I below N");
    if (options.seed == 0 && !(options.hours > 0))
        misused("--hours must be more than 0");
    if (!options.state.empty() && options.code.empty())
        misused("--state needs --code");
    return options;
}

/** Written beside it and put in its place, so that it is whole at any time. */
void save(const Options &options, const WalkSum &sum) {
    const std::string &file = options.state;
    if (file.empty())
        return;
    std::ofstream out(file + ".new");
    out << "code " << options.code << '\n';
    sum.print(out, "\n");
    out.close();
    if (!out || std::rename((file + ".new").c_str(), file.c_str()) != 0)
        misused("cannot write " + file);
}

/** What was lived before, of this code only. */
WalkSum load(const Options &options) {
    WalkSum sum;
    std::ifstream in(options.state);
    if (!in)
        return sum;
    std::string word;
    std::string code;
    if (!(in >> word >> code) || word != "code" || code != options.code)
        misused(options.state + " is of other code than " + options.code +
                ": its hours do not count here; remove it to begin anew");
    if (!sum.read(in))
        misused(options.state + " is no state of this program: remove it");
    return sum;
}

int tell(std::uint64_t seed) {
    const LifeReport life = live(seed, true);
    std::cout << (life.complaint.empty() ? "every promise was held" : life.complaint) << '\n';
    return life.complaint.empty() ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    const Options options = read_options(argc, argv);
    if (options.seed != 0)
        return tell(options.seed);

    WalkSum sum = load(options);
    const double enough_us = options.hours * us_per_hour / static_cast<double>(options.shares);
    while (static_cast<double>(sum.virtual_us) < enough_us) {
        const std::uint64_t seed = options.first + options.index + sum.lives * options.shares;
        const LifeReport life = live(seed);
        if (!life.complaint.empty()) {
            save(options, sum);
            std::cout << "seed " << seed << ": " << life.complaint
                      << "\nagain, step by step: scripts/verify --only life --seed " << seed
                      << '\n';
            return 1;
        }
        sum.add(life);
        if (sum.lives % lives_per_save == 0)
            save(options, sum);
    }
    save(options, sum);
    std::printf("%.1f virtual hours, %llu lives from seed %llu: ",
                static_cast<double>(sum.virtual_us) / us_per_hour,
                static_cast<unsigned long long>(sum.lives),
                static_cast<unsigned long long>(options.first));
    std::fflush(stdout);
    sum.print(std::cout);
    return 0;
}
