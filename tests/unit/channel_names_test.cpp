/* SPDX-License-Identifier: MIT
 *
 * Names of the channels of a robot's card, and channels by their names.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint32_t analog = ROBUROC4_IO_ANALOG_INPUT;
constexpr std::uint32_t digital = ROBUROC4_IO_DIGITAL_INPUT;

/** A robot that sends no texts, with this many inputs. */
ScriptedRobot silent_robot(std::int32_t digital_inputs, std::int32_t analog_inputs) {
    ScriptedRobot robot;
    robot.texts_refused = true;
    robot.iocard.digital_inputs = digital_inputs;
    robot.iocard.analog_inputs = analog_inputs;
    robot.analog.resize(static_cast<std::size_t>(analog_inputs));
    return robot;
}

std::string name(const Bench &bench, std::uint32_t io_type, std::uint32_t index) {
    const char *found = roburoc4_client_channel_name(&bench.client, io_type, index);
    return found != nullptr ? found : "none";
}

roburoc4_result find(const Bench &bench, const char *wanted, std::uint32_t io_type = digital,
                     const std::vector<const char *> &texts = {}) {
    return roburoc4_client_channel_find(&bench.client, io_type, wanted, texts.data(),
                                        static_cast<std::uint32_t>(texts.size()));
}

TEST(ChannelName, IsTheManualsAtItsIndexOnTheUsualCard) {
    ScriptedRobot robot = silent_robot(22, 9);
    Ready bench(robot);
    for (std::uint32_t index = 0; index < 22; index++)
        EXPECT_STREQ(roburoc4_client_channel_name(nullptr, digital, index),
                     roburoc4_client_channel_name(&bench.client, digital, index));
    EXPECT_EQ("Game pad \"A\" button", name(bench, digital, 8));
    EXPECT_EQ("Battery voltage", name(bench, analog, 2));
    EXPECT_EQ("Watchdog", name(bench, ROBUROC4_IO_DIGITAL_OUTPUT, 0));
    EXPECT_EQ("none", name(bench, digital, 22));
    EXPECT_EQ("none", name(bench, ROBUROC4_IO_ANALOG_OUTPUT, 0));
    EXPECT_EQ("none", name(bench, 4, 0));
}

TEST(ChannelName, IsNoneForOutputsThatTheManualDoesNotHave) {
    ScriptedRobot robot = silent_robot(22, 9);
    robot.iocard.analog_outputs = 2;
    Ready bench(robot);
    EXPECT_EQ("none", name(bench, ROBUROC4_IO_ANALOG_OUTPUT, 1));
}

TEST(ChannelFind, LooksAtNoMoreChannelsThanAClientStores) {
    ScriptedRobot robot = silent_robot(100, 9);
    Ready bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_INDEX, find(bench, "{front} bumper~"));
    EXPECT_EQ(ROBUROC4_ERR_INDEX,
              roburoc4_client_channel_find(&bench.client, digital, "lamp", nullptr, 5));
    std::vector<const char *> texts(100, "?");
    texts[64] = "lamp";
    EXPECT_EQ(ROBUROC4_ERR_INDEX, find(bench, "lamp", digital, texts));
}

TEST(ChannelFind, AnInputThatWasSetHasTheManualsNameToo) {
    roburoc4_config config = default_config();
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = 12;
    config.role_index[ROBUROC4_ROLE_FRONT_BUMPER] = 13;
    ScriptedRobot robot = silent_robot(22, 9);
    Ready bench(robot, config);
    const std::vector<const char *> texts(22, "spare");
    EXPECT_EQ(12, find(bench, "Game pad \"A\" button", digital, texts));
    EXPECT_EQ(13, find(bench, "Front bumper", digital, texts));
}

TEST(ChannelName, HasTheManualsNumberOnACardWithOneInputMore) {
    ScriptedRobot robot = silent_robot(23, 10);
    Ready bench(robot);
    EXPECT_EQ("Rear bumper", name(bench, digital, 1));
    EXPECT_EQ("none", name(bench, digital, 2));
    EXPECT_EQ("", name(bench, digital, 3));
    EXPECT_EQ("", name(bench, digital, 8));
    EXPECT_EQ("Game pad \"A\" button", name(bench, digital, 9));
    EXPECT_EQ("Game pad \"RB\" button", name(bench, digital, 22));
    EXPECT_EQ("Battery voltage", name(bench, analog, 3));
    EXPECT_EQ(9, find(bench, "Game pad \"A\" button"));
}

TEST(ChannelName, IsNoneOnACardThatTheManualDoesNotKnow) {
    for (const std::int32_t inputs : {0, 8, 21, 24, 40}) {
        ScriptedRobot robot = silent_robot(inputs, inputs);
        Ready bench(robot);
        for (std::uint32_t index = 0; index < 64; index++)
            EXPECT_EQ("none", name(bench, digital, index)) << inputs;
        EXPECT_EQ(ROBUROC4_ERR_INDEX, find(bench, "Front bumper"));
    }
}

TEST(ChannelName, OfTheManualGoesToTheInputWithTheRole) {
    ScriptedRobot robot;
    robot.channel_text = [](std::uint32_t io_type, std::uint32_t index) -> std::string {
        return io_type == digital && index == 12 ? "Game pad A button" : "?";
    };
    Ready bench(robot);
    EXPECT_EQ("Game pad \"A\" button", name(bench, digital, 12));
    EXPECT_EQ("none", name(bench, digital, 8));
    EXPECT_EQ(12, find(bench, "Game pad \"A\" button"));
    std::vector<const char *> texts(22, "Front bumper");
    EXPECT_EQ(0, find(bench, "Front bumper", digital, texts)) << "the input with the role";
}

TEST(ChannelName, OfTheOverrideGoesToTheInputOfTheUser) {
    ScriptedRobot robot = silent_robot(22, 9);
    roburoc4_config config = default_config();
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = 20;
    Ready bench(robot, config);
    EXPECT_EQ("Game pad \"A\" button", name(bench, digital, 20));
    EXPECT_EQ("none", name(bench, digital, 8));
}

TEST(ChannelName, IsUnknownBeforeTheRobotReportsItsCard) {
    ScriptedRobot robot;
    robot.powered = false;
    Bench bench(robot);
    bench.run(second);
    EXPECT_EQ("none", name(bench, digital, 0));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, find(bench, "Front bumper"));
}

TEST(ChannelFind, ComparesWordsWhateverTheirFormAndOrder) {
    ScriptedRobot robot = silent_robot(22, 9);
    Ready bench(robot);
    for (const char *wanted : {"Game pad \"B\" button", "gamepad b", "Button B, game-pad",
                               "Joystick button B", "  B (GAMEPAD)", "Button, button B: gamepad"})
        EXPECT_EQ(9, find(bench, wanted)) << wanted;
    EXPECT_EQ(0, find(bench, "bumper, front"));
    EXPECT_EQ(4, find(bench, "gamepad lj up/down", analog));
    for (const char *wanted : {"", " ", "?", "button", "bumper", "front front bumper", "gamepad",
                               "frontbumper", "game b", "pad b", "front bumpe", "gamepad b b"})
        EXPECT_EQ(ROBUROC4_ERR_INDEX, find(bench, wanted)) << wanted;
    EXPECT_EQ(ROBUROC4_ERR_INDEX, find(bench, "Front bumper", analog));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, find(bench, "Front bumper", 4));
}

TEST(ChannelFind, BelievesTheRobotsOwnTextsFirst) {
    ScriptedRobot robot = silent_robot(22, 9);
    Ready bench(robot);
    std::vector<const char *> texts(22, nullptr);
    texts[9] = "Gamepad X";  // which the manual has at 10
    texts[10] = "Gamepad B"; // which the manual has at 9
    texts[15] = "Grüne Lampe";
    texts[16] = "";
    EXPECT_EQ(9, find(bench, "Game pad \"X\" button", digital, texts));
    EXPECT_EQ(10, find(bench, "Game pad \"B\" button", digital, texts));
    EXPECT_EQ(15, find(bench, "lampe grüne", digital, texts));
    EXPECT_EQ(16, find(bench, "game pad \"D\" right", digital, texts)) << "an empty text is none";
    EXPECT_EQ(ROBUROC4_ERR_INDEX, find(bench, "game pad \"D\" left", digital, texts));
}

TEST(ChannelFind, ReportsANameThatTwoChannelsHave) {
    ScriptedRobot robot = silent_robot(22, 9);
    Ready bench(robot);
    std::vector<const char *> texts(22, nullptr);
    texts[0] = texts[1] = "Spare";
    EXPECT_EQ(ROBUROC4_ERR_VALUE, find(bench, "spare", digital, texts));
}

TEST(ChannelFind, TellsDigitsAndForeignLettersApart) {
    ScriptedRobot robot = silent_robot(22, 9);
    Ready bench(robot);
    std::vector<const char *> texts(22, nullptr);
    texts[15] = "Lamp 1";
    texts[16] = "Lamp 2";
    texts[17] = "Tür";
    texts[18] = "Tor";
    texts[19] = "Tör";
    EXPECT_EQ(16, find(bench, "lamp 2", digital, texts));
    EXPECT_EQ(17, find(bench, "Tür", digital, texts));
    EXPECT_EQ(19, find(bench, "Tör", digital, texts));
}

} // namespace
