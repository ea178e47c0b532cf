/* SPDX-License-Identifier: MIT
 *
 * Numbers that are drawn anew in each run.
 */
#ifndef ROBUROC4_TESTS_DRAWN_H
#define ROBUROC4_TESTS_DRAWN_H

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace roburoc4_tests {

/** A new seed, or ROBUROC4_SEED of the environment, to repeat a run. It is printed. */
inline std::uint64_t drawn_seed() {
    const char *given = std::getenv("ROBUROC4_SEED");
    const std::uint64_t seed =
        given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
    std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
    return seed;
}

class Drawn {
  public:
    explicit Drawn(std::uint64_t seed = drawn_seed()) : random_(seed) {}
    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    double within(double most) {
        return between(-most, most);
    }

  private:
    std::mt19937_64 random_;
};

} // namespace roburoc4_tests

#endif
