/* SPDX-License-Identifier: MIT
 *
 * How long texts wait (and in fixed-id mode all requests) so that no late answer is taken for that
 * to another request: requests.c alone, with drawn answers.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

extern "C" {
#include "../../src/machines.h"
}

namespace {

constexpr std::uint32_t kErrorMs = 700; /* after an error that does not name its request */
constexpr std::uint32_t kTextMs = 250;  /* after each text, at least */
constexpr std::uint32_t kLongestMs = 5000;

struct Machine {
    requests r{};
    std::uint32_t now_us;

    explicit Machine(bool fixed_id, std::uint32_t start_us = 0xFFFF0000U) : now_us(start_us) {
        r.fixed_id = fixed_id;
        r.last_id = 50;
    }
    void pass_ms(std::uint32_t ms) {
        now_us += ms * MS;
    }
    slot *look() {
        timer t{now_us, UINT32_MAX};
        slot *given_up = nullptr;
        return roburoc4_requests_due(&r, 100, 0, &t, &given_up);
    }
    static ask text(std::uint8_t list, std::uint16_t index = 0) {
        return {ROBUROC4_SERVICE_IOCARD, index, ROBUROC4_ACTION_QUERY,
                ROBUROC4_SERVICE_IOCARD, list,  10};
    }
    static ask other(std::uint8_t max_tries = 5) {
        return {ROBUROC4_SERVICE_BATTERY, 0, ROBUROC4_ACTION_GET,
                ROBUROC4_SERVICE_BATTERY, 0, max_tries};
    }
    /* A request that is open since `took_ms`, and its try. */
    slot *open(std::uint32_t at, const ask &a, std::uint32_t took_ms, std::uint8_t tries = 1,
               std::uint32_t wait_ms = 100) {
        slot *s = &r.slots[at];
        *s = {};
        s->ask = a;
        s->open = 1;
        s->id = static_cast<std::uint8_t>(in_fixed_id_mode(&r) ? 1 : 20 + at);
        s->tries = tries;
        s->sent_us = now_us - took_ms * MS;
        s->wait_us = wait_ms * MS;
        return s;
    }
    slot *hear(std::initializer_list<std::uint8_t> bytes) {
        return roburoc4_requests_match(&r, bytes.begin(), bytes.size(), now_us);
    }
    /* How long texts, or all requests, wait from now on; no request may be open. */
    std::uint32_t waits_ms(bool all = false) const {
        for (std::uint32_t ms = 0; ms < 20000; ms++) {
            Machine later = *this;
            later.pass_ms(ms);
            later.look();
            if (all ? roburoc4_requests_has_room(&later.r, 0)
                    : roburoc4_requests_has_room_for_text(&later.r)) {
                return ms;
            }
        }
        return UINT32_MAX;
    }
};

/* As an answer to another try of the request may still come. */
std::uint32_t after_tries_ms(std::uint32_t took_ms, std::uint32_t tries, std::uint32_t wait_ms) {
    const std::uint32_t least_ms = std::min<std::uint32_t>(wait_ms, 1000);
    return tries < 2 ? kErrorMs : took_ms > least_ms ? std::min(took_ms, kLongestMs) : least_ms;
}

TEST(QuietTimes, LastUntilTheLatestAnswerThatMayStillCome) {
    for (std::uint32_t seed = 1; seed <= 300; seed++) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        const auto draw = [&](std::uint32_t below) {
            return static_cast<std::uint32_t>(random() % below);
        };
        Machine m(true, static_cast<std::uint32_t>(random()));
        std::uint32_t texts_left_ms = 0, all_left_ms = 0, slowest_ms = 0;
        const auto texts_wait = [&](std::uint32_t ms) {
            texts_left_ms = std::max(texts_left_ms, ms);
        };
        const auto all_wait = [&](std::uint32_t ms) {
            texts_wait(ms);
            all_left_ms = std::max(all_left_ms, ms);
        };
        const auto answered = [&](std::uint32_t took_ms) {
            slowest_ms = std::max(std::min(took_ms, kLongestMs / 2) + 1, slowest_ms * 7 / 8);
        };
        for (int step = 0; step < 12; step++) {
            const std::uint32_t took_ms = draw(4) == 0 ? draw(9000) : draw(300);
            const std::uint8_t tries = static_cast<std::uint8_t>(1 + draw(3));
            const std::uint32_t wait_ms = 50 + draw(2000);
            switch (draw(4)) {
            case 0: /* a text of a channel */
                roburoc4_requests_close(
                    &m.r, m.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), took_ms, tries),
                    m.now_us);
                answered(took_ms);
                texts_wait(std::max(kTextMs, 2 * slowest_ms));
                break;
            case 1: { /* the answer to a request with so many tries, or to the first one */
                const bool connecting = draw(2) == 0;
                const ask a = Machine::other(connecting ? REQUEST_FOREVER : 5);
                roburoc4_requests_close(&m.r, m.open(0, a, took_ms, tries, wait_ms), m.now_us);
                if (!connecting) {
                    answered(took_ms);
                }
                if (tries > 1) {
                    all_wait(after_tries_ms(took_ms, tries, wait_ms));
                }
                break;
            }
            case 2:
                roburoc4_requests_be_quiet(&m.r, nullptr, m.now_us);
                all_wait(kErrorMs);
                break;
            default: {
                const std::uint32_t ms = draw(800);
                m.pass_ms(ms);
                if (draw(2) == 0) {
                    m.look();
                }
                texts_left_ms -= std::min(texts_left_ms, ms);
                all_left_ms -= std::min(all_left_ms, ms);
            }
            }
            const std::uint32_t all_ms = m.waits_ms(true);
            ASSERT_EQ(m.waits_ms(), texts_left_ms) << step;
            ASSERT_GE(all_ms, all_left_ms) << step;
            ASSERT_LE(all_ms, texts_left_ms) << step;
            if (all_left_ms == 0 && texts_left_ms == 0) {
                ASSERT_EQ(all_ms, 0u) << step;
            }
        }
    }
}

TEST(QuietTimes, OfTextsAloneDelayNothingElse) {
    Machine m(true);
    roburoc4_requests_close(&m.r, m.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), 10),
                            m.now_us);
    EXPECT_EQ(m.waits_ms(), kTextMs);
    EXPECT_EQ(m.waits_ms(true), 0u);
}

TEST(QuietTimes, OfTheDirectorysTextsAreThoseOfOtherRequests) {
    Machine m(true);
    roburoc4_requests_close(&m.r, m.open(0, Machine::text(LIST_DIRECTORY), 10), m.now_us);
    EXPECT_EQ(m.waits_ms(), 0u);
    roburoc4_requests_close(&m.r, m.open(0, Machine::text(LIST_DIRECTORY), 900, 2), m.now_us);
    EXPECT_EQ(m.waits_ms(true), 900u);
}

TEST(QuietTimes, AreNotNeededWhereAnswersNameTheirRequests) {
    Machine m(false);
    roburoc4_requests_close(&m.r, m.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), 10, 3),
                            m.now_us);
    roburoc4_requests_close(&m.r, m.open(0, Machine::other(), 900, 3), m.now_us);
    m.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), 10);
    roburoc4_requests_cancel_all(&m.r, m.now_us);
    EXPECT_EQ(m.waits_ms(), 0u);
}

TEST(QuietTimes, BeginAgainWithEachLateCopy) {
    Machine m(true);
    roburoc4_requests_be_quiet(&m.r, nullptr, m.now_us);
    m.pass_ms(500);
    EXPECT_EQ(m.hear({1, ROBUROC4_ACTION_GET, 4, 0, 0}), nullptr);
    EXPECT_EQ(m.waits_ms(true), kErrorMs);
    Machine texts(true);
    roburoc4_requests_close(&texts.r, texts.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), 10),
                            texts.now_us);
    texts.pass_ms(100);
    EXPECT_EQ(texts.hear({1, ROBUROC4_ACTION_GET, 4, 0, 0}), nullptr);
    EXPECT_EQ(texts.waits_ms(), kTextMs - 100) << "it was no text";
    EXPECT_EQ(texts.hear({1, ROBUROC4_ACTION_QUERY, 2, 0, 0}), nullptr);
    EXPECT_EQ(texts.waits_ms(), kErrorMs);
    EXPECT_EQ(texts.waits_ms(true), 0u);
    texts.pass_ms(300);
    EXPECT_EQ(texts.hear({0}), nullptr);
    EXPECT_EQ(texts.waits_ms(), kErrorMs) << "it may be about a text";
    Machine rested(true);
    EXPECT_EQ(rested.hear({1, ROBUROC4_ACTION_QUERY, 2, 0, 0}), nullptr);
    EXPECT_EQ(rested.waits_ms(), 0u);
}

TEST(QuietTimes, FollowATextThatIsGivenUpOrCancelled) {
    for (const bool fixed_id : {false, true}) {
        Machine m(fixed_id);
        m.r.single_texts = !fixed_id;
        m.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), 60000, 10);
        EXPECT_EQ(m.look(), nullptr);
        EXPECT_EQ(m.r.slots[0].open, 0);
        EXPECT_EQ(m.waits_ms(), fixed_id ? kErrorMs : kLongestMs);
        Machine cancelled(fixed_id);
        cancelled.r.single_texts = !fixed_id;
        cancelled.open(1, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), 10);
        roburoc4_requests_cancel_all(&cancelled.r, cancelled.now_us);
        EXPECT_EQ(cancelled.waits_ms(), fixed_id ? kErrorMs : kLongestMs);
        Machine others(fixed_id);
        others.open(1, Machine::other(), 10);
        roburoc4_requests_cancel_all(&others.r, others.now_us);
        EXPECT_EQ(others.waits_ms(), 0u) << fixed_id;
    }
}

TEST(QuietTimes, FollowTheTextsOfTheListsThatAreCancelled) {
    Machine m(false);
    m.open(0, Machine::text(ROBUROC4_IO_ANALOG_INPUT), 2000, 3);
    m.open(1, Machine::text(LIST_DIRECTORY), 10);
    m.open(2, Machine::other(), 10);
    roburoc4_requests_cancel_texts(&m.r, LIST_DIRECTORY, m.now_us);
    EXPECT_EQ(m.r.slots[0].open, 0);
    EXPECT_EQ(m.r.slots[1].open, 1) << "the directory's are others";
    EXPECT_EQ(m.r.slots[2].open, 1);
    roburoc4_requests_cancel(&m.r, ROBUROC4_ACTION_QUERY, ROBUROC4_SERVICE_IOCARD, m.now_us);
    roburoc4_requests_cancel(&m.r, ROBUROC4_ACTION_GET, ROBUROC4_SERVICE_BATTERY, m.now_us);
    EXPECT_EQ(m.waits_ms(), 2000u) << "as long as its answer took";
}

TEST(QuietTimes, BeginAgainWithAClockFaultThatMakesRequestsDue) {
    Machine m(true);
    roburoc4_requests_be_quiet(&m.r, nullptr, m.now_us);
    m.pass_ms(kErrorMs - 1);
    slot *s = m.open(2, Machine::other(), 10, 1, 500);
    m.now_us -= 5000 * MS;
    m.r.quiet_since_us = m.now_us; /* as the client does with all that is timed */
    roburoc4_requests_rebase(&m.r, m.now_us);
    s->open = 0;
    EXPECT_EQ(m.waits_ms(true), kErrorMs) << "late answers are still to come";
    s->open = 1;
    EXPECT_EQ(m.look(), s);
}

TEST(QuietTimes, OfOneTextAtATimeFollowTheSlowest) {
    Machine m(false);
    m.r.single_texts = 1;
    EXPECT_TRUE(roburoc4_requests_has_room_for_text(&m.r));
    slot *s = m.open(0, Machine::other(), 10);
    EXPECT_FALSE(roburoc4_requests_has_room_for_text(&m.r)) << "an error may be about either";
    s->open = 0;
    roburoc4_requests_close(&m.r, m.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), 799),
                            m.now_us);
    s = m.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT, 1), 10);
    EXPECT_EQ(m.hear({0, ROBUROC4_ACTION_QUERY, 2, 0, 1}), s);
    s->open = 0;
    EXPECT_EQ(m.waits_ms(), 1400u) << "of 800 ms an eighth is forgotten";
}

TEST(QuietTimes, FollowAnErrorThatMayRefuseAText) {
    Machine several(false);
    several.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT, 1), 10);
    several.open(1, Machine::text(ROBUROC4_IO_DIGITAL_INPUT, 2), 20);
    EXPECT_EQ(several.hear({0, ROBUROC4_ACTION_QUERY, 2, 0, 1}), nullptr) << "which?";
    EXPECT_EQ(several.r.slots[0].open + several.r.slots[1].open, 0);
    EXPECT_EQ(several.r.single_texts, 1);
    EXPECT_EQ(several.waits_ms(), kLongestMs) << "a slow text may be refused, too";
    Machine first(false);
    first.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT, 1), 10);
    EXPECT_EQ(first.hear({0, ROBUROC4_ACTION_QUERY, 2, 0, 1}), nullptr)
        << "it may be about a text that was requested before";
    EXPECT_EQ(first.r.slots[0].open, 0);
    EXPECT_EQ(first.r.single_texts, 1);
    Machine either(false);
    either.r.single_texts = 1;
    either.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT, 1), 20);
    either.open(1, Machine::other(), 10);
    EXPECT_EQ(either.hear({0}), nullptr);
    EXPECT_EQ(either.r.slots[0].open, 0);
    EXPECT_EQ(either.r.slots[1].open, 1);
    Machine one(false);
    one.r.single_texts = 1;
    slot *s = one.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT, 1), 600);
    EXPECT_EQ(one.hear({0, ROBUROC4_ACTION_QUERY, 2, 0, 1}), s);
    s->open = 0;
    EXPECT_EQ(one.waits_ms(), 2 * 601u) << "twice as long as the slowest answer took";
    Machine named(false);
    s = named.open(0, Machine::other(), 10);
    EXPECT_EQ(named.hear({0, ROBUROC4_ACTION_GET, 4, 0, 1}), s);
    s->open = 0;
    EXPECT_EQ(named.waits_ms(), 0u) << "it refuses no text";
    s = named.open(0, Machine::other(), 10);
    EXPECT_EQ(named.hear({0, ROBUROC4_ACTION_GET}), s);
    s->open = 0;
    EXPECT_EQ(named.waits_ms(), kErrorMs) << "it may be of a text";
}

TEST(QuietTimes, FollowARequestThatIsAbandonedWhereErrorsNameNone) {
    Machine m(false);
    m.r.single_texts = 1;
    slot *pose = m.open(0, Machine::other(), 20);
    m.open(1, Machine::text(ROBUROC4_IO_DIGITAL_INPUT, 8), 2000);
    roburoc4_requests_abandon(&m.r, pose, m.now_us);
    m.pass_ms(200);
    EXPECT_EQ(m.hear({0}), nullptr) << "it may be about the abandoned request";
    EXPECT_EQ(m.r.slots[1].open, 0);
    EXPECT_EQ(m.waits_ms(), kLongestMs);
    Machine cancelled(false);
    cancelled.r.single_texts = 1;
    cancelled.open(0, Machine::other(), 20);
    roburoc4_requests_cancel(&cancelled.r, ROBUROC4_ACTION_GET, ROBUROC4_SERVICE_BATTERY,
                             cancelled.now_us);
    EXPECT_EQ(cancelled.waits_ms(), kLongestMs);
}

TEST(QuietTimes, AreLongerWhereTextsComeTwice) {
    Machine m(true);
    slot *s = m.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), 10);
    roburoc4_requests_close(&m.r, s, m.now_us);
    m.pass_ms(20);
    EXPECT_EQ(m.hear({1, ROBUROC4_ACTION_QUERY, 2, 0, 0}), nullptr) << "a copy";
    m.pass_ms(2000);
    m.look();
    s = m.open(0, Machine::text(ROBUROC4_IO_DIGITAL_INPUT, 1), 10);
    roburoc4_requests_close(&m.r, s, m.now_us);
    EXPECT_GE(m.waits_ms(), 600u) << "that of this one may come late";
}

TEST(QuietTimes, FollowTheTextsThatAreOpenWhenOnlyOneIdIsAnswered) {
    for (const bool texts : {false, true}) {
        Machine m(false);
        m.open(0, Machine::other(), 10, 3)->ones = 2;
        if (texts) {
            m.open(1, Machine::text(ROBUROC4_IO_DIGITAL_INPUT), 5);
        }
        ASSERT_NE(m.hear({1, ROBUROC4_ACTION_GET, 4, 0, 0}), nullptr);
        EXPECT_EQ(m.r.fixed_id, 1);
        m.r.slots[0].open = 0;
        EXPECT_EQ(m.waits_ms(), texts ? kErrorMs : 0u);
    }
}

} // namespace
