/* SPDX-License-Identifier: MIT
 *
 * Configuration: defaults, both ends of every range, errors that name the value; sizes of structs.
 */
#include <cstring>

#include "client_bench.h"

#include <cmath>
#include <limits>

using namespace roburoc4_tests;

namespace {

using Change = std::function<void(roburoc4_config &)>;

void expect_good(const char *what, const Change &change) {
    roburoc4_config config = default_config();
    change(config);
    const char *error = roburoc4_config_error(&config);
    EXPECT_EQ(nullptr, error) << what << ": " << (error != nullptr ? error : "");
    roburoc4_client client;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_init(&client, sizeof client, &config)) << what;
}

void expect_bad(const char *name, const Change &change) {
    roburoc4_config config = default_config();
    change(config);
    const char *error = roburoc4_config_error(&config);
    ASSERT_NE(nullptr, error) << name;
    EXPECT_EQ(0U, std::string(error).find(name)) << "says: " << error;
    roburoc4_client client;
    EXPECT_EQ(ROBUROC4_ERR_CONFIG, roburoc4_client_init(&client, sizeof client, &config)) << name;
}

template <typename T> using Member = T roburoc4_config::*;

/** Just outside its range, and far outside, the error is this range. */
void check_range(
    const char *name, Member<std::uint32_t> member, std::uint32_t low, std::uint32_t high,
    const Change &with = [](roburoc4_config &) {}) {
    for (const std::uint32_t value : {low, high})
        expect_good(name, [&](roburoc4_config &c) {
            with(c);
            c.*member = value;
        });
    for (const std::uint32_t value : {low - 1, high + 1, UINT32_MAX})
        expect_bad(name, [&](roburoc4_config &c) {
            with(c);
            c.*member = value;
        });
}

void check_range(const char *name, Member<float> member, float low, float high) {
    for (const float value : {low, high})
        expect_good(name, [&](roburoc4_config &c) { c.*member = value; });
    for (const float value :
         {low * 0.99F, high * 1.01F, 0.0F, -low, -high, std::numeric_limits<float>::quiet_NaN(),
          std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()})
        expect_bad(name, [&](roburoc4_config &c) { c.*member = value; });
}

} // namespace

TEST(Config, APeriodOfAThirdOfFreshIsTheLongest) {
    roburoc4_config config = default_config();
    config.fresh_ms = 300;
    config.period_ms[ROBUROC4_SERVICE_IOCARD] = config.period_ms[ROBUROC4_SERVICE_DIFFERENTIAL] =
        100;
    EXPECT_EQ(nullptr, roburoc4_config_error(&config));
    config.fresh_ms = 299;
    EXPECT_NE(nullptr, roburoc4_config_error(&config));
}

TEST(Config, Defaults) {
    roburoc4_config c;
    memset(&c, 0xEE, sizeof c);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_config_init(&c, sizeof c));
    EXPECT_EQ(sizeof c, c.size);
    EXPECT_EQ(0x7CU, c.subscriptions);
    const std::uint16_t periods[5] = {50, 100, 1000, 50, 50};
    for (std::size_t i = 0; i < 5; i++)
        EXPECT_EQ(periods[i], c.period_ms[i + 2]) << i;
    for (const std::size_t unused : {0U, 1U, 7U})
        EXPECT_EQ(0U, c.period_ms[unused]) << unused;
    EXPECT_EQ(100U, c.first_retry_ms);
    EXPECT_EQ(1000U, c.lost_ms);
    EXPECT_EQ(300U, c.fresh_ms);
    EXPECT_EQ(50U, c.drive_period_ms);
    EXPECT_EQ(250U, c.lease_ms);
    EXPECT_EQ(1000U, c.robot_watchdog_ms);
    EXPECT_EQ(1.0F, c.max_linear_m_s);
    EXPECT_EQ(1.5F, c.max_angular_rad_s);
    EXPECT_EQ(1.0F, c.scale_linear);
    EXPECT_EQ(1.0F, c.scale_angular);
    EXPECT_EQ(0U, c.options);
    for (const std::int16_t index : c.role_index)
        EXPECT_EQ(ROBUROC4_INDEX_AUTO, index);
    EXPECT_EQ(1000U, c.lapse_disarm_ms);
    EXPECT_EQ(ROBUROC4_ID_AUTO, c.iocard_id);
    EXPECT_EQ(ROBUROC4_ID_AUTO, c.differential_id);
    EXPECT_EQ(nullptr, roburoc4_config_error(&c));
}

TEST(Config, InitWithAnUnknownSizeWritesNothing) {
    roburoc4_config c;
    memset(&c, 0xEE, sizeof c);
    const roburoc4_config before = c;
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_config_init(&c, sizeof c - 1));
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_config_init(&c, sizeof c + 4));
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_config_init(&c, 0));
    EXPECT_EQ(0, memcmp(&before, &c, sizeof c));
}

TEST(Config, SizeIsThatOfAVersion) {
    expect_bad("size", [](roburoc4_config &c) { c.size = 0; });
    expect_bad("size", [](roburoc4_config &c) { c.size += 4; });
}

TEST(Config, EveryRangeEndsWhereTheHeaderSays) {
    check_range("first_retry_ms: 10 to 100", &roburoc4_config::first_retry_ms, 10, 100);
    check_range("lost_ms: 200 to 60000", &roburoc4_config::lost_ms, 200, 60000);
    check_range("fresh_ms: 50 to 1000", &roburoc4_config::fresh_ms, 50, 1000,
                [](roburoc4_config &c) { c.period_ms[2] = c.period_ms[6] = 10; });
    check_range("drive_period_ms: 10 to 500", &roburoc4_config::drive_period_ms, 10, 500,
                [](roburoc4_config &c) { c.lease_ms = 1000; });
    check_range("lease_ms: 20 to 1000", &roburoc4_config::lease_ms, 20, 1000,
                [](roburoc4_config &c) { c.drive_period_ms = 10; });
    check_range("robot_watchdog_ms: 100 to 60000", &roburoc4_config::robot_watchdog_ms, 100, 60000);
    check_range("lapse_disarm_ms: 0 to 60000", &roburoc4_config::lapse_disarm_ms, 0, 60000);
    check_range("max_linear_m_s: 0.001 to 5", &roburoc4_config::max_linear_m_s, 0.001F, 5);
    check_range("max_angular_rad_s: 0.001 to 10", &roburoc4_config::max_angular_rad_s, 0.001F, 10);
    check_range("scale_linear: 0.01 to 10", &roburoc4_config::scale_linear, 0.01F, 10);
    check_range("scale_angular: 0.01 to 10", &roburoc4_config::scale_angular, 0.01F, 10);
}

TEST(Config, ErrorIsTheNameAndTheRange) {
    const std::vector<std::pair<const char *, Change>> errors{
        {"size: set by roburoc4_config_init()", [](roburoc4_config &c) { c.size = 0; }},
        {"subscriptions: bits 2 to 6", [](roburoc4_config &c) { c.subscriptions = 0x80; }},
        {"subscriptions: bits 2 to 6", [](roburoc4_config &c) { c.subscriptions = 1; }},
        {"options: unknown bit", [](roburoc4_config &c) { c.options = 8; }},
        {"drive_period_ms: at most half of lease_ms",
         [](roburoc4_config &c) { c.drive_period_ms = 126; }},
        {"drive_period_ms: at most half of robot_watchdog_ms",
         [](roburoc4_config &c) {
             c.robot_watchdog_ms = 199;
             c.drive_period_ms = 100;
         }},
        {"period_ms of IO card and differential: at most a third of fresh_ms",
         [](roburoc4_config &c) { c.period_ms[2] = 500; }},
        {"period_ms of IO card and differential: at most a third of fresh_ms",
         [](roburoc4_config &c) { c.period_ms[6] = 500; }},
        {"period_ms: multiples of 10, 10 to 2550; the last is 0",
         [](roburoc4_config &c) { c.period_ms[6] = 0; }},
        {"period_ms: multiples of 10, 10 to 2550; the last is 0",
         [](roburoc4_config &c) { c.period_ms[7] = 10; }},
        {"role_index: -1, or an index to 63 (battery voltage: 15); the last four are -1",
         [](roburoc4_config &c) { c.role_index[0] = 64; }},
        {"role_index: -1, or an index to 63 (battery voltage: 15); the last four are -1",
         [](roburoc4_config &c) { c.role_index[4] = 0; }},
        {"role_index: -1, or an index to 63 (battery voltage: 15); the last four are -1",
         [](roburoc4_config &c) { c.role_index[7] = 3; }},
    };
    for (const auto &[error, change] : errors) {
        roburoc4_config config = default_config();
        change(config);
        EXPECT_STREQ(error, roburoc4_config_error(&config));
    }
}

TEST(Config, PeriodsAreMultiplesOfTenUpTo2550) {
    for (std::size_t service = 2; service < 7; service++) {
        for (const int value : {10, 20, 2540, 2550})
            expect_good("period_ms", [&](roburoc4_config &c) {
                c.subscriptions = 0;
                c.period_ms[service] = static_cast<std::uint16_t>(value);
            });
        for (const int value : {0, 5, 9, 11, 2549, 2551, 2560, 65535})
            expect_bad("period_ms", [&](roburoc4_config &c) {
                c.period_ms[service] = static_cast<std::uint16_t>(value);
            });
    }
    expect_good("the first two are not used", [](roburoc4_config &c) {
        c.period_ms[0] = 3;
        c.period_ms[1] = 7;
    });
}

TEST(Config, PeriodsThatAreNotUsedMakeNoDifference) {
    roburoc4_client with{};
    roburoc4_client without{};
    roburoc4_config config = default_config();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_init(&without, sizeof without, &config));
    for (const std::size_t unused : {0U, 1U})
        config.period_ms[unused] = 2550;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_init(&with, sizeof with, &config));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_start(&with, second));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_start(&without, second));
    without.private_config = config;
    EXPECT_EQ(0, memcmp(&with, &without, sizeof with));
}

TEST(Config, OfAnOlderProgramGetsDefaultsForTheRest) {
    const std::size_t older = offsetof(roburoc4_config, options);
    roburoc4_config config;
    std::memset(&config, 0xFF, sizeof config);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_config_init(&config, older));
    EXPECT_EQ(older, config.size);
    EXPECT_EQ(UINT32_MAX, config.options) << "beyond the program's struct nothing is written";
    EXPECT_EQ(nullptr, roburoc4_config_error(&config));
    roburoc4_client client{};
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_init(&client, sizeof client, &config));
    config.size = 2 * sizeof config.size; /* far older */
    EXPECT_EQ(nullptr, roburoc4_config_error(&config));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_init(&client, sizeof client, &config));
    for (const std::size_t wrong : {std::size_t{0}, std::size_t{4}, older - 1, sizeof config + 4})
        EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_config_init(&config, wrong)) << wrong;
}

TEST(Config, UnknownBitsAreRefused) {
    for (std::uint32_t bit = 0; bit < 32; bit++) {
        const std::uint32_t value = 1U << bit;
        const auto check = [&](const char *name, bool known, Member<std::uint32_t> member) {
            if (known)
                expect_good(name, [&](roburoc4_config &c) { c.*member = value; });
            else
                expect_bad(name, [&](roburoc4_config &c) { c.*member = value; });
        };
        check("subscriptions", bit >= 2 && bit <= 6, &roburoc4_config::subscriptions);
        check("options", bit < 3, &roburoc4_config::options);
    }
    expect_good("subscriptions", [](roburoc4_config &c) { c.subscriptions = 0; });
}

TEST(Config, RoleIndicesEndAtTheCapacities) {
    for (std::size_t role = 0; role < 4; role++) {
        const int last = role == ROBUROC4_ROLE_BATTERY_V ? 15 : 63;
        for (const int value : {-1, 0, last})
            expect_good("role_index", [&](roburoc4_config &c) {
                c.role_index[role] = static_cast<std::int16_t>(value);
            });
        for (const int value : {-2, last + 1, 32767, -32768})
            expect_bad("role_index", [&](roburoc4_config &c) {
                c.role_index[role] = static_cast<std::int16_t>(value);
            });
    }
}

TEST(Config, IdsAreThoseOfTwoServices) {
    for (const auto id : {&roburoc4_config::iocard_id, &roburoc4_config::differential_id}) {
        for (const int value : {-1, 2, 65535})
            expect_good("id", [&](roburoc4_config &c) { c.*id = value; });
        for (const int value : {-2, 0, 1, 65536})
            expect_bad("iocard_id, differential_id", [&](roburoc4_config &c) { c.*id = value; });
    }
    expect_bad("iocard_id, differential_id",
               [](roburoc4_config &c) { c.iocard_id = c.differential_id = 6; });
}

TEST(Init, OfAnotherSizeIsRefused) {
    EXPECT_EQ(sizeof(roburoc4_client), roburoc4_client_size());
    roburoc4_client client;
    memset(&client, 0x5A, sizeof client);
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_init(&client, sizeof client - 8, nullptr));
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_init(&client, sizeof client + 8, nullptr));
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_init(&client, 0, nullptr));
}

TEST(Init, OfASmallerSizeTouchesNothingBeyondIt) {
    ExactBlock block(64, 0x5A);
    EXPECT_EQ(ROBUROC4_ERR_SIZE,
              roburoc4_client_init(reinterpret_cast<roburoc4_client *>(block.data()), 64, nullptr));
}

TEST(Init, OfASmallerSizeIsRefusedAndNothingWorks) {
    roburoc4_client c;
    memset(&c, 0x5A, sizeof c); /* what follows the smaller struct is not the client's */
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_init(&c, 64, nullptr));
    const roburoc4_client before = c;
    EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_client_start(&c, 1));
    EXPECT_EQ(ROBUROC4_ERR_NOT_READY, roburoc4_client_arm(&c, 1));
    EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_client_drive(&c, 1, 0, 100000, 1));
    EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_client_stop(&c, 1));
    EXPECT_EQ(0, memcmp(&before, &c, sizeof c));
}

TEST(Init, ByABuildWithAnotherStructIsRefused) {
    for (const std::size_t size : {sizeof(roburoc4_client) - 8, sizeof(roburoc4_client) + 8}) {
        roburoc4_client c;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_init(&c, sizeof c, nullptr));
        c.private_size = static_cast<std::uint16_t>(size);
        EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_client_start(&c, 1));
        EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_client_drive(&c, 1, 0, 100000, 1));
        EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), roburoc4_client_state(&c));
    }
}

TEST(Init, AfterAnErrorEveryOtherFunctionRefusesTheClient) {
    for (int error = 0; error < 2; error++) {
        SCOPED_TRACE(error);
        roburoc4_config config = default_config();
        config.lease_ms = 5;
        roburoc4_client c;
        memset(&c, 0x04, sizeof c); /* looks as if it were ready */
        EXPECT_LT(roburoc4_client_init(&c, sizeof c - static_cast<std::size_t>(error), &config), 0);
        std::uint8_t buffer[ROBUROC4_MAX_TRANSMIT] = {2, 0, 0, 0, 0};
        EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_client_start(&c, 1));
        EXPECT_LT(roburoc4_client_arm(&c, 1), 0);
        EXPECT_LT(roburoc4_client_drive(&c, 1, 0, 100000, 1), 0);
        EXPECT_LT(roburoc4_client_stop(&c, 1), 0);
        EXPECT_LT(roburoc4_client_close(&c, 1), 0);
        EXPECT_LT(roburoc4_client_receive(&c, buffer, 5, 1), 0);
        EXPECT_LE(roburoc4_client_poll_transmit(&c, buffer, sizeof buffer, 1), 0);
        EXPECT_LT(set_digital_output(&c, 1, 1, 1), 0);
        EXPECT_LT(roburoc4_client_set_analog_output(&c, 1, 1, 1), 0);
        EXPECT_LT(roburoc4_client_relocalize(&c, 0, 0, 0, 1), 0);
        EXPECT_EQ(UINT64_MAX, roburoc4_client_next_deadline(&c));
    }
}

TEST(Struct, OfAnUnknownSizeIsRefused) {
    RobotBench bench;
    roburoc4_facts facts{};
    roburoc4_link link{};
    roburoc4_service_link service{};
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_facts(&bench.client, 1, &facts));
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_link(&bench.client, 1, &link));
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_service_link(&bench.client, 2, 1, &service));
    for (const int more : {-1, 1, 4}) {
        facts.size = static_cast<std::uint32_t>(static_cast<int>(sizeof facts) + more);
        link.size = static_cast<std::uint32_t>(static_cast<int>(sizeof link) + more);
        service.size = static_cast<std::uint32_t>(static_cast<int>(sizeof service) + more);
        EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_facts(&bench.client, 1, &facts)) << more;
        EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_link(&bench.client, 1, &link)) << more;
        EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_client_service_link(&bench.client, 2, 1, &service))
            << more;
    }
    service.size = sizeof service;
    for (const std::uint32_t none : {0U, 1U, 7U, 8U, 32U, UINT32_MAX})
        EXPECT_EQ(ROBUROC4_ERR_ARGUMENT,
                  roburoc4_client_service_link(&bench.client, none, 1, &service))
            << none;
}

TEST(Client, MayBeMovedAsPlainBytes) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    const auto copy = std::make_unique<roburoc4_client>();
    memcpy(copy.get(), &bench.client, sizeof bench.client);
    memset(&bench.client, 0xEE, sizeof bench.client);
    memcpy(&bench.client, copy.get(), sizeof bench.client);
    EXPECT_EQ(1, bench.facts().armed);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
}

TEST(Client, PollWithTooSmallABufferSendsNothing) {
    RobotBench bench;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_start(&bench.client, bench.client_us()));
    std::uint8_t buffer[ROBUROC4_MAX_TRANSMIT];
    for (const std::size_t size : {std::size_t{3}, sizeof buffer - 1})
        EXPECT_EQ(ROBUROC4_ERR_BUFFER,
                  roburoc4_client_poll_transmit(&bench.client, buffer, size, bench.client_us()));
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_SENT));
    EXPECT_TRUE(bench.poll());
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_SENT));
    for (const std::uint32_t none : {14U, 15U, 32U, UINT32_MAX})
        EXPECT_EQ(0U, bench.count(none)) << "no such counter";
}

TEST(Client, ConfigurationIsNotKept) {
    roburoc4_config config = default_config();
    config.lease_ms = 500;
    RobotBench bench(config);
    config.lease_ms = 20;
    bench.armed();
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.1F, 0));
    EXPECT_EQ(500000U, bench.facts().lease_left_us);
}
