/* SPDX-License-Identifier: MIT
 *
 * Robot files: what is read is what was written, a bad line is named with its remedy, and a file
 * makes a configuration.
 */
#include "roburoc4_robot_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

namespace {

roburoc4_robot_file empty() {
    roburoc4_robot_file file;
    std::memset(&file, 0, sizeof file);
    return file;
}

roburoc4_robot_file file_of(const std::string &text) {
    roburoc4_robot_file file = empty();
    const char *remedy = "";
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_robot_file_read(&file, text.data(), text.size(), nullptr, &remedy))
        << remedy;
    return file;
}

std::string text_of(const roburoc4_robot_file &file) {
    char text[ROBUROC4_ROBOT_FILE_SIZE];
    const roburoc4_result length = roburoc4_robot_file_write(&file, text, sizeof text);
    EXPECT_GT(length, 0);
    return std::string(text, static_cast<std::size_t>(length));
}

void expect_wrong(const std::string &text, std::uint32_t line, const std::string &part) {
    roburoc4_robot_file file = empty();
    const roburoc4_robot_file before = file;
    std::uint32_t found = 0;
    const char *remedy = "";
    EXPECT_EQ(ROBUROC4_ERR_CONFIG,
              roburoc4_robot_file_read(&file, text.data(), text.size(), &found, &remedy))
        << text;
    EXPECT_EQ(line, found) << text;
    EXPECT_NE(std::string::npos, std::string(remedy).find(part)) << text << ": " << remedy;
    EXPECT_EQ(0, std::memcmp(&before, &file, sizeof file)) << text;
}

TEST(RobotFile, EveryNameIsReadAsItWasWritten) {
    roburoc4_robot_file file = empty();
    const char *name = nullptr;
    std::uint32_t count = 0;
    for (; (name = roburoc4_robot_file_name(count)) != nullptr; count++) {
        const float values[] = {static_cast<float>(count + 2), 1.03456F, 0.0F, 0.01F, 1.0F, 100.0F};
        bool stored = false;
        for (const float value : values)
            stored = stored || roburoc4_robot_file_set(&file, name, value) == ROBUROC4_OK;
        EXPECT_TRUE(stored) << name;
    }
    EXPECT_GT(count, 60U);
    const roburoc4_robot_file again = file_of(text_of(file));
    for (std::uint32_t index = 0; (name = roburoc4_robot_file_name(index)) != nullptr; index++) {
        float mine = -1, read = -2;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_get(&file, name, &mine));
        EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_get(&again, name, &read));
        EXPECT_NEAR(mine, read, 1e-5F) << name;
    }
}

TEST(RobotFile, ReadsWhatAPersonWrites) {
    const roburoc4_robot_file file =
        file_of("\xEF\xBB\xBF# mine\r\n\r\n[inputs]\r\n\toverride_index=9 ; the pad\r\n"
                "telemeter_turn_rad = -1.25\nscale_linear = 0.970 # measured\n linear_gain=.95");
    float value = 0;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_get(&file, "override_index", &value));
    EXPECT_EQ(9.0F, value);
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_get(&file, "telemeter_turn_rad", &value));
    EXPECT_EQ(-1.25F, value);
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_get(&file, "linear_gain", &value));
    EXPECT_EQ(0.95F, value);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, roburoc4_robot_file_get(&file, "iocard_id", &value));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, roburoc4_robot_file_get(&file, "nonsense", &value));
    EXPECT_EQ("# A RobuROC4: docs/first-contact.md explains the names.\n"
              "\n[inputs]\noverride_index = 9\n"
              "\n[telemeters]\ntelemeter_turn_rad = -1.25\n"
              "\n[response]\nlinear_gain = 0.95\n"
              "\n[calibration]\nscale_linear = 0.97\n",
              text_of(file));
}

TEST(RobotFile, ThatOfThePageIsRead) {
    std::ifstream page(ROBUROC4_SOURCE_DIR "/docs/first-contact.md");
    std::stringstream whole;
    whole << page.rdbuf();
    const std::string text = whole.str(), opening = "```ini\n";
    const std::size_t begin = text.find(opening);
    ASSERT_NE(std::string::npos, begin);
    const std::size_t from = begin + opening.size();
    const roburoc4_robot_file file = file_of(text.substr(from, text.find("```", from) - from));
    float value = 0;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_get(&file, "override_index", &value));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_get(&file, "scale_angular", &value));
}

TEST(RobotFile, ABadLineIsNamedWithItsRemedy) {
    expect_wrong("", 1, "roburoc4 first-contact");
    expect_wrong("# nothing\n\n", 1, "roburoc4 first-contact");
    expect_wrong("{\"scale_linear\": 1}\n", 1, "NAME = VALUE");
    expect_wrong("[inputs\noverride_index = 8\n", 1, "section");
    expect_wrong("[inputs]\noverride_index 8\n", 2, "NAME = VALUE");
    expect_wrong("[inputs]\n\noverride = 8\n", 3, "no such name");
    expect_wrong("override_index = 8\noverride_index = 8\n", 2, "again");
    expect_wrong("iocard_id = 4\nbattery_id = 4\n", 2, "its own");
    expect_wrong("differential_id = 4\niocard_id = 4\n", 2, "its own");
    for (const char *value : {"", "x", "8.5", "64", "-1", "8 9", "1e1", "0x8", "nan", "--8", "8-",
                              "1234567890", "1.2.3", "."})
        expect_wrong("override_index = " + std::string(value), 1,
                     "override_index: give a whole number, 0 to 63");
    expect_wrong("scale_linear = 2.01", 1, "scale_linear: give a number, 0.5 to 2");
}

TEST(RobotFile, AnyCutOrFlippedByteIsReadOrRefusedButNeverMore) {
    const std::string good = "[inputs]\noverride_index = 8\n[response]\nlinear_gain = 1.05\n";
    for (std::size_t at = 0; at < good.size(); at++) {
        for (int byte = 0; byte < 256; byte += 5) {
            const std::string cut(good, 0, at);
            std::string text = good;
            text[at] = static_cast<char>(byte);
            roburoc4_robot_file file = empty();
            const char *remedy = nullptr;
            if (roburoc4_robot_file_read(&file, text.data(), text.size(), nullptr, &remedy) < 0) {
                EXPECT_NE(nullptr, remedy);
            }
            (void)roburoc4_robot_file_read(&file, cut.data(), cut.size(), nullptr, nullptr);
        }
    }
}

TEST(RobotFile, ValuesBeyondTheirRangeAreNotSet) {
    roburoc4_robot_file file = empty();
    EXPECT_EQ(ROBUROC4_ERR_INDEX, roburoc4_robot_file_set(&file, "nonsense", 1));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_robot_file_set(&file, "override_index", 1.5F));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_robot_file_set(&file, "robot_watchdog_ms", 99));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_set(&file, "iocard_id", 7));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_set(&file, "iocard_id", 7));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_robot_file_set(&file, "differential_id", 7));
    char text[ROBUROC4_ROBOT_FILE_SIZE];
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_set(&file, "max_linear_m_s", 2.999999F));
    EXPECT_NE(std::string::npos, text_of(file).find("max_linear_m_s = 3\n")) << "rounded";
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_set(&file, "telemeter_turn_rad", -0.5F));
    EXPECT_NE(std::string::npos, text_of(file).find("telemeter_turn_rad = -0.5\n"));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_robot_file_set(&file, "robot_watchdog_ms", 60000));
    const roburoc4_result length = roburoc4_robot_file_write(&file, text, sizeof text);
    EXPECT_EQ(ROBUROC4_ERR_BUFFER,
              roburoc4_robot_file_write(&file, text, static_cast<std::size_t>(length) - 1));
}

TEST(RobotFile, MakesAConfigurationAndLeavesTheRest) {
    roburoc4_config config, usual;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_config_init(&config, sizeof config));
    usual = config;
    roburoc4_robot_file file = empty();
    roburoc4_robot_file_config(&file, &config);
    EXPECT_EQ(0, std::memcmp(&usual, &config, sizeof config));

    file = file_of("iocard_id = 40\ndifferential_id = 41\noverride_index = 9\n"
                   "rear_bumper_index = 1\nrobot_watchdog_ms = 500\nscale_angular = 1.14\n");
    roburoc4_robot_file_config(&file, &config);
    EXPECT_EQ(nullptr, roburoc4_config_error(&config));
    EXPECT_EQ(40, config.iocard_id);
    EXPECT_EQ(41, config.differential_id);
    EXPECT_EQ(9, config.role_index[ROBUROC4_ROLE_OVERRIDE]);
    EXPECT_EQ(ROBUROC4_INDEX_AUTO, config.role_index[ROBUROC4_ROLE_FRONT_BUMPER]);
    EXPECT_EQ(1, config.role_index[ROBUROC4_ROLE_REAR_BUMPER]);
    EXPECT_EQ(500U, config.robot_watchdog_ms);
    EXPECT_EQ(1.0F, config.scale_linear);
    EXPECT_EQ(1.14F, config.scale_angular);
}

} // namespace
