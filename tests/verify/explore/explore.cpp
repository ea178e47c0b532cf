/* SPDX-License-Identifier: MIT
 *
 * explore - applies every sequence of letters (world.h) to the client, up to a length, and judges
 * each state. Equal states are explored once.
 */
#include "world.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

namespace {

using namespace explore;

constexpr std::size_t client_words = sizeof(roburoc4_client) / 4;
constexpr std::size_t longest = 32;

/** From where, with which letters, and how far. */
struct Exploration {
    const char *name;
    std::uint32_t robot;
    const char *start;    /* letters from power on; "." takes 50 ms */
    const char *alphabet; /* letters */
    std::uint32_t depth, full_depth;
};

#define READY ".........."
#define DRIVING "DDDDDDDDDDDDDDDDDDDDDDDDDDDDDDDDD" /* until shortly before it is noticed */
const char all_letters[] = ".xlr2vUDPSABORCH";
/* Those whose effect takes longer than a few periods are in the longer histories only. */
const Exploration explorations[] = {
    {"watching", 0, READY, all_letters, 6, 7},
    {"armed", 0, READY "A", all_letters, 6, 8},
    {"driving", 0, READY "ADDD", all_letters, 6, 8},
    {"driving, robot 2", 1, READY "ADDD", all_letters, 7, 8},
    {"overridden", 1, READY "ADDDB..", all_letters, 7, 8},
    {"unconfirmed", 1, READY "ADDDUP....", all_letters, 6, 7},
    {"uplink out", 0, READY "AUDDDDDDD", all_letters, 6, 7},
    {"motors off", 0, READY "ADDDDDDDDE" DRIVING, ".xlDdPAEH", 7, 9},
    {"program and pad", 1, READY "A", ".DPSAB", 13, 15},
    {"losses", 1, READY "A", ".xaUDPA", 10, 12},
    {"delays", 0, READY "A", ".lrqvDA", 11, 13},
    {"restarts", 0, READY "A", ".xDARC", 10, 12},
};

/** Numbers that are the same in each run. */
class Random {
  public:
    std::uint32_t below(std::uint32_t limit) {
        state_ = state_ * 6364136223846793005 + 1442695040888963407;
        return static_cast<std::uint32_t>(state_ >> 33) % limit;
    }

  private:
    std::uint64_t state_ = 1;
};

/** States that were explored, with the number of letters that were applied to them. A state that
 *  does not fit replaces one that was explored less: then some are explored again, none is missed.
 */
class Table {
  public:
    explicit Table(std::uint32_t bits) : entries_(std::size_t{1} << bits) {}

    /** False if so many letters were applied to it before; else it is stored. */
    bool add(std::uint64_t hash, std::uint32_t letters) {
        std::uint64_t *bucket = &entries_[(hash >> 20) % (entries_.size() / 8) * 8];
        std::uint64_t *oldest = bucket;
        for (std::uint64_t *entry = bucket; entry != bucket + 8; entry++) {
            if (*entry >> 5 == hash >> 5) {
                if ((*entry & 31) >= letters)
                    return false;
                oldest = entry;
                break;
            }
            if ((*entry & 31) < (*oldest & 31))
                oldest = entry;
        }
        if (*oldest == 0)
            states_++;
        *oldest = (hash & ~std::uint64_t{31}) | letters;
        return true;
    }
    std::uint64_t states() const {
        return states_;
    }
    void clear() {
        std::fill(entries_.begin(), entries_.end(), 0);
        states_ = 0;
    }

  private:
    std::vector<std::uint64_t> entries_;
    std::uint64_t states_ = 0;
};

World started(const Exploration &exploration, std::uint64_t later_us = 0) {
    World world(exploration.robot, later_us);
    for (const char *letter = exploration.start; *letter && world.step(*letter);)
        letter++;
    return world;
}

/* ---- which states are equal ---- */

/** The 32-bit words of the client that are not compared: statistics. */
struct Statistics {
    std::uint8_t words[client_words] = {};

    Statistics() {
        using Service = roburoc4_private_service;
        const roburoc4_client client{};
        mark(offsetof(roburoc4_client, private_counters), sizeof client.private_counters);
        for (std::size_t i = 0; i < 5; i++) {
            const std::size_t service = offsetof(roburoc4_client, private_link) +
                                        offsetof(roburoc4_private_link, services) +
                                        i * sizeof(Service);
            mark(service + offsetof(Service, received), 4);
            mark(service + offsetof(Service, lost), 4);
            mark(service + offsetof(Service, late), 4);
            mark(service + offsetof(Service, duplicates), 4);
            mark(service + offsetof(Service, recent), 4); /* and recent_lost */
            mark(service + offsetof(Service, jitter_us), 4);
        }
    }
    void scramble(roburoc4_client &client, Random &random) const {
        for (std::size_t i = 0; i < client_words; i++)
            if (words[i]) {
                const std::uint32_t value = random.below(1000);
                std::memcpy(reinterpret_cast<char *>(&client) + 4 * i, &value, 4);
            }
    }

  private:
    void mark(std::size_t offset, std::size_t size) {
        std::memset(words + offset / 4, 1, size / 4);
    }
};

/** What is assumed where equal states are explored once, by trial: a client with other statistics
 *  that was started at another time does the same. */
bool equal_states_behave_alike(const Statistics &statistics) {
    Random random;
    for (const Exploration &exploration : explorations)
        for (int trial = 0; trial < 200; trial++) {
            World world = started(exploration);
            World other = started(exploration, 10000ULL * (1 + random.below(1U << 24)));
            statistics.scramble(other.client(), random);
            for (int i = 0; i < 20; i++) {
                const char letter = all_letters[random.below(sizeof all_letters - 1)];
                world.step(letter);
                other.step(letter);
            }
            if (world.seen() != other.seen())
                return false;
        }
    return true;
}

/* ---- the search ---- */

class Search {
  public:
    Search(const Exploration &exploration, Table &table, const std::uint8_t *ignored)
        : alphabet_(exploration.alphabet), table_(table), ignored_(ignored) {
        world_.reserve(longest + 1);
        world_.assign(longest + 1, started(exploration));
    }
    /** All sequences of so many letters. */
    void run(std::uint32_t letters) {
        const Promise at_start = world_[0].judge().broken;
        if (at_start != none)
            broken[at_start] = "-";
        else
            from(0, letters);
    }
    std::uint64_t steps = 0, merged = 0;
    std::string broken[promise_count]; /* by which history first */
    Promise only = none;               /* ends when this one was broken */

  private:
    void from(std::uint32_t depth, std::uint32_t letters) {
        for (const char *letter = alphabet_; *letter && broken[only].empty(); letter++) {
            World &next = world_[depth + 1];
            next = world_[depth];
            steps++;
            history_.resize(depth);
            history_ += *letter;
            if (!next.step(*letter)) {
                std::string &first = broken[next.judge().broken];
                if (first.empty())
                    first = history_;
            } else if (letters > 1) {
                if (table_.add(next.hash(ignored_), letters - 1))
                    from(depth + 1, letters - 1);
                else
                    merged++;
            }
        }
    }

    std::string history_;
    const char *alphabet_;
    Table &table_;
    const std::uint8_t *ignored_;
    std::vector<World> world_;
};

/** Of this processor. */
double seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

bool replay(const Exploration &exploration, const std::string &history) {
    World world = started(exploration);
    world.trace = true;
    std::printf("%s, then %s\n", exploration.start, history.c_str());
    for (const char letter : history)
        if (!world.step(letter)) {
            std::printf("BROKEN: %s\n", promise_text(world.judge().broken));
            return false;
        }
    return true;
}

class Explorer {
  public:
    std::uint32_t deepest = 0; /* letters; 0: as in the table above */
    bool full = false;
    std::string only; /* the name of one exploration; empty: all */

    /** True if no promise was broken. */
    bool run() {
        bool kept = equal_states_behave_alike(statistics_);
        if (!kept)
            std::printf("BROKEN: a client does not do the same at other times or with other "
                        "statistics, so equal states cannot be found\n");
        for (const Exploration &exploration : explorations)
            if (only.empty() || only == exploration.name)
                kept = run(exploration) && kept;
        std::printf("%.3g histories, %.3g steps, %.0f s: %s\n", histories_, steps_, seconds(),
                    kept ? "no promise broken" : "BROKEN");
        return kept;
    }

  private:
    /** Shorter histories first, so that what is found is short. */
    bool run(const Exploration &exploration) {
        table_.clear();
        std::uint32_t last = full ? exploration.full_depth : exploration.depth;
        last = deepest > 0 ? deepest : last;
        std::string found[promise_count];
        double steps = 0, merged = 0;
        const double begun = seconds();
        for (std::uint32_t letters = 1; letters <= last; letters++) {
            Search search(exploration, table_, statistics_.words);
            search.run(letters);
            steps += static_cast<double>(search.steps);
            merged += static_cast<double>(search.merged);
            for (std::uint32_t i = none + 1; i < promise_count; i++)
                if (found[i].empty() && !search.broken[i].empty()) {
                    found[i] = search.broken[i];
                    std::printf("BROKEN: %s\n", promise_text(static_cast<Promise>(i)));
                    std::printf("  again: explore --replay '%s' %s\n", exploration.name,
                                found[i].c_str());
                }
        }
        const auto letters = static_cast<double>(std::strlen(exploration.alphabet));
        const double histories = std::pow(letters, last);
        std::printf("%-16s all %8.3g histories of %2u of %2.0f letters: %8.3g steps, %8.3g times "
                    "an equal state, %.1f s\n",
                    exploration.name, histories, last, letters, steps, merged, seconds() - begun);
        std::fflush(stdout);
        histories_ += histories;
        steps_ += steps;
        return std::all_of(found, found + promise_count,
                           [](const std::string &history) { return history.empty(); });
    }
    Statistics statistics_;
    Table table_{25};
    double histories_ = 0, steps_ = 0;
};

/** By which history the active fault's promise is broken first; empty if it is not. */
std::string noticed(Promise breaks, Table &table, const Statistics &statistics) {
    for (std::uint32_t letters = 1; letters <= 5; letters++)
        for (const Exploration &exploration : explorations) {
            table.clear();
            Search search(exploration, table, statistics.words);
            search.only = breaks;
            search.run(letters);
            if (!search.broken[breaks].empty())
                return std::string(exploration.name) + ", " + search.broken[breaks];
        }
    return "";
}

/** Clients with one fault each: true if each breaks the promise that it should, and each promise is
 *  broken by one. */
bool run_canaries() {
    Table table(20);
    const Statistics statistics;
    bool all = true, breaks[promise_count] = {};
    for (std::uint32_t fault = no_fault + 1; fault < fault_count; fault++) {
        set_fault(fault);
        breaks[faults[fault].breaks] = true;
        const std::string history = noticed(faults[fault].breaks, table, statistics);
        std::printf("%s: %s\n", faults[fault].what,
                    history.empty() ? "NOT NOTICED" : history.c_str());
        std::fflush(stdout);
        all = all && !history.empty();
    }
    for (std::uint32_t i = none + 1; i < promise_count; i++)
        if (!breaks[i]) {
            std::printf("no fault breaks: %s\n", promise_text(static_cast<Promise>(i)));
            all = false;
        }
    std::printf("%u faults: %s\n", fault_count - 1, all ? "all noticed" : "NOT ALL NOTICED");
    return all;
}

} // namespace

int main(int count, char **arguments) {
    Explorer explorer;
    const std::vector<std::string> words(arguments + 1, arguments + count);
    std::size_t i = 0;
    for (; i < words.size(); i++) {
        const bool more = i + 1 < words.size();
        if (words[i] == "--canaries" && words.size() == 1)
            return run_canaries() ? 0 : 1;
        if (words[i] == "--full")
            explorer.full = true;
        else if (words[i] == "--only" && more)
            explorer.only = words[++i];
        else if (words[i] == "--depth" && more)
            explorer.deepest = static_cast<std::uint32_t>(std::atoi(words[++i].c_str()));
        else
            break;
    }
    if (i == 0 && words.size() == 3 && words[0] == "--replay")
        for (const Exploration &exploration : explorations)
            if (words[1] == exploration.name)
                return replay(exploration, words[2]) ? 0 : 1;
    if (i == words.size() && explorer.deepest < longest)
        return explorer.run() ? 0 : 1;
    std::printf("Usage: explore [--full] [--depth LETTERS] [--only NAME]\n"
                "       explore --replay NAME HISTORY\n"
                "       explore --canaries\n"
                "Apply every sequence of letters to the client, from each of these starts:\n");
    for (const Exploration &exploration : explorations)
        std::printf("  %-16s %s; %s\n", exploration.name, exploration.alphabet,
                    robot_kinds[exploration.robot].name);
    std::printf("What happens in 50 ms:\n");
    for (std::uint32_t letter = 0; letter < letter_count; letter++)
        std::printf("  %c  %s\n", letters[letter].letter, letters[letter].meaning);
    return words.size() == 1 && words[0] == "--help" ? 0 : 2;
}
