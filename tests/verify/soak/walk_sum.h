/* SPDX-License-Identifier: MIT
 *
 * walk_sum.h - what many lives were made of, added up: to see that they were not empty, to print,
 * and to go on later where a long run was stopped.
 */
#ifndef ROBUROC4_TESTS_WALK_SUM_H
#define ROBUROC4_TESTS_WALK_SUM_H

#include <algorithm>
#include <cstdint>
#include <istream>
#include <ostream>
#include <string>

#include "walk.h"

namespace roburoc4_tests {

struct WalkSum {
    RefereeTotals totals;
    std::uint64_t lives = 0, monitors = 0, damaged = 0, deceived = 0, forged = 0, virtual_us = 0;
    std::uint64_t ready_us = 0, armed_us = 0, moving_us = 0, moved_cycles = 0;

    /** visit(sum, name, field, whether the fields of two sums add up) for every field. */
    template <class Sum, class Visitor> static void each(Sum &sum, Visitor visit) {
        auto &t = sum.totals;
        visit("lives", sum.lives, true);
        visit("virtual_us", sum.virtual_us, true);
        visit("monitors", sum.monitors, true);
        visit("damaged", sum.damaged, true);
        visit("deceived", sum.deceived, true);
        visit("forged", sum.forged, true);
        visit("grants", t.grants, true);
        visit("armings", t.armings, true);
        visit("speeds", t.speeds, true);
        visit("zeros", t.zeros, true);
        visit("trains", t.trains, true);
        visit("leases_over", t.leases_over, true);
        visit("stops", t.stops, true);
        visit("disarms", t.disarms, true);
        visit("overrides", t.overrides, true);
        visit("stale", t.stale, true);
        visit("losses", t.losses, true);
        visit("reboots", t.reboots, true);
        visit("foreign", t.foreign, true);
        visit("clock_faults", t.clock_faults, true);
        visit("used", t.used, true);
        visit("dropped", t.dropped, true);
        visit("moved_cycles", sum.moved_cycles, true);
        visit("latest_ready_us", sum.ready_us, false);
        visit("latest_armed_us", sum.armed_us, false);
        visit("latest_moving_us", sum.moving_us, false);
    }

    void add(const LifeReport &life) {
        WalkSum one;
        one.totals = life.totals;
        one.lives = 1;
        one.monitors = life.monitor ? 1 : 0;
        one.damaged = life.damaged ? 1 : 0;
        one.deceived = life.deceived ? 1 : 0;
        one.forged = life.forged;
        one.virtual_us = life.virtual_us;
        one.ready_us = life.ready_after_us;
        one.armed_us = life.armed_after_us;
        one.moving_us = life.moving_after_us;
        one.moved_cycles = life.robot_moved_cycles;
        add(one);
    }
    void add(const WalkSum &other) {
        std::uint64_t values[32];
        std::size_t count = 0;
        each(other, [&](const char *, std::uint64_t value, bool) { values[count++] = value; });
        count = 0;
        each(*this, [&](const char *, std::uint64_t &value, bool adds) {
            value = adds ? value + values[count] : std::max(value, values[count]);
            count++;
        });
    }
    void print(std::ostream &out, const char *between = ", ") const {
        const char *lead = "";
        each(*this, [&](const char *name, std::uint64_t value, bool) {
            out << lead << name << ' ' << value;
            lead = between;
        });
        out << '\n';
    }
    /** Lines "name value"; false where one is missing. */
    bool read(std::istream &in) {
        bool good = true;
        each(*this, [&](const char *name, std::uint64_t &value, bool) {
            std::string found;
            good = good && in >> found >> value && found == name;
        });
        return good;
    }
};

} // namespace roburoc4_tests

#endif
