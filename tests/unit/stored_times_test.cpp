/* SPDX-License-Identifier: MIT
 *
 * The client stores times in 32 bits, which hold 71 minutes: none may stay as it is for so long.
 */
#include <cstring>
#include <fstream>
#include <iterator>
#include <regex>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

struct StoredTime {
    const char *name;
    std::size_t offset;
};

#define AT(part, field)                                                                            \
    { #part "." #field, offsetof(roburoc4_client, private_##part.field) }
const StoredTime times[] = {AT(drive, granted_us),
                            AT(drive, sent_us),
                            AT(drive, stop_us),
                            AT(drive, envelope_us),
                            AT(drive, reached_us),
                            AT(drive, expected_us),
                            AT(link, offset_since_us),
                            AT(link, last_used_us),
                            AT(link, asked_us),
                            AT(link, heard_us),
                            AT(link, card_inserted_us),
                            AT(link, excess_since_us),
                            AT(link, contradicted_us),
                            AT(requests, quiet_since_us),
                            AT(requests, slots[0].sent_us),
                            AT(requests, slots[1].sent_us),
                            AT(requests, slots[2].sent_us),
                            AT(requests, slots[3].sent_us),
                            AT(schedule, phase_us),
                            AT(schedule, probe_us),
                            AT(subscriptions, refused_us),
                            AT(subscriptions, inserted_us[0]),
                            AT(subscriptions, inserted_us[1]),
                            AT(subscriptions, inserted_us[2]),
                            AT(subscriptions, inserted_us[3]),
                            AT(subscriptions, inserted_us[4]),
                            AT(outputs, sent_us),
                            {"answered_us", offsetof(roburoc4_client, private_answered_us)},
                            {"driven_us", offsetof(roburoc4_client, private_driven_us)}};
#undef AT

/** What else has such a name in the private part of the header. */
const std::set<std::string> durations = {
    "wait_us",       "lease_us",  "quiet_span_us",     "jitter_us", "floor_age_us",
    "round_trip_us", "excess_us", "round_trip_min_us", "slack_us",  "now_us" /* of the timer */,
    "relocalize_us" /* limited while it counts; then only compared for equality */};

std::uint32_t value(const roburoc4_client &client, const StoredTime &time) {
    std::uint32_t value = 0;
    std::memcpy(&value, reinterpret_cast<const char *>(&client) + time.offset, sizeof value);
    return value;
}

} // namespace

/* Each is set to now, and so is what makes some of them count. */
TEST(StoredTimes, NoneIsKeptForAsLongAsItsBitsHold) {
    for (const std::uint64_t asleep_s : {10U, 1800U, 4200U}) { /* between two polls */
        SCOPED_TRACE(asleep_s);
        Ready bench;
        bench.robot.powered = false;
        for (const StoredTime &time : times)
            std::memcpy(reinterpret_cast<char *>(&bench.client) + time.offset,
                        &bench.client.private_timer.now_us, sizeof(std::uint32_t));
        bench.client.private_link.contradicted = 1;
        bench.client.private_link.excess_us = 1000;
        std::map<std::string, std::pair<std::uint32_t, std::uint64_t>> since;
        for (std::uint64_t passed_s = 0; passed_s < 2 * 86400; passed_s += asleep_s) {
            bench.skew_us += static_cast<std::int64_t>(asleep_s * second);
            while (bench.poll()) {
            }
            for (const StoredTime &time : times) {
                const std::uint32_t now = value(bench.client, time);
                auto &[before, at_s] =
                    since.emplace(time.name, std::pair{now, passed_s}).first->second;
                if (before != now)
                    at_s = passed_s;
                before = now;
                ASSERT_LT(passed_s - at_s, 2400 + asleep_s) << time.name;
            }
        }
        bench.robot.powered = true;
        bench.run(10 * second);
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

TEST(StoredTimes, AreAllKnownToThisTest) {
    std::ifstream file(ROBUROC4_SOURCE_DIR "/include/roburoc4.h");
    std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    text.erase(0, text.find("private layout"));
    ASSERT_FALSE(text.empty());
    std::set<std::string> known = durations;
    known.insert("private_answered_us");
    known.insert("private_driven_us");
    for (const StoredTime &time : times)
        known.insert(std::regex_replace(std::string(time.name), std::regex(".*\\.|\\[.*\\]$"), ""));
    const std::regex declaration("uint32_t ([a-z0-9_, \\[\\]\n]+);"), name("[a-z0-9_]+_us");
    std::size_t found = 0;
    for (std::sregex_iterator d(text.begin(), text.end(), declaration), end; d != end; ++d) {
        const std::string names = (*d)[1];
        for (std::sregex_iterator n(names.begin(), names.end(), name); n != end; ++n) {
            found++;
            EXPECT_EQ(1U, known.count(n->str()))
                << n->str() << ": does lifecycle.c limit its age, and is it here?";
        }
    }
    EXPECT_GT(found, 30U);
}

/** A program that hung for hours, and then receives what waited in its socket. */
TEST(StoredTimes, NoAgeIsBelievedThatIsLongerThanTimesAreKept) {
    for (const bool answered : {false, true}) {
        RobotBench bench;
        std::vector<Bytes> waiting;
        if (answered)
            bench.ready();
        bench.drop_to_client = [&waiting](const Bytes &bytes) {
            if (bytes[0] == ROBUROC4_HEADER_STATUS || !waiting.empty())
                waiting.push_back(bytes);
            return !waiting.empty();
        };
        if (!answered)
            bench.start();
        ASSERT_TRUE(bench.run_until([&] { return waiting.size() > 40; }));
        bench.now_us += 2 * 3600 * second;
        for (const Bytes &bytes : waiting)
            bench.receive(bytes);
        for (const std::uint32_t age_us : bench.facts().age_us)
            EXPECT_EQ(UINT32_MAX, age_us) << answered;
    }
}
