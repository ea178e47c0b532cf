/* SPDX-License-Identifier: MIT
 *
 * Answers that do not name their request: where a robot answers everything with 0x01, or refuses
 * with the header 0x00, one answer too many never gives a wrong [A].
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

bool is_text_answer(const Bytes &bytes) {
    return bytes.size() >= 5 && bytes[0] <= ROBUROC4_HEADER_MANUAL &&
           bytes[1] == ROBUROC4_ACTION_QUERY;
}

/** A robot whose [A] is at `pad`, and that refuses the texts of `refused` (or of all but [A]). */
struct Card {
    const char *name;
    std::uint32_t pad;
    std::set<std::uint32_t> refused;
    bool only_pad;
    bool known; /* the client may believe in [A] at last */
};

/* The manual's table has [A] at 8. */
const Card cards[] = {{"as in the manual", 8, {}, false, true},
                      {"before the table's place", 7, {}, false, false},
                      {"last, the rest refused", 21, {}, true, false},
                      {"behind a refused place", 10, {8, 9}, false, false}};

void set_up(ScriptedRobot &robot, const Card &card) {
    robot.channel_text = [&card](std::uint32_t type, std::uint32_t index) -> std::string {
        return type == ROBUROC4_IO_DIGITAL_INPUT && index == card.pad
                   ? "Game pad A"
                   : "input " + std::to_string(index);
    };
    robot.instead = [&robot, &card](const roburoc4_request &r, std::vector<Bytes> &answers) {
        const auto index = static_cast<std::uint32_t>(r.index);
        const bool input = r.action == ROBUROC4_ACTION_QUERY && r.service == 2 &&
                           r.io_type == ROBUROC4_IO_DIGITAL_INPUT;
        if (!input || index == card.pad || !(card.only_pad || card.refused.count(index) > 0))
            return false;
        const std::uint8_t id = robot.error_header       ? std::uint8_t{0}
                                : robot.always_manual_id ? ROBUROC4_HEADER_MANUAL
                                                         : r.id;
        answers.push_back(plain_answer(id, r.action, r.service, ROBUROC4_ERROR_UNSUPPORTED));
        return true;
    };
}

bool is_text_request(const Bytes &bytes) {
    return bytes[0] != ROBUROC4_HEADER_STATUS && bytes[1] == ROBUROC4_ACTION_QUERY;
}

/** When the second copy of an answer arrives. */
struct Copy {
    int answer;            /* about a text, from 0 */
    std::uint64_t late_us; /* after the first copy */
    std::size_t requests;  /* or, if not 0, while this many requests for texts later is open */
};

/** Duplicate one answer; the client never believes in a wrong [A]. */
void expect_no_wrong_pad(ScriptedRobot &robot, const Card &card, const Copy &copy,
                         std::uint64_t round_trip_us) {
    SCOPED_TRACE(std::string(card.name) + ", answer " + std::to_string(copy.answer) + ", late by " +
                 std::to_string(copy.late_us) + " us or " + std::to_string(copy.requests) +
                 " requests, round trip " + std::to_string(round_trip_us));
    Bench bench(robot);
    int answers = 0;
    std::size_t requests = 0, copied_at = 0;
    std::uint64_t due_us = UINT64_MAX;
    Bytes bytes;
    bench.delay_to_client = [round_trip_us] { return round_trip_us; };
    bench.drop_to_robot = [&](const Bytes &request) {
        requests += is_text_request(request);
        if (copied_at != 0 && requests >= copied_at + copy.requests) {
            due_us = std::min(due_us, bench.now_us);
            copied_at = 0;
        }
        return false;
    };
    bench.drop_to_client = [&](const Bytes &answer) {
        if (is_text_answer(answer) && answers++ == copy.answer) {
            bytes = answer;
            (copy.requests > 0 ? copied_at : due_us) =
                copy.requests > 0 ? requests : bench.now_us + round_trip_us + copy.late_us;
        }
        return false;
    };
    const auto pad = [&] {
        return roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE);
    };
    bool delivered = false;
    bench.start();
    for (int i = 0; i < 12000 && !(delivered && pad() >= 0 && answers > copy.answer + 3); i++) {
        bench.run(bytes.empty() || delivered ? 20 * ms : 1 * ms);
        if (!delivered && bench.now_us >= due_us) {
            bench.receive(bytes);
            delivered = true;
        }
        ASSERT_TRUE(pad() < 0 || pad() == static_cast<roburoc4_result>(card.pad)) << pad();
        if (delivered && !card.known && bench.now_us > 1012 * second)
            break;
    }
    EXPECT_TRUE(delivered);
    if (card.known) {
        EXPECT_EQ(static_cast<roburoc4_result>(card.pad), pad()) << "found at last";
    }
}

const Copy copies_by_time[] = {{0, 0, 0}, {0, 20 * ms, 0}, {0, 260 * ms, 0}, {0, 720 * ms, 0}};
const std::size_t requests_later[] = {1, 2, 5};

/** All times for copies of this answer. */
std::vector<Copy> copies_of(int answer) {
    std::vector<Copy> all;
    for (Copy copy : copies_by_time) {
        copy.answer = answer;
        all.push_back(copy);
    }
    for (const std::size_t later : requests_later)
        all.push_back({answer, 0, later});
    return all;
}

} // namespace

TEST(FixedId, ACopyDoesNotShortenTheWaitAfterASlowAnswer) {
    ScriptedRobot robot;
    robot.always_manual_id = true;
    Ready bench(robot);
    bench.run(60 * second);
    ASSERT_EQ(1, bench.facts().fixed_id);
    bool asked = false;
    robot.instead = [&](const roburoc4_request &r, std::vector<Bytes> &) {
        const bool held = r.action == ROBUROC4_ACTION_GET && r.service == 3;
        asked = asked || held;
        return held;
    };
    ASSERT_TRUE(bench.run_until([&] { return asked; }));
    bench.run(1200 * ms); /* it is requested again meanwhile */
    const Bytes refused =
        plain_answer(ROBUROC4_HEADER_MANUAL, ROBUROC4_ACTION_GET, 3, ROBUROC4_ERROR_UNSUPPORTED);
    EXPECT_EQ(ROBUROC4_OK, bench.receive(refused));
    const std::uint64_t answered_us = bench.now_us;
    bench.run(50 * ms);
    EXPECT_EQ(ROBUROC4_ERR_UNMATCHED, bench.receive(refused));
    robot.requests.clear();
    ASSERT_TRUE(bench.run_until([&] { return !robot.requests.empty(); }));
    EXPECT_GE(bench.now_us, answered_us + 1200 * ms) << "as long as the answer took";
}

TEST(FixedId, OneDuplicatedAnswerNeverGivesAWrongOverride) {
    for (const Card &card : cards)
        for (const std::uint64_t round_trip_us : {2 * ms, 150 * ms})
            for (const int answer : {0, 6, 7, 8, 9, 20})
                for (const Copy &copy : copies_of(answer)) {
                    ScriptedRobot robot;
                    robot.always_manual_id = true;
                    set_up(robot, card);
                    expect_no_wrong_pad(robot, card, copy, round_trip_us);
                }
}

TEST(ErrorHeader, OneDuplicatedRefusalNeverGivesAWrongOverride) {
    const Card last{"last", 21, {}, true, true};
    for (const int answer : {0, 21, 22})
        for (const Copy &copy : copies_of(answer)) {
            ScriptedRobot robot;
            robot.error_header = true;
            set_up(robot, last);
            expect_no_wrong_pad(robot, last, copy, 2 * ms);
        }
}

/** A bad link looks like such a robot: it begins without an answer, at a request's third try. */
TEST(FixedId, FromItsBeginningOnTheOverrideIsKnownOnlyWithItsInput) {
    RobotBench bench;
    int manual_ids = 0;
    bench.robot.channel_text = [](std::uint32_t, std::uint32_t index) {
        return index == 11 ? "Game pad A" : "spare";
    };
    bench.robot.instead = [](const roburoc4_request &r, std::vector<Bytes> &) {
        return r.action == ROBUROC4_ACTION_GET && r.service == 3;
    };
    bench.drop_to_client = [&](const Bytes &answer) {
        if (answer[0] == ROBUROC4_HEADER_STATUS || manual_ids == 0)
            return answer[0] == ROBUROC4_HEADER_MANUAL && ++manual_ids == 1;
        return answer[0] != ROBUROC4_HEADER_MANUAL;
    };
    bench.drop_to_robot = [&bench](const Bytes &request) {
        return bench.state() != ROBUROC4_STATE_CONNECTING && request.size() == 4 &&
               request[2] == 0 && request[0] != ROBUROC4_HEADER_MANUAL;
    };
    bench.start();
    ASSERT_TRUE(bench.run_until([&] { return bench.facts().override_known == 1; }));
    const auto consistent = [&bench] {
        return bench.facts().override_known == 0 ||
               roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE) >= 0;
    };
    ASSERT_TRUE(bench.run_until([&] { return !consistent() || bench.facts().fixed_id == 1; },
                                120 * second));
    EXPECT_TRUE(consistent());
    EXPECT_EQ(1, bench.facts().fixed_id);
}

TEST(FixedId, ARobotThatSendsStatusesIsLostAfterTheConfiguredSilence) {
    ScriptedRobot robot;
    robot.always_manual_id = true;
    Ready bench(robot);
    bench.run(20 * second);
    ASSERT_EQ(1, bench.facts().fixed_id);
    robot.powered = false;
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST, second));
}

TEST(FixedId, TheOverrideIsKnownWithinTenSeconds) {
    for (const std::uint64_t round_trip_us : {1 * ms, 20 * ms, 100 * ms}) {
        ScriptedRobot robot;
        robot.always_manual_id = true;
        Bench bench(robot);
        bench.delay_to_client = [round_trip_us] { return round_trip_us; };
        bench.start();
        EXPECT_TRUE(
            bench.run_until([&] { return bench.facts().override_known == 1; }, 10 * second));
    }
}

TEST(FixedId, OtherRequestsDoNotWaitForTexts) {
    ScriptedRobot robot;
    robot.always_manual_id = true;
    Bench bench(robot);
    bench.delay_to_client = [] { return 5 * ms; };
    bench.start();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 3 * second));
    ASSERT_TRUE(bench.run_until(
        [&] { return robot.requests.back().what.action == ROBUROC4_ACTION_QUERY; }, second));
    bench.run(10 * ms); /* answered; the next text waits */
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_subscribe(&bench.client, ROBUROC4_SERVICE_TELEMETER, 50,
                                                     bench.client_us()));
    bench.pump();
    EXPECT_EQ(ROBUROC4_ACTION_INSERT, robot.requests.back().what.action);
}

TEST(FixedId, ATextIsReadAgainAfterAClockStepButNotForALateOneOfTheDirectory) {
    for (const bool steps : {false, true}) {
        ScriptedRobot robot;
        robot.always_manual_id = true;
        Started bench(robot);
        std::size_t count = 0;
        const auto asked = [&robot, &count] {
            const auto queries = robot.seen(ROBUROC4_ACTION_QUERY, ROBUROC4_SERVICE_IOCARD);
            count = static_cast<std::size_t>(
                std::count_if(queries.begin(), queries.end(), [](const ScriptedRobot::Request &r) {
                    return r.what.io_type == ROBUROC4_IO_DIGITAL_INPUT &&
                           r.what.index == ROBUROC4_DI_PAD_A;
                }));
            return count > 0;
        };
        ASSERT_TRUE(bench.run_until(asked));
        bench.run(10 * ms); /* it was answered */
        EXPECT_EQ(ROBUROC4_ERR_UNMATCHED, bench.receive(encoded([](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_text(b, n, ROBUROC4_HEADER_MANUAL, ROBUROC4_SERVICE_DIRECTORY,
                                        "Battery", 7);
        })));
        bench.skew_us -= static_cast<std::int64_t>(steps ? second : 0); /* nothing dates copies */
        bench.run(20 * second);
        asked();
        EXPECT_EQ(steps ? 2U : 1U, count);
        EXPECT_EQ(ROBUROC4_DI_PAD_A,
                  roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
    }
}

/* ---- one request at a time ---- */

namespace {

/** Answers no other id than 0x01, and only its texts say which service is which: after 0.6 s, or
 *  never. */
struct SlowTexts : LateRobot {
    explicit SlowTexts(bool silent) {
        only_manual_id = always_manual_id = true;
        texts_silent = silent;
        for (ScriptedService &service : services)
            service.type = 0;
    }

  private:
    std::uint64_t late_us(const Bytes &bytes) override {
        return is_text_answer(bytes) ? 600 * ms : 0;
    }
};

} // namespace

TEST(FixedId, ARobotOfWhichNothingIsKnownIsNotLostAgainAndAgain) {
    SlowTexts robot(true);
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(120 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
    robot.powered = false;
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST, 20 * second));
}

TEST(FixedId, ProbesOfASlowRobotLeaveTimeForTexts) {
    SlowTexts robot(false);
    Started bench(robot);
    EXPECT_TRUE(bench.run_until(
        [&] {
            return roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL) == 6;
        },
        40 * second));
    EXPECT_TRUE(bench.run_until([&] { return bench.arm() >= 0; }, 120 * second));
}
