/* SPDX-License-Identifier: MIT
 *
 * sim_family_test.cpp - each answer of the family (docs/PROTOCOL.md) as a setting or a control of
 * the simulator, and the members that are drawn.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "config_file.h"
#include "sim_support.h"

using namespace roburoc4_tests;

namespace {

using Config = roburoc4_sim_config;

/** A robot with some settings of its own, without slip and on an empty floor. */
class Member : public SimRobot {
  public:
    template <typename Change> explicit Member(Change change) : SimRobot(with(change)) {
        roburoc4_sim_clear_obstacles(get());
    }
    Member() : Member([](Config &) {}) {}

    void set(const char *control, double value) {
        const auto number = roburoc4_sim_control_find(control);
        ASSERT_GE(number, 0) << control;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(get(), std::uint32_t(number), value)) << control;
    }
    /** Subscribe with a period of a cycle. */
    void watch(std::uint16_t service) {
        EXPECT_EQ(0, insert(service, 1));
    }
    /** Run a cycle, and take the statuses that it sent. */
    std::vector<Bytes> statuses() {
        take();
        run(1);
        std::vector<Bytes> all;
        for (const auto &sent : take())
            if (sent.bytes.at(0) == ROBUROC4_HEADER_STATUS)
                all.push_back(sent.bytes);
        return all;
    }
    roburoc4_differential_status differential() {
        roburoc4_differential_status status{};
        const auto all = statuses();
        EXPECT_LE(0, roburoc4_decode_differential_status(all.at(0).data(), all[0].size(), &status));
        return status;
    }
    roburoc4_localization_status localization() {
        roburoc4_localization_status status{};
        const auto all = statuses();
        EXPECT_LE(0, roburoc4_decode_localization_status(all.at(0).data(), all[0].size(), &status));
        return status;
    }
    double target() {
        return double(differential().target_linear_m_s);
    }
    /** Its speed after driving long enough for any response. */
    double speed_at(float linear_m_s, std::uint64_t cycles = 1000) {
        drive(linear_m_s, 0.0F, cycles);
        return state().wheel_linear_m_s;
    }
    std::string text(std::uint8_t index) {
        const Bytes answer =
            ask({9, ROBUROC4_ACTION_QUERY, 2, 0, ROBUROC4_IO_DIGITAL_INPUT, index, 0, 0, 0});
        return answer.size() < 5 || answer[4] != 0 ? "none"
                                                   : std::string(answer.begin() + 5, answer.end());
    }
    int error_of(const Bytes &request) {
        const Bytes answer = ask(request);
        return answer.size() < 5 ? -1 : answer[4];
    }

  private:
    template <typename Change> static Config with(Change change) {
        Config config = default_sim_config();
        config.slip = 0.0F;
        change(config);
        return config;
    }
};

constexpr std::uint16_t differential = ROBUROC4_SERVICE_DIFFERENTIAL;
constexpr std::uint16_t localization = ROBUROC4_SERVICE_LOCALIZATION;

const Bytes get_directory = {9, ROBUROC4_ACTION_GET, 0, 0};
const Bytes unsubscribe = {9, ROBUROC4_ACTION_DELETE, 1, 0, 6, 0};

/* ------------------------------------------------------------------------------------- draws ---
 */

TEST(SimFamily, DrawsValidRobotsWithEveryUsualAnswerAndOthers) {
    constexpr std::uint64_t seeds = 500;
    std::vector<Config> drawn(seeds);
    for (std::uint64_t seed = 0; seed < seeds; seed++) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_config_family(&drawn[seed], sizeof drawn[seed], seed));
        EXPECT_EQ(nullptr, roburoc4_sim_config_error(&drawn[seed])) << "seed " << seed;
    }
    const sim_setting *setting = nullptr;
    for (std::uint32_t index = 0; (setting = sim_setting_at(index)) != nullptr; index++) {
        if (setting->from >= setting->to)
            continue;
        const auto usual = std::count_if(drawn.begin(), drawn.end(), [&](const Config &config) {
            return sim_setting_get(&config, setting) == setting->usual;
        });
        EXPECT_LT(usual, std::ptrdiff_t{seeds}) << setting->name;
        EXPECT_TRUE(usual > 0 || setting->kind == SIM_FLOAT) << setting->name;
    }
}

TEST(SimFamily, AMemberIsRepeatedByItsSettings) {
    for (std::uint64_t seed = 0; seed < 100; seed++) {
        Config drawn{};
        Config repeated = default_sim_config();
        ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_config_family(&drawn, sizeof drawn, seed));
        std::string text = "[Simulator]\n";
        const sim_setting *setting = nullptr;
        for (std::uint32_t index = 0; (setting = sim_setting_at(index)) != nullptr; index++) {
            std::array<char, 100> line{};
            (void)std::snprintf(line.data(), line.size(), "%s=%.*g\n", setting->name,
                                setting->kind == SIM_FLOAT ? 7 : 16,
                                sim_setting_get(&drawn, setting));
            text += line.data();
        }
        std::array<char, 200> error{};
        ASSERT_EQ(ROBUROC4_OK,
                  sim_config_read(&repeated, text.data(), text.size(), error.data(), error.size()))
            << error.data();
        EXPECT_EQ(0, std::memcmp(&drawn, &repeated, sizeof drawn)) << "seed " << seed;
    }
}

TEST(SimFamily, AnotherMemberTakesItsPlaceAtTheAddress) {
    Member robot;
    Config drawn{};
    ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_config_family(&drawn, sizeof drawn, 4));
    ASSERT_EQ(0U, drawn.telemeters) << "choose a seed whose robot can be told from the default";
    robot.watch(localization);
    robot.speed_at(1.0F);
    robot.set("family", 4);
    EXPECT_EQ(drawn.uptime_cycles, robot.state().cycles);
    EXPECT_EQ(0.0, robot.state().true_x_m);
    EXPECT_TRUE(robot.statuses().empty()) << "nobody has subscribed";
    EXPECT_TRUE(std::isnan(robot.state().distances_m[0]));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_FAMILY, 3));
    EXPECT_FALSE(std::isnan(robot.state().distances_m[0]));
}

/* ---------------------------------------------------------------------------------- texts --- */

TEST(SimFamily, AnswersQueriesInEachMode) {
    const auto texts = [](std::uint32_t mode) {
        Member robot([mode](Config &config) { config.query_mode = mode; });
        return robot.text(ROBUROC4_DI_PAD_A) + "," + robot.text(ROBUROC4_DI_FRONT_BUMPER);
    };
    EXPECT_EQ("Game pad \"A\" button,Front bumper", texts(ROBUROC4_SIM_QUERY_ANSWERED));
    EXPECT_EQ("none,none", texts(ROBUROC4_SIM_QUERY_SILENT));
    EXPECT_EQ("none,none", texts(ROBUROC4_SIM_QUERY_REFUSED));
    EXPECT_EQ("none,Front bumper", texts(ROBUROC4_SIM_QUERY_A_SILENT));
    EXPECT_EQ("none,Front bumper", texts(ROBUROC4_SIM_QUERY_A_REFUSED));
    EXPECT_EQ(",", texts(ROBUROC4_SIM_QUERY_EMPTY));
    const Bytes of_a = {9, ROBUROC4_ACTION_QUERY, 2, 0, 2, ROBUROC4_DI_PAD_A, 0, 0, 0};
    EXPECT_EQ(ROBUROC4_ERROR_DATA, Member([](Config &config) {
                                       config.query_mode = ROBUROC4_SIM_QUERY_A_REFUSED;
                                   }).error_of(of_a));
}

TEST(SimFamily, WritesTextsInEachShape) {
    const auto text = [](std::uint32_t texts, std::uint8_t index) {
        return Member([texts](Config &config) { config.texts = texts; }).text(index);
    };
    EXPECT_EQ("button, Game pad \"A\"", text(ROBUROC4_SIM_TEXTS_REORDERED, 8));
    EXPECT_EQ("Game pad \xAB"
              "A\xBB button",
              text(ROBUROC4_SIM_TEXTS_LATIN_1, 8));
    EXPECT_EQ("Front bumper", text(ROBUROC4_SIM_TEXTS_TWO_FRONT, 2));
    EXPECT_EQ("Game pad A LED", text(ROBUROC4_SIM_TEXTS_LIKE_A, 3));
    EXPECT_EQ("", text(0, 2));
    EXPECT_EQ("", text(0, 3));
}

TEST(SimFamily, ShiftsInputs) {
    Member robot([](Config &config) { config.input_shift = 3; });
    EXPECT_EQ("Game pad \"A\" button", robot.text(ROBUROC4_DI_PAD_A + 3));
    EXPECT_EQ("Front bumper", robot.text(0));
    EXPECT_EQ("", robot.text(4));
    robot.set("pad_a", 1);
    EXPECT_EQ(0, robot.value(ROBUROC4_SIM_PIN_DIGITAL + ROBUROC4_DI_PAD_A));
    EXPECT_EQ(1, robot.value(ROBUROC4_SIM_PIN_DIGITAL + ROBUROC4_DI_PAD_A + 3));
}

/* ----------------------------------------------------------------------------- telemeters --- */

TEST(SimFamily, HasAnyTelemetersAndReportsFewer) {
    for (std::uint32_t count = 0; count <= ROBUROC4_SIM_MAX_TELEMETERS; count++) {
        Member robot([count](Config &config) {
            config.telemeters = count;
            config.reported_distances = 3;
        });
        EXPECT_EQ(9U + 28U * count, robot.ask({9, ROBUROC4_ACTION_GET, 3, 0}).size());
        robot.watch(ROBUROC4_SERVICE_TELEMETER);
        EXPECT_EQ(11U + 4U * std::min(count, 3U), robot.statuses().at(0).size());
    }
}

/* -------------------------------------------------------------------------- time and queues --- */

TEST(SimFamily, StampsAFrozenServiceAsItsStampsMean) {
    for (const std::uint32_t measured : {0U, 1U}) {
        Member robot([measured](Config &config) { config.stamp_measured = measured; });
        robot.watch(localization);
        robot.speed_at(1.0F, 100);
        const double x_m = robot.localization().x_m;
        robot.set("frozen", 1 << localization);
        robot.speed_at(1.0F, 100);
        const auto status = robot.localization();
        EXPECT_EQ(x_m, status.x_m);
        EXPECT_EQ(robot.state().cycles - (measured != 0 ? 101 : 0), status.robot_cycles);
        robot.set("frozen", 1 << localization | 1 << differential);
        EXPECT_EQ(x_m, robot.localization().x_m) << "another freezes";
        robot.set("frozen", 0);
        EXPECT_LT(x_m + 0.1, robot.localization().x_m);
    }
}

TEST(SimFamily, DelaysEachQueueAlone) {
    struct Delay {
        const char *queue;
        std::uint16_t service; /* 0: an answer, 1: a text */
    };
    for (const Delay &delay :
         {Delay{"queue_answer_ms", 0}, Delay{"queue_text_ms", 1}, Delay{"queue_iocard_ms", 2},
          Delay{"queue_telemeter_ms", 3}, Delay{"queue_battery_ms", 4},
          Delay{"queue_localization_ms", 5}, Delay{"queue_differential_ms", 6}}) {
        Member robot;
        for (std::uint16_t service = 2; service <= differential; service++)
            EXPECT_EQ(0, robot.insert(service, 100));
        robot.set(delay.queue, 50);
        robot.run(99);
        robot.send(get_directory);
        robot.send({9, ROBUROC4_ACTION_QUERY, 2, 0, 2, 8, 0, 0, 0});
        robot.run(1);
        EXPECT_EQ(6U, robot.take().size()) << delay.queue;
        robot.run(delay.service < 2 ? 3 : 4);
        EXPECT_EQ(0U, robot.take().size()) << delay.queue;
        robot.run(1);
        const auto late = robot.take();
        ASSERT_EQ(1U, late.size()) << delay.queue;
        const Bytes &bytes = late[0].bytes;
        if (delay.service >= 2)
            EXPECT_EQ(delay.service, bytes.at(1)) << delay.queue;
        else
            EXPECT_EQ(delay.service, bytes.at(1) == ROBUROC4_ACTION_QUERY ? 1 : 0);
    }
}

TEST(SimFamily, ReceivesLate) {
    Member robot([](Config &config) { config.queue_uplink_ms = 50; });
    robot.command(1.0F, 0.0F);
    robot.run(4);
    EXPECT_EQ(0.0, robot.state().target_linear_m_s);
    robot.run(1);
    EXPECT_EQ(1.0, robot.state().target_linear_m_s);
    robot.command(0.5F, 0.0F);
    robot.set("queue_uplink_ms", 0);
    robot.command(0.25F, 0.0F);
    robot.run(4);
    EXPECT_EQ(1.0, robot.state().target_linear_m_s) << "nothing overtakes within a queue";
    robot.run(1);
    EXPECT_EQ(0.25, robot.state().target_linear_m_s);
}

/* --------------------------------------------------------------------------- subscriptions --- */

std::size_t statuses_of(const std::vector<Sent> &all, std::uint64_t peer) {
    return std::size_t(std::count_if(all.begin(), all.end(),
                                     [peer](const Sent &sent) { return sent.peer == peer; }));
}

TEST(SimFamily, SharesItsListOfSubscriptions) {
    for (const std::uint32_t lists : {0U, 1U, 2U}) {
        Member robot([lists](Config &config) { config.subscription_lists = lists; });
        EXPECT_EQ(0, robot.insert(differential, 1, 1));
        EXPECT_EQ(0, robot.insert(differential, 2, 2));
        robot.take();
        robot.run(8);
        const auto sent = robot.take();
        EXPECT_EQ(lists == 0 ? 8U : lists == 1 ? 4U : 0U, statuses_of(sent, 1)) << lists;
        EXPECT_EQ(4U, statuses_of(sent, 2)) << lists;
        EXPECT_EQ(lists == 0 ? 0U : 2U, robot.subscription(differential, 3)) << lists;
        EXPECT_EQ(lists == 0 ? ROBUROC4_ERROR_DATA : 0, robot.ask(unsubscribe, 3).at(4)) << lists;
        robot.run(8);
        EXPECT_EQ(lists == 0 ? 12U : 0U, robot.take().size()) << lists;
    }
}

TEST(SimFamily, FullListRefusesIgnoresOrForgets) {
    for (const std::uint32_t full : {0U, 1U, 2U}) {
        Member robot([full](Config &config) {
            config.max_subscriptions = 2;
            config.full_list = full;
        });
        EXPECT_EQ(0, robot.insert(4, 1));
        robot.run(1);
        EXPECT_EQ(0, robot.insert(5, 1));
        EXPECT_EQ(full == ROBUROC4_SIM_FULL_REFUSES ? ROBUROC4_ERROR_SERVICE : 0,
                  robot.insert(6, 1));
        EXPECT_EQ(0, robot.insert(5, 7)) << "what is there can be changed";
        EXPECT_EQ(full == ROBUROC4_SIM_FULL_FORGETS ? 0U : 1U, robot.subscription(4));
        EXPECT_EQ(7U, robot.subscription(5));
        EXPECT_EQ(full == ROBUROC4_SIM_FULL_FORGETS ? 1U : 0U, robot.subscription(6));
        EXPECT_EQ(2U, robot.state().subscriptions);
    }
}

/* ----------------------------------------------------- commands, watchdog and game pad --- */

TEST(SimFamily, KeepsATargetUnderTheGamePadAsConfigured) {
    struct Kept {
        std::uint32_t mode;
        double silent,
            commanded; /* target after the release, without and with commands under [A] */
    };
    for (const Kept &kept : {Kept{ROBUROC4_SIM_OVERRIDE_DISCARDS, 0.0, 0.0},
                             Kept{ROBUROC4_SIM_OVERRIDE_STORES, 1.0, 0.5},
                             Kept{ROBUROC4_SIM_OVERRIDE_RESUMES, 1.0, 1.0}}) {
        for (const bool commanded : {false, true}) {
            Member robot([&](Config &config) { config.pad_keeps_target = kept.mode; });
            robot.command(1.0F, 0.0F);
            robot.run(10);
            robot.set("pad_a", 1);
            robot.run(10);
            if (commanded)
                robot.command(0.5F, 0.0F);
            robot.run(10);
            EXPECT_EQ(0.0, robot.state().target_linear_m_s) << "the pad's sticks rest";
            robot.set("pad_a", 0);
            robot.run(1);
            EXPECT_EQ(commanded ? kept.commanded : kept.silent, robot.state().target_linear_m_s)
                << kept.mode;
            robot.run(100);
            EXPECT_EQ(0.0, robot.state().target_linear_m_s) << "the watchdog";
        }
    }
}

TEST(SimFamily, StatusesShowTheTargetAsConfigured) {
    for (const std::uint32_t answer : {0U, 1U}) {
        Member robot([answer](Config &config) {
            config.pad_keeps_target = ROBUROC4_SIM_OVERRIDE_RESUMES;
            config.pad_target_hidden = answer;
            config.tripped_target_shown = answer;
            config.dead_time_cycles = 10;
            config.late_targets = 0;
        });
        robot.watch(differential);
        robot.command(1.0F, 0.0F);
        EXPECT_EQ(1.0, robot.target());
        robot.set("pad_a", 1);
        EXPECT_EQ(double(answer), robot.target()) << "under [A]";
        robot.set("pad_a", 0);
        robot.run(500);
        EXPECT_EQ(double(answer), robot.target()) << "after the watchdog";
        EXPECT_NEAR(0.0, robot.state().wheel_linear_m_s, 1e-3) << "but it has stopped";
        robot.command(0.0F, 0.0F);
        EXPECT_EQ(0.0, robot.target());
    }
}

TEST(SimFamily, CommandsWithoutMotorPowerAreIgnoredAsConfigured) {
    for (const std::uint32_t ignored : {0U, 1U}) {
        Member robot([ignored](Config &config) { config.commands_need_motors = ignored; });
        robot.drive(1.0F, 0.0F, 20);
        robot.set("estop_local", 1);
        robot.drive(1.0F, 0.0F, 20);
        EXPECT_EQ(1.0 - ignored, robot.state().target_linear_m_s);
        EXPECT_EQ(int(ignored), robot.state().watchdog_tripped);
    }
}

/* ----------------------------------------------------------------------------------- faults --- */

TEST(SimFamily, ServicesReportNan) {
    for (std::uint16_t service = ROBUROC4_SERVICE_IOCARD; service <= differential; service++) {
        Member robot;
        robot.watch(service);
        const Bytes usual = robot.statuses().at(0);
        robot.set("nan", 1 << service);
        const Bytes status = robot.statuses().at(0);
        ASSERT_EQ(usual.size(), status.size());
        /* the last float, or double, of each; the battery has none */
        const std::size_t ends[] = {0, 0, 47, 19, 0, 35, 27};
        if (ends[service] != 0) {
            EXPECT_EQ(0x7F, status.at(ends[service] - 1) & 0x7F) << service;
            EXPECT_EQ(0xC0, status.at(ends[service] - 2) & 0xC0) << service;
        }
        robot.set("nan", 0);
        EXPECT_EQ(Bytes(usual.begin() + 11, usual.end()), [&robot] {
            const Bytes after = robot.statuses().at(0);
            return Bytes(after.begin() + 11, after.end());
        }());
    }
}

TEST(SimFamily, CreepsRunsAwayAndMovesOneAxisOnly) {
    Member creeping;
    creeping.set("creep_m_s", 0.05);
    EXPECT_NEAR(0.05, creeping.speed_at(0.0F), 1e-3);
    EXPECT_NEAR(0.55, creeping.speed_at(0.5F), 1e-3);

    Member running;
    running.set("blocked_linear", 1);
    running.set("creep_m_s", 2.6);
    EXPECT_NEAR(2.6, running.speed_at(0.1F), 1e-3);
    running.set("estop_local", 1);
    EXPECT_NEAR(0.0, running.speed_at(0.1F), 1e-9) << "the brakes are stronger";

    Member one_axis;
    one_axis.set("blocked_angular", 1);
    one_axis.drive(0.5F, 1.0F, 300);
    EXPECT_NEAR(0.5, one_axis.state().wheel_linear_m_s, 0.02);
    EXPECT_EQ(0.0, one_axis.state().wheel_angular_rad_s);
    one_axis.set("creep_rad_s", -0.3);
    one_axis.drive(0.5F, 1.0F, 300);
    EXPECT_NEAR(-0.3, one_axis.state().wheel_angular_rad_s, 0.02);
}

} // namespace
