/* SPDX-License-Identifier: MIT
 *
 * The bridges' gate in virtual time: which commands may reach a robot.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "gate.h"
#include "reason.h"
#include "roburoc4.h"

namespace {

constexpr std::int64_t ms = 1000;
constexpr std::int64_t second = 1000000;
/** Some day in 2026; the monotonic clock has another zero. */
constexpr std::int64_t epoch = 1790000000 * second;
constexpr std::uint64_t boot = 77 * 1000000ULL;

/** The kinds that are judged: a stop is always obeyed. */
constexpr int judged_kinds = GATE_STOP;

constexpr gate_robot absent{false, false, ROBUROC4_ERR_NOT_READY};
constexpr gate_robot armed{true, true, 0};
constexpr gate_robot armable{true, false, 0};
constexpr gate_robot overridden{true, false, ROBUROC4_ERR_OVERRIDE};

gate_rules default_rules() {
    gate_rules rules{};
    rules.enabled[GATE_DRIVE] = rules.enabled[GATE_RELOCALIZE] = rules.enabled[GATE_OUTPUT] = true;
    rules.lease_us = 300 * ms;
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
    /** A valid drive command, sent and arriving now. */
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
    /** Send a valid command every 50 ms for some time; returns the last verdict. */
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
    [[nodiscard]] std::string owner() const {
        std::size_t length = 0;
        const char *name = gate_control_owner(&gate, us(), &length);
        return name == nullptr ? "" : std::string(name, length);
    }

    [[nodiscard]] std::int64_t rejections() const {
        return std::accumulate(std::begin(gate.rejected), std::end(gate.rejected), std::int64_t{0});
    }
    void expect_the_sender_in_control_is_remembered() {
        for (int i = 0; i < GATE_SENDERS; i++)
            (void)judge(command(("sender " + std::to_string(i)).c_str()));
        EXPECT_EQ("sender 0", owner());
        gate.control_until_us += 100 * static_cast<std::uint64_t>(second);
        run(61 * second);
        EXPECT_EQ(GATE_CONTROL, judge(command("one more")));
        EXPECT_EQ("sender 0", owner());
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

/** Ages longer than the pause, which would else reject the same commands. */
class GateWithLongAges : public Gate {
  protected:
    GateWithLongAges()
        : Gate([] {
              gate_rules rules = default_rules();
              rules.max_age_us = 2000000;
              return rules;
          }()) {}
};

} // namespace

/* ------------------------------------------------------------------------------------ form --- */

TEST_F(Gate, AcceptsAValidCommandAndCountsItByKind) {
    for (int kind = 0; kind < judged_kinds; kind++) {
        gate_command c = command();
        c.kind = static_cast<gate_kind>(kind);
        EXPECT_EQ(GATE_TAKEN, judge(c));
        EXPECT_EQ(1, gate.taken[kind]);
    }
    EXPECT_EQ(0, rejections());
}

TEST_F(Gate, IsReadOnlyForEveryKindThatIsNotEnabled) {
    for (int kind = 0; kind < judged_kinds; kind++) {
        rules_ = default_rules();
        rules_.enabled[kind] = false;
        gate_init(&gate, &rules_, {boot, epoch - second});
        for (int other = 0; other < judged_kinds; other++) {
            gate_command c = command();
            c.kind = static_cast<gate_kind>(other);
            EXPECT_EQ(kind == other ? GATE_DISABLED : GATE_TAKEN, judge(c)) << kind << other;
        }
        EXPECT_EQ(1, gate.rejected[GATE_DISABLED]);
    }
}

TEST_F(Gate, RequiresASenderOf1To63Bytes) {
    const std::string longest(GATE_MAX_SENDER, 's');
    const std::string longer(GATE_MAX_SENDER + 1, 's');
    EXPECT_EQ(GATE_SENDER, judge(command("")));
    EXPECT_EQ(GATE_SENDER, judge(command(longer.c_str())));
    EXPECT_EQ(GATE_TAKEN, judge(command(longest.c_str())));
    EXPECT_EQ(longest, owner());
}

TEST_F(Gate, RejectsNaNAndInfinityAndInvalidUtimes) {
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

TEST_F(Gate, HoldsAllKindsForAPauseAfterItsStart) {
    for (int kind = 0; kind < judged_kinds; kind++) {
        restart();
        gate_command c = command();
        c.kind = static_cast<gate_kind>(kind);
        c.zero = true;
        for (const std::int64_t at : {200 * ms + 1, 500 * ms - 1}) {
            now_ = start_ + at;
            c.utime = c.arrived_utime = time().utime;
            EXPECT_EQ(GATE_DISARMED, judge(c)) << at;
        }
        run(1);
        c.utime = c.arrived_utime = time().utime;
        EXPECT_EQ(GATE_TAKEN, judge(c));
    }
}

TEST_F(Gate, APlannerThatStreamsSinceBeforeTheStartMustPause) {
    for (const gate_robot &first : {absent, overridden, armable, armed}) {
        restart();
        EXPECT_NE(GATE_TAKEN, stream(2 * second, first));
        EXPECT_EQ(GATE_DISARMED, stream(2 * second, armable));
        EXPECT_FALSE(gate_can_drive(&gate, &armable, us()));
        run(500 * ms);
        EXPECT_TRUE(gate_can_drive(&gate, &armable, us()));
        EXPECT_EQ(GATE_TAKEN, judge(command(), armable));
    }
}

TEST_F(Gate, RejectsCommandsFromBeforeItsStartEvenWithAClockAhead) {
    /* Commands that the bridge received before its restart, of a clock that is 199 ms ahead. */
    const std::int64_t last_utime = time().utime + 199 * ms;
    restart();
    for (std::int64_t at = 0; at < 2 * second; at += 10 * ms) {
        now_ = start_ + at;
        gate_command c = command();
        c.utime = last_utime;
        EXPECT_NE(GATE_TAKEN, judge(c)) << at;
    }
}

TEST_F(GateWithLongAges, RejectsCommandsFromBeforeItsStartAlsoAfterThePause) {
    restart();
    run(600 * ms);
    ASSERT_FALSE(gate_is_waiting(&gate, us()));
    gate_command c = command();
    for (const std::int64_t utime :
         {std::int64_t{-1000000}, std::int64_t{0}, std::int64_t{600000}, std::int64_t{2000000}}) {
        c.utime = gate.start.utime + utime;
        EXPECT_EQ(GATE_STARTING, judge(c))
            << "by a clock that is ahead it is from before: " << utime;
    }
    c.utime = gate.start.utime + 2000001;
    EXPECT_EQ(GATE_TAKEN, judge(c));
}

TEST_F(GateWithLongAges, RejectsCommandsFromBeforeTheClockWasSetAlsoAfterThePause) {
    gate_time now{us(), epoch + 7200 * second};
    EXPECT_NE(0, gate_look_at_clock(&gate, now));
    now.us += 600000;
    now.utime += 600000;
    gate_command c = command();
    c.utime = c.arrived_utime = now.utime;
    EXPECT_EQ(GATE_STARTING, gate_judge(&gate, &c, &armed, now, &lease_us));
    now.us += 1400001;
    now.utime += 1400001;
    c.utime = c.arrived_utime = now.utime;
    EXPECT_EQ(GATE_TAKEN, gate_judge(&gate, &c, &armed, now, &lease_us));
}

TEST_F(Gate, AcceptsExactlyTheMaximumAgeAndNothingOlder) {
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

TEST_F(Gate, AcceptsEachUtimeOfASenderOnceAndInOrder) {
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

TEST_F(Gate, AReplayIsRejectedAlsoWithTheClockAhead) {
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
    ASSERT_EQ(GATE_CONTROL, judge(c));
    gate.control_until_us = us();
    EXPECT_EQ(GATE_REPEATED, judge(c));
}

TEST_F(GateWithoutAges, AcceptsAllAgesButNoRepetition) {
    gate_command c = command();
    c.utime = 5;
    EXPECT_EQ(GATE_TAKEN, judge(c));
    EXPECT_EQ(GATE_REPEATED, judge(c));
    c.utime = INT64_MAX;
    EXPECT_EQ(GATE_TAKEN, judge(c));
    c.utime = 0;
    EXPECT_EQ(GATE_NO_UTIME, judge(c));
}

TEST_F(GateWithoutAges, RemembersEachSenderForAMinute) {
    for (int i = 0; i < GATE_SENDERS; i++) {
        EXPECT_EQ(GATE_TAKEN, judge(command(("sender " + std::to_string(i)).c_str())));
        run(second);
    }
    EXPECT_EQ(GATE_SENDER, judge(command("one more")));
    EXPECT_EQ(GATE_TAKEN, judge(command("sender 0")));
}

TEST_F(GateWithoutAges, ForgetsTheSenderThatWasSilentLongest) {
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
    gate_command new_one = command("a new program");
    new_one.utime = 5;
    EXPECT_EQ(GATE_TAKEN, judge(new_one)) << "it has no earlier utime";
    EXPECT_EQ("a new program", owner());
    run(second);
    log.erase(log.begin() + 1); /* the sender that was silent for longest: its log counts as new */
    for (gate_command &c : log) {
        c.arrived_utime = time().utime;
        EXPECT_EQ(GATE_REPEATED, judge(c)) << c.sender;
    }
}

TEST_F(GateWithoutAges, DoesNotForgetTheSenderInControl) {
    rules_.lease_us = ROBUROC4_MAX_LEASE_US;
    restart();
    run(second);
    expect_the_sender_in_control_is_remembered();
}

TEST_F(Gate, DoesNotForgetTheSenderInControl) {
    expect_the_sender_in_control_is_remembered();
}

TEST_F(Gate, ForgetsSendersOnceTheirReplaysAreTooOld) {
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

TEST_F(Gate, RemembersASenderOfAnyKindAsLongAsAReplayMayHaveTheAge) {
    for (const gate_kind kind : {GATE_DRIVE, GATE_RELOCALIZE, GATE_OUTPUT}) {
        run(second);
        gate_command first = command("sender 0");
        first.kind = kind;
        EXPECT_EQ(GATE_TAKEN, judge(first));
        run(200 * ms);
        for (int i = 1; i <= GATE_SENDERS; i++) {
            const std::string name = "sender " + std::to_string(i);
            gate_command c = command(name.c_str());
            c.zero = true;
            (void)judge(c);
        }
        EXPECT_EQ(GATE_REPEATED, judge(first)) << kind;
    }
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

TEST_F(Gate, AfterTheClockIsSetAllMustPause) {
    ASSERT_EQ(GATE_TAKEN, judge(command()));
    const gate_time set{us(), epoch - 3600 * second};
    EXPECT_NE(0, gate_look_at_clock(&gate, set));
    std::size_t length = 0;
    EXPECT_EQ(nullptr, gate_control_owner(&gate, us(), &length)) << "nobody is in control";
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

TEST_F(GateWithoutAges, RejectsWhatWaitedLongerThanItsLease) {
    const gate_command c = command();
    run(10 * second);
    EXPECT_EQ(GATE_TOO_OLD, judge(c));
}

/* --------------------------------------------------------------------------------- control --- */

TEST_F(Gate, OneSenderIsInControlUntilItsLeaseEnds) {
    ASSERT_EQ(GATE_TAKEN, judge(command("first")));
    EXPECT_EQ("first", owner());
    run(299 * ms);
    EXPECT_EQ(GATE_CONTROL, judge(command("second")));
    EXPECT_EQ(GATE_TAKEN, judge(command("first")));
    run(300 * ms - 1);
    EXPECT_EQ(GATE_CONTROL, judge(command("second")));
    run(1);
    EXPECT_EQ("", owner());
    EXPECT_EQ(GATE_TAKEN, judge(command("second")));
    EXPECT_EQ("second", owner());
    EXPECT_EQ(GATE_CONTROL, judge(command("first")));
    EXPECT_EQ(GATE_CONTROL, judge(command("sec"))) << "a name that begins alike is another";
}

TEST_F(Gate, AShortLeaseEndsControlSooner) {
    ASSERT_EQ(GATE_TAKEN, judge(command("first")));
    run(10 * ms);
    gate_command last = command("first");
    last.lease_us = 50 * ms;
    ASSERT_EQ(GATE_TAKEN, judge(last));
    run(50 * ms);
    EXPECT_EQ(GATE_TAKEN, judge(command("second")));
}

TEST_F(Gate, OutputsAndRelocalizationsObeyControlAndDoNotShortenIt) {
    ASSERT_EQ(GATE_TAKEN, judge(command("first")));
    for (const gate_kind kind : {GATE_OUTPUT, GATE_RELOCALIZE}) {
        gate_command c = command("second");
        c.kind = kind;
        EXPECT_EQ(GATE_CONTROL, judge(c));
        c = command("first");
        c.kind = kind;
        c.lease_us = 20 * ms;
        EXPECT_EQ(GATE_TAKEN, judge(c));
    }
    run(250 * ms);
    EXPECT_EQ(GATE_CONTROL, judge(command("second")));
}

TEST_F(Gate, OutputsAndRelocalizationsTakeNoControl) {
    for (const gate_kind kind : {GATE_OUTPUT, GATE_RELOCALIZE}) {
        gate_command c = command("lamp");
        c.kind = kind;
        EXPECT_EQ(GATE_TAKEN, judge(c, overridden)) << "nor need they a robot that can be armed";
        EXPECT_EQ("", owner());
    }
    EXPECT_EQ(GATE_TAKEN, judge(command("planner")));
    EXPECT_EQ("planner", owner());
    run(200 * ms);
    gate_command c = command("planner");
    c.kind = GATE_OUTPUT;
    EXPECT_EQ(GATE_TAKEN, judge(c));
    run(100 * ms);
    EXPECT_EQ("", owner()) << "nor do they prolong it";
}

TEST_F(Gate, ARejectedCommandTakesNoControl) {
    EXPECT_EQ(GATE_DISARMED, judge(command("first"), overridden));
    EXPECT_EQ("", owner());
}

/* ---------------------------------------------------------------------------------- pauses --- */

TEST_F(Gate, AfterADisarmItWaitsUntilAllHavePausedFor500Milliseconds) {
    ASSERT_EQ(GATE_TAKEN, judge(command()));
    gate_hold(&gate, us());
    EXPECT_EQ(GATE_DISARMED, stream(10 * second, armable)) << "who streams on is refused for ever";
    EXPECT_EQ(200, gate.rejected[GATE_DISARMED]);
    run(500 * ms - 1);
    EXPECT_TRUE(gate_is_waiting(&gate, us()));
    run(1);
    EXPECT_FALSE(gate_is_waiting(&gate, us()));
    EXPECT_EQ(GATE_TAKEN, judge(command(), armable)) << "the next command arms again";
}

TEST_F(Gate, ACommandRightBeforeTheEndOfThePauseRestartsIt) {
    gate_hold(&gate, us());
    for (int i = 0; i < 5; i++) {
        run(500 * ms - 1);
        EXPECT_EQ(GATE_DISARMED, judge(command(), armable));
    }
    run(500 * ms);
    EXPECT_EQ(GATE_TAKEN, judge(command(), armable));
}

TEST_F(Gate, TimeInWhichTheBridgeHungIsNotAPause) {
    gate_hold(&gate, us());
    EXPECT_EQ(GATE_DISARMED, stream(400 * ms, armed));
    const std::uint64_t since_us = us();
    run(2 * second);
    gate_was_stalled(&gate, since_us, us());
    EXPECT_EQ(GATE_DISARMED, judge(command())) << "it may have streamed meanwhile";
    run(GATE_PAUSE_US);
    EXPECT_EQ(GATE_TAKEN, judge(command()));
    const std::uint64_t later_us = us();
    run(2 * second);
    gate_was_stalled(&gate, later_us, us());
    EXPECT_EQ(GATE_TAKEN, judge(command())) << "the pause was over before";
}

TEST_F(Gate, AStopRightBeforeTheBridgeHungHoldsUntilAPauseAfterwards) {
    const std::uint64_t since_us = us();
    run(ms); /* the stop is read, then it hangs */
    gate_hold(&gate, us());
    run(2 * second);
    gate_was_stalled(&gate, since_us, us());
    EXPECT_EQ(GATE_DISARMED, judge(command(), armable)) << "it may have streamed meanwhile";
    run(GATE_PAUSE_US - 1);
    EXPECT_EQ(GATE_DISARMED, judge(command(), armable));
    run(GATE_PAUSE_US);
    EXPECT_EQ(GATE_TAKEN, judge(command(), armable));
}

TEST_F(Gate, TheTimeInWhichTheBridgeHungIsNoPause) {
    gate_hold(&gate, us());
    run(GATE_PAUSE_US / 2);
    const std::uint64_t since_us = us();
    run(2 * second);
    gate_was_stalled(&gate, since_us, us());
    EXPECT_TRUE(gate_is_waiting(&gate, us()));
    run(GATE_PAUSE_US / 2);
    EXPECT_FALSE(gate_is_waiting(&gate, us()));
}

TEST_F(Gate, ZerosCountAsAPauseButAreRejectedDuringIt) {
    gate_hold(&gate, us());
    EXPECT_EQ(GATE_DISARMED, stream(450 * ms, armable, true));
    EXPECT_EQ(GATE_TAKEN, stream(50 * ms, armable, true));
}

TEST_F(Gate, EverySenderMustPauseAlsoOneThatWouldBeRejected) {
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

TEST_F(Gate, OnlyRequestsForMotionProlongAPause) {
    for (int kind = 0; kind < judged_kinds; kind++) {
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

TEST_F(Gate, AllKindsOfCommandsAreRejectedDuringAPause) {
    gate_hold(&gate, us());
    for (const gate_kind kind : {GATE_OUTPUT, GATE_RELOCALIZE}) {
        gate_command c = command();
        c.kind = kind;
        EXPECT_EQ(GATE_DISARMED, judge(c, armed));
    }
}

TEST_F(Gate, ASenderThatStreamsWhileTheRobotIsAwayMustPauseLater) {
    gate_hold(&gate, us());
    run(2 * second); /* paused while [A] is held or the robot is away ... */
    for (const gate_robot &state : {overridden, absent}) {
        EXPECT_NE(GATE_TAKEN, stream(second, state)) << "... then streams again ...";
        EXPECT_EQ(GATE_DISARMED, stream(second, armable)) << "... and it comes back";
        run(500 * ms);
        EXPECT_EQ(GATE_TAKEN, judge(command(), armable));
    }
}

TEST_F(Gate, ThatIsNotReadyAcceptsNoCommands) {
    for (int kind = 0; kind < judged_kinds; kind++) {
        gate_command c = command();
        c.kind = static_cast<gate_kind>(kind);
        EXPECT_EQ(GATE_NOT_READY, judge(c, absent));
    }
    EXPECT_EQ(3, gate.rejected[GATE_NOT_READY]);
}

/* ----------------------------------------------------------------------------------- stops --- */

TEST_F(Gate, AStopEndsControlAndHoldsUntilAPause) {
    ASSERT_EQ(GATE_TAKEN, judge(command("planner")));
    gate_stop(&gate, "operator", 8, us());
    EXPECT_TRUE(gate.stopped);
    EXPECT_STREQ("operator", gate.stopped_by);
    EXPECT_EQ("", owner());
    EXPECT_EQ(GATE_DISARMED, stream(5 * second, armed));
    run(500 * ms);
    EXPECT_EQ(GATE_TAKEN, judge(command("second")));
    EXPECT_TRUE(gate.stopped) << "it may still be refused";
}

TEST_F(Gate, AStopMayHaveNoSenderOrALongOne) {
    gate_stop(&gate, nullptr, 0, us());
    EXPECT_STREQ("", gate.stopped_by);
    const std::string longer(200, 's');
    gate_stop(&gate, longer.data(), longer.size(), us());
    EXPECT_EQ(longer.substr(0, GATE_MAX_SENDER), gate.stopped_by);
    gate_stop(&gate, "operator", 8, us());
    EXPECT_STREQ("operator", gate.stopped_by) << "nothing is left of the longer one";
}

TEST_F(Gate, ZerosNeitherTakeNorKeepControl) {
    EXPECT_EQ(GATE_TAKEN, stream(second, armed, true));
    EXPECT_EQ("", owner());
    ASSERT_EQ(GATE_TAKEN, judge(command("second")));
    EXPECT_EQ("second", owner());
    EXPECT_EQ(GATE_CONTROL, stream(50 * ms, armed, true)) << "of another sender";
    gate_command c = command("second");
    c.zero = true;
    ASSERT_EQ(GATE_TAKEN, judge(c));
    EXPECT_EQ("", owner());
}

TEST_F(Gate, CanDriveOnlyIfEnabled) {
    EXPECT_TRUE(gate_can_drive(&gate, &armed, us()));
    EXPECT_FALSE(gate_can_drive(&gate, &overridden, us()));
    EXPECT_FALSE(gate_can_drive(&gate, &absent, us()));
    rules_.enabled[GATE_DRIVE] = false;
    restart();
    run(second);
    EXPECT_FALSE(gate_can_drive(&gate, &armed, us()));
}

/* --------------------------------------------------------------------------------- reasons --- */

TEST_F(Gate, IncidentIsOneUntilNoneOfItsCauseCameForFiveSeconds) {
    const auto is_incident = [&] { return gate_is_incident(&gate, GATE_TOO_OLD, "one", 3, us()); };
    EXPECT_TRUE(is_incident());
    for (int count = 0; count < 100; count++) {
        run(4900 * ms);
        EXPECT_FALSE(is_incident());
    }
    run(5 * second);
    EXPECT_TRUE(is_incident());
}

TEST_F(Gate, IncidentOfAnotherSenderOrCauseIsNew) {
    EXPECT_TRUE(gate_is_incident(&gate, GATE_TOO_OLD, "one", 3, us()));
    EXPECT_TRUE(gate_is_incident(&gate, GATE_CONTROL, "one", 3, us()));
    run(999 * ms);
    EXPECT_FALSE(gate_is_incident(&gate, GATE_TOO_OLD, "two", 3, us())) << "once a second";
    run(ms);
    EXPECT_TRUE(gate_is_incident(&gate, GATE_TOO_OLD, "one", 3, us()));
    run(second);
    EXPECT_TRUE(gate_is_incident(&gate, GATE_TOO_OLD, nullptr, 0, us()));
    run(second);
    EXPECT_TRUE(gate_is_incident(&gate, GATE_TOO_OLD, "longer", 6, us()));
    run(second);
    EXPECT_TRUE(gate_is_incident(&gate, GATE_TOO_OLD, "one", 3, us()));
    run(second);
    EXPECT_FALSE(gate_is_incident(&gate, GATE_TOO_OLD, "one", 3, us()));
}

/* ---------------------------------------------------------------------------------- stalls --- */

TEST(GateStall, CommandsAfterAStallCountFromItsBeginning) {
    gate_stall stall{};
    std::uint64_t since_us = 0;
    gate_time now{boot, epoch};
    const auto look_after = [&](std::int64_t us, std::int64_t asked_us) {
        now.us += static_cast<std::uint64_t>(us);
        now.utime += us;
        return gate_look_for_stall(&stall, static_cast<std::uint64_t>(asked_us), now, &since_us);
    };
    EXPECT_FALSE(look_after(0, 0)) << "the first look";
    EXPECT_FALSE(look_after(119 * ms, 100 * ms));
    EXPECT_EQ(now.utime, gate_arrival(&stall, now.utime)) << "it waited, as it was asked to";
    const std::int64_t began_utime = now.utime;
    EXPECT_TRUE(look_after(200 * ms, 20 * ms));
    EXPECT_EQ(boot + 119 * ms, since_us);
    EXPECT_EQ(began_utime, gate_arrival(&stall, now.utime));
    EXPECT_FALSE(look_after(10 * ms, 0));
    EXPECT_EQ(began_utime, gate_arrival(&stall, now.utime)) << "queues below may be read late";
    EXPECT_FALSE(look_after(170 * ms - 1, 170 * ms));
    EXPECT_EQ(began_utime, gate_arrival(&stall, now.utime));
    EXPECT_EQ(began_utime - 1, gate_arrival(&stall, began_utime - 1)) << "the clock was set back";
    EXPECT_FALSE(look_after(1, 0));
    EXPECT_EQ(now.utime, gate_arrival(&stall, now.utime)) << "they are empty after as long a time";
    EXPECT_TRUE(look_after(20 * ms, 0));
    EXPECT_FALSE(look_after(50 * ms - 1, 50 * ms));
    EXPECT_GT(now.utime, gate_arrival(&stall, now.utime)) << "or after 50 ms";
    EXPECT_FALSE(look_after(1, 0));
    EXPECT_EQ(now.utime, gate_arrival(&stall, now.utime));
    EXPECT_TRUE(look_after(10 * second, 0));
    EXPECT_FALSE(look_after(250 * ms, 250 * ms));
    EXPECT_EQ(now.utime, gate_arrival(&stall, now.utime)) << "after 250 ms at most";
    const std::int64_t first_utime = now.utime;
    EXPECT_TRUE(look_after(300 * ms, 0));
    EXPECT_TRUE(look_after(200 * ms, 0)) << "it hangs again before they are empty";
    EXPECT_EQ(first_utime, gate_arrival(&stall, now.utime));
    EXPECT_FALSE(look_after(10 * ms, 0));
    EXPECT_EQ(first_utime, gate_arrival(&stall, now.utime));
}

TEST_F(Gate, AClockThatWasSetIsNoticedAndHolds) {
    EXPECT_EQ(0, gate_look_at_clock(&gate, time()));
    const gate_time slewed{us(), time().utime + 100 * ms};
    EXPECT_EQ(0, gate_look_at_clock(&gate, slewed));
    EXPECT_FALSE(gate_is_waiting(&gate, us()));
    const gate_time set{us(), time().utime - 3600 * second};
    EXPECT_EQ(-3600 * second - 100 * ms, gate_look_at_clock(&gate, set));
    EXPECT_TRUE(gate_is_waiting(&gate, us()));
    EXPECT_EQ(0, gate_look_at_clock(&gate, set));
    gate_init(&gate, &rules_, time());
    const gate_time ahead{us(), time().utime + second};
    EXPECT_EQ(second, gate_look_at_clock(&gate, ahead));
    EXPECT_TRUE(gate_is_waiting(&gate, us()));
}

TEST_F(Gate, WhatKeepsARobotFromArmingIsNothingToOneThatIsArmed) {
    const gate_robot moving{true, true, ROBUROC4_ERR_MOVING}, rolling{true, false, -1};
    EXPECT_EQ(GATE_TAKEN, judge(command(), moving));
    run(50 * ms);
    EXPECT_EQ(GATE_DISARMED, judge(command(), rolling));
}

TEST_F(Gate, ALongNameIsAnIncidentLikeAnyOther) {
    const std::string name(3 * GATE_MAX_SENDER, 'n');
    EXPECT_TRUE(gate_is_incident(&gate, GATE_SENDER, name.data(), name.size(), us()));
    EXPECT_EQ(name.substr(0, GATE_MAX_SENDER), gate.incidents[GATE_SENDER].sender);
    EXPECT_FALSE(gate_is_incident(&gate, GATE_SENDER, name.data(), name.size(), us()));
    EXPECT_TRUE(gate_is_incident(&gate, static_cast<gate_verdict>(GATE_SENDER + 1), "x", 1, us()))
        << "the next cause is untouched";
}

TEST(GateReason, EachVerdictHasItsOwn) {
    gate_rules rules = default_rules();
    std::set<std::string> reasons;
    const auto reason = [&](int verdict, int kind = GATE_DRIVE, std::int64_t age_us = second) {
        char room[300];
        const gate_time now{boot, epoch};
        const std::int64_t utime = verdict == GATE_IN_FUTURE ? epoch + age_us : epoch - age_us;
        const gate_rejection rejection{static_cast<gate_verdict>(verdict),
                                       static_cast<gate_kind>(kind), utime, "stamp"};
        gate_reason(room, sizeof room, &rejection, &rules, now);
        return std::string(room);
    };
    for (int verdict = GATE_MALFORMED; verdict < GATE_VERDICTS; verdict++)
        reasons.insert(reason(verdict));
    EXPECT_EQ(static_cast<std::size_t>(GATE_VERDICTS - 1), reasons.size());
    const std::map<gate_verdict, const char *> remedies{
        {GATE_MALFORMED, "use the types of this bridge's version"},
        {GATE_SENDER, "give each program its own name, and use at most 32"},
        {GATE_NOT_FINITE, "NaN or infinity"},
        {GATE_CONTROL, "a stop command needs no control"},
        {GATE_NOT_READY, "not connected"},
        {GATE_DISARMED, "pause (or send zero) for 500 ms"},
        {GATE_UNITS, "give m/s and rad/s, at most 5 and 10"},
        {GATE_IMPOSSIBLE, "digital output 0 is its own"},
        {GATE_NO_UTIME, "its stamp is 0 or less; set it to the time at which it is sent"},
        {GATE_REPEATED, "a replayed log, or two programs with the same name"},
        {GATE_STARTING, "then pause 500 ms"},
        {GATE_TOO_OLD, "set both by NTP"},
        {GATE_IN_FUTURE, "set both by NTP"}};
    for (const auto &[verdict, remedy] : remedies)
        EXPECT_NE(std::string::npos, reason(verdict).find(remedy)) << reason(verdict);
    EXPECT_EQ(
        "by its stamp it is 1.000 s old (--max-age-ms 200): a replayed log, a slow network, or "
        "clocks that differ: set both by NTP (--max-age-ms 0 accepts all ages, including "
        "replays)",
        reason(GATE_TOO_OLD));
    EXPECT_EQ(0U, reason(GATE_IN_FUTURE).find("by its stamp it is 1.000 s in the future ("));
    const char *const options[] = {"--enable-drive", "--enable-relocalize", "--enable-outputs"};
    for (int kind = 0; kind < judged_kinds; kind++)
        EXPECT_EQ(std::string("start the bridge with ") + options[kind] + " to enable it",
                  reason(GATE_DISABLED, kind));
    EXPECT_EQ("its lease ended before it could be read",
              reason(GATE_TOO_OLD, GATE_DRIVE, 200 * ms));
    rules.max_age_us = 0;
    EXPECT_EQ("its lease ended before it could be read", reason(GATE_TOO_OLD));
}

/* ---------------------------------------------------------------------------------- oracle --- */

/** Thousands of random commands; an independent oracle decides which may not pass. */
TEST_F(Gate, NothingPassesThatAPlainOracleForbids) {
    std::mt19937 random(5);
    const auto below = [&](std::int64_t n) {
        return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n));
    };
    struct Book {
        std::int64_t utime[judged_kinds] = {0, 0, 0};
    } books[4];
    std::int64_t control_until = -1, noise = now_, passed = 0;
    std::int64_t owner_now = -1;
    bool hold = true;
    restart();
    for (int step = 0; step < 200000; step++) {
        run(below(60) * ms + below(1000));
        if (below(1000) == 0) {
            gate_stop(&gate, "x", 1, us());
            hold = true;
            noise = now_;
            control_until = -1;
            run(below(900) * ms);
        }
        if (below(400) == 0) {
            gate_hold(&gate, us());
            hold = true;
            noise = now_;
            run(below(900) * ms);
        }
        const std::int64_t who = below(50) == 0 ? below(4) : 0;
        const char *const names[] = {"a", "b", "c", "abc"};
        gate_command c = command(names[who]);
        c.kind = static_cast<gate_kind>(below(20) == 0 ? below(judged_kinds) : 0);
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
            ASSERT_TRUE(c.finite && robot.ready && !hold) << step;
            ASSERT_LE(std::llabs(c.utime - time().utime), 200 * ms);
            ASSERT_GT(c.utime, books[who].utime[c.kind]);
            ASSERT_TRUE(who == owner_now || now_ >= control_until) << step;
            ASSERT_GE(lease_us, 20000U);
            const std::int64_t waited = time().utime - c.arrived_utime;
            const std::int64_t asked =
                c.lease_us > 0 ? std::min<std::int64_t>(c.lease_us, 300 * ms) : 300 * ms;
            const std::int64_t read_at_once = waited < 10 * ms ? 20 * ms : 0;
            ASSERT_LE(static_cast<std::int64_t>(lease_us), std::max(asked - waited, read_at_once));
            books[who].utime[c.kind] = c.utime;
            if (c.kind == GATE_DRIVE) {
                control_until = c.zero ? -1 : now_ + static_cast<std::int64_t>(lease_us);
                owner_now = who;
            }
        } else if (c.kind == GATE_DRIVE && !c.zero && (hold || !robot.ready)) {
            hold = true;
            noise = now_;
        }
    }
    EXPECT_GT(passed, 10000) << "refusals alone would test little";
    EXPECT_EQ(200000, passed + rejections());
}
