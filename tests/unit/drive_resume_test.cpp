/* SPDX-License-Identifier: MIT
 *
 * Resuming by itself: off unless switched on, and even then never with a command from before.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

roburoc4_config resuming(std::uint32_t bits) {
    roburoc4_config config = default_config();
    config.resume = bits;
    return config;
}

struct Cause {
    const char *name;
    std::uint32_t bit;
    roburoc4_result disarm_cause;
    std::function<void(Bench &, ScriptedRobot &)> begin;
    std::function<void(ScriptedRobot &)> end;
};

const std::vector<Cause> causes{
    {"override", ROBUROC4_RESUME_OVERRIDE, ROBUROC4_ERR_OVERRIDE,
     [](Bench &b, ScriptedRobot &r) {
         r.press(ROBUROC4_DI_PAD_A);
         b.run(200 * ms);
     },
     [](ScriptedRobot &r) { r.press(ROBUROC4_DI_PAD_A, false); }},
    {"loss", ROBUROC4_RESUME_LOSS, ROBUROC4_ERR_LOST,
     [](Bench &b, ScriptedRobot &r) {
         r.powered = false;
         b.run(3 * second);
     },
     [](ScriptedRobot &r) { r.powered = true; }},
    {"stale", ROBUROC4_RESUME_LOSS, ROBUROC4_ERR_STALE_IOCARD,
     [](Bench &b, ScriptedRobot &r) {
         r.service(ROBUROC4_SERVICE_IOCARD).mute = true;
         b.run(400 * ms);
     },
     [](ScriptedRobot &r) { r.service(ROBUROC4_SERVICE_IOCARD).mute = false; }},
    {"reboot", ROBUROC4_RESUME_REBOOT, ROBUROC4_ERR_REBOOT,
     [](Bench &b, ScriptedRobot &r) {
         for (std::uint64_t i = 0; i < 3; i++)
             b.receive(r.status_at(6, r.cycles() - 500 + i));
         r.reboot();
     },
     [](ScriptedRobot &) {}},
};

/** Drive until the cause comes, all with a lease of a second. */
void drive_into(Bench &bench, ScriptedRobot &robot, const Cause &cause) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.25F, 0, 200 * ms));
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.25F, 0, 1000000));
    bench.run(20 * ms);
    cause.begin(bench, robot);
    EXPECT_EQ(0, bench.facts().armed);
}

/** Let the cause go, until nothing but the past speaks against arming. */
void clear_cause(Bench &bench, ScriptedRobot &robot, const Cause &cause) {
    cause.end(robot);
    ASSERT_TRUE(
        bench.run_until([&] { return bench.facts().arm_refusal == ROBUROC4_OK; }, 5 * second));
}

} // namespace

TEST(Resume, IsOffByDefault) {
    for (const Cause &cause : causes) {
        SCOPED_TRACE(cause.name);
        ScriptedRobot robot;
        Bench bench(robot);
        drive_into(bench, robot, cause);
        clear_cause(bench, robot, cause);
        const std::uint64_t at_us = bench.now_us;
        for (int i = 0; i < 100; i++) {
            EXPECT_LT(bench.drive(i % 10 == 0 ? 0.0F : 0.25F, 0), 0);
            bench.run(i % 10 == 5 ? 300 * ms : 50 * ms);
        }
        EXPECT_EQ(0U, bench.speeds(at_us));
        EXPECT_EQ(0, bench.facts().armed);
        EXPECT_EQ(ROBUROC4_OK, bench.arm()) << "only a person's arm() helps";
    }
}

TEST(Resume, AfterAnotherCauseThanTheConfiguredStaysOff) {
    for (const Cause &cause : causes) {
        SCOPED_TRACE(cause.name);
        ScriptedRobot robot;
        Bench bench(robot, resuming(7U & ~cause.bit));
        drive_into(bench, robot, cause);
        clear_cause(bench, robot, cause);
        EXPECT_LT(bench.drive(0, 0), 0);
        EXPECT_EQ(0, bench.facts().armed);
    }
}

TEST(Resume, NeedsANeutralCommandFirst) {
    for (const Cause &cause : causes) {
        SCOPED_TRACE(cause.name);
        ScriptedRobot robot;
        Bench bench(robot, resuming(cause.bit));
        drive_into(bench, robot, cause);
        EXPECT_LT(bench.drive(0, 0), 0) << "while the cause lasts nothing is neutral";
        clear_cause(bench, robot, cause);
        const std::uint64_t at_us = bench.now_us;
        for (int i = 0; i < 40; i++) { /* somebody leans on the stick */
            EXPECT_EQ(ROBUROC4_ERR_NOT_NEUTRAL, bench.drive(0.25F, 0));
            bench.run(50 * ms);
        }
        EXPECT_EQ(0U, bench.speeds(at_us));
        EXPECT_EQ(0, bench.facts().armed);
        bench.take_events();
        EXPECT_EQ(ROBUROC4_OK, bench.drive(0, 0));
        EXPECT_EQ(1, bench.facts().armed);
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_ARMED);
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.25F, 0, 200 * ms));
        EXPECT_GT(bench.speeds(at_us), 0U);
    }
}

TEST(Resume, OrAPauseOfALease) {
    for (const Cause &cause : causes) {
        SCOPED_TRACE(cause.name);
        ScriptedRobot robot;
        Bench bench(robot, resuming(cause.bit));
        drive_into(bench, robot, cause);
        clear_cause(bench, robot, cause);
        EXPECT_EQ(ROBUROC4_ERR_NOT_NEUTRAL, bench.drive(0.25F, 0));
        bench.run(249 * ms);
        EXPECT_EQ(ROBUROC4_ERR_NOT_NEUTRAL, bench.drive(0.25F, 0)) << "it began anew";
        bench.run(250 * ms);
        EXPECT_EQ(ROBUROC4_OK, bench.drive(0.25F, 0));
        bench.pump();
        EXPECT_EQ(0.25F, bench.commands().back().linear);
    }
}

TEST(Resume, PauseIsThatOfTheLongerLease) {
    for (const std::uint32_t lease_us : {20000U, 100000U, 250000U, 1000000U}) {
        SCOPED_TRACE(lease_us);
        const std::uint64_t pause_us = std::max<std::uint64_t>(lease_us, 250 * ms);
        ScriptedRobot robot;
        Bench bench(robot, resuming(ROBUROC4_RESUME_OVERRIDE));
        drive_into(bench, robot, causes[0]);
        clear_cause(bench, robot, causes[0]);
        EXPECT_EQ(ROBUROC4_ERR_NOT_NEUTRAL, bench.drive(0.25F, 0, lease_us));
        bench.run(pause_us - 1);
        EXPECT_EQ(ROBUROC4_ERR_NOT_NEUTRAL, bench.drive(0.25F, 0, lease_us));
        bench.run(pause_us);
        EXPECT_EQ(ROBUROC4_OK, bench.drive(0.25F, 0, lease_us));
    }
}

TEST(Resume, NeutralIsNeitherADriveNorATurn) {
    ScriptedRobot robot;
    Bench bench(robot, resuming(ROBUROC4_RESUME_OVERRIDE));
    drive_into(bench, robot, causes[0]);
    clear_cause(bench, robot, causes[0]);
    for (const auto &[linear, angular] :
         {std::pair<float, float>{0.25F, 0}, {-0.25F, 0}, {0, 0.25F}, {0, -0.25F}, {0, 1e-6F}})
        EXPECT_EQ(ROBUROC4_ERR_NOT_NEUTRAL, bench.drive(linear, angular));
    EXPECT_EQ(ROBUROC4_OK, bench.drive(-0.0F, -0.0F));
    EXPECT_EQ(1, bench.facts().armed);
}

TEST(Resume, CommandFromBeforeTheCauseIsDead) {
    for (const Cause &cause : causes) {
        SCOPED_TRACE(cause.name);
        ScriptedRobot robot;
        Bench bench(robot, resuming(7));
        drive_into(bench, robot, cause);
        const std::uint64_t at_us = bench.now_us;
        clear_cause(bench, robot, cause);
        bench.run(10 * second);
        EXPECT_EQ(0U, bench.speeds(at_us));
        EXPECT_EQ(0, bench.facts().driving);
        EXPECT_EQ(0, bench.facts().armed) << "a lease given after it is needed";
    }
}

TEST(Resume, SaysTheCauseUntilItIsCleared) {
    for (const Cause &cause : causes) {
        SCOPED_TRACE(cause.name);
        ScriptedRobot robot;
        roburoc4_config config = resuming(7);
        config.fresh_ms = 1000; /* lost before stale */
        config.lost_ms = 500;
        if (cause.disarm_cause == ROBUROC4_ERR_STALE_IOCARD)
            config = resuming(7);
        Bench bench(robot, config);
        drive_into(bench, robot, cause);
        EXPECT_EQ(cause.disarm_cause, bench.facts().disarm_cause);
        EXPECT_EQ(cause.disarm_cause, bench.drive(0.25F, 0));
        clear_cause(bench, robot, cause);
        EXPECT_EQ(cause.disarm_cause, bench.facts().disarm_cause);
    }
}

TEST(Resume, EndsWhenSomebodyDisarms) {
    ScriptedRobot robot;
    Bench bench(robot, resuming(7));
    drive_into(bench, robot, causes[0]);
    bench.take_events();
    bench.disarm();
    EXPECT_EQ(0U, bench.take_events()) << "it was disarmed before";
    clear_cause(bench, robot, causes[0]);
    EXPECT_EQ(ROBUROC4_ERR_DISARMED, bench.drive(0, 0));
    EXPECT_EQ(0, bench.facts().armed);
}

TEST(Resume, IsNotForWhoWasNeverArmed) {
    ScriptedRobot robot;
    Bench bench(robot, resuming(7));
    bench.ready();
    causes[0].begin(bench, robot);
    clear_cause(bench, robot, causes[0]);
    EXPECT_EQ(ROBUROC4_ERR_DISARMED, bench.drive(0, 0));
}

TEST(Resume, IsNotForClockFaultsOrAnotherCommander) {
    for (int i = 0; i < 2; i++) {
        ScriptedRobot robot;
        Bench bench(robot, resuming(7));
        bench.armed();
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.25F, 0, 200 * ms));
        if (i == 0) {
            bench.skew_us -= 1000;
            bench.run(second);
        } else {
            robot.follows = false;
            robot.target_linear = -1;
            bench.run(300 * ms);
            robot.target_linear = 0;
            bench.run(300 * ms);
        }
        EXPECT_EQ(i == 0 ? ROBUROC4_ERR_CLOCK : ROBUROC4_ERR_FOREIGN, bench.drive(0, 0));
        EXPECT_EQ(0, bench.facts().armed);
    }
}

TEST(Resume, WaitsAgainWhereTheCauseComesBack) {
    ScriptedRobot robot;
    Bench bench(robot, resuming(ROBUROC4_RESUME_OVERRIDE));
    drive_into(bench, robot, causes[0]);
    clear_cause(bench, robot, causes[0]);
    robot.press(ROBUROC4_DI_PAD_A);
    bench.run(100 * ms);
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.drive(0, 0));
    robot.press(ROBUROC4_DI_PAD_A, false);
    bench.run(100 * ms);
    EXPECT_EQ(ROBUROC4_OK, bench.drive(0, 0));
}

TEST(Resume, WaitsAgainWhereAnotherReasonComes) {
    struct Reason {
        const char *name;
        std::function<void(ScriptedRobot &)> begin, end;
    };
    const std::vector<Reason> reasons{
        {"moving", [](ScriptedRobot &r) { r.current_linear = 0.5F; },
         [](ScriptedRobot &r) { r.current_linear = 0; }},
        {"turning", [](ScriptedRobot &r) { r.current_angular = -0.5F; },
         [](ScriptedRobot &r) { r.current_angular = 0; }},
        {"no inputs", [](ScriptedRobot &r) { r.service(ROBUROC4_SERVICE_IOCARD).mute = true; },
         [](ScriptedRobot &r) { r.service(ROBUROC4_SERVICE_IOCARD).mute = false; }},
        {"no speeds",
         [](ScriptedRobot &r) { r.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true; },
         [](ScriptedRobot &r) { r.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = false; }},
    };
    for (const Reason &reason : reasons)
        for (const bool before_it_cleared : {false, true}) {
            SCOPED_TRACE(testing::Message() << reason.name << ", " << before_it_cleared);
            ScriptedRobot robot;
            Bench bench(robot, resuming(ROBUROC4_RESUME_OVERRIDE));
            drive_into(bench, robot, causes[0]);
            robot.follows = false;
            bench.run(second);
            if (before_it_cleared)
                reason.begin(robot);
            bench.run(400 * ms);
            causes[0].end(robot);
            bench.run(100 * ms);
            if (!before_it_cleared)
                reason.begin(robot);
            bench.run(400 * ms);
            EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.drive(0, 0));
            EXPECT_EQ(0, bench.facts().armed);
            reason.end(robot);
            bench.run(400 * ms);
            EXPECT_EQ(ROBUROC4_OK, bench.drive(0, 0));
        }
}
