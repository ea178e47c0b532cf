/* SPDX-License-Identifier: MIT
 *
 * Arming: refused for each single reason, lost with each condition, and no driving without it.
 */
#include "client_bench.h"

#include <limits>
#include <set>

using namespace roburoc4_tests;

namespace {

constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();
constexpr float inf_f = std::numeric_limits<float>::infinity();

/** arm() and arm_refusal give this result, and a refused client does not drive. */
void expect_refused(Bench &bench, roburoc4_result reason) {
    EXPECT_EQ(reason, bench.facts().arm_refusal);
    EXPECT_EQ(reason, bench.arm());
    EXPECT_EQ(0, bench.facts().armed);
    EXPECT_LT(bench.drive(0.5F, 0), 0);
    EXPECT_EQ(0, bench.facts().driving);
    bench.run(100 * ms);
    EXPECT_EQ(0U, bench.speeds());
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_ARMED);
}

/** Drive, remove the condition, and check that the client disarmed for this cause. */
void expect_disarmed(Bench &bench, roburoc4_result cause, const std::function<void()> &lose,
                     std::uint64_t within_us) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.25F, 0, 200 * ms));
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.25F, 0, 1000000));
    bench.run(1 * ms);
    bench.take_events();
    lose();
    EXPECT_TRUE(bench.run_until([&] { return bench.facts().armed == 0; }, within_us));
    const std::size_t speeds = bench.speeds();
    const std::size_t commands = bench.commands().size();
    EXPECT_EQ(cause, bench.facts().disarm_cause);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_DISARMED);
    EXPECT_EQ(0, bench.facts().driving);
    EXPECT_EQ(cause, bench.drive(0.25F, 0)) << "drive says why it is not armed";
    bench.run(3 * second);
    EXPECT_EQ(speeds, bench.speeds());
    EXPECT_GE(bench.commands().size(), commands + 2) << "a stop sequence";
    EXPECT_EQ(0, bench.facts().armed) << "it does not arm itself";
}

} // namespace

TEST(Arm, OnlyTransientReasonsAreWorthWaitingFor) {
    const std::set<roburoc4_result> passing = {
        ROBUROC4_ERR_NOT_READY,    ROBUROC4_ERR_STALE_DIFFERENTIAL,
        ROBUROC4_ERR_STALE_IOCARD, ROBUROC4_ERR_OVERRIDE_UNKNOWN,
        ROBUROC4_ERR_MOVING,       ROBUROC4_ERR_UPLINK};
    for (roburoc4_result refusal = -50; refusal <= 1; refusal++)
        EXPECT_EQ(passing.count(refusal) == 1, roburoc4_refusal_may_pass(refusal) == 1) << refusal;
}

TEST(Arm, IsPossibleWhenAllConditionsHold) {
    Ready bench;
    EXPECT_EQ(0, bench.facts().armed);
    EXPECT_EQ(ROBUROC4_ERR_DISARMED, bench.facts().disarm_cause);
    EXPECT_EQ(ROBUROC4_OK, bench.facts().arm_refusal);
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
    EXPECT_EQ(1, bench.facts().armed);
    EXPECT_EQ(ROBUROC4_OK, bench.facts().disarm_cause);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_ARMED);
    EXPECT_EQ(ROBUROC4_OK, bench.arm()) << "arming twice is fine";
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_ARMED);
}

TEST(Drive, WhileDisarmedIsAnErrorAndStoresNothing) {
    RobotBench bench;
    EXPECT_EQ(ROBUROC4_ERR_DISARMED, bench.drive(0.5F, 0));
    bench.ready();
    EXPECT_EQ(ROBUROC4_ERR_DISARMED, bench.drive(0.5F, 0, 1000000));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
    bench.run(second);
    EXPECT_EQ(0U, bench.commands().size()) << "arming brings nothing back";
    EXPECT_EQ(0, bench.facts().driving);
}

/* ---- the event of armable ---- */

/** Whether the event occurs within this time, and exactly when arming becomes possible. */
static bool tells_armable(Bench &bench, std::uint64_t within_us = 5 * second) {
    bool told = false;
    const bool possible = bench.run_until(
        [&] {
            told = told || (bench.take_events() & ROBUROC4_EVENT_ARMABLE) != 0;
            return told || bench.facts().arm_refusal >= 0;
        },
        within_us);
    EXPECT_EQ(possible, told);
    EXPECT_EQ(possible, bench.facts().arm_refusal >= 0);
    return told;
}

TEST(Armable, IsReportedWhenArmingBecomesPossibleUnlikeReady) {
    Started bench;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    EXPECT_LT(bench.arm(), 0);
    ASSERT_TRUE(tells_armable(bench));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
    bench.take_events();
    bench.run(2 * second);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_ARMABLE) << "it is armed";
}

TEST(Armable, IsReportedAgainAfterEachRefusalAndDisarm) {
    Armed bench;
    bench.stop();
    ASSERT_TRUE(tells_armable(bench)) << "disarmed by the program";
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    bench.robot.digital = std::uint64_t{1} << ROBUROC4_DI_PAD_A;
    bench.run(200 * ms);
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.arm());
    EXPECT_FALSE(tells_armable(bench, 2 * second));
    bench.robot.digital = 0;
    ASSERT_TRUE(tells_armable(bench)) << "the pad was released";
    bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
    bench.run(400 * ms);
    EXPECT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, bench.arm());
    bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = false;
    ASSERT_TRUE(tells_armable(bench)) << "statuses come again";
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(Armable, ATimeFromBeforeAnotherCallDisarms) {
    Armed bench;
    const std::uint64_t before_us = bench.client_us();
    bench.run(50 * ms);
    EXPECT_EQ(ROBUROC4_ERR_CLOCK, roburoc4_client_drive(&bench.client, 0.5F, 0, 0, before_us));
    EXPECT_EQ(0, bench.facts().armed);
}

/* ---- refused, each reason alone ---- */

TEST(Arm, TwiceIsOneEvent) {
    Ready bench;
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_EVENT_ARMED), bench.take_events());
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    EXPECT_EQ(0U, bench.take_events());
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
    EXPECT_EQ(ROBUROC4_OK, bench.arm()) << "also while it drives";
    EXPECT_EQ(ROBUROC4_OK, bench.facts().arm_refusal);
}

TEST(ArmRefused, BeforeReady) {
    RobotBench bench;
    EXPECT_EQ(ROBUROC4_ERR_NOT_READY, bench.arm());
    bench.robot.powered = false;
    bench.start();
    expect_refused(bench, ROBUROC4_ERR_NOT_READY);
}

TEST(ArmRefused, WithoutDifferentialProperties) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_refused = true;
    Ready bench(robot);
    expect_refused(bench, ROBUROC4_ERR_NO_DIFFERENTIAL);
}

TEST(ArmRefused, WithLimitsThatAreNotUsable) {
    using P = roburoc4_differential_properties;
    const std::vector<std::function<void(P &)>> bad{
        [](P &p) { p.max_linear_m_s = nan_f; },     [](P &p) { p.max_linear_m_s = inf_f; },
        [](P &p) { p.min_linear_m_s = -inf_f; },    [](P &p) { p.min_linear_m_s = 0.01F; },
        [](P &p) { p.max_linear_m_s = -0.01F; },    [](P &p) { p.max_angular_rad_s = nan_f; },
        [](P &p) { p.min_angular_rad_s = -inf_f; }, [](P &p) { p.min_angular_rad_s = 0.5F; },
        [](P &p) { p.max_angular_rad_s = -1; },     [](P &p) { p.min_linear_m_s = -nan_f; }};
    for (std::size_t i = 0; i < bad.size(); i++) {
        SCOPED_TRACE(i);
        ScriptedRobot robot;
        bad[i](robot.differential);
        Ready bench(robot);
        expect_refused(bench, ROBUROC4_ERR_LIMITS);
    }
}

TEST(Arm, RequiresOnlyLimitsOfSpeed) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    ScriptedRobot robot;
    robot.differential.max_linear_m_s2 = robot.differential.min_linear_m_s2 = nan;
    robot.differential.max_angular_rad_s2 = robot.differential.min_angular_rad_s2 = nan;
    robot.differential.width_m = nan;
    robot.differential.target_linear_m_s = robot.differential.current_linear_m_s = nan;
    robot.differential.target_angular_rad_s = robot.differential.current_angular_rad_s = nan;
    Ready bench(robot);
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(ArmRefused, WithoutAFreshDifferentialStatus) {
    Ready bench;
    bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
    bench.run(400 * ms);
    expect_refused(bench, ROBUROC4_ERR_STALE_DIFFERENTIAL);
}

TEST(ArmRefused, WithoutAFreshIoCardStatus) {
    Ready bench;
    bench.robot.service(ROBUROC4_SERVICE_IOCARD).mute = true;
    bench.run(400 * ms);
    expect_refused(bench, ROBUROC4_ERR_STALE_IOCARD);
}

TEST(ArmRefused, OnStatusesFromBeforeTheClientWasStartedAgain) {
    constexpr std::uint64_t held_back = 40; /* cycles, so 400 ms */
    constexpr std::uint16_t needed[] = {ROBUROC4_SERVICE_IOCARD, ROBUROC4_SERVICE_DIFFERENTIAL};
    ScriptedRobot robot;
    roburoc4_config config = default_config();
    config.options |= ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    Bench bench(robot, config);
    bench.delay_to_client = [] { return 1 * ms; };
    bench.drop_to_client = [](const Bytes &bytes) { return bytes[0] == ROBUROC4_HEADER_STATUS; };
    bench.start();
    ASSERT_TRUE(bench.run_until([&] { return roburoc4_client_service_id(&bench.client, 6) > 0; }));
    EXPECT_EQ(ROBUROC4_ERR_UNEXPECTED_STATUS, bench.receive(robot.status_at(6, robot.cycles())));
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    for (const std::uint16_t service : needed)
        EXPECT_EQ(ROBUROC4_OK, bench.receive(robot.status_at(service, robot.cycles() - held_back)));
    expect_refused(bench, ROBUROC4_ERR_STALE_DIFFERENTIAL);
    for (const std::uint16_t service : needed)
        EXPECT_EQ(ROBUROC4_OK, bench.receive(robot.status_at(service, robot.cycles())));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(ArmRefused, WithoutTheSubscriptionsThatDrivingNeeds) {
    for (const std::uint32_t service : {2U, 6U}) {
        ScriptedRobot robot;
        robot.service(ROBUROC4_SERVICE_BATTERY).insert_refused = true; /* not what is reported */
        roburoc4_config config = default_config();
        config.subscriptions &= ~(1U << service);
        Ready bench(robot, config);
        expect_refused(bench,
                       service == 2 ? ROBUROC4_ERR_STALE_IOCARD : ROBUROC4_ERR_STALE_DIFFERENTIAL);
    }
}

TEST(ArmRefused, WithAnUnknownOverride) {
    ScriptedRobot robot;
    robot.iocard.digital_inputs = 4;
    robot.texts_refused = true;
    Ready bench(robot);
    EXPECT_EQ(0, bench.facts().override_known);
    expect_refused(bench, ROBUROC4_ERR_OVERRIDE_UNKNOWN);
}

TEST(ArmRefused, WhileOverridden) {
    ScriptedRobot robot;
    robot.press(ROBUROC4_DI_PAD_A);
    Ready bench(robot);
    EXPECT_EQ(1, bench.facts().overridden);
    expect_refused(bench, ROBUROC4_ERR_OVERRIDE);
}

TEST(ArmRefused, WhileAnotherClientCommands) {
    ScriptedRobot robot;
    robot.target_linear = 0.5F;
    Ready bench(robot);
    EXPECT_EQ(1, bench.facts().other_commander);
    expect_refused(bench, ROBUROC4_ERR_OTHER_COMMANDER);
}

TEST(ArmRefused, WhileItMovesUnasked) {
    for (int axis = 0; axis < 2; axis++) {
        ScriptedRobot robot;
        robot.follows = false;
        (axis == 0 ? robot.current_linear : robot.current_angular) = -0.5F;
        Ready bench(robot);
        expect_refused(bench, ROBUROC4_ERR_MOVING);
    }
}

TEST(ArmRefused, WhileItsOwnLastTargetIsStillShown) {
    for (int axis = 0; axis < 2; axis++) {
        SCOPED_TRACE(axis);
        Armed bench;
        bench.robot.follows = false; /* the wheels are held */
        (axis == 0 ? bench.robot.target_linear : bench.robot.target_angular) = 0.5F;
        ASSERT_EQ(ROBUROC4_OK, bench.drive(bench.robot.target_linear, bench.robot.target_angular));
        bench.run(100 * ms);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_stop(&bench.client, bench.client_us()));
        EXPECT_EQ(ROBUROC4_ERR_MOVING, bench.arm());
    }
}

TEST(ArmRefused, FromATenthOfAMetreOrTwoTenthsOfARadianPerSecondOn) {
    struct Speed {
        float linear, angular;
        bool stands;
    };
    for (const Speed &speed :
         {Speed{0.09F, 0.19F, true}, Speed{-0.09F, -0.19F, true}, Speed{0.11F, 0, false},
          Speed{-0.11F, 0, false}, Speed{0, 0.21F, false}, Speed{0, -0.21F, false}}) {
        SCOPED_TRACE(testing::Message() << speed.linear << " m/s, " << speed.angular << " rad/s");
        ScriptedRobot robot;
        robot.follows = false;
        robot.current_linear = speed.linear;
        robot.current_angular = speed.angular;
        Ready bench(robot);
        EXPECT_EQ(speed.stands ? ROBUROC4_OK : ROBUROC4_ERR_MOVING, bench.arm());
    }
}

TEST(ArmRefused, WhileItReportsASpeedThatIsNotFinite) {
    ScriptedRobot robot;
    robot.current_linear = nan_f;
    Ready bench(robot);
    expect_refused(bench, ROBUROC4_ERR_MOVING);
}

/* ---- lost while armed ---- */

TEST(Disarms, WhenTheDifferentialStatusesStop) {
    RobotBench bench;
    expect_disarmed(
        bench, ROBUROC4_ERR_STALE_DIFFERENTIAL,
        [&] { bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true; }, 300 * ms);
}

TEST(Disarms, WhenTheIoCardStatusesStop) {
    RobotBench bench;
    expect_disarmed(
        bench, ROBUROC4_ERR_STALE_IOCARD,
        [&] { bench.robot.service(ROBUROC4_SERVICE_IOCARD).mute = true; }, 300 * ms);
}

TEST(Disarms, ExactlyWhenAStatusIsTooOld) {
    for (const int muted : {ROBUROC4_SERVICE_IOCARD, ROBUROC4_SERVICE_DIFFERENTIAL}) {
        const auto service = static_cast<std::uint32_t>(muted);
        for (const std::uint32_t fresh_ms : {50U, 333U}) {
            SCOPED_TRACE(testing::Message() << "service " << service << ", " << fresh_ms << " ms");
            roburoc4_config config = default_config();
            config.fresh_ms = fresh_ms;
            config.period_ms[ROBUROC4_SERVICE_IOCARD] = 10;
            config.period_ms[ROBUROC4_SERVICE_DIFFERENTIAL] = 10;
            Armed bench(config);
            bench.robot.service(service).mute = true;
            const std::uint64_t too_old_us =
                bench.now_us - bench.service_link(service).age_us + fresh_ms * ms;
            bench.run_to(too_old_us - 1);
            EXPECT_EQ(1, bench.facts().armed);
            EXPECT_EQ(too_old_us, bench.next_us());
            bench.run_to(too_old_us);
            EXPECT_EQ(0, bench.facts().armed);
        }
    }
}

TEST(Disarms, OnTheStatusThatShowsTheOverride) {
    RobotBench bench;
    expect_disarmed(
        bench, ROBUROC4_ERR_OVERRIDE, [&] { bench.robot.press(ROBUROC4_DI_PAD_A); }, 50 * ms);
}

TEST(Disarms, NotWhenAnotherButtonIsPressed) {
    Armed bench;
    bench.robot.digital = 0x3FFFFF & ~(1U << ROBUROC4_DI_PAD_A);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.25F, 0, second));
    EXPECT_EQ(1, bench.facts().armed);
}

TEST(Disarms, WhenTheRobotIsLost) {
    roburoc4_config config = default_config();
    config.fresh_ms = 1000;
    config.lost_ms = 300;
    RobotBench bench(config);
    expect_disarmed(
        bench, ROBUROC4_ERR_LOST, [&] { bench.robot.powered = false; }, 310 * ms);
}

TEST(Disarms, OnAReboot) {
    RobotBench bench;
    expect_disarmed(
        bench, ROBUROC4_ERR_REBOOT,
        [&] {
            for (std::uint64_t i = 0; i < 3; i++)
                bench.receive(bench.robot.status_at(6, bench.robot.cycles() - 500 + i));
        },
        1);
}

TEST(Disarms, WhenTheLimitsBecomeUnusable) {
    Armed bench;
    bench.robot.differential.max_linear_m_s = nan_f;
    EXPECT_TRUE(bench.run_until([&] { return bench.facts().armed == 0; }, 10 * second));
    EXPECT_EQ(ROBUROC4_ERR_LIMITS, bench.facts().disarm_cause);
}

TEST(Disarms, WhenTheDirectoryChanges) {
    Armed bench;
    bench.robot.services.push_back({0x1111, 99, 99, "new"});
    EXPECT_TRUE(bench.run_until([&] { return bench.facts().armed == 0; }, 10 * second));
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.facts().disarm_cause);
}

TEST(Disarms, WhenAnotherClientCommands) {
    ScriptedRobot robot;
    robot.follows = false;
    Bench bench(robot);
    expect_disarmed(
        bench, ROBUROC4_ERR_OTHER_COMMANDER, [&] { robot.target_linear = -1.5F; }, 200 * ms);
}

TEST(Disarms, OnTheThirdStatusOfAnotherCommander) {
    ScriptedRobot robot;
    robot.follows = false;
    Armed bench(robot);
    robot.target_linear = -1.5F;
    for (std::uint64_t i = 1; i <= 3; i++) {
        EXPECT_EQ(1, bench.facts().armed) << i;
        bench.receive(robot.status_at(ROBUROC4_SERVICE_DIFFERENTIAL, robot.cycles() + i));
    }
    EXPECT_EQ(0, bench.facts().armed);
}

TEST(Disarms, WhenTheInputOfTheOverrideIsChanged) {
    RobotBench bench;
    expect_disarmed(
        bench, ROBUROC4_ERR_OVERRIDE_UNKNOWN,
        [&] {
            EXPECT_EQ(ROBUROC4_OK,
                      roburoc4_client_set_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE, 5,
                                                     bench.client_us()));
            EXPECT_EQ(0, bench.facts().override_known);
            EXPECT_EQ(0, bench.facts().armed) << "at once";
        },
        1);
}

TEST(Disarms, InWhicheverCallComesFirst) {
    const std::vector<std::function<void(Bench &)>> calls{
        [](Bench &b) { EXPECT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, b.arm()); },
        [](Bench &b) { EXPECT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, b.drive(0.25F, 0)); },
        [](Bench &b) {
            EXPECT_EQ(ROBUROC4_OK,
                      roburoc4_client_set_role_index(&b.client, ROBUROC4_ROLE_OVERRIDE,
                                                     ROBUROC4_DI_PAD_A, b.client_us()));
        },
        [](Bench &b) { EXPECT_TRUE(b.poll()); },
    };
    for (std::size_t i = 0; i < calls.size(); i++) {
        SCOPED_TRACE(i);
        Armed bench;
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.25F, 0, 1000000));
        bench.pump();
        bench.take_events();
        bench.now_us += 400 * ms; /* and nothing came meanwhile */
        calls[i](bench);
        EXPECT_EQ(0, bench.facts().armed);
        EXPECT_EQ(0, bench.facts().driving);
        EXPECT_EQ(1, bench.facts().stopping);
        EXPECT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, bench.facts().disarm_cause);
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_DISARMED);
    }
}

TEST(Disarms, WhenALateTextFindsTheOverride) {
    ScriptedRobot robot;
    bool silent = true;
    robot.instead = [&](const roburoc4_request &r, std::vector<Bytes> &) {
        return silent && r.action == ROBUROC4_ACTION_QUERY && r.io_type == 2 && r.index == 15;
    };
    robot.channel_text = [](std::uint32_t io_type, std::uint32_t index) {
        return io_type == ROBUROC4_IO_DIGITAL_INPUT && index == 15 ? "Game pad \"A\" button" : "";
    };
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    Started bench(robot, config);
    ASSERT_TRUE(bench.run_until([&] { return bench.arm() == ROBUROC4_OK; }));
    silent = false;
    EXPECT_TRUE(bench.run_until([&] { return bench.facts().armed == 0; }, 10 * second));
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE_UNKNOWN, bench.facts().disarm_cause);
    EXPECT_EQ(15, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
}

/** An error that does not name its text is believed some time after it came. */
TEST(Disarms, WithZerosAtOnceWhenDriveNoticesIt) {
    ScriptedRobot robot;
    robot.texts_refused = robot.error_header = true;
    bool silent = true;
    std::uint64_t asked = 0;
    robot.instead = [&](const roburoc4_request &r, std::vector<Bytes> &) {
        const bool last = r.action == ROBUROC4_ACTION_QUERY &&
                          r.io_type == ROBUROC4_IO_DIGITAL_INPUT && r.index == ROBUROC4_DI_PAD_A;
        asked += last;
        return last && silent;
    };
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    Started bench(robot, config);
    ASSERT_TRUE(bench.run_until([&] { return bench.arm() == ROBUROC4_OK; }, 600 * second));
    silent = false;
    asked = 0;
    ASSERT_TRUE(bench.run_until([&] { return asked != 0; }, 60 * second));
    roburoc4_result result = ROBUROC4_OK;
    for (int i = 0; i < 200 && result >= 0; i++) {
        bench.run(7 * ms);
        result = bench.drive(0.5F, 0);
    }
    ASSERT_EQ(ROBUROC4_ERR_OVERRIDE_UNKNOWN, result);
    ASSERT_EQ(1, bench.facts().stopping);
    bench.sent.clear();
    bench.poll();
    ASSERT_EQ(1U, bench.commands().size());
    EXPECT_EQ(0U, bench.speeds());
}

namespace {

/** A robot that keeps silent about the text of its battery, the fifth service, while `silent`. */
void keep_battery_nameless(ScriptedRobot &robot, const bool &silent) {
    robot.instead = [&silent](const roburoc4_request &r, std::vector<Bytes> &) {
        return silent && r.action == ROBUROC4_ACTION_QUERY && r.service == 0 && r.index == 4;
    };
}

} // namespace

/* If two services have this name, the one with the manual's id counts. */
TEST(Disarms, WhenALateTextNamesAnotherService) {
    ScriptedRobot robot;
    bool silent = true;
    keep_battery_nameless(robot, silent);
    robot.services.push_back({0x7100, 50, 99, "Battery"});
    Armed bench(robot);
    ASSERT_EQ(50, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_BATTERY));
    silent = false;
    EXPECT_TRUE(bench.run_until([&] { return bench.facts().armed == 0; }, 20 * second));
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.facts().disarm_cause);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    EXPECT_EQ(4, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_BATTERY));
    bench.run(second);
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.drive(0, 0));
    EXPECT_EQ(ROBUROC4_OK, bench.arm()) << "who asks may";
}

TEST(Armed, StaysWhenALateTextAddsAService) {
    ScriptedRobot robot;
    bool silent = true;
    keep_battery_nameless(robot, silent);
    Armed bench(robot);
    ASSERT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_BATTERY));
    silent = false;
    roburoc4_battery_status status;
    EXPECT_TRUE(bench.run_until(
        [&] { return roburoc4_client_battery(&bench.client, &status, nullptr) == ROBUROC4_OK; },
        20 * second));
    EXPECT_EQ(1, bench.facts().armed);
}

/* ---- a robot without the game pad's inputs ---- */

TEST(UnknownOverride, CanBeAllowed) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    for (int robot_kind = 0; robot_kind < 2; robot_kind++) {
        ScriptedRobot robot;
        if (robot_kind == 0) {
            robot.iocard.digital_inputs = 4;
            robot.texts_refused = true;
        } else {
            robot.remove(ROBUROC4_SERVICE_IOCARD);
        }
        Ready bench(robot, config);
        EXPECT_EQ(ROBUROC4_OK, bench.arm()) << robot_kind;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
        EXPECT_EQ(0.5F, robot.target_linear);
    }
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
    ScriptedRobot robot;
    robot.remove(ROBUROC4_SERVICE_IOCARD);
    Ready bench(robot, config);
    EXPECT_EQ(ROBUROC4_ERR_SUBSCRIPTION_REFUSED, bench.arm()) << "but not of an input that was set";
}

/* There may be a card of unknown type with another id than the manual's, until texts are read. */
TEST(UnknownOverride, IsNotAllowedWhileAServiceIsNotKnown) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_IOCARD).type = 0x7100;
    robot.service(ROBUROC4_SERVICE_IOCARD).id = 20;
    robot.texts_silent = true;
    Ready bench(robot, config);
    EXPECT_EQ(ROBUROC4_ERR_STALE_IOCARD, bench.arm());
    bench.run(20 * second); /* they were given up */
    EXPECT_EQ(ROBUROC4_ERR_STALE_IOCARD, bench.arm());
    robot.service(ROBUROC4_SERVICE_IOCARD).text = "Camera"; /* it is none */
    robot.texts_silent = false;
    bench.close();
    bench.ready();
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(UnknownOverride, IsNotAllowedWhereATextNamesIt) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    for (const bool doubly : {true, false}) {
        ScriptedRobot robot;
        robot.channel_text = [&](std::uint32_t, std::uint32_t index) {
            return std::string(index == 4 || (doubly && index == 5) ? "Game pad A" : "spare");
        };
        robot.instead = [&](const roburoc4_request &request, std::vector<Bytes> &) {
            return !doubly && request.action == ROBUROC4_ACTION_QUERY && request.index == 5;
        };
        Ready bench(robot, config);
        bench.run(60 * second);
        EXPECT_EQ(1, bench.facts().descriptions_done);
        EXPECT_EQ(ROBUROC4_ERR_OVERRIDE_UNKNOWN, bench.arm()) << doubly;
    }
}

TEST(UnknownOverride, IsNotAllowedIfTheCardThatWasSetIsNotListed) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    config.iocard_id = 9;
    Ready bench(config);
    bench.run(20 * second);
    EXPECT_EQ(ROBUROC4_ERR_SUBSCRIPTION_REFUSED, bench.arm());
}

TEST(UnknownOverride, IsNotAllowedWhereNotEverythingCanBeLookedAt) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    enum Way { NO_CARD, SAID_TO_HAVE_NONE, MANY_INPUTS };
    for (const Way way : {NO_CARD, SAID_TO_HAVE_NONE, MANY_INPUTS}) {
        ScriptedRobot robot;
        config.role_index[ROBUROC4_ROLE_OVERRIDE] =
            way == SAID_TO_HAVE_NONE ? 40 : ROBUROC4_INDEX_AUTO;
        if (way == NO_CARD)
            robot.remove(ROBUROC4_SERVICE_IOCARD);
        robot.texts_refused = way == SAID_TO_HAVE_NONE;
        if (way != MANY_INPUTS) {
            for (std::uint16_t id = 20; id < 34; id++) {
                ScriptedService laser = robot.services.back();
                laser.kind = ROBUROC4_SERVICE_COUNT;
                laser.id = id;
                laser.type = ROBUROC4_TYPE_LASER;
                robot.services.push_back(laser);
            }
        } else {
            robot.iocard.digital_inputs = 65;
        }
        Ready bench(robot, config);
        bench.run(20 * second);
        EXPECT_GT(0, bench.arm()) << way;
    }
}

/* A short outage while texts are read must not hide [A] for good. */
TEST(UnknownOverride, IsLookedForWhileTheRobotIsDriven) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    ScriptedRobot robot;
    robot.texts_silent = true;
    Ready bench(robot, config);
    ASSERT_TRUE(bench.run_until([&] { return bench.arm() == ROBUROC4_OK; }, 600 * second));
    robot.texts_silent = false;
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE_UNKNOWN, bench.drive_until_refused(0.3F, 0, 60 * second))
        << "found, but not seen yet";
    ASSERT_TRUE(bench.run_until([&] { return bench.arm() == ROBUROC4_OK; }, 60 * second));
    EXPECT_EQ(1, bench.facts().override_known);
    robot.press(ROBUROC4_DI_PAD_A);
    bench.run(60 * ms);
    EXPECT_EQ(0, bench.facts().armed);
}

TEST(UnknownOverride, IsNotAllowedBeforeTextsWereRequested) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    ScriptedRobot robot;
    robot.texts_silent = true;
    Ready bench(robot, config);
    expect_refused(bench, ROBUROC4_ERR_OVERRIDE_UNKNOWN);
    ASSERT_TRUE(
        bench.run_until([&] { return bench.facts().descriptions_done == 1; }, 600 * second));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(UnknownOverride, IsNotAllowedBeforeAListedCardGaveItsCounts) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    for (int way = 0; way < 3; way++) {
        SCOPED_TRACE(way);
        ScriptedRobot robot;
        ScriptedService &card = robot.service(ROBUROC4_SERVICE_IOCARD);
        card.get_refused = way == 0;
        card.get_silent = way == 1;
        card.get_length = way == 2 ? 20 : 0;
        Ready bench(robot, config);
        expect_refused(bench, ROBUROC4_ERR_STALE_IOCARD);
    }
}

TEST(UnknownOverride, AllowedStillObeysAKnownOverride) {
    for (const int input : {ROBUROC4_DI_PAD_A, 0, 1}) {
        SCOPED_TRACE(input);
        roburoc4_config config = default_config();
        config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
        config.role_index[ROBUROC4_ROLE_OVERRIDE] = static_cast<std::int16_t>(input);
        Armed bench(config);
        bench.robot.press(static_cast<std::uint32_t>(input));
        bench.run(60 * ms);
        EXPECT_EQ(0, bench.facts().armed);
        expect_refused(bench, ROBUROC4_ERR_OVERRIDE);
        bench.robot.service(ROBUROC4_SERVICE_IOCARD).mute = true;
        bench.run(400 * ms);
        EXPECT_EQ(ROBUROC4_ERR_STALE_IOCARD, bench.arm()) << "the robot has a game pad";
    }
}

TEST(Override, IsNotChangedByALateTextOfTheCardBefore) {
    RobotBench bench;
    roburoc4_request late{};
    bench.robot.iocard.digital_inputs = 40;
    bench.robot.instead = [&](const roburoc4_request &request, std::vector<Bytes> &) {
        const bool held = request.action == ROBUROC4_ACTION_QUERY &&
                          request.service == ROBUROC4_SERVICE_IOCARD &&
                          request.io_type == ROBUROC4_IO_DIGITAL_INPUT && request.index == 39;
        late = held ? request : late;
        return held;
    };
    bench.start();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    ASSERT_EQ(39, late.index);
    bench.robot.iocard.digital_inputs = 22;
    ASSERT_TRUE(bench.run_until([&] { return bench.facts().override_known == 1; }, 5 * second));
    const std::string text = "Game pad \"A\" button";
    EXPECT_EQ(ROBUROC4_ERR_UNMATCHED, bench.receive(encoded([&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_text(b, n, late.id, late.service, text.data(), text.size());
    })));
    EXPECT_EQ(ROBUROC4_DI_PAD_A, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
}

TEST(UnknownOverride, IsNotThatOfARemovedCard) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    Ready bench(config);
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.run(60 * ms);
    ASSERT_EQ(1, bench.facts().overridden);
    bench.robot.remove(ROBUROC4_SERVICE_IOCARD);
    ASSERT_TRUE(bench.run_until(
        [&] { return roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_IOCARD) < 0; }));
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(second);
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
    bench.robot.follows = false;
    bench.robot.target_linear = -1; /* somebody else's */
    bench.run(second);
    EXPECT_EQ(1, bench.facts().other_commander);
    EXPECT_EQ(ROBUROC4_ERR_OTHER_COMMANDER, bench.facts().disarm_cause);
}
