/* SPDX-License-Identifier: MIT
 *
 * Fuzzing every decoder: the first byte chooses one, the rest is its datagram, in a block of
 * exactly its size. What was decoded is encoded again and must give the same bytes; what was
 * refused must have left the output alone.
 */
#include <functional>

#include "fuzz.h"
#include "roburoc4.h"

using namespace roburoc4_tests;

namespace {

using Encoder = std::function<roburoc4_result(std::uint8_t *, std::size_t)>;

/** An encoder writes exactly as much as it returns, also where there is more room, and nothing into
 * a buffer that is shorter. */
void encodes_to(const Bytes &expected, const Encoder &encode) {
    for (const std::size_t room : {0U, 9U}) {
        ExactBlock block(expected.size() + room, 0xAA);
        const roburoc4_result size = encode(block.data(), block.size());
        expect(size == static_cast<roburoc4_result>(expected.size()), "encoded again: same length");
        Bytes all = expected;
        all.insert(all.end(), room, 0xAA);
        expect(block.bytes() == all, "encoded again: same bytes");
    }
    for (const std::size_t capacity :
         {std::size_t{0}, std::size_t{1}, expected.size() / 2, expected.size() - 1}) {
        ExactBlock tight(capacity, 0xAA);
        expect(encode(tight.data(), tight.size()) == ROBUROC4_ERR_BUFFER, "too short is said");
        expect(tight.bytes() == Bytes(tight.size(), 0xAA), "too short: nothing is written");
    }
}

/** Decode `datagram` to `out`; false and an untouched output where it is refused. With success,
 *  *used is what the telegram is made of: the datagram without the surplus at its end. */
template <class Out, class Decoder>
bool decodes(const Bytes &datagram, Out &out, Bytes &used, Decoder decode) {
    Out before;
    std::memset(static_cast<void *>(&out), 0x5A, sizeof out);
    std::memcpy(static_cast<void *>(&before), &out, sizeof out);
    const roburoc4_result result = decode(datagram.data(), datagram.size(), &out);
    if (result < 0) {
        expect(std::memcmp(static_cast<void *>(&before), &out, sizeof out) == 0,
               "what is refused writes nothing");
        expect(std::strcmp(roburoc4_result_text(result), "unknown error") != 0, "a known error");
        return false;
    }
    expect(static_cast<std::size_t>(result) <= datagram.size(), "no more surplus than bytes");
    used = Bytes(datagram.begin(), datagram.end() - result);
    return true;
}

/** The first byte of an answer is its id, of an error none that a request could have. */
std::uint8_t id_of(const Bytes &datagram) {
    return datagram[0];
}

/** All floats of a list, which may be empty: hence one more than there are. */
std::vector<float> all_floats(const std::uint8_t *list, std::uint32_t count) {
    std::vector<float> values(count + 1);
    expect(roburoc4_floats(list, count, values.data(), count + 1) == count, "all floats are read");
    return values;
}

void request(const Bytes &datagram) {
    roburoc4_request r;
    Bytes used;
    if (!decodes(datagram, r, used, roburoc4_decode_request))
        return;
    if ((r.action == ROBUROC4_ACTION_INSERT && r.period_cycles == 0) ||
        r.action == ROBUROC4_ACTION_UPDATE || r.action >= ROBUROC4_ACTION_SUBMIT)
        return;
    encodes_to(used,
               [&](std::uint8_t *b, std::size_t n) { return roburoc4_encode_request(b, n, &r); });
}

void answer(const Bytes &datagram) {
    roburoc4_answer a;
    Bytes used;
    if (!decodes(datagram, a, used, roburoc4_decode_answer))
        return;
    expect(a.payload == datagram.data() + 5 && a.payload_size == datagram.size() - 5,
           "the payload is what follows the head");
    encodes_to(Bytes(datagram.begin(), datagram.begin() + 5), [&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_answer(b, n, a.id, a.action, a.service, a.error);
    });
}

void directory(const Bytes &datagram) {
    roburoc4_directory d;
    Bytes used;
    if (!decodes(datagram, d, used, roburoc4_decode_directory))
        return;
    std::vector<roburoc4_directory_entry> entries(d.count);
    for (std::uint32_t i = 0; i < d.count; i++)
        expect(roburoc4_directory_at(&d, i, &entries[i]) == ROBUROC4_OK, "each entry can be read");
    roburoc4_directory_entry beyond;
    expect(roburoc4_directory_at(&d, d.count, &beyond) == ROBUROC4_ERR_INDEX, "none beyond");
    encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_directory(b, n, id_of(datagram), d.service, entries.data(), d.count);
    });
}

void notification(const Bytes &datagram) {
    roburoc4_notification v;
    Bytes used;
    if (!decodes(datagram, v, used, roburoc4_decode_notification))
        return;
    std::vector<roburoc4_subscription> entries(v.count);
    for (std::uint32_t i = 0; i < v.count; i++)
        expect(roburoc4_notification_at(&v, i, &entries[i]) == ROBUROC4_OK, "each can be read");
    roburoc4_subscription beyond;
    expect(roburoc4_notification_at(&v, v.count, &beyond) == ROBUROC4_ERR_INDEX, "none beyond");
    encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_notification(b, n, id_of(datagram), v.service, entries.data(),
                                            v.count);
    });
}

void iocard_properties(const Bytes &datagram) {
    roburoc4_iocard_properties p;
    Bytes used;
    if (!decodes(datagram, p, used, roburoc4_decode_iocard_properties))
        return;
    expect(p.analog_inputs >= 0 && p.analog_outputs >= 0 && p.digital_inputs >= 0 &&
               p.digital_outputs >= 0,
           "counts are not negative");
    encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_iocard_properties(b, n, id_of(datagram), &p);
    });
}

void telemeter_properties(const Bytes &datagram) {
    roburoc4_telemeter_list list;
    Bytes used;
    if (!decodes(datagram, list, used, roburoc4_decode_telemeter_properties))
        return;
    std::vector<roburoc4_telemeter> all(list.count);
    for (std::uint32_t i = 0; i < list.count; i++)
        expect(roburoc4_telemeter_at(&list, i, &all[i]) == ROBUROC4_OK, "each can be read");
    roburoc4_telemeter beyond;
    expect(roburoc4_telemeter_at(&list, list.count, &beyond) == ROBUROC4_ERR_INDEX, "none beyond");
    encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_telemeter_properties(b, n, id_of(datagram), list.service, all.data(),
                                                    list.count);
    });
}

void battery_properties(const Bytes &datagram) {
    roburoc4_battery_properties p;
    Bytes used;
    if (decodes(datagram, p, used, roburoc4_decode_battery_properties))
        encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_battery_properties(b, n, id_of(datagram), &p);
        });
}

void localization_properties(const Bytes &datagram) {
    roburoc4_localization_properties p;
    Bytes used;
    if (decodes(datagram, p, used, roburoc4_decode_localization_properties))
        encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_localization_properties(b, n, id_of(datagram), &p);
        });
}

void differential_properties(const Bytes &datagram) {
    roburoc4_differential_properties p;
    Bytes used;
    if (decodes(datagram, p, used, roburoc4_decode_differential_properties))
        encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_differential_properties(b, n, id_of(datagram), &p);
        });
}

void text(const Bytes &datagram) {
    roburoc4_text t;
    Bytes used;
    if (!decodes(datagram, t, used, roburoc4_decode_text))
        return;
    expect(t.text == datagram.data() + 5 && t.length == datagram.size() - 5, "all of the text");
    encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_text(b, n, id_of(datagram), t.service,
                                    reinterpret_cast<const char *>(t.text), t.length);
    });
}

void status_header(const Bytes &datagram) {
    roburoc4_status_header h;
    Bytes used;
    if (decodes(datagram, h, used, roburoc4_decode_status_header))
        expect(used.size() == 11, "a status has a head of 11 bytes");
}

/** The first bytes say how many channels the robot has. */
/** The numbers of analog and digital channels come first; `status`, or a command. */
void channels(const Bytes &input, bool status) {
    Input in(input.data(), input.size());
    const auto analog = in.number<std::uint32_t>();
    const auto digital = in.number<std::uint32_t>();
    const Bytes datagram = in.rest();
    const auto decode = status ? roburoc4_decode_iocard_status : roburoc4_decode_iocard_command;
    roburoc4_channels c;
    Bytes used;
    if (!decodes(datagram, c, used, [&](auto *data, auto size, auto *out) {
            return decode(data, size, analog, digital, out);
        }))
        return;
    const auto floats = all_floats(c.analog, analog);
    encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
        return status ? roburoc4_encode_iocard_status(b, n, c.service, c.robot_cycles,
                                                      floats.data(), analog, c.digital, digital)
                      : roburoc4_encode_iocard_command(b, n, c.service, floats.data(), analog,
                                                       c.digital, digital);
    });
}

void iocard_status(const Bytes &input) {
    channels(input, true);
}

void iocard_command(const Bytes &input) {
    channels(input, false);
}

void telemeter_status(const Bytes &datagram) {
    roburoc4_telemeter_status s;
    Bytes used;
    if (!decodes(datagram, s, used, roburoc4_decode_telemeter_status))
        return;
    const auto floats = all_floats(s.distances, s.count);
    encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_telemeter_status(b, n, s.service, s.robot_cycles, floats.data(),
                                                s.count);
    });
}

void battery_status(const Bytes &datagram) {
    roburoc4_battery_status s;
    Bytes used;
    if (decodes(datagram, s, used, roburoc4_decode_battery_status))
        encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_battery_status(b, n, &s);
        });
}

void localization_status(const Bytes &datagram) {
    roburoc4_localization_status s;
    Bytes used;
    if (decodes(datagram, s, used, roburoc4_decode_localization_status))
        encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_localization_status(b, n, &s);
        });
}

void differential_status(const Bytes &datagram) {
    roburoc4_differential_status s;
    Bytes used;
    if (decodes(datagram, s, used, roburoc4_decode_differential_status))
        encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_differential_status(b, n, &s);
        });
}

void differential_command(const Bytes &datagram) {
    roburoc4_differential_command c;
    Bytes used;
    if (decodes(datagram, c, used, roburoc4_decode_differential_command))
        encodes_to(used, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_differential_command(b, n, c.service, c.linear_m_s,
                                                        c.angular_rad_s);
        });
}

/* By the first byte of the input; tests/verify/fuzz/corpus/codec has one or more of each. */
void (*const decoders[])(const Bytes &) = {
    request,
    answer,
    directory,
    notification,
    iocard_properties,
    telemeter_properties,
    battery_properties,
    localization_properties,
    differential_properties,
    text,
    status_header,
    iocard_status,
    iocard_command,
    telemeter_status,
    battery_status,
    localization_status,
    differential_status,
    differential_command,
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    if (size == 0)
        return 0;
    /* a vector of exactly its size, so that the address sanitizer sees a byte too much */
    const Bytes datagram(data + 1, data + size);
    decoders[data[0] % (sizeof decoders / sizeof decoders[0])](datagram);
    return 0;
}
