/* SPDX-License-Identifier: MIT
 *
 * Which inputs are the override and the bumpers, by the texts of the robot, and what is known of
 * them.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

/** The input with a role if its text is this one, and all others say nothing. */
roburoc4_result role_with_text(std::uint32_t role, const std::string &text) {
    ScriptedRobot robot;
    robot.channel_text = [&](std::uint32_t type, std::uint32_t index) -> std::string {
        return type == ROBUROC4_IO_DIGITAL_INPUT && index == 12 ? text : "spare";
    };
    Ready bench(robot);
    return roburoc4_client_role_index(&bench.client, role);
}

/** Texts come this late. */
struct LateTextsRobot : LateRobot {
    std::uint64_t texts_us = 0;

  private:
    std::uint64_t late_us(const Bytes &bytes) override {
        return !is_status(bytes) && bytes[1] == ROBUROC4_ACTION_QUERY ? texts_us : 0;
    }
};

} // namespace

TEST(OverrideText, ConsistsExactlyOfTheWordsForIt) {
    for (const char *text :
         {"Game pad A", "Game pad \"A\" button", "GAMEPAD A", "Gamepad \"a\" button",
          "Joystick button A", "joystick A", "A (game pad)", "Button A, Joystick", "A: game-pad",
          "A button game pad",
          "Game pad \x93"
          "A\x94 button",
          "Game pad \xAB"
          "A\xBB",
          "Game pad \xE2\x80\x9C"
          "A\xE2\x80\x9D button",
          "Game pad\xA0"
          "A"})
        EXPECT_EQ(12, role_with_text(ROBUROC4_ROLE_OVERRIDE, text)) << text;
    for (const char *text :
         {"Game pad A LED", "Game pad battery A", "Game pad A axis", "A axis", "Game pad A B",
          "Game pad A A", "Game pad", "A", "", "Game A", "Pad A", "Game pad B", "Game pad A\xE9",
          "Game pad A \xE2", "Gamepad joystick A", "Not game pad A", "Game pad A 2"})
        EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, role_with_text(ROBUROC4_ROLE_OVERRIDE, text)) << text;
}

/** Because a text may be as long as a datagram, and searching it takes time. */
TEST(OverrideText, IsSearchedInItsFirst255Bytes) {
    const struct {
        std::size_t before, behind;
        const char *more;
        roburoc4_result index;
    } cases[] = {{245, 0, "", 12},
                 {246, 0, "", ROBUROC4_ERR_NOT_KNOWN},
                 {0, 300, "", 12},
                 {0, 240, "LED", ROBUROC4_ERR_NOT_KNOWN},
                 {0, 245, "LED", 12}};
    for (const auto &c : cases)
        EXPECT_EQ(c.index,
                  role_with_text(ROBUROC4_ROLE_OVERRIDE, std::string(c.before, ' ') + "Game pad A" +
                                                             std::string(c.behind, ' ') + c.more))
            << c.before << " " << c.behind;
}

TEST(OverrideText, IsFoundAmongAsManyInputsAsAreStored) {
    for (const std::int32_t count : {63, 64, 65}) {
        ScriptedRobot robot;
        robot.iocard.digital_inputs = count;
        robot.channel_text = [](std::uint32_t type, std::uint32_t index) -> std::string {
            return type == ROBUROC4_IO_DIGITAL_INPUT && index == 62 ? "Game pad A" : "spare";
        };
        Ready bench(robot);
        EXPECT_EQ(count <= ROBUROC4_MAX_DIGITAL_INPUTS ? 62 : ROBUROC4_ERR_NOT_KNOWN,
                  roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE))
            << count;
    }
}

TEST(OverrideText, MayBeThatOfAnInputThatIsNotStored) {
    ScriptedRobot robot;
    robot.iocard.digital_inputs = ROBUROC4_MAX_DIGITAL_INPUTS + 8;
    robot.channel_text = [](std::uint32_t, std::uint32_t) { return std::string("spare"); };
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    Bench bench(robot, config);
    bench.ready();
    bench.run(30 * second);
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE_UNKNOWN, bench.arm());
}

TEST(OverrideText, RefusedOfTheCardBeforeSaysNothingOfTheNextOne) {
    ScriptedRobot robot;
    robot.texts_refused = true;
    Ready bench(robot);
    ASSERT_EQ(ROBUROC4_DI_PAD_A, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
    ASSERT_EQ(1, bench.facts().front_bumper_known);
    robot.texts_refused = false;
    robot.channel_text = [](std::uint32_t, std::uint32_t) { return std::string("spare"); };
    robot.iocard.digital_inputs = ROBUROC4_DI_COUNT + 1; /* to which the manual's table fits, too */
    bench.run(20 * second);
    roburoc4_iocard_properties card{};
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_iocard_properties(&bench.client, &card));
    ASSERT_EQ(ROBUROC4_DI_COUNT + 1, card.digital_inputs);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
    EXPECT_EQ(0, bench.facts().front_bumper_known);
}

TEST(Bumper, WithSeveralInputsIsPressedIfAnyIs) {
    ScriptedRobot robot;
    robot.channel_text = [](std::uint32_t type, std::uint32_t index) -> std::string {
        const std::map<std::uint32_t, std::string> texts{{3, "Front bumper left"},
                                                         {5, "Right front bumper"},
                                                         {6, "REAR BUMPER 1"},
                                                         {7, "bumper (rear) 2"},
                                                         {8, "Game pad A"}};
        return type == ROBUROC4_IO_DIGITAL_INPUT && texts.count(index) > 0 ? texts.at(index)
                                                                           : "spare";
    };
    Ready bench(robot);
    EXPECT_EQ(3, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_FRONT_BUMPER));
    EXPECT_EQ(6, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_REAR_BUMPER));
    EXPECT_EQ(1, bench.facts().front_bumper_known);
    EXPECT_EQ(1, bench.facts().rear_bumper_known);
    for (std::uint32_t input = 0; input < 22; input++) {
        robot.digital = std::uint64_t{1} << input;
        bench.run(100 * ms);
        EXPECT_EQ(input == 3 || input == 5, bench.facts().front_bumper) << input;
        EXPECT_EQ(input == 6 || input == 7, bench.facts().rear_bumper) << input;
    }
    robot.digital = 0;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_set_role_index(&bench.client, ROBUROC4_ROLE_FRONT_BUMPER,
                                                          10, bench.client_us()));
    robot.press(3);
    bench.run(100 * ms);
    EXPECT_EQ(0, bench.facts().front_bumper) << "the program's choice";
    EXPECT_EQ(1, bench.facts().front_bumper_known);
    robot.press(10);
    bench.run(100 * ms);
    EXPECT_EQ(1, bench.facts().front_bumper);
}

TEST(Bumper, IsKnownOnlyIfTheTextsSayWhichInputItIs) {
    enum { NAMED, ALL_REFUSED, UNNAMED, ONE_MISSING, OTHER_COUNT, CASES };
    for (int way = 0; way < CASES; way++) {
        SCOPED_TRACE(way);
        ScriptedRobot robot;
        robot.texts_refused = way == ALL_REFUSED;
        if (way == UNNAMED || way == OTHER_COUNT)
            robot.channel_text = [](std::uint32_t, std::uint32_t) { return ""; };
        if (way == OTHER_COUNT)
            robot.iocard.digital_inputs = 30;
        robot.instead = [way](const roburoc4_request &r, std::vector<Bytes> &) {
            return way == ONE_MISSING && r.action == ROBUROC4_ACTION_QUERY && r.service == 2 &&
                   r.io_type == ROBUROC4_IO_DIGITAL_INPUT && r.index == ROBUROC4_DI_PAD_A;
        };
        Started bench(robot);
        EXPECT_EQ(0, bench.facts().front_bumper_known);
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
        bench.run(30 * second);
        const bool known = way == NAMED || way == ALL_REFUSED;
        EXPECT_EQ(known, bench.facts().front_bumper_known);
        EXPECT_EQ(known, bench.facts().rear_bumper_known);
        EXPECT_EQ(known ? ROBUROC4_OK : ROBUROC4_ERR_OVERRIDE_UNKNOWN, bench.arm());
    }
}

TEST(Bumper, IsUnknownUntilAStatusOfTheFoundRobotAndAfterALoss) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_IOCARD).mute = true;
    Ready bench(robot);
    EXPECT_EQ(0, bench.facts().front_bumper_known);
    EXPECT_EQ(UINT32_MAX, bench.facts().age_us[ROBUROC4_SERVICE_IOCARD]);
    robot.service(ROBUROC4_SERVICE_IOCARD).mute = false;
    bench.run(100 * ms);
    EXPECT_EQ(1, bench.facts().front_bumper_known);
    const std::uint32_t age_us = bench.facts().age_us[ROBUROC4_SERVICE_IOCARD];
    EXPECT_LT(age_us, 200000U);
    bench.now_us += 7;
    EXPECT_EQ(age_us + 7, bench.facts().age_us[ROBUROC4_SERVICE_IOCARD]) << "ages by itself";
    EXPECT_EQ(1, bench.facts().battery_known);
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    const roburoc4_facts lost = bench.facts();
    EXPECT_EQ(0, lost.front_bumper_known);
    EXPECT_EQ(0, lost.rear_bumper_known);
    EXPECT_EQ(0, lost.battery_known);
    EXPECT_EQ(0, lost.override_known);
    for (const std::uint32_t age : lost.age_us)
        EXPECT_EQ(UINT32_MAX, age);
}

/* The family's texts are up to 3 s late, and an outage may hide the first ones. */
TEST(InputTexts, AreFoundLaterHoweverLateTheyCome) {
    for (const std::uint32_t retry_ms : {10U, 100U})
        for (const std::uint64_t late_us : {200 * ms, 3 * second}) {
            roburoc4_config config = default_config();
            config.first_retry_ms = retry_ms;
            LateTextsRobot robot;
            robot.texts_us = late_us;
            robot.texts_silent = true;
            Ready bench(robot, config);
            bench.run(30 * second);
            robot.texts_silent = false;
            EXPECT_TRUE(bench.run_until([&] { return bench.arm() == ROBUROC4_OK; }, 300 * second))
                << retry_ms << " " << late_us;
        }
}
