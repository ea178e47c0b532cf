/* SPDX-License-Identifier: MIT
 *
 * The core without texts, statistics and fixed-id mode (the options at the head of roburoc4.h).
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

roburoc4_config where_things_are() {
    roburoc4_config config = default_config();
    config.iocard_id = ROBUROC4_SERVICE_IOCARD;
    config.differential_id = ROBUROC4_SERVICE_DIFFERENTIAL;
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
    return config;
}

} // namespace

TEST(Small, DrivesAndAsksForNoText) {
    ScriptedRobot robot;
    Bench bench(robot, where_things_are());
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0.25F, 2 * second));
    EXPECT_GT(bench.speeds(), 30U);
    bench.run(3 * second);
    EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    EXPECT_TRUE(robot.seen(ROBUROC4_ACTION_QUERY).empty());
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_SENT));
}

TEST(Small, NeverAsksWithTheManualsId) {
    ScriptedRobot robot;
    robot.instead = [](const roburoc4_request &, std::vector<Bytes> &) { return true; };
    Bench bench(robot, where_things_are());
    bench.start();
    bench.run(20 * second);
    EXPECT_GT(robot.requests.size(), 10U);
    for (const auto &request : robot.requests)
        EXPECT_NE(ROBUROC4_HEADER_MANUAL, request.what.id);
}

TEST(Small, TheGamePadDisarms) {
    ScriptedRobot robot;
    Bench bench(robot, where_things_are());
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 500 * ms));
    robot.press(ROBUROC4_DI_PAD_A);
    bench.run(200 * ms);
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.facts().disarm_cause);
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.arm());
}

/** The option says that nobody will press [A], not where the card is. */
TEST(Small, TheOptionOfAnUnknownOverrideNeedsTheCardAndAnIndexToo) {
    roburoc4_config config = where_things_are();
    config.options |= ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = 63;
    ScriptedRobot robot;
    Bench bench(robot, config);
    bench.armed();
    config.iocard_id = ROBUROC4_ID_AUTO;
    Bench without(robot, config);
    without.start();
    ASSERT_TRUE(without.run_until_state(ROBUROC4_STATE_READY));
    without.run(5 * second);
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE_UNKNOWN, without.arm());
}

TEST(Small, IsNotArmedUnlessTheProgramSaysWhereThingsAre) {
    for (int missing = 0; missing < 6; missing++) {
        SCOPED_TRACE(missing);
        roburoc4_config config = where_things_are();
        config.options |= missing >= 3 ? ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE : 0;
        if (missing % 3 == 0)
            config.differential_id = ROBUROC4_ID_AUTO;
        else if (missing % 3 == 1)
            config.iocard_id = ROBUROC4_ID_AUTO;
        else
            config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_INDEX_AUTO;
        ScriptedRobot robot;
        Bench bench(robot, config);
        bench.start();
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
        bench.run(5 * second);
        EXPECT_EQ(missing % 3 == 0 ? ROBUROC4_ERR_NO_DIFFERENTIAL : ROBUROC4_ERR_OVERRIDE_UNKNOWN,
                  bench.arm());
    }
}
