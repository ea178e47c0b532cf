/* SPDX-License-Identifier: MIT
 *
 * hex.h - bytes for tests: written and printed as hex, and placed in heap blocks of exactly their
 * size, so that the address sanitizer sees every access beyond them.
 */
#ifndef ROBUROC4_TESTS_HEX_H
#define ROBUROC4_TESTS_HEX_H

#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace roburoc4_tests {

using Bytes = std::vector<std::uint8_t>;

/** Bytes of "FF 06 00  # note": white space is free, a note runs from '#' to the end of its line.
 */
inline Bytes from_hex(const std::string &text) {
    std::string digits;
    bool note = false;
    for (const char c : text) {
        note = c == '#' || (note && c != '\n');
        if (note || std::isspace(static_cast<unsigned char>(c)) != 0)
            continue;
        if (std::isxdigit(static_cast<unsigned char>(c)) == 0)
            throw std::invalid_argument(std::string("not a hex digit: ") + c);
        digits += c;
    }
    if (digits.size() % 2 != 0)
        throw std::invalid_argument("half a byte in: " + text);
    Bytes bytes;
    for (std::size_t i = 0; i < digits.size(); i += 2)
        bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
    return bytes;
}

inline std::string to_hex(const Bytes &bytes) {
    static const char digits[] = "0123456789ABCDEF";
    std::string text;
    for (const std::uint8_t byte : bytes) {
        text += text.empty() ? "" : " ";
        text += digits[byte >> 4];
        text += digits[byte & 15];
    }
    return text;
}

/** A heap block of exactly `size` bytes; never a null pointer, not even for 0 bytes. */
class ExactBlock {
  public:
    explicit ExactBlock(std::size_t size, std::uint8_t fill = 0) : size_(size), data_(make(size)) {
        std::memset(data_.get(), fill, size);
    }
    explicit ExactBlock(const Bytes &bytes) : ExactBlock(bytes.size()) {
        if (!bytes.empty())
            std::memcpy(data_.get(), bytes.data(), bytes.size());
    }
    std::uint8_t *data() {
        return data_.get();
    }
    std::size_t size() const {
        return size_;
    }
    Bytes bytes() const {
        return Bytes(data_.get(), data_.get() + size_);
    }

  private:
    static std::unique_ptr<std::uint8_t[]> make(std::size_t size) {
        return std::unique_ptr<std::uint8_t[]>(new std::uint8_t[size]);
    }
    std::size_t size_;
    std::unique_ptr<std::uint8_t[]> data_;
};

} // namespace roburoc4_tests

#endif
