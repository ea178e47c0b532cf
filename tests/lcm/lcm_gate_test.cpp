/* SPDX-License-Identifier: MIT
 *
 * The LCM bridge's gate in virtual time: which commands may reach a robot.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "gate.h"
#include "roburoc4.h"

namespace {

constexpr std::int64_t ms = 1000;
constexpr std::int64_t second = 1000000;
/** Some day of 2026; the clock that never goes back has another zero. */
constexpr std::int64_t epoch = 1790000000 * second;
constexpr std::uint64_t boot = 77 * 1000000ULL;

constexpr gate_robot absent{false, false, ROBUROC4_ERR_NOT_READY};
constexpr gate_robot armed{true, true, 0};
constexpr gate_robot armable{true, false, 0};
constexpr gate_robot overridden{true, false, ROBUROC4_ERR_OVERRIDE};

gate_rules default_rules() {
    gate_rules rules{};
    rules.enabled[GATE_DRIVE] = rules.enabled[GATE_RELOCALIZE] = rules.enabled[GATE_OUTPUT] = true;
    rules.command_timeout_us = 300 * ms;
    rules.max_age_us = 200 * ms;
    return rules;
}

/** A gate, a clock, and a command that would pass. */
class Gate : public testing::Test {
  protected:
    explicit Gate(const gate_rules &rules = default_rules()) : rules_(rules) {
        restart();
        run(second);
    }
    void restart() {
        start_ = now_;
        gate_init(&gate, &rules_, time());
    }
    void run(std::int64_t us) {
        now_ += us;
    }
    [[nodiscard]] gate_time time() const {
        return {boot + static_cast<std::uint64_t>(now_), epoch + now_};
    }
    [[nodiscard]] std::uint64_t us() const {
        return time().us;
    }
    /** A good drive command, sent and arriving now. */
    [[nodiscard]] gate_command command(const char *sender = "planner") const {
        gate_command c{};
        c.kind = GATE_DRIVE;
        c.sender = sender;
        c.sender_length = std::string(sender).size();
        c.utime = time().utime;
        c.arrived_utime = time().utime;
        c.finite = true;
        return c;
    }
    gate_verdict judge(const gate_command &c, const gate_robot &robot = armed) {
        const gate_verdict verdict = gate_judge(&gate, &c, &robot, time(), &lease_us);
        if (verdict == GATE_TAKEN)
            gate_count_taken(&gate, c.kind);
        return verdict;
    }
    /** What the bridge asks on each wake: whether to arm. */
    bool wants_arming(const gate_robot &robot) {
        gate_tick(&gate, &robot, us());
        return gate_wants_arming(&gate, &robot, us());
    }
    /** Send a good command every 50 ms for some time; the verdict of the last. */
    gate_verdict stream(std::int64_t for_us, const gate_robot &robot, bool zero = false) {
        gate_verdict last = GATE_VERDICTS;
        for (std::int64_t at = 0; at < for_us; at += 50 * ms) {
            run(50 * ms);
            gate_command c = command();
            c.zero = zero;
            last = judge(c, robot);
        }
        return last;
    }
    [[nodiscard]] std::string commander() const {
        std::size_t length = 0;
        const char *name = gate_commander(&gate, us(), &length);
        return name == nullptr ? "" : std::string(name, length);
    }

    gate_rules rules_;
    struct gate gate {};
    std::int64_t now_ = 0;
    std::int64_t start_ = 0;
    std::uint32_t lease_us = 0;
};

class GateWithoutAges : public Gate {
  protected:
    GateWithoutAges()
        : Gate([] {
              gate_rules rules = default_rules();
              rules.max_age_us = 0;
              return rules;
          }()) {}
};

} // namespace

/* ------------------------------------------------------------------------------------ form --- */

TEST_F(Gate, TakesAGoodCommandAndCountsItByKind) {
    for (int kind = 0; kind < GATE_KINDS; kind++) {
        gate_command c = command();
        c.kind = static_cast<gate_kind>(kind);
        EXPECT_EQ(GATE_TAKEN, judge(c));
        EXPECT_EQ(1, gate.taken[kind]);
    }
    EXPECT_EQ(0, gate_rejections(&gate));
}

TEST_F(Gate, IsReadOnlyForEveryKindThatIsNotEnabled) {
    for (int kind = 0; kind < GATE_KINDS; kind++) {
        rules_ = default_rules();
        rules_.enabled[kind] = false;
        gate_init(&gate, &rules_, {boot, epoch});
        for (int other = 0; other < GATE_KINDS; other++) {
            gate_command c = command();
            c.kind = static_cast<gate_kind>(other);
            EXPECT_EQ(kind == other ? GATE_DISABLED : GATE_TAKEN, judge(c)) << kind << other;
        }
        EXPECT_EQ(1, gate.rejected[GATE_DISABLED]);
    }
}

TEST_F(Gate, WantsASenderOf1To63Bytes) {
    const std::string longest(GATE_MAX_SENDER, 's');
    const std::string longer(GATE_MAX_SENDER + 1, 's');
    EXPECT_EQ(GATE_SENDER, judge(command("")));
    EXPECT_EQ(GATE_SENDER, judge(command(longer.c_str())));
    EXPECT_EQ(GATE_TAKEN, judge(command(longest.c_str())));
    EXPECT_EQ(longest, commander());
}

TEST_F(Gate, RejectsNaNAndInfinityAndAllUtimesThatAreNone) {
    gate_command c = command();
    c.finite = false;
    EXPECT_EQ(GATE_NOT_FINITE, judge(c));
    for (const std::int64_t utime : {std::int64_t{0}, std::int64_t{-1}, INT64_MIN}) {
        c = command();
        c.utime = utime;
        EXPECT_EQ(GATE_NO_UTIME, judge(c));
    }
}

/* ----------------------------------------------------------------------------------- times --- */

TEST_F(Gate, TakesNothingInTheFirst250Milliseconds) {
    restart();
    for (const std::int64_t at : {0 * ms, 1 * ms, 249 * ms, 250 * ms - 1}) {
        now_ = start_ + at;
        EXPECT_EQ(GATE_STARTING, judge(command())) << at;
    }
    now_ = start_ + 250 * ms;
    EXPECT_EQ(GATE_TAKEN, judge(command()));
    EXPECT_EQ(4, gate.rejected[GATE_STARTING]);
}

TEST_F(Gate, TakesNothingFromBeforeItsStartEvenFromAClockThatIsAhead) {
    /* Commands that another life of the bridge heard, whose sender's clock was ahead by 199 ms. */
    const std::int64_t last_utime = time().utime + 199 * ms;
    restart();
    for (std::int64_t at = 0; at < 2 * second; at += 10 * ms) {
        now_ = start_ + at;
        gate_command c = command();
        c.utime = last_utime;
        EXPECT_NE(GATE_TAKEN, judge(c)) << at;
    }
}

TEST_F(Gate, TakesACommandOfExactlyTheMaximumAgeAndNoneBeyondIt) {
    gate_command c = command();
    c.utime = time().utime - 200 * ms - 1;
    EXPECT_EQ(GATE_TOO_OLD, judge(c));
    c.utime = time().utime - 200 * ms;
    EXPECT_EQ(GATE_TAKEN, judge(c));
    c.utime = time().utime + 200 * ms + 1;
    EXPECT_EQ(GATE_IN_FUTURE, judge(c));
    c.utime = INT64_MAX;
    EXPECT_EQ(GATE_IN_FUTURE, judge(c));
    c.utime = 1;
    EXPECT_EQ(GATE_TOO_OLD, judge(c));
    c.utime = time().utime + 200 * ms;
    EXPECT_EQ(GATE_TAKEN, judge(c));
}

TEST_F(Gate, AClockFarAheadDoesNotLockItsSenderOut) {
    gate_command c = command();
    c.utime += 3600 * second;
    EXPECT_EQ(GATE_IN_FUTURE, judge(c));
    EXPECT_EQ(GATE_TAKEN, judge(command())) << "rejected utimes are not remembered";
}

TEST_F(Gate, TakesEachUtimeOfASenderOnceAndInOrder) {
    gate_command c = command();
    EXPECT_EQ(GATE_TAKEN, judge(c));
    EXPECT_EQ(GATE_REPEATED, judge(c));
    c.utime -= 1;
    EXPECT_EQ(GATE_REPEATED, judge(c));
    c.utime += 2;
    EXPECT_EQ(GATE_TAKEN, judge(c));
    c.kind = GATE_OUTPUT;
    EXPECT_EQ(GATE_TAKEN, judge(c)) << "a planner may command two things at one time";
    EXPECT_EQ(GATE_REPEATED, judge(c));
}

TEST_F(Gate, AReplayRightAfterTheOriginalIsRejectedAlsoWithTheClockAhead) {
    for (const std::int64_t ahead : {0 * ms, 100 * ms, 200 * ms}) {
        std::vector<gate_command> log;
        for (int i = 0; i < 3; i++) {
            run(20 * ms);
            gate_command c = command();
            c.utime += ahead;
            log.push_back(c);
            EXPECT_EQ(GATE_TAKEN, judge(c));
        }
        for (std::int64_t waited = 0; waited < second; waited += 20 * ms) {
            run(20 * ms);
            for (gate_command c : log) {
                c.arrived_utime = time().utime;
                EXPECT_NE(GATE_TAKEN, judge(c)) << ahead << " " << waited;
            }
        }
        run(second);
    }
}

TEST_F(Gate, ARejectedCommandCannotBeReplayedEither) {
    ASSERT_EQ(GATE_TAKEN, judge(command("first")));
    const gate_command c = command("second");
    ASSERT_EQ(GATE_SEAT, judge(c));
    gate.seat_until_us = us();
    EXPECT_EQ(GATE_REPEATED, judge(c));
}

TEST_F(GateWithoutAges, TakesAllAgesButNoRepetition) {
    gate_command c = command();
    c.utime = 5;
    EXPECT_EQ(GATE_TAKEN, judge(c));
    EXPECT_EQ(GATE_REPEATED, judge(c));
    c.utime = INT64_MAX;
    EXPECT_EQ(GATE_TAKEN, judge(c));
    c.utime = 0;
    EXPECT_EQ(GATE_NO_UTIME, judge(c));
}

TEST_F(GateWithoutAges, ForgetsNoSenderWithinAMinuteAndTakesNoMoreThanItCanRemember) {
    for (int i = 0; i < GATE_SENDERS; i++) {
        EXPECT_EQ(GATE_TAKEN, judge(command(("sender " + std::to_string(i)).c_str())));
        run(second);
    }
    EXPECT_EQ(GATE_SENDER, judge(command("one more")));
    EXPECT_EQ(GATE_TAKEN, judge(command("sender 0")));
}

TEST_F(GateWithoutAges, ForgetsTheSenderThatWasSilentForLongestWhereItMust) {
    std::vector<std::string> names;
    std::vector<gate_command> log;
    for (int i = 0; i < GATE_SENDERS; i++)
        names.push_back("sender " + std::to_string(i));
    for (const std::string &name : names) {
        log.push_back(command(name.c_str()));
        EXPECT_EQ(GATE_TAKEN, judge(log.back()));
        run(second);
    }
    EXPECT_EQ(GATE_TAKEN, judge(command("sender 0")));
    run(59 * second);
    EXPECT_EQ(GATE_TAKEN, judge(command("a new program")));
    EXPECT_EQ("a new program", commander());
    run(second);
    log.erase(log.begin() + 1); /* who was silent for longest: its log is as good as new */
    for (gate_command &c : log) {
        c.arrived_utime = time().utime;
        EXPECT_EQ(GATE_REPEATED, judge(c)) << c.sender;
    }
}

TEST_F(GateWithoutAges, ForgetsNobodyWhoHasTheSeat) {
    rules_.command_timeout_us = GATE_MAX_LEASE_US;
    restart();
    run(second);
    for (int i = 0; i < GATE_SENDERS; i++)
        (void)judge(command(("sender " + std::to_string(i)).c_str()));
    EXPECT_EQ("sender 0", commander());
    gate.seat_until_us += 100 * static_cast<std::uint64_t>(second);
    run(61 * second);
    EXPECT_EQ(GATE_SEAT, judge(command("one more")));
    EXPECT_EQ("sender 0", commander());
}

TEST_F(Gate, ForgetsSendersOnceTheirAgeSpeaksAgainstReplays) {
    std::vector<gate_command> log;
    std::vector<std::string> names;
    for (int i = 0; i < 3 * GATE_SENDERS; i++)
        names.push_back("sender " + std::to_string(i));
    for (const std::string &name : names) {
        log.push_back(command(name.c_str()));
        EXPECT_EQ(GATE_TAKEN, judge(log.back())) << name;
        run(301 * ms);
    }
    for (const gate_command &c : log)
        EXPECT_NE(GATE_TAKEN, judge(c));
}

TEST_F(Gate, MoreSendersAtOnceThanItCanRememberAreRejected) {
    for (int i = 0; i < GATE_SENDERS; i++) {
        (void)judge(command(("sender " + std::to_string(i)).c_str()));
        run(1 * ms);
    }
    EXPECT_EQ(GATE_SENDER, judge(command("one more")));
    run(second);
    EXPECT_EQ(GATE_TAKEN, judge(command("one more")));
}

TEST_F(Gate, AClockThatIsSetMakesAllPause) {
    ASSERT_EQ(GATE_TAKEN, judge(command()));
    const gate_time set{us(), epoch - 3600 * second};
    gate_clock_was_set(&gate, set);
    gate_command c = command();
    for (std::int64_t at = 0; at <= 600 * ms; at += 50 * ms) {
        const gate_time now{set.us + static_cast<std::uint64_t>(at), set.utime + at};
        c.utime = c.arrived_utime = now.utime;
        EXPECT_NE(GATE_TAKEN, gate_judge(&gate, &c, &armed, now, &lease_us)) << at;
    }
    const gate_time later{set.us + 1200000, set.utime + 1200000};
    c.utime = c.arrived_utime = later.utime;
    EXPECT_EQ(GATE_TAKEN, gate_judge(&gate, &c, &armed, later, &lease_us))
        << "utimes of the other time are forgotten";
}

/* ----------------------------------------------------------------------------------- lease --- */

TEST_F(Gate, ALeaseIsItsOwnOrTheDefaultAndNeverLonger) {
    const struct {
        std::int32_t asked;
        std::uint32_t given;
    } cases[] = {{0, 300000},      {-1, 300000},       {INT32_MIN, 300000}, {1, 20000},
                 {19999, 20000},   {20000, 20000},     {123456, 123456},    {300000, 300000},
                 {300001, 300000}, {INT32_MAX, 300000}};
    for (const auto &each : cases) {
        gate_command c = command();
        c.lease_us = each.asked;
        EXPECT_EQ(GATE_TAKEN, judge(c));
        EXPECT_EQ(each.given, lease_us) << each.asked;
        run(second);
    }
}

TEST_F(Gate, ALeaseBeginsWhenTheCommandArrives) {
    const gate_command c = command();
    run(120 * ms);
    EXPECT_EQ(GATE_TAKEN, judge(c));
    EXPECT_EQ(180000U, lease_us);
    gate_command late = command();
    late.lease_us = 100 * ms;
    run(80 * ms + 1);
    EXPECT_EQ(GATE_TOO_OLD, judge(late)) << "less is left than a lease can last";
    gate_command from_the_future = command();
    from_the_future.arrived_utime += second;
    EXPECT_EQ(GATE_TAKEN, judge(from_the_future));
    EXPECT_EQ(300000U, lease_us);
}

TEST_F(Gate, TheShortestLeaseIsNotLostWhileItIsRead) {
    for (const std::int32_t asked : {1, 20000, 25000}) {
        gate_command c = command();
        c.lease_us = asked;
        run(9 * ms);
        EXPECT_EQ(GATE_TAKEN, judge(c)) << asked;
        EXPECT_EQ(20000U, lease_us) << asked;
        c = command();
        c.lease_us = asked;
        run(11 * ms);
        EXPECT_EQ(GATE_TOO_OLD, judge(c)) << asked;
        run(second);
    }
}

TEST_F(GateWithoutAges, WhatWaitedLongerThanItsLeaseIsDead) {
    const gate_command c = command();
    run(10 * second);
    EXPECT_EQ(GATE_TOO_OLD, judge(c));
}

/* ------------------------------------------------------------------------------------ seat --- */

TEST_F(Gate, OneCommanderAtATimeUntilItsLeaseHasRunOut) {
    ASSERT_EQ(GATE_TAKEN, judge(command("first")));
    EXPECT_EQ("first", commander());
    run(299 * ms);
    EXPECT_EQ(GATE_SEAT, judge(command("second")));
    EXPECT_EQ(GATE_TAKEN, judge(command("first")));
    run(300 * ms - 1);
    EXPECT_EQ(GATE_SEAT, judge(command("second")));
    run(1);
    EXPECT_EQ("", commander());
    EXPECT_EQ(GATE_TAKEN, judge(command("second")));
    EXPECT_EQ("second", commander());
    EXPECT_EQ(GATE_SEAT, judge(command("first")));
}

TEST_F(Gate, AShortLeaseGivesTheSeatAwaySooner) {
    ASSERT_EQ(GATE_TAKEN, judge(command("first")));
    run(10 * ms);
    gate_command last = command("first");
    last.lease_us = 50 * ms;
    ASSERT_EQ(GATE_TAKEN, judge(last));
    run(50 * ms);
    EXPECT_EQ(GATE_TAKEN, judge(command("second")));
}

TEST_F(Gate, OutputsAndRelocalizationsObeyTheSeatButDoNotShortenIt) {
    ASSERT_EQ(GATE_TAKEN, judge(command("first")));
    for (const gate_kind kind : {GATE_OUTPUT, GATE_RELOCALIZE}) {
        gate_command c = command("second");
        c.kind = kind;
        EXPECT_EQ(GATE_SEAT, judge(c));
        c = command("first");
        c.kind = kind;
        c.lease_us = 20 * ms;
        EXPECT_EQ(GATE_TAKEN, judge(c));
    }
    run(250 * ms);
    EXPECT_EQ(GATE_SEAT, judge(command("second")));
}

TEST_F(Gate, OutputsAndRelocalizationsTakeNoSeat) {
    for (const gate_kind kind : {GATE_OUTPUT, GATE_RELOCALIZE}) {
        gate_command c = command("lamp");
        c.kind = kind;
        EXPECT_EQ(GATE_TAKEN, judge(c));
        EXPECT_EQ("", commander());
    }
    EXPECT_EQ(GATE_TAKEN, judge(command("planner")));
    EXPECT_EQ("planner", commander());
    run(200 * ms);
    gate_command c = command("planner");
    c.kind = GATE_OUTPUT;
    EXPECT_EQ(GATE_TAKEN, judge(c));
    run(100 * ms);
    EXPECT_EQ("", commander()) << "nor do they prolong it";
}

TEST_F(Gate, ARejectedCommandTakesNoSeat) {
    EXPECT_EQ(GATE_DISARMED, judge(command("first"), overridden));
    EXPECT_EQ("", commander());
}

/* ---------------------------------------------------------------------------------- pauses --- */

TEST_F(Gate, AfterADisarmItWaitsUntilAllHavePausedFor500Milliseconds) {
    ASSERT_EQ(GATE_TAKEN, judge(command()));
    gate_armed(&gate);
    gate_hold(&gate, us());
    EXPECT_EQ(GATE_DISARMED, stream(10 * second, armable)) << "who streams on is refused for ever";
    EXPECT_EQ(200, gate.rejected[GATE_DISARMED]);
    run(500 * ms - 1);
    EXPECT_TRUE(gate_is_waiting(&gate, us()));
    run(1);
    EXPECT_FALSE(gate_is_waiting(&gate, us()));
    EXPECT_EQ(GATE_TAKEN, judge(command(), armable)) << "the next command arms again";
}

TEST_F(Gate, ACommandRightBeforeTheEndOfThePauseBeginsItAnew) {
    gate_armed(&gate);
    gate_hold(&gate, us());
    for (int i = 0; i < 5; i++) {
        run(500 * ms - 1);
        EXPECT_EQ(GATE_DISARMED, judge(command(), armable));
    }
    run(500 * ms);
    EXPECT_EQ(GATE_TAKEN, judge(command(), armable));
}

TEST_F(Gate, ZerosCountAsAPauseButAreRefusedDuringIt) {
    gate_armed(&gate);
    gate_hold(&gate, us());
    EXPECT_EQ(GATE_DISARMED, stream(450 * ms, armable, true));
    EXPECT_EQ(GATE_TAKEN, stream(50 * ms, armable, true));
}

TEST_F(Gate, EverySenderMustPauseAlsoOneThatWouldBeRejected) {
    gate_armed(&gate);
    gate_hold(&gate, us());
    const gate_command replayed = command("replay");
    gate_command broken = command("broken");
    broken.finite = false;
    for (int i = 0; i < 10; i++) {
        run(300 * ms);
        EXPECT_NE(GATE_TAKEN, judge(i % 2 == 0 ? replayed : broken, armable));
        EXPECT_TRUE(gate_is_waiting(&gate, us()));
    }
    run(500 * ms);
    EXPECT_EQ(GATE_TAKEN, judge(command(), armable));
}

TEST_F(Gate, OnlyWhoAsksForMotionProlongsAPause) {
    for (int kind = 0; kind < GATE_KINDS; kind++) {
        for (const bool enabled : {true, false}) {
            rules_ = default_rules();
            rules_.enabled[kind] = enabled;
            restart();
            run(second);
            gate_hold(&gate, us());
            for (int i = 0; i < 10; i++) {
                gate_command c = command();
                c.kind = static_cast<gate_kind>(kind);
                EXPECT_NE(GATE_TAKEN, judge(c));
                run(50 * ms);
            }
            EXPECT_EQ(kind == GATE_DRIVE && enabled, gate_is_waiting(&gate, us())) << kind;
        }
    }
}

TEST_F(Gate, AllKindsOfCommandsAreRefusedDuringAPause) {
    gate_armed(&gate);
    gate_hold(&gate, us());
    for (const gate_kind kind : {GATE_OUTPUT, GATE_RELOCALIZE}) {
        gate_command c = command();
        c.kind = kind;
        EXPECT_EQ(GATE_DISARMED, judge(c, armed));
    }
}

TEST_F(Gate, WhoPausesWhileTheRobotIsInOtherHandsMustPauseOnceItIsBack) {
    gate_armed(&gate);
    gate_hold(&gate, us());
    run(2 * second); /* paused while [A] is held or the robot is away ... */
    for (const gate_robot &state : {overridden, absent}) {
        EXPECT_NE(GATE_TAKEN, stream(second, state)) << "... then streams again ...";
        EXPECT_EQ(GATE_DISARMED, stream(second, armable)) << "... and it comes back";
        run(500 * ms);
        EXPECT_EQ(GATE_TAKEN, judge(command(), armable));
    }
}

TEST_F(Gate, ThatIsNotReadyTakesNothingOfAnyKind) {
    for (int kind = 0; kind < GATE_KINDS; kind++) {
        gate_command c = command();
        c.kind = static_cast<gate_kind>(kind);
        EXPECT_EQ(GATE_NOT_READY, judge(c, absent));
    }
    EXPECT_EQ(3, gate.rejected[GATE_NOT_READY]);
}

/* ---------------------------------------------------------------------------------- arming --- */

TEST_F(Gate, ArmsAloneOnceTheRobotIsReadyAndNeverAgain) {
    EXPECT_FALSE(wants_arming(absent));
    EXPECT_TRUE(wants_arming(armable));
    gate_armed(&gate);
    EXPECT_FALSE(wants_arming(armable));
    gate_hold(&gate, us());
    run(10 * second);
    EXPECT_FALSE(wants_arming(armable)) << "after a disarm a command arms";
}

TEST_F(Gate, ArmsNothingWhereDrivingIsNotEnabled) {
    rules_.enabled[GATE_DRIVE] = false;
    restart();
    EXPECT_FALSE(wants_arming(armable));
}

TEST_F(Gate, APlannerThatStreamsBeforeTheRobotIsReadyDrivesOnceItIs) {
    EXPECT_EQ(GATE_NOT_READY, stream(second, absent));
    const gate_robot reading{true, false, ROBUROC4_ERR_STALE_IOCARD};
    EXPECT_FALSE(wants_arming(reading));
    EXPECT_EQ(GATE_DISARMED, stream(100 * ms, reading));
    EXPECT_TRUE(wants_arming(armable));
    EXPECT_EQ(GATE_TAKEN, stream(50 * ms, armed));
}

TEST_F(Gate, ARobotInOtherHandsAtTheStartWaitsForAPause) {
    for (const std::int32_t refusal :
         {ROBUROC4_ERR_OVERRIDE, ROBUROC4_ERR_OTHER_COMMANDER, ROBUROC4_ERR_MOVING}) {
        restart();
        run(second);
        const gate_robot taken{true, false, refusal};
        EXPECT_FALSE(wants_arming(taken));
        EXPECT_NE(GATE_TAKEN, stream(second, taken));
        EXPECT_FALSE(wants_arming(armable));
        EXPECT_EQ(GATE_DISARMED, stream(second, armable));
        run(500 * ms);
        EXPECT_TRUE(wants_arming(armable));
    }
}

TEST_F(Gate, ARobotThatWasAbsentAtTheStartWaitsForAPause) {
    gate_hold(&gate, us()); /* what the bridge does after a second without an answer */
    EXPECT_EQ(GATE_NOT_READY, stream(5 * second, absent));
    EXPECT_FALSE(wants_arming(armable));
    EXPECT_EQ(GATE_DISARMED, stream(second, armable));
    run(500 * ms);
    EXPECT_TRUE(wants_arming(armable)) << "silent: it arms once it is ready";
}

/* ------------------------------------------------------------------------------- a referee --- */

/** Thousands of random commands; books kept otherwise than by the gate say which may not pass. */
TEST_F(Gate, NothingPassesThatAPlainRefereeForbids) {
    std::mt19937 random(5);
    const auto below = [&](std::int64_t n) {
        return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n));
    };
    struct Book {
        std::int64_t utime[GATE_KINDS] = {0, 0, 0};
    } books[4];
    std::int64_t seat_until = -1, noise = -second, passed = 0;
    std::int64_t seat = -1;
    bool hold = false;
    restart();
    for (int step = 0; step < 200000; step++) {
        run(below(60) * ms + below(1000));
        if (below(400) == 0) {
            gate_armed(&gate);
            gate_hold(&gate, us());
            hold = true;
            noise = now_;
            run(below(900) * ms);
        }
        const std::int64_t who = below(50) == 0 ? below(4) : 0;
        const char *const names[] = {"a", "b", "c", "abc"};
        gate_command c = command(names[who]);
        c.kind = static_cast<gate_kind>(below(20) == 0 ? below(GATE_KINDS) : 0);
        c.utime += (below(4) == 0 ? below(900) - 450 : 0) * ms;
        c.arrived_utime -= (below(8) == 0 ? below(400) : below(12)) * ms;
        c.lease_us =
            static_cast<std::int32_t>(below(4) == 0 ? below(40) * ms : below(500) * ms - 100 * ms);
        c.finite = below(50) != 0;
        c.zero = c.kind == GATE_DRIVE && below(3) == 0;
        const gate_robot robot = below(100) == 0 ? absent : armed;
        if (hold && now_ - noise >= 500 * ms)
            hold = false;
        const bool passes = judge(c, robot) == GATE_TAKEN;
        if (passes) {
            passed++;
            ASSERT_TRUE(c.finite && robot.ready && !hold && now_ - start_ >= 250 * ms) << step;
            ASSERT_LE(std::llabs(c.utime - time().utime), 200 * ms);
            ASSERT_GT(c.utime, books[who].utime[c.kind]);
            ASSERT_TRUE(who == seat || now_ >= seat_until) << step;
            ASSERT_GE(lease_us, 20000U);
            const std::int64_t waited = time().utime - c.arrived_utime;
            const std::int64_t asked =
                c.lease_us > 0 ? std::min<std::int64_t>(c.lease_us, 300 * ms) : 300 * ms;
            const std::int64_t read_at_once = waited < 10 * ms ? 20 * ms : 0;
            ASSERT_LE(static_cast<std::int64_t>(lease_us), std::max(asked - waited, read_at_once));
            books[who].utime[c.kind] = c.utime;
            if (c.kind == GATE_DRIVE) {
                seat_until = now_ + lease_us;
                seat = who;
            }
        } else if (c.kind == GATE_DRIVE && !c.zero && (hold || !robot.ready) && !gate.fresh) {
            hold = true;
            noise = now_;
        }
    }
    EXPECT_GT(passed, 10000) << "the walk must not test refusals only";
    EXPECT_EQ(200000, passed + gate_rejections(&gate));
}
