/* SPDX-License-Identifier: MIT
 *
 * What the codecs that are compared have in common: two messages, a long and a short one, with the
 * same fields and values, and what each codec offers for them. The structs of all peers name their
 * fields alike, so that one template fills each.
 */
#ifndef BENCH_MESSAGES_H
#define BENCH_MESSAGES_H

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

/** One message of one peer. Calls go through pointers, so that nothing is computed in advance. */
struct message_codec {
    const char *message;
    const char *peer;
    /** Encode the message's values: bytes written. */
    size_t (*encode)(uint8_t *buffer, size_t capacity);
    /** Decode: all values are then in a plain struct, where an application can use them. */
    bool (*decode)(const uint8_t *wire, size_t size);
    /** Whether what decode() left is what encode() was given. */
    bool (*intact)();
};

using message_codecs = std::vector<message_codec>;

message_codecs memcpy_codecs();
message_codecs roburoc4_codecs();
#ifdef BENCH_PEERS
message_codecs lcm_codecs();
message_codecs nanopb_codecs();
message_codecs mavlink_codecs();
#endif

inline message_codecs all_codecs() {
    message_codecs all;
    for (const auto &of_peer : {
             memcpy_codecs(),
             roburoc4_codecs(),
#ifdef BENCH_PEERS
             lcm_codecs(),
             nanopb_codecs(),
             mavlink_codecs(),
#endif
         }) {
        all.insert(all.end(), of_peer.begin(), of_peer.end());
    }
    return all;
}

/* ---- values ---- */

template <class T> void fill_iocard(T &v) {
    v.service = 2;
    v.robot_cycles = 123456;
    for (int i = 0; i < 9; i++) {
        v.analog[i] = 0.5F * static_cast<float>(i + 1);
    }
    v.digital[0] = 0x01;
    v.digital[1] = 0x83;
    v.digital[2] = 0x3F;
}

template <class T> void fill_differential(T &v) {
    v.service = 6;
    v.robot_cycles = 123456;
    v.target_linear_m_s = 1.0F;
    v.current_linear_m_s = 0.75F;
    v.target_angular_rad_s = -0.5F;
    v.current_angular_rad_s = -0.25F;
}

/** What a codec works on: the values that go in, and those that came out. */
template <class T, void (*fill)(T &)> struct values {
  private:
    static T filled() {
        T v;
        std::memset(&v, 0, sizeof v);
        fill(v);
        return v;
    }
    /* Not in a function: there each call would ask whether they are initialized. */
    static inline T in = filled();
    static inline T out{};

  public:
    static T &sent() {
        return in;
    }
    static T &received() {
        return out;
    }
    /* Whole structs: what lies between fields is 0 in both, or copied. */
    static bool intact() {
        return std::memcmp(&in, &out, sizeof(T)) == 0;
    }
};

#endif
