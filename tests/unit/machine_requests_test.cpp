/* SPDX-License-Identifier: MIT
 *
 * The machine "requests": ids, tries and answers.
 * Alone: what it promises to whoever calls it, also where the joined client never leads it.
 */
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <iterator>

extern "C" {
#include "joined.h"
}

namespace {

constexpr std::uint64_t ms = 1000;
constexpr std::uint64_t second = 1000000;
constexpr std::uint64_t begin_us = 100 * second;

constexpr ask get_directory{
    0, 0, ROBUROC4_ACTION_GET, ROBUROC4_SERVICE_DIRECTORY, 0, REQUEST_FOREVER};

ask get(std::uint8_t kind) {
    return {kind, 0, ROBUROC4_ACTION_GET, kind, 0, 3};
}

/** Ask the services from 2 to before `end`, each once. */
void send_each(requests &r, std::uint8_t end) {
    slot *given_up = nullptr;
    for (std::uint8_t kind = 2; kind < end; kind++) {
        const ask a = get(kind);
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        ASSERT_NE(nullptr, roburoc4_requests_due(&r, 100, begin_us, &given_up));
    }
}

} // namespace

TEST(Requests, HaveRoomForFourAndNoneTwice) {
    requests r{};
    for (std::uint8_t kind = 2; kind < 6; kind++) {
        const ask a = get(kind);
        EXPECT_TRUE(roburoc4_requests_free(&r, 0));
        EXPECT_TRUE(roburoc4_requests_begin(&r, &a));
        EXPECT_FALSE(roburoc4_requests_begin(&r, &a)) << "it is open";
    }
    for (std::uint32_t keep = 0; keep < 5; keep++)
        EXPECT_FALSE(roburoc4_requests_free(&r, keep)) << keep;
    const ask fifth = get(6);
    EXPECT_FALSE(roburoc4_requests_begin(&r, &fifth));
    roburoc4_requests_cancel(&r, ROBUROC4_ACTION_GET, 3);
    EXPECT_TRUE(roburoc4_requests_free(&r, 0));
    EXPECT_FALSE(roburoc4_requests_free(&r, 1));
    EXPECT_TRUE(roburoc4_requests_begin(&r, &fifth));
}

/* Behind the four stands, as if it were a fifth, an open one: whoever looks too far finds it. */
TEST(Requests, NothingBehindTheFourIsReadOrChanged) {
    struct {
        requests r;
        slot behind;
    } memory{};
    const ask asked = get(2);
    memory.behind = {asked, 1, 2, 1, 0, 100000, begin_us};
    const slot before = memory.behind;
    requests *r = &memory.r;
    slot *given_up = nullptr;
    EXPECT_TRUE(roburoc4_requests_free(r, 3));
    r->fixed_id = 1;
    EXPECT_TRUE(roburoc4_requests_free(r, 0));
    r->fixed_id = 0;
    EXPECT_FALSE(roburoc4_requests_open(r, &asked));
    EXPECT_EQ(UINT64_MAX, roburoc4_requests_deadline(r));
    const std::array<std::uint8_t, 5> answer{2, ROBUROC4_ACTION_GET, 2, 0, 0};
    EXPECT_EQ(nullptr, roburoc4_requests_match(r, answer.data(), answer.size(), begin_us));
    EXPECT_EQ(nullptr, roburoc4_requests_due(r, 100, begin_us + second, &given_up));
    EXPECT_EQ(nullptr, given_up);
    roburoc4_requests_cancel(r, ROBUROC4_ACTION_GET, 2);
    roburoc4_requests_cancel_all(r);
    roburoc4_requests_rebase(r, begin_us - second);
    roburoc4_requests_clear(r);
    r->last_id = 1;
    ASSERT_TRUE(roburoc4_requests_begin(r, &asked)) << "it is not open";
    const slot *own = roburoc4_requests_due(r, 100, begin_us, &given_up);
    ASSERT_NE(nullptr, own);
    EXPECT_EQ(2, own->id) << "no open one has it";
    for (std::uint8_t kind = 3; kind < 6; kind++) {
        const ask a = get(kind);
        EXPECT_TRUE(roburoc4_requests_begin(r, &a));
    }
    const ask fifth = get(6);
    EXPECT_FALSE(roburoc4_requests_begin(r, &fifth));
    EXPECT_EQ(0, std::memcmp(&before, &memory.behind, sizeof before));
}

TEST(Requests, AreCancelledByActionAndKindWhereverTheyStand) {
    for (std::uint8_t cancelled = 2; cancelled < 6; cancelled++) {
        requests r{};
        for (std::uint8_t kind = 2; kind < 6; kind++) {
            const ask a = get(kind);
            ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        }
        roburoc4_requests_cancel(&r, ROBUROC4_ACTION_INSERT, cancelled);
        EXPECT_FALSE(roburoc4_requests_free(&r, 0)) << "that was another question";
        roburoc4_requests_cancel(&r, ROBUROC4_ACTION_GET, cancelled);
        for (std::uint8_t kind = 2; kind < 6; kind++) {
            const ask a = get(kind);
            EXPECT_EQ(kind != cancelled, roburoc4_requests_open(&r, &a)) << int{kind};
        }
        roburoc4_requests_cancel_all(&r);
        EXPECT_TRUE(roburoc4_requests_free(&r, 3));
    }
}

TEST(Requests, OfOneActionAndKindAreAllCancelled) {
    requests r{};
    const ask other = get(2);
    ASSERT_TRUE(roburoc4_requests_begin(&r, &other));
    for (std::uint16_t index = 0; index < 3; index++) {
        const ask text{0, index, ROBUROC4_ACTION_QUERY, ROBUROC4_SERVICE_DIRECTORY, 4, 10};
        ASSERT_TRUE(roburoc4_requests_begin(&r, &text));
    }
    roburoc4_requests_cancel(&r, ROBUROC4_ACTION_QUERY, ROBUROC4_SERVICE_DIRECTORY);
    EXPECT_TRUE(roburoc4_requests_free(&r, 2));
    EXPECT_TRUE(roburoc4_requests_open(&r, &other));
}

TEST(Requests, AreTriedAsOftenAsTheySayAndThenGivenUp) {
    for (std::uint8_t tries = 1; tries < 12; tries++) {
        requests r{};
        ask a = get(2);
        a.max_tries = tries;
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        slot *given_up = nullptr;
        std::uint64_t now_us = begin_us;
        for (int i = 0; i < tries; i++, now_us = roburoc4_requests_deadline(&r)) {
            ASSERT_NE(nullptr, roburoc4_requests_due(&r, 100, now_us, &given_up)) << i;
            EXPECT_EQ(nullptr, given_up);
        }
        EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 100, now_us - 1, &given_up));
        EXPECT_EQ(nullptr, given_up) << "the last try is waited for, too";
        EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 100, now_us, &given_up));
        EXPECT_EQ(&r.slots[0], given_up);
        EXPECT_TRUE(roburoc4_requests_free(&r, 3));
    }
}

/* A whole round of ids later the next ones are those of requests that are still open. */
TEST(Requests, NeverShareAnId) {
    requests r{};
    slot *given_up = nullptr;
    ASSERT_NO_FATAL_FAILURE(send_each(r, 5));
    const std::uint8_t first = r.slots[0].id;
    const ask last = get(5);
    ASSERT_TRUE(roburoc4_requests_begin(&r, &last));
    for (std::uint8_t before = 0; before < 3; before++) {
        requests later = r;
        later.last_id = static_cast<std::uint8_t>(first - 1 + before);
        const slot *s = roburoc4_requests_due(&later, 100, begin_us, &given_up);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(first + 3, s->id) << int{before};
    }
    for (int own = 0; own < 3; own++) { /* those of closed ones are free again */
        requests later = r;
        later.last_id = static_cast<std::uint8_t>(first - 1);
        later.slots[own].open = 0;
        const slot *s = roburoc4_requests_due(&later, 100, begin_us, &given_up);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(first + own, s->id);
    }
}

TEST(Requests, UseAllIdsButThoseWithAMeaning) {
    requests r{};
    slot *given_up = nullptr;
    const ask a = get(2);
    std::array<int, 256> used{};
    for (int i = 0; i < 253; i++) {
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        slot *s = roburoc4_requests_due(&r, 100, begin_us, &given_up);
        ASSERT_NE(nullptr, s);
        used[s->id]++;
        roburoc4_requests_close(&r, s, begin_us);
    }
    for (int id = 0; id < 256; id++)
        EXPECT_EQ(id >= 2 && id <= 254 ? 1 : 0, used[static_cast<std::size_t>(id)]) << id;
}

TEST(Requests, OnlyWhoConnectsTriesTheManualId) {
    const auto uses_it = [](const ask &a) {
        requests r{};
        slot *given_up = nullptr;
        EXPECT_TRUE(roburoc4_requests_begin(&r, &a));
        bool used = false;
        for (std::uint64_t i = 0; i < 20; i++) {
            const slot *s = roburoc4_requests_due(&r, 100, begin_us + i * second, &given_up);
            EXPECT_NE(nullptr, s);
            used = used || (s != nullptr && s->id == ROBUROC4_HEADER_MANUAL);
        }
        return used;
    };
    EXPECT_TRUE(uses_it(get_directory));
    for (const std::uint8_t tries : std::array<std::uint8_t, 2>{REQUEST_FOREVER, 100}) {
        ask battery = get(4);
        battery.max_tries = tries;
        EXPECT_FALSE(uses_it(battery));
        ask text{0, 1, ROBUROC4_ACTION_QUERY, ROBUROC4_SERVICE_DIRECTORY, 4, tries};
        EXPECT_FALSE(uses_it(text));
    }
    ask probe = get_directory;
    probe.max_tries = 100;
    EXPECT_FALSE(uses_it(probe)) << "that the robot is there is known";
}

TEST(Requests, ThatWereNotSentMatchNothingAndAreDueNow) {
    requests r{};
    const ask a = get(2);
    ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
    EXPECT_EQ(0U, roburoc4_requests_deadline(&r));
    const std::array<std::uint8_t, 5> answer{0, ROBUROC4_ACTION_GET, 2, 0, 0};
    EXPECT_EQ(nullptr, roburoc4_requests_match(&r, answer.data(), answer.size(), begin_us));
    slot *given_up = nullptr;
    ASSERT_NE(nullptr, roburoc4_requests_due(&r, 100, begin_us, &given_up));
    EXPECT_EQ(begin_us + 100 * ms, roburoc4_requests_deadline(&r));
}

TEST(Requests, AShortDatagramThatIsNoErrorBelongsToNone) {
    requests r{};
    slot *given_up = nullptr;
    ASSERT_TRUE(roburoc4_requests_begin(&r, &get_directory));
    const slot *open = roburoc4_requests_due(&r, 100, begin_us, &given_up);
    ASSERT_NE(nullptr, open);
    const std::array<std::uint8_t, 4> cut{ROBUROC4_HEADER_MANUAL, ROBUROC4_ACTION_GET, 0, 0};
    for (int i = 0; i < 5; i++)
        EXPECT_EQ(nullptr, roburoc4_requests_match(&r, cut.data(), cut.size(), begin_us));
    EXPECT_EQ(0, r.fixed_id);
    const std::array<std::uint8_t, 4> own{open->id, ROBUROC4_ACTION_GET, 0, 0};
    EXPECT_EQ(nullptr, roburoc4_requests_match(&r, own.data(), own.size(), begin_us));
    const std::array<std::uint8_t, 1> error{ROBUROC4_HEADER_ERROR};
    EXPECT_EQ(open, roburoc4_requests_match(&r, error.data(), error.size(), begin_us));
}

/* Also on a clock that has just begun. */
TEST(Requests, AnErrorThatFitsSeveralEndsTheOneThatHasWaitedLongest) {
    for (std::size_t longest = 0; longest < std::size(requests{}.slots); longest++) {
        for (std::uint64_t sent_us = 0; sent_us < 4; sent_us++) {
            requests r{};
            for (std::uint8_t i = 0; i < 4; i++) {
                r.slots[i] = {get(2), 1, static_cast<std::uint8_t>(i + 2), 1, 0, 100000, 0};
                r.slots[i].sent_us = i == longest ? sent_us : 10 + i;
            }
            const std::array<std::uint8_t, 1> error{ROBUROC4_HEADER_ERROR};
            EXPECT_EQ(&r.slots[longest],
                      roburoc4_requests_match(&r, error.data(), error.size(), 20))
                << longest << " " << sent_us;
        }
    }
}

/* Also on a clock that has just begun. */
TEST(Requests, WithOneIdForAllWaitForLateAnswersOfTheLast) {
    for (const std::uint64_t start_us : {std::uint64_t{0}, begin_us}) {
        SCOPED_TRACE(start_us);
        requests r{};
        r.fixed_id = 1;
        slot *given_up = nullptr;
        const ask a = get(2);
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        slot *s = roburoc4_requests_due(&r, 10, start_us, &given_up);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(ROBUROC4_HEADER_MANUAL, s->id);
        roburoc4_requests_close(&r, s, start_us);
        EXPECT_TRUE(roburoc4_requests_free(&r, 0)) << "of a single try no answer is late";
        EXPECT_EQ(UINT64_MAX, roburoc4_requests_deadline(&r));

        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        ASSERT_EQ(s, roburoc4_requests_due(&r, 10, start_us, &given_up));
        ASSERT_EQ(s, roburoc4_requests_due(&r, 10, start_us + 10 * ms, &given_up)) << "second try";
        EXPECT_EQ(ROBUROC4_HEADER_MANUAL, s->id);
        roburoc4_requests_close(&r, s, start_us + 20 * ms);
        for (const std::uint64_t wait_us : {20 * ms, 40 * ms, 120 * ms - 1}) {
            EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 10, start_us + wait_us, &given_up));
            EXPECT_FALSE(roburoc4_requests_free(&r, 0)) << wait_us;
            EXPECT_EQ(start_us + 120 * ms, roburoc4_requests_deadline(&r));
        }
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        EXPECT_EQ(0U, roburoc4_requests_deadline(&r)) << "what is open counts";
        roburoc4_requests_cancel_all(&r);
        EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 10, start_us + 120 * ms, &given_up));
        EXPECT_TRUE(roburoc4_requests_free(&r, 0));
        EXPECT_EQ(UINT64_MAX, roburoc4_requests_deadline(&r));
    }
}

/* Once a directory came for 0x01, what was tried three times or more is tried with it, too. */
TEST(Requests, UseTheManualIdWhereNoOtherWasEverAnswered) {
    for (std::uint64_t begun = 0; begun < 6; begun++) {
        requests r{};
        slot *given_up = nullptr;
        ask other = get(2);
        other.max_tries = 20;
        const slot *directory = nullptr;
        ASSERT_TRUE(roburoc4_requests_begin(&r, &get_directory));
        for (std::uint64_t i = 0; i < 6; i++) {
            if (i == begun) {
                ASSERT_TRUE(roburoc4_requests_begin(&r, &other));
            }
            while (const slot *s =
                       roburoc4_requests_due(&r, 100, begin_us + i * second, &given_up)) {
                directory = s->ask.kind == 0 ? s : directory;
                EXPECT_EQ(s == directory && i == 5, s->id == ROBUROC4_HEADER_MANUAL) << i;
            }
        }
        const std::array<std::uint8_t, 5> answer{ROBUROC4_HEADER_MANUAL, 0, 0, 0, 0};
        slot *answered =
            roburoc4_requests_match(&r, answer.data(), answer.size(), begin_us + 5 * second);
        ASSERT_EQ(directory, answered);
        roburoc4_requests_close(&r, answered, begin_us + 5 * second);
        std::uint64_t tries = 6 - begun;
        for (std::uint64_t i = 6; i < 10; i++, tries++) {
            const slot *s = roburoc4_requests_due(&r, 100, begin_us + i * second, &given_up);
            ASSERT_NE(nullptr, s);
            EXPECT_EQ(tries >= 3, s->id == ROBUROC4_HEADER_MANUAL) << begun << " " << i;
            EXPECT_EQ(tries >= 3, r.fixed_id == 1);
            EXPECT_EQ(r.fixed_id, r.announce);
        }
    }
}

/* Of any length; of several answers to one try one counts; of what is open only this is kept. */
TEST(Requests, ThreeTriesThatSawOnlyTheManualIdLeadToFixedId) {
    for (const std::size_t size : {std::size_t{5}, std::size_t{6}, std::size_t{60}}) {
        requests r{};
        slot *given_up = nullptr;
        const ask other = get(2);
        const ask asked = get(3);
        ASSERT_TRUE(roburoc4_requests_begin(&r, &other));
        ASSERT_TRUE(roburoc4_requests_begin(&r, &asked));
        std::array<std::uint8_t, 60> answer{ROBUROC4_HEADER_MANUAL, ROBUROC4_ACTION_GET, 3, 0, 0};
        for (std::uint64_t i = 0; i < 3; i++) {
            const std::uint64_t now_us = begin_us + i * 200 * ms;
            EXPECT_EQ(nullptr, roburoc4_requests_match(&r, answer.data(), size, now_us)) << i;
            for (int both = 0; both < 2; both++)
                ASSERT_NE(nullptr, roburoc4_requests_due(&r, 100, now_us, &given_up));
            for (int again = 0; i < 2 && again < 5; again++)
                EXPECT_EQ(nullptr, roburoc4_requests_match(&r, answer.data(), size, now_us)) << i;
        }
        EXPECT_EQ(0, r.fixed_id);
        const slot before = r.slots[1];
        slot *s = roburoc4_requests_match(&r, answer.data(), size, begin_us + second);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(0, std::memcmp(&asked, &s->ask, sizeof asked));
        EXPECT_EQ(before.sent_us, s->sent_us) << "of the round trip";
        EXPECT_EQ(1, r.fixed_id);
        EXPECT_EQ(1, r.announce);
        EXPECT_TRUE(roburoc4_requests_open(&r, &asked));
        EXPECT_FALSE(roburoc4_requests_open(&r, &other));
        EXPECT_FALSE(roburoc4_requests_free(&r, 0));
        roburoc4_requests_cancel_all(&r);
        EXPECT_TRUE(roburoc4_requests_free(&r, 0));
    }
}

TEST(Requests, AnswersWithAnyOtherIdThanTheManualsLeadToNoFixedId) {
    for (int id = 2; id < 256; id++) {
        requests r{};
        slot *given_up = nullptr;
        ask a = get(2);
        a.max_tries = 10;
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        for (std::uint64_t i = 0; i < 5; i++) {
            slot *s = roburoc4_requests_due(&r, 100, begin_us + i * second, &given_up);
            ASSERT_NE(nullptr, s);
            const std::array<std::uint8_t, 5> late{static_cast<std::uint8_t>(id),
                                                   ROBUROC4_ACTION_GET, 2, 0, 0};
            EXPECT_EQ(s->id == id ? s : nullptr,
                      roburoc4_requests_match(&r, late.data(), late.size(), begin_us + i * second));
        }
        EXPECT_EQ(0, r.fixed_id) << id;
    }
}

TEST(Requests, ThatAreClearedLeaveNothingButWhatLaterOnesNeed) {
    for (std::uint8_t suspect = 0; suspect < 3; suspect++) {
        requests r;
        std::memset(&r, 0xA5, sizeof r);
        r.suspect = suspect;
        requests wanted{};
        wanted.last_id = 0xA5;
        wanted.suspect = suspect == 2 ? 2 : 0;
        roburoc4_requests_clear(&r);
        EXPECT_EQ(0, std::memcmp(&wanted, &r, sizeof r)) << int{suspect};
    }
}

TEST(Requests, AreAllDueAtOnceAfterAFaultOfTheClock) {
    requests r{};
    slot *given_up = nullptr;
    ASSERT_NO_FATAL_FAILURE(send_each(r, 6));
    EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 100, begin_us, &given_up));
    const std::uint64_t earlier_us = begin_us - 50 * second;
    roburoc4_requests_rebase(&r, earlier_us);
    for (std::size_t only = 0; only < std::size(r.slots); only++) {
        requests alone = r;
        roburoc4_requests_cancel_all(&alone);
        alone.slots[only].open = 1;
        EXPECT_LE(roburoc4_requests_deadline(&alone), earlier_us) << only;
    }
    for (std::uint8_t kind = 2; kind < 6; kind++) {
        const slot *s = roburoc4_requests_due(&r, 100, earlier_us, &given_up);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(kind, s->ask.kind);
        EXPECT_EQ(2, s->tries) << "what was asked before counts";
    }
    EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 100, earlier_us, &given_up));
    EXPECT_EQ(earlier_us + 200 * ms, roburoc4_requests_deadline(&r));
    r.fixed_id = 1;
    roburoc4_requests_cancel_all(&r);
    roburoc4_requests_close(&r, &r.slots[0], earlier_us);
    ASSERT_FALSE(roburoc4_requests_free(&r, 0));
    roburoc4_requests_rebase(&r, earlier_us - second);
    EXPECT_TRUE(roburoc4_requests_free(&r, 0)) << "nor is a late answer waited for";
}

TEST(Requests, AreDueWhenTheSoonestIsWhereverItStands) {
    for (std::size_t soonest = 0; soonest < std::size(requests{}.slots); soonest++) {
        requests r{};
        for (std::size_t i = 0; i < std::size(r.slots); i++) {
            r.slots[i].open = 1;
            r.slots[i].tries = 1;
            r.slots[i].sent_us = 5000000;
            r.slots[i].wait_us = i == soonest ? 100000 : 200000;
        }
        EXPECT_EQ(5100000U, roburoc4_requests_deadline(&r)) << soonest;
    }
}
