/* SPDX-License-Identifier: MIT
 *
 * random.h - seeded random numbers (splitmix64): the same seed gives the same run everywhere,
 * as long as no two are drawn in one expression whose order the compiler may choose.
 */
#ifndef ROBUROC4_SOAK_RANDOM_H
#define ROBUROC4_SOAK_RANDOM_H

#include <cstdint>

namespace soak {

class Random {
  public:
    /* Neighbouring seeds must not give one sequence that is shifted by one: hence the second pass.
     */
    explicit Random(std::uint64_t seed) : state_(seed + 1) {
        state_ = next();
    }

    std::uint64_t next() {
        state_ += 0x9E3779B97F4A7C15U;
        std::uint64_t mixed = state_;
        mixed = (mixed ^ (mixed >> 30)) * 0xBF58476D1CE4E5B9U;
        mixed = (mixed ^ (mixed >> 27)) * 0x94D049BB133111EBU;
        return mixed ^ (mixed >> 31);
    }

    /** 0 to 1, without 1. */
    double unit() {
        return static_cast<double>(next() >> 11) * (1.0 / 9007199254740992.0);
    }

    bool chance(double probability) {
        return unit() < probability;
    }

    /** A whole number from low to high, both included. */
    std::uint64_t between(std::uint64_t low, std::uint64_t high) {
        return low + next() % (high - low + 1);
    }

    double uniform(double low, double high) {
        return low + (high - low) * unit();
    }

    template <typename T, unsigned N> const T &pick(const T (&choices)[N]) {
        return choices[next() % N];
    }

  private:
    std::uint64_t state_;
};

} // namespace soak

#endif
