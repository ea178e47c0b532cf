/* SPDX-License-Identifier: MIT
 *
 * Services that the program names by their ids, for a robot that says nothing about itself.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

/** A robot whose types, texts and ids say nothing. */
void say_nothing(ScriptedRobot &robot) {
    for (ScriptedService &service : robot.services) {
        service.text = "service";
        if (service.id > ROBUROC4_SERVICE_NOTIFICATION) {
            service.type = 0x7100;
            service.id = static_cast<std::uint16_t>(service.id + 50);
        }
    }
}

} // namespace

TEST(ConfiguredIds, ARobotThatSaysNothingCanBeDriven) {
    for (const bool texts_refused : {false, true}) {
        SCOPED_TRACE(texts_refused);
        ScriptedRobot robot;
        say_nothing(robot);
        roburoc4_config config = default_config();
        Bench without(robot, config);
        without.ready();
        EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, without.arm());
        robot.reboot();
        robot.instead = [texts_refused](const roburoc4_request &r, std::vector<Bytes> &answers) {
            if (!texts_refused || r.action != ROBUROC4_ACTION_QUERY || r.service != 0)
                return false;
            answers.push_back(plain_answer(r.id, r.action, r.service, ROBUROC4_ERROR_UNSUPPORTED));
            return true;
        };
        config.iocard_id = 52;
        config.differential_id = 56;
        Bench bench(robot, config, without.now_us);
        bench.ready();
        EXPECT_EQ(52, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_IOCARD));
        EXPECT_EQ(56, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL));
        ASSERT_EQ(ROBUROC4_OK, bench.arm());
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
        EXPECT_EQ(0.5F, robot.target_linear);
        robot.press(ROBUROC4_DI_PAD_A);
        bench.run(100 * ms);
        EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.facts().disarm_cause);
    }
}

TEST(ConfiguredIds, GoBeforeTypesAndTexts) {
    ScriptedRobot robot; /* whose directory has types and texts of two differential services */
    robot.services.push_back({ROBUROC4_TYPE_DIFFERENTIAL, 9, 6, "Differential"});
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_silent = true;
    roburoc4_config config = default_config();
    config.differential_id = 9;
    Ready bench(robot, config);
    EXPECT_EQ(9, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL));
    EXPECT_TRUE(robot.seen(ROBUROC4_ACTION_GET, 6).empty());
}

TEST(ConfiguredIds, ThatTheDirectoryDoesNotListAreNoService) {
    roburoc4_config config = default_config();
    config.differential_id = 77;
    Ready bench(config);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL));
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.arm());
    EXPECT_EQ(1U << ROBUROC4_SERVICE_DIFFERENTIAL, bench.facts().missing);
}

TEST(ConfiguredIds, StillRequireFullPropertiesAndLimits) {
    for (const bool cut : {false, true}) {
        ScriptedRobot robot;
        say_nothing(robot);
        roburoc4_config config = default_config();
        config.iocard_id = 52;
        config.differential_id = cut ? 56 : 54; /* 54 is the battery */
        robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_length = cut ? 40 : 0;
        Ready bench(robot, config);
        EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.arm()) << cut;
        ASSERT_EQ(ROBUROC4_OK, bench.stop());
        bench.run(3 * second);
        EXPECT_EQ(0U, bench.commands().size()) << cut;
    }
}
