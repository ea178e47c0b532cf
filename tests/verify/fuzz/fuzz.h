/* SPDX-License-Identifier: MIT
 *
 * fuzz.h - what the harnesses share. Each defines LLVMFuzzerTestOneInput(), which libFuzzer, AFL++
 * and replay.cpp call with bytes of any content and length; a broken promise ends the program.
 */
#ifndef ROBUROC4_TESTS_FUZZ_H
#define ROBUROC4_TESTS_FUZZ_H

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "hex.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size);

namespace roburoc4_tests {

[[noreturn]] inline void broken(const std::string &promise) {
    std::fprintf(stderr, "a promise is broken: %s\n", promise.c_str());
    std::abort();
}

inline void expect(bool holds, const char *promise) {
    if (!holds)
        broken(promise);
}

/** The input, read from its front; zeros after its end. */
class Input {
  public:
    Input(const std::uint8_t *data, std::size_t size) : data_(data), left_(size) {}

    [[nodiscard]] bool over() const {
        return left_ == 0;
    }
    std::uint8_t byte() {
        if (left_ == 0)
            return 0;
        left_--;
        return *data_++;
    }
    template <class Number> Number number() {
        Number value{};
        Bytes raw = bytes(sizeof value);
        raw.resize(sizeof value);
        std::memcpy(&value, raw.data(), sizeof value);
        return value;
    }
    /** The next `count` bytes, or what is left of them. */
    Bytes bytes(std::size_t count) {
        const std::size_t taken = count < left_ ? count : left_;
        Bytes all(data_, data_ + taken);
        data_ += taken;
        left_ -= taken;
        return all;
    }
    Bytes rest() {
        return bytes(left_);
    }

  private:
    const std::uint8_t *data_;
    std::size_t left_;
};

} // namespace roburoc4_tests

#endif
