/* SPDX-License-Identifier: MIT
 *
 * pcapng.h - strict reader of the pcapng files of roburoc4_record.h: complete blocks, and every
 * length as the format requires.
 */
#ifndef ROBUROC4_TESTS_PCAPNG_H
#define ROBUROC4_TESTS_PCAPNG_H

#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace test {

struct RecordedDatagram {
    uint64_t calendar_us, drop_count;
    uint32_t flags; /* 1 inbound, 2 outbound */
    std::vector<uint8_t> ip, payload;
    uint16_t from_port, to_port;
};

struct Capture {
    std::vector<RecordedDatagram> datagrams;
    std::string interface_name;
    bool has_statistics = false, is_cut = false;
    uint64_t received = 0, dropped = 0; /* of the statistics */

    uint64_t drop_counts() const {
        uint64_t sum = 0;
        for (const RecordedDatagram &datagram : datagrams) {
            sum += datagram.drop_count;
        }
        return sum;
    }
};

class CaptureReader {
  public:
    explicit CaptureReader(std::vector<uint8_t> bytes) : bytes_(std::move(bytes)) {}
    Capture read() {
        size_t at = 0, blocks = 0;
        while (at + 12 <= bytes_.size() && at + word(at + 4) <= bytes_.size()) {
            const size_t length = word(at + 4);
            check(length % 4 == 0 && length >= 12 && word(at + length - 4) == length);
            check((blocks == 0) == (word(at) == 0x0A0D0D0A));
            check((blocks == 1) == (word(at) == 1));
            block(at, length);
            at += length;
            blocks++;
        }
        capture_.is_cut = at != bytes_.size();
        return capture_;
    }

  private:
    static void check(bool holds) {
        if (!holds) {
            throw std::runtime_error("not a pcapng file by our recorder");
        }
    }
    uint32_t word(size_t at) const {
        check(at + 4 <= bytes_.size());
        return uint32_t{bytes_[at]} | uint32_t{bytes_[at + 1]} << 8 |
               uint32_t{bytes_[at + 2]} << 16 | uint32_t{bytes_[at + 3]} << 24;
    }
    uint16_t half(size_t at) const {
        return static_cast<uint16_t>(word(at));
    }
    static uint16_t net_half(const std::vector<uint8_t> &bytes, size_t at) {
        return static_cast<uint16_t>(bytes.at(at) << 8 | bytes.at(at + 1));
    }
    uint64_t wide(size_t at) const {
        return word(at) | uint64_t{word(at + 4)} << 32;
    }
    void block(size_t at, size_t length) {
        switch (word(at)) {
        case 0x0A0D0D0A:
            check(word(at + 8) == 0x1A2B3C4D);
            break;
        case 1:
            check(half(at + 8) == 101);
            check(half(at + 16) == 2);
            capture_.interface_name.assign(&bytes_[at + 20], &bytes_[at + 20] + half(at + 18));
            break;
        case 5:
            capture_.has_statistics = true;
            options(at + 20, at + length - 4, nullptr);
            break;
        case 6:
            packet(at, length);
            break;
        default:
            check(false);
        }
    }
    void options(size_t at, size_t end, RecordedDatagram *datagram) {
        while (at + 4 <= end && half(at) != 0) {
            switch (half(at)) {
            case 2:
                if (datagram != nullptr) {
                    datagram->flags = word(at + 4);
                }
                break;
            case 4:
                check(datagram == nullptr || wide(at + 4) > 0);
                (datagram != nullptr ? datagram->drop_count : capture_.received) = wide(at + 4);
                break;
            case 5:
                capture_.dropped = wide(at + 4);
                break;
            default:
                break;
            }
            at += 4 + (half(at + 2) + 3u) / 4 * 4;
        }
        check(at + 4 == end && word(at) == 0);
    }
    void packet(size_t at, size_t length) {
        RecordedDatagram datagram{};
        const uint32_t size = word(at + 20);
        check(word(at + 8) == 0 && size == word(at + 24) && 28 + size + 8 <= length);
        datagram.calendar_us = uint64_t{word(at + 12)} << 32 | word(at + 16);
        datagram.ip.assign(&bytes_[at + 28], &bytes_[at + 28] + size);
        const bool is_ipv4 = datagram.ip.at(0) == 0x45;
        const size_t udp = is_ipv4 ? 20 : 40;
        check(is_ipv4 ? net_half(datagram.ip, 2) == size : (datagram.ip.at(0) == 0x60));
        check(net_half(datagram.ip, udp + 4) == size - udp);
        datagram.from_port = net_half(datagram.ip, udp);
        datagram.to_port = net_half(datagram.ip, udp + 2);
        datagram.payload.assign(datagram.ip.begin() + static_cast<std::ptrdiff_t>(udp) + 8,
                                datagram.ip.end());
        options(at + 28 + (size + 3) / 4 * 4, at + length - 4, &datagram);
        capture_.datagrams.push_back(datagram);
    }

    std::vector<uint8_t> bytes_;
    Capture capture_;
};

inline Capture read_capture(const std::vector<uint8_t> &bytes) {
    return CaptureReader(bytes).read();
}

inline Capture read_capture(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw std::runtime_error("no file " + path);
    }
    return read_capture(std::vector<uint8_t>{std::istreambuf_iterator<char>(file),
                                             std::istreambuf_iterator<char>()});
}

} // namespace test

#endif
