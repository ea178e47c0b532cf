/* SPDX-License-Identifier: MIT
 *
 * pump_test.cpp - the pump with a simulated robot over loopback UDP: a hung program stops the
 * robot, every reader sees every sample, and it ends cleanly whatever the robot and the readers do.
 */
#include "pump_calls.h"
#include "roburoc4_pump.h"
#include "sim_process.h"
#include "udp_robot.h"

#include <gtest/gtest.h>

#include <pthread.h>
#include <sys/wait.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <thread>
#include <vector>

using test::eventually;
using test::kPatienceUs;
using test::on_client;
using test::socket_of;
using test::SpeedCommand;
using test::UdpRobot;

namespace {

constexpr uint32_t kPatience = static_cast<uint32_t>(kPatienceUs);

struct Destroy {
    void operator()(roburoc4_pump *pump) const {
        roburoc4_pump_destroy(pump);
    }
};
using Pump = std::unique_ptr<roburoc4_pump, Destroy>;

Pump make_pump(const roburoc4_address &address, uint32_t queue = 0,
               const roburoc4_config *config = nullptr) {
    roburoc4_result result = 1;
    const roburoc4_config patient = test::patient_config();
    Pump pump(roburoc4_pump_create(&address, config != nullptr ? config : &patient, queue, nullptr,
                                   &result));
    EXPECT_EQ(result, ROBUROC4_OK);
    return pump;
}

void sleep_ms(int ms) {
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

bool becomes_ready(roburoc4_pump *pump) {
    roburoc4_pump_reader reader{};
    return roburoc4_pump_wait_events(pump, &reader, ROBUROC4_EVENT_READY, kPatience) > 0;
}

bool becomes_armed(roburoc4_pump *pump) {
    return roburoc4_pump_arm(pump, kPatience) == ROBUROC4_OK;
}

size_t zeros_at_the_end(const std::vector<SpeedCommand> &commands) {
    size_t zeros = 0;
    while (zeros < commands.size() && commands[commands.size() - 1 - zeros].is_zero()) {
        zeros++;
    }
    return zeros;
}

size_t speeds_in(const std::vector<SpeedCommand> &commands) {
    size_t speeds = 0;
    for (const SpeedCommand &command : commands) {
        speeds += !command.is_zero();
    }
    return speeds;
}

double cpu_seconds() {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

/* ------------------------------------------------------------------------------------ life --- */

TEST(Pump, RefusesInvalidArguments) {
    roburoc4_address address{};
    roburoc4_result result = 0;
    EXPECT_EQ(roburoc4_pump_create(&address, nullptr, 0, nullptr, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
    ASSERT_EQ(roburoc4_udp_resolve("127.0.0.1:9", 0, &address), ROBUROC4_OK);
    EXPECT_EQ(
        roburoc4_pump_create(&address, nullptr, ROBUROC4_PUMP_QUEUE_MIN - 1, nullptr, &result),
        nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
    EXPECT_EQ(
        roburoc4_pump_create(&address, nullptr, ROBUROC4_PUMP_QUEUE_MAX + 1, nullptr, &result),
        nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
    roburoc4_config config;
    ASSERT_EQ(roburoc4_config_init(&config, sizeof config), ROBUROC4_OK);
    config.lease_ms = 1;
    EXPECT_EQ(roburoc4_pump_create(&address, &config, 0, nullptr, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_CONFIG);
    ASSERT_EQ(roburoc4_udp_resolve("255.255.255.255:9", 0, &address), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_create(&address, nullptr, 0, nullptr, nullptr), nullptr)
        << "the result is not asked for";
    roburoc4_pump_destroy(nullptr);
}

TEST(Pump, KeepsTheRobotsTexts) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    roburoc4_pump_reader reader{};
    char text[ROBUROC4_PUMP_DESCRIPTION_SIZE];
    EXPECT_EQ(
        roburoc4_pump_description(pump.get(), ROBUROC4_IO_DIGITAL_INPUT, 63, text, sizeof text),
        ROBUROC4_ERR_UNKNOWN);
    ASSERT_GT(
        roburoc4_pump_wait_events(pump.get(), &reader, ROBUROC4_EVENT_DESCRIPTIONS_DONE, kPatience),
        0);
    const int32_t kinds[] = {-1, ROBUROC4_IO_ANALOG_INPUT, ROBUROC4_IO_DIGITAL_INPUT,
                             ROBUROC4_IO_DIGITAL_OUTPUT};
    const uint32_t counts[] = {ROBUROC4_SERVICE_COUNT, ROBUROC4_AI_COUNT, ROBUROC4_DI_COUNT,
                               ROBUROC4_DO_COUNT};
    for (size_t kind = 0; kind < 4; kind++) {
        for (uint32_t index = 0; index < counts[kind]; index++) {
            EXPECT_GE(roburoc4_pump_description(pump.get(), kinds[kind], index, text, sizeof text),
                      0)
                << kinds[kind] << " " << index;
        }
        EXPECT_EQ(
            roburoc4_pump_description(pump.get(), kinds[kind], counts[kind], text, sizeof text),
            kind == 0 || counts[kind] < 64 ? ROBUROC4_ERR_UNKNOWN : ROBUROC4_ERR_INDEX);
    }
    roburoc4_result length =
        roburoc4_pump_description(pump.get(), -1, ROBUROC4_SERVICE_BATTERY, text, sizeof text);
    EXPECT_STREQ(text, "Battery");
    EXPECT_EQ(length, 7);
    EXPECT_EQ(roburoc4_pump_description(pump.get(), -1, ROBUROC4_SERVICE_BATTERY, text, 8), 7);
    EXPECT_EQ(roburoc4_pump_description(pump.get(), -1, ROBUROC4_SERVICE_BATTERY, text, 7),
              ROBUROC4_ERR_BUFFER);
    EXPECT_EQ(roburoc4_pump_description(pump.get(), -2, 0, text, sizeof text),
              ROBUROC4_ERR_ARGUMENT);
    EXPECT_EQ(roburoc4_pump_description(pump.get(), 4, 0, text, sizeof text),
              ROBUROC4_ERR_ARGUMENT);
    EXPECT_EQ(roburoc4_pump_description(pump.get(), -1, ROBUROC4_MAX_SERVICES, text, sizeof text),
              ROBUROC4_ERR_INDEX);
}

TEST(Pump, RetriesAnAbsentRobotWithoutSpinningAndFindsItLater) {
    uint16_t port = test::free_port();
    roburoc4_address address{};
    ASSERT_EQ(roburoc4_udp_resolve("127.0.0.1", port, &address), ROBUROC4_OK);
    Pump pump = make_pump(address);
    double cpu_before = cpu_seconds();
    EXPECT_TRUE(eventually([&] {
        sleep_ms(50);
        return socket_of(pump.get()).counters[ROBUROC4_UDP_COUNT_REFUSED] >= 4;
    }));
    EXPECT_LT(cpu_seconds() - cpu_before, 0.7);
    EXPECT_EQ(socket_of(pump.get()).fault, uint32_t{ROBUROC4_FAULT_REFUSED});
    EXPECT_EQ(on_client(pump.get(), roburoc4_client_arm), ROBUROC4_ERR_NOT_READY);
    UdpRobot robot(port);
    EXPECT_TRUE(becomes_ready(pump.get()));
}

/* ---------------------------------------------------------------------------------- motion --- */

TEST(Pump, StopsTheRobotOfAProgramThatHangs) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    ASSERT_TRUE(becomes_armed(pump.get()));
    ASSERT_EQ(on_client(pump.get(), roburoc4_client_drive, 0.5f, 0.0f, 1000000), ROBUROC4_OK);
    /* From here on nobody calls drive. */
    ASSERT_TRUE(eventually([&] {
        sleep_ms(5);
        std::vector<SpeedCommand> commands = robot.commands();
        return speeds_in(commands) > 0 && zeros_at_the_end(commands) >= 3;
    }));
    size_t speeds = speeds_in(robot.commands());
    EXPECT_GE(speeds, 2u) << "within the lease the speed is repeated";
    EXPECT_LE(speeds, 21u) << "a lease of a second has 20 periods of 50 ms";
    sleep_ms(500);
    EXPECT_EQ(speeds_in(robot.commands()), speeds) << "no speed after the lease";
    EXPECT_EQ(on_client(pump.get(), roburoc4_client_drive, 0.2f, 0.0f, 0), ROBUROC4_OK)
        << "it stays armed";
}

TEST(Pump, FeedsALeaseWhileTheRobotIsQuiet) {
    roburoc4_config config;
    ASSERT_EQ(roburoc4_config_init(&config, sizeof config), ROBUROC4_OK);
    for (int service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        config.period_ms[service] = 330; /* no status wakes the pump in time */
    }
    config.fresh_ms = 1000;
    config.lost_ms = 5000;
    UdpRobot robot;
    Pump pump = make_pump(robot.address(), 0, &config);
    roburoc4_pump_reader reader{};
    ASSERT_GT(
        roburoc4_pump_wait_events(pump.get(), &reader, ROBUROC4_EVENT_DESCRIPTIONS_DONE, kPatience),
        0);
    ASSERT_TRUE(becomes_armed(pump.get()));
    /* A loaded machine may be late; a pump that waits for statuses always is. */
    EXPECT_TRUE(eventually([&] {
        roburoc4_pump_reader_init(pump.get(), &reader);
        roburoc4_pump_wait_events(pump.get(), &reader, ROBUROC4_EVENT_DIFFERENTIAL, kPatience);
        sleep_ms(50);
        on_client(pump.get(), roburoc4_client_arm);
        size_t before = robot.commands().size();
        if (on_client(pump.get(), roburoc4_client_drive, 0.5f, 0.0f, 500000) != ROBUROC4_OK) {
            return false;
        }
        roburoc4_pump_wait_events(pump.get(), &reader, ROBUROC4_EVENT_STOPPED, kPatience);
        std::vector<SpeedCommand> commands = robot.commands();
        return commands.size() >= before + 2 &&
               commands[before + 1].at_us - commands[before].at_us < 90000;
    })) << "the first repetition is due after 50 ms";
}

TEST(Pump, SendsCommandsBeforeTheCallReturns) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    ASSERT_TRUE(becomes_armed(pump.get()));
    uint32_t before = socket_of(pump.get()).counters[ROBUROC4_UDP_COUNT_SENT];
    ASSERT_EQ(on_client(pump.get(), roburoc4_client_set_digital_outputs, uint64_t{1} << 3,
                        uint64_t{1} << 3),
              ROBUROC4_OK);
    EXPECT_GT(socket_of(pump.get()).counters[ROBUROC4_UDP_COUNT_SENT], before);
    before = socket_of(pump.get()).counters[ROBUROC4_UDP_COUNT_SENT];
    ASSERT_EQ(on_client(pump.get(), roburoc4_client_drive, 0.1f, 0.0f, 0), ROBUROC4_OK);
    EXPECT_GT(socket_of(pump.get()).counters[ROBUROC4_UDP_COUNT_SENT], before);
}

/* ---------------------------------------------------------------------------------- arming --- */

TEST(PumpArm, WaitsForARobotThatComesLater) {
    const uint16_t port = test::free_port();
    roburoc4_address address{};
    ASSERT_EQ(roburoc4_udp_resolve("127.0.0.1", port, &address), ROBUROC4_OK);
    Pump pump = make_pump(address);
    EXPECT_EQ(roburoc4_pump_arm(pump.get(), 50000), ROBUROC4_ERR_NOT_READY);
    std::unique_ptr<UdpRobot> robot;
    std::thread later([&] {
        sleep_ms(100);
        robot = std::make_unique<UdpRobot>(port);
    });
    EXPECT_EQ(roburoc4_pump_arm(pump.get(), kPatience), ROBUROC4_OK);
    EXPECT_EQ(on_client(pump.get(), roburoc4_client_drive, 0.5f, 0.0f, 0), ROBUROC4_OK);
    later.join();
}

TEST(PumpArm, RefusesAtOnceWhatWaitingCannotChange) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    ASSERT_TRUE(becomes_armed(pump.get()));
    roburoc4_pump_reader reader{};
    roburoc4_pump_reader_init(pump.get(), &reader);
    ASSERT_TRUE(robot.panel("pad a down"));
    ASSERT_GT(roburoc4_pump_wait_events(pump.get(), &reader, ROBUROC4_EVENT_OVERRIDE, kPatience),
              0);
    EXPECT_EQ(roburoc4_pump_arm(pump.get(), UINT32_MAX), ROBUROC4_ERR_OVERRIDE);
    ASSERT_TRUE(robot.panel("pad a up"));
    EXPECT_GT(roburoc4_pump_wait_events(pump.get(), &reader, ROBUROC4_EVENT_ARMABLE, kPatience), 0);
    EXPECT_EQ(roburoc4_pump_arm(pump.get(), 0), ROBUROC4_OK);
}

TEST(PumpArm, IsEndedByAStopAndByTheEnd) {
    roburoc4_address address{};
    ASSERT_EQ(roburoc4_udp_resolve("127.0.0.1", test::free_port(), &address), ROBUROC4_OK);
    Pump pump = make_pump(address);
    for (const roburoc4_result expected : {ROBUROC4_ERR_STOPPED, ROBUROC4_ERR_CLOSED}) {
        std::thread later([&] {
            sleep_ms(50);
            if (expected == ROBUROC4_ERR_STOPPED) {
                roburoc4_pump_request_stop(pump.get());
            } else {
                roburoc4_pump_close(pump.get());
            }
        });
        EXPECT_EQ(roburoc4_pump_arm(pump.get(), UINT32_MAX), expected);
        later.join();
    }
    EXPECT_EQ(roburoc4_pump_arm(pump.get(), UINT32_MAX), ROBUROC4_ERR_CLOSED);
    roburoc4_result result = 0;
    Pump manual(roburoc4_pump_create(nullptr, nullptr, 0, nullptr, &result));
    EXPECT_EQ(roburoc4_pump_arm(manual.get(), UINT32_MAX), ROBUROC4_ERR_CLOSED);
}

TEST(PumpCreate, CanSendFromALocalPort) {
    test::Socket robot;
    const roburoc4_address address = robot.address();
    roburoc4_address local = address;
    local.port = test::free_port();
    roburoc4_result result = 0;
    Pump pump(roburoc4_pump_create_from(&address, &local, nullptr, 0, nullptr, &result));
    ASSERT_NE(pump, nullptr) << roburoc4_result_text(result);
    const test::Received got = robot.receive(static_cast<int>(test::kPatienceUs / 1000));
    EXPECT_EQ(ntohs(got.from.sin_port), local.port);
    const test::Socket other;
    local.port = other.port();
    Pump refused(roburoc4_pump_create_from(&address, &local, nullptr, 0, nullptr, &result));
    EXPECT_EQ(refused, nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_SYSTEM) << "another program has the port";
}

/* -------------------------------------------------------------------- samples and events --- */

TEST(Samples, AreAllSeenByEveryReader) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    constexpr size_t kReaders = 4, kSamples = 120;
    std::vector<std::vector<roburoc4_sample>> seen(kReaders);
    std::vector<std::thread> threads;
    std::atomic<uint64_t> lost{0};
    for (size_t i = 0; i < kReaders; i++) {
        threads.emplace_back([&, i] {
            roburoc4_pump_reader reader{};
            while (seen[i].size() < kSamples &&
                   roburoc4_pump_wait_samples(pump.get(), &reader, kPatience) > 0) {
                roburoc4_sample some[7];
                roburoc4_result got = roburoc4_pump_read_samples(pump.get(), &reader, some, 7);
                for (roburoc4_result k = 0; k < got; k++) {
                    seen[i].push_back(some[k]);
                }
            }
            lost += reader.lost;
        });
    }
    for (std::thread &thread : threads) {
        thread.join();
    }
    EXPECT_EQ(lost, 0u);
    uint32_t services = 0;
    for (size_t i = 0; i < kReaders; i++) {
        ASSERT_GE(seen[i].size(), kSamples);
        for (size_t k = 0; k < kSamples; k++) {
            ASSERT_EQ(seen[i][k].sequence, k);
            EXPECT_EQ(std::memcmp(&seen[i][k], &seen[0][k], sizeof(roburoc4_sample)), 0);
            services |= 1u << seen[i][k].service;
        }
    }
    EXPECT_EQ(services, 0x7Cu);
}

TEST(Samples, CarryTheValuesOfTheirService) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    roburoc4_pump_reader reader{};
    uint64_t last_cycles[8] = {};
    uint32_t services = 0;
    ASSERT_TRUE(eventually([&] {
        roburoc4_sample sample;
        roburoc4_pump_wait_samples(pump.get(), &reader, kPatience);
        EXPECT_EQ(roburoc4_pump_read_samples(pump.get(), &reader, &sample, 1), 1);
        EXPECT_GT(sample.robot_cycles, last_cycles[sample.service]);
        last_cycles[sample.service] = sample.robot_cycles;
        EXPECT_LE(sample.host_us, roburoc4_udp_now_us());
        if (sample.service == ROBUROC4_SERVICE_IOCARD) {
            EXPECT_EQ(sample.value.inputs.analog_count, uint32_t{ROBUROC4_AI_COUNT});
        } else if (sample.service == ROBUROC4_SERVICE_BATTERY) {
            EXPECT_EQ(sample.value.battery.remaining_percent, 100);
        } else if (sample.service == ROBUROC4_SERVICE_TELEMETER) {
            EXPECT_EQ(sample.value.distances.count, 2u);
        }
        services |= 1u << sample.service;
        return services == 0x7C;
    }));
}

TEST(Samples, ASlowReaderLosesTheOldestAndLearnsThat) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address(), ROBUROC4_PUMP_QUEUE_MIN);
    roburoc4_pump_reader slow{}, newest{};
    ASSERT_TRUE(eventually([&] {
        sleep_ms(10);
        roburoc4_pump_reader_init(pump.get(), &newest);
        return newest.next_sample >= 5 * ROBUROC4_PUMP_QUEUE_MIN;
    }));
    EXPECT_EQ(newest.lost, 0u);
    ASSERT_EQ(roburoc4_pump_close(pump.get()), ROBUROC4_OK); /* nothing comes in between */
    roburoc4_pump_reader_init(pump.get(), &newest);
    std::vector<roburoc4_sample> samples(100);
    EXPECT_EQ(roburoc4_pump_wait_samples(pump.get(), &slow, 0), ROBUROC4_PUMP_QUEUE_MIN);
    EXPECT_EQ(roburoc4_pump_read_samples(pump.get(), &slow, samples.data(), 100),
              ROBUROC4_PUMP_QUEUE_MIN);
    EXPECT_EQ(slow.lost + ROBUROC4_PUMP_QUEUE_MIN, newest.next_sample);
    for (uint64_t i = 0; i < ROBUROC4_PUMP_QUEUE_MIN; i++) {
        EXPECT_EQ(samples[i].sequence, slow.lost + i);
    }
    EXPECT_EQ(roburoc4_pump_read_samples(pump.get(), &slow, samples.data(), 100),
              ROBUROC4_ERR_CLOSED);
}

TEST(Samples, WaitingEndsWithItsTime) {
    roburoc4_address address{};
    ASSERT_EQ(roburoc4_udp_resolve("127.0.0.1", test::free_port(), &address), ROBUROC4_OK);
    Pump pump = make_pump(address);
    roburoc4_pump_reader reader{};
    roburoc4_sample sample;
    uint64_t before_us = roburoc4_udp_now_us();
    EXPECT_EQ(roburoc4_pump_wait_samples(pump.get(), &reader, 30000), 0);
    EXPECT_GE(roburoc4_udp_now_us() - before_us, 30000u);
    EXPECT_EQ(roburoc4_pump_wait_samples(pump.get(), &reader, 0), 0);
    EXPECT_EQ(roburoc4_pump_read_samples(pump.get(), &reader, &sample, 1), 0);
    EXPECT_EQ(roburoc4_pump_wait_events(pump.get(), &reader, ROBUROC4_EVENT_READY, 1000), 0);
}

/** A pump without a thread, whose client a world moves. */
TEST(PumpWithoutAddress, KeepsWhatItsClientReceivesForReaders) {
    roburoc4_result result = ROBUROC4_ERR_SYSTEM;
    roburoc4_pump *pump = roburoc4_pump_create(nullptr, nullptr, 0, nullptr, &result);
    ASSERT_NE(pump, nullptr);
    roburoc4_world *world = roburoc4_world_create(nullptr);
    ASSERT_EQ(roburoc4_world_join(world, roburoc4_pump_lock(pump)), 1);
    roburoc4_pump_unlock(pump);
    const std::uint8_t *datagram = nullptr;
    std::size_t size = 0;
    while (roburoc4_world_step(world, 11000000, &datagram, &size) != 0) {
        roburoc4_pump_lock(pump);
        roburoc4_pump_collect(pump, datagram, size);
        roburoc4_pump_unlock(pump);
    }
    roburoc4_pump_reader reader{};
    std::vector<roburoc4_sample> samples(1000);
    EXPECT_GT(roburoc4_pump_read_samples(pump, &reader, samples.data(), 1000), 600);
    EXPECT_NE(roburoc4_pump_take_events(pump, &reader) & ROBUROC4_EVENT_READY, 0);
    std::array<char, ROBUROC4_PUMP_DESCRIPTION_SIZE> text{};
    EXPECT_GT(
        roburoc4_pump_description(pump, ROBUROC4_IO_DIGITAL_INPUT, 0, text.data(), text.size()), 0);
    EXPECT_STREQ(text.data(), "Front bumper");
    EXPECT_EQ(roburoc4_pump_running(pump), 1);
    EXPECT_EQ(roburoc4_pump_close(pump), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_running(pump), 0);
    EXPECT_EQ(roburoc4_pump_read_samples(pump, &reader, samples.data(), 1000), ROBUROC4_ERR_CLOSED);
    roburoc4_client *client = roburoc4_pump_lock(pump);
    EXPECT_EQ(roburoc4_client_state(client), ROBUROC4_STATE_READY);
    roburoc4_sample latest;
    for (std::uint32_t service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT;
         service++) {
        EXPECT_EQ(roburoc4_sample_latest(client, service, &latest), ROBUROC4_OK);
        EXPECT_EQ(latest.service, service);
        EXPECT_GT(latest.robot_cycles, 0U);
        EXPECT_GT(latest.host_us, 0U);
        EXPECT_LE(latest.made_us, latest.host_us);
        EXPECT_GT(latest.made_us + 1000000, latest.host_us);
    }
    EXPECT_EQ(roburoc4_sample_latest(client, ROBUROC4_SERVICE_DIRECTORY, &latest),
              ROBUROC4_ERR_ARGUMENT);
    roburoc4_pump_unlock(pump);
    roburoc4_world_destroy(world);
    roburoc4_pump_destroy(pump);
}

TEST(Events, AreTakenByEachReaderForItself) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    roburoc4_pump_reader first{}, second{};
    ASSERT_TRUE(becomes_ready(pump.get()));
    EXPECT_NE(roburoc4_pump_take_events(pump.get(), &first) & ROBUROC4_EVENT_READY, 0);
    EXPECT_EQ(roburoc4_pump_take_events(pump.get(), &first) & ROBUROC4_EVENT_READY, 0);
    EXPECT_NE(roburoc4_pump_take_events(pump.get(), &second) & ROBUROC4_EVENT_READY, 0);
    ASSERT_EQ(roburoc4_pump_reader_init(pump.get(), &second), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_take_events(pump.get(), &second) & ROBUROC4_EVENT_READY, 0);
    EXPECT_EQ(roburoc4_pump_wait_events(pump.get(), &second, ROBUROC4_EVENT_REBOOT, 1000), 0)
        << "others than those of the mask do not end the wait";
    EXPECT_GT(roburoc4_pump_wait_events(pump.get(), &second, ROBUROC4_EVENT_IOCARD, kPatience), 0);
    EXPECT_NE(roburoc4_pump_take_events(pump.get(), &second) & ROBUROC4_EVENT_IOCARD, 0)
        << "waiting does not take";
}

/* ----------------------------------------------------------------------------------- the end ---
 */

TEST(PumpStop, SendsTheStopSequenceOfADrivingRobot) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    ASSERT_TRUE(becomes_armed(pump.get()));
    ASSERT_TRUE(eventually([&] {
        EXPECT_EQ(on_client(pump.get(), roburoc4_client_drive, 0.5f, 0.2f, 1000000), ROBUROC4_OK);
        sleep_ms(5);
        return speeds_in(robot.commands()) >= 2;
    }));
    ASSERT_EQ(roburoc4_pump_close(pump.get()), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_running(pump.get()), 0);
    EXPECT_EQ(on_client(pump.get(), roburoc4_client_state), uint32_t{ROBUROC4_STATE_IDLE});
    EXPECT_TRUE(eventually([&] { return zeros_at_the_end(robot.commands()) >= 3; }));
    EXPECT_EQ(roburoc4_pump_close(pump.get()), ROBUROC4_OK) << "a second time";
}

TEST(PumpStop, LeavesValuesReadableAndRefusesCommands) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    roburoc4_pump_reader reader{};
    ASSERT_TRUE(becomes_ready(pump.get()));
    ASSERT_GT(roburoc4_pump_wait_samples(pump.get(), &reader, kPatience), 0);
    ASSERT_EQ(roburoc4_pump_close(pump.get()), ROBUROC4_OK);
    roburoc4_pump *p = pump.get();
    EXPECT_EQ(on_client(p, roburoc4_client_arm), ROBUROC4_ERR_NOT_READY);
    EXPECT_EQ(on_client(p, roburoc4_client_stop), ROBUROC4_ERR_STATE);
    EXPECT_EQ(on_client(p, roburoc4_client_drive, 0.0f, 0.0f, 0), ROBUROC4_ERR_DISARMED);
    EXPECT_EQ(on_client(p, roburoc4_client_pause), ROBUROC4_ERR_STATE);
    EXPECT_EQ(on_client(p, roburoc4_client_set_digital_outputs, 2, 2), ROBUROC4_ERR_NOT_READY);
    EXPECT_EQ(on_client(p, roburoc4_client_relocalize, 0.0, 0.0, 0.0), ROBUROC4_ERR_NOT_READY);
    EXPECT_EQ(on_client(p, service_count), uint32_t{ROBUROC4_SERVICE_COUNT});
    roburoc4_sample samples[64];
    roburoc4_result got;
    uint64_t read = 0;
    while ((got = roburoc4_pump_read_samples(p, &reader, samples, 64)) > 0) {
        read += static_cast<uint64_t>(got);
    }
    EXPECT_GT(read, 0u) << "what came before the end can be read";
    EXPECT_EQ(got, ROBUROC4_ERR_CLOSED);
    EXPECT_EQ(roburoc4_pump_wait_samples(p, &reader, kPatience), ROBUROC4_ERR_CLOSED);
    roburoc4_pump_take_events(p, &reader);
    EXPECT_EQ(roburoc4_pump_take_events(p, &reader), ROBUROC4_ERR_CLOSED);
}

TEST(PumpStop, IsBoundedIfTheRobotIsSilent) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    ASSERT_TRUE(becomes_armed(pump.get()));
    ASSERT_EQ(on_client(pump.get(), roburoc4_client_drive, 0.5f, 0.0f, 1000000), ROBUROC4_OK);
    robot.fall_silent();
    uint64_t before_us = roburoc4_udp_now_us();
    EXPECT_EQ(roburoc4_pump_close(pump.get()), ROBUROC4_OK);
    EXPECT_LT(roburoc4_udp_now_us() - before_us, 10000000u);
}

TEST(PumpStop, WakesAllWaitingThreads) {
    roburoc4_address address{};
    ASSERT_EQ(roburoc4_udp_resolve("127.0.0.1", test::free_port(), &address), ROBUROC4_OK);
    Pump pump = make_pump(address);
    roburoc4_pump *p = pump.get();
    std::vector<std::thread> threads;
    std::atomic<int> closed{0}, started{0};
    for (int i = 0; i < 6; i++) {
        threads.emplace_back([&, i] {
            roburoc4_pump_reader reader{};
            started++;
            roburoc4_result result =
                i % 2 == 0
                    ? roburoc4_pump_wait_samples(p, &reader, UINT32_MAX)
                    : roburoc4_pump_wait_events(p, &reader, ROBUROC4_EVENT_READY, UINT32_MAX);
            closed += result == ROBUROC4_ERR_CLOSED;
        });
    }
    while (started < 6) {
        sleep_ms(1);
    }
    sleep_ms(20);
    std::thread other([&] { EXPECT_EQ(roburoc4_pump_close(p), ROBUROC4_OK); });
    EXPECT_EQ(roburoc4_pump_close(p), ROBUROC4_OK);
    other.join();
    for (std::thread &thread : threads) {
        thread.join();
    }
    EXPECT_EQ(closed, 6);
}

TEST(PumpStop, DestroyWaitsForWaitingThreads) {
    roburoc4_address address{};
    ASSERT_EQ(roburoc4_udp_resolve("127.0.0.1", test::free_port(), &address), ROBUROC4_OK);
    for (int round = 0; round < 20; round++) {
        roburoc4_pump *p = make_pump(address).release();
        std::atomic<bool> started{false};
        roburoc4_result result = 0;
        std::thread waiter([&] {
            roburoc4_pump_reader reader{};
            started = true;
            result = roburoc4_pump_wait_samples(p, &reader, UINT32_MAX);
        });
        while (!started) {
            sleep_ms(1);
        }
        sleep_ms(10);
        roburoc4_pump_destroy(p);
        waiter.join();
        EXPECT_EQ(result, ROBUROC4_ERR_CLOSED);
    }
}

/* --------------------------------------------------- signals, cancelled threads and exit() --- */

/* What the handler stops. */
std::atomic<roburoc4_pump *> signalled{nullptr};

void stop_robot(int) {
    roburoc4_pump_request_stop(signalled);
}

class RequestStop : public ::testing::Test {
  protected:
    void SetUp() override {
        signalled = pump_.get();
        std::signal(SIGUSR1, stop_robot);
    }
    void TearDown() override {
        std::signal(SIGUSR1, SIG_DFL);
        signalled = nullptr;
    }
    void drive_off() {
        ASSERT_TRUE(becomes_armed(pump_.get()));
        ASSERT_TRUE(eventually([&] {
            EXPECT_EQ(on_client(pump_.get(), roburoc4_client_drive, 0.5f, 0.0f, 1000000),
                      ROBUROC4_OK);
            sleep_ms(5);
            return speeds_in(robot_.commands()) >= 2;
        }));
    }
    bool stops() {
        return eventually([&] {
            sleep_ms(5);
            return zeros_at_the_end(robot_.commands()) >= 3;
        });
    }

    UdpRobot robot_;
    Pump pump_ = make_pump(robot_.address());
};

TEST_F(RequestStop, DisarmsAndStopsTheRobot) {
    drive_off();
    roburoc4_pump_request_stop(pump_.get());
    EXPECT_TRUE(stops());
    EXPECT_EQ(on_client(pump_.get(), roburoc4_client_drive, 0.5f, 0.0f, 0), ROBUROC4_ERR_STOPPED);
    EXPECT_EQ(roburoc4_pump_running(pump_.get()), 1) << "the link lives on";
    EXPECT_TRUE(becomes_armed(pump_.get())) << "as after any stop()";
}

TEST_F(RequestStop, SendsNoSpeedCommandedAfterIt) {
    drive_off();
    roburoc4_client *client = roburoc4_pump_lock(pump_.get());
    std::raise(SIGUSR1); /* while this thread has the lock */
    EXPECT_EQ(roburoc4_client_drive(client, 0.7f, 0.0f, 0, roburoc4_udp_now_us()), ROBUROC4_OK);
    roburoc4_pump_unlock(pump_.get());
    EXPECT_TRUE(stops());
    for (const SpeedCommand &command : robot_.commands()) {
        EXPECT_LT(command.linear_m_s, 0.7f);
    }
}

TEST_F(RequestStop, NeverBlocksWhateverItsHandlerInterrupts) {
    drive_off();
    std::atomic<bool> running{true};
    std::thread driver([&] {
        while (running) {
            on_client(pump_.get(), roburoc4_client_arm);
            on_client(pump_.get(), roburoc4_client_drive, 0.5f, 0.0f, 0);
        }
    });
    for (int i = 0; i < 2000; i++) {
        pthread_kill(driver.native_handle(), SIGUSR1);
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    running = false;
    driver.join();
    roburoc4_pump_request_stop(pump_.get());
    EXPECT_TRUE(stops());
}

TEST_F(RequestStop, IsHarmlessBeforeReadyAfterCloseAndOfNone) {
    roburoc4_pump_request_stop(nullptr);
    roburoc4_pump_request_stop(pump_.get());
    ASSERT_TRUE(becomes_ready(pump_.get()));
    ASSERT_EQ(roburoc4_pump_close(pump_.get()), ROBUROC4_OK);
    errno = 1234;
    roburoc4_pump_request_stop(pump_.get());
    roburoc4_pump_request_stop(pump_.get());
    EXPECT_EQ(errno, 1234);
    EXPECT_EQ(roburoc4_pump_close(pump_.get()), ROBUROC4_OK);
    EXPECT_EQ(speeds_in(robot_.commands()), 0u);
}

/* Cancels a thread repeatedly until it ends, whatever it is doing. */
template <class Work> void cancel_in(Work work) {
    pthread_t thread;
    const auto begin = [](void *argument) -> void * {
        for (;;) {
            (*static_cast<Work *>(argument))();
        }
    };
    ASSERT_EQ(pthread_create(&thread, nullptr, begin, &work), 0);
    sleep_ms(3);
    ASSERT_EQ(pthread_cancel(thread), 0);
    void *result = nullptr;
    ASSERT_EQ(pthread_join(thread, &result), 0);
    EXPECT_EQ(result, PTHREAD_CANCELED);
}

TEST(Cancel, OfAReaderLeavesThePumpAlive) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    ASSERT_TRUE(becomes_armed(pump.get()));
    for (int i = 0; i < 20; i++) {
        cancel_in([&] {
            roburoc4_pump_reader reader{};
            roburoc4_pump_reader_init(pump.get(), &reader);
            roburoc4_pump_wait_samples(pump.get(), &reader, 20000);
            pthread_testcancel();
        });
    }
    ASSERT_EQ(on_client(pump.get(), roburoc4_client_drive, 0.5f, 0.0f, 0), ROBUROC4_OK);
    EXPECT_TRUE(eventually([&] {
        sleep_ms(5);
        return zeros_at_the_end(robot.commands()) >= 3;
    })) << "the lease ended";
}

TEST(Cancel, WaitsForTheLastOfTheLocksOfAThread) {
    UdpRobot robot;
    Pump first = make_pump(robot.address()), second = make_pump(robot.address());
    for (int i = 0; i < 20; i++) {
        cancel_in([&] {
            roburoc4_pump_lock(first.get());
            roburoc4_pump_lock(second.get());
            sleep_ms(1); /* where a thread is cancelled */
            roburoc4_pump_unlock(first.get());
            sleep_ms(1);
            roburoc4_pump_unlock(second.get());
            pthread_testcancel();
        });
    }
    EXPECT_NE(roburoc4_pump_lock(first.get()), nullptr);
    roburoc4_pump_unlock(first.get());
    EXPECT_NE(roburoc4_pump_lock(second.get()), nullptr);
    roburoc4_pump_unlock(second.get());
}

/* Runs exit_in_mid_drive.c's program to its end; returns its status as waitpid() does. */
int run_exit_in_mid_drive(const UdpRobot &robot, const char *how) {
    const std::string address = "127.0.0.1:" + std::to_string(robot.port());
    const std::string program = test::beside_this_program("exit_in_mid_drive");
    const pid_t child = fork();
    if (child == 0) {
        setenv("TSAN_OPTIONS", "report_thread_leaks=0", 1); /* exit() leaves threads */
        execl(program.c_str(), program.c_str(), address.c_str(), how, nullptr);
        _exit(127);
    }
    int status = -1;
    EXPECT_TRUE(eventually([&] {
        sleep_ms(5);
        return waitpid(child, &status, WNOHANG) == child;
    }));
    return status;
}

TEST(Exit, WhileDrivingStopsTheRobot) {
    UdpRobot robot;
    EXPECT_EQ(run_exit_in_mid_drive(robot, ""), 0);
    EXPECT_TRUE(eventually([&] { return zeros_at_the_end(robot.commands()) >= 3; }));
    EXPECT_GE(speeds_in(robot.commands()), 1u);
}

TEST(Exit, WithTheLockHeldStillEnds) {
    UdpRobot robot;
    EXPECT_EQ(run_exit_in_mid_drive(robot, "locked"), 0);
    EXPECT_GE(speeds_in(robot.commands()), 1u);
}

/* ------------------------------------------------------------------------- many at a time --- */

TEST(Fork, LeavesTheChildWithoutAPumpAndTheParentWithIts) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    ASSERT_TRUE(becomes_ready(pump.get()));
    pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        roburoc4_pump *p = pump.release();
        roburoc4_pump_reader reader{};
        roburoc4_sample sample;
        int wrong = on_client(p, roburoc4_client_drive, 0.1f, 0.0f, 0) != ROBUROC4_ERR_CLOSED;
        wrong += roburoc4_pump_running(p) != 0;
        wrong += on_client(p, roburoc4_client_state) != 0;
        wrong += roburoc4_pump_close(p) != ROBUROC4_ERR_CLOSED;
        wrong += roburoc4_pump_wait_samples(p, &reader, UINT32_MAX) != ROBUROC4_ERR_CLOSED;
        wrong += roburoc4_pump_read_samples(p, &reader, &sample, 1) != ROBUROC4_ERR_CLOSED;
        roburoc4_pump_destroy(p);
        _exit(wrong);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
    roburoc4_pump_reader reader{};
    ASSERT_EQ(roburoc4_pump_reader_init(pump.get(), &reader), ROBUROC4_OK);
    EXPECT_GT(roburoc4_pump_wait_samples(pump.get(), &reader, kPatience), 0)
        << "the parent's link lives on";
}

TEST(Threads, CanAllCallEverythingAtOnce) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address(), 32);
    ASSERT_TRUE(becomes_armed(pump.get()));
    roburoc4_pump *p = pump.get();
    std::atomic<bool> running{true};
    std::vector<std::thread> threads;
    threads.emplace_back([&] {
        while (running) {
            on_client(p, roburoc4_client_drive, 0.2f, 0.1f, 100000);
            sleep_ms(3);
        }
    });
    threads.emplace_back([&] {
        while (running) {
            on_client(p, roburoc4_client_arm);
            on_client(p, roburoc4_client_stop);
            on_client(p, roburoc4_client_set_digital_outputs, 0x0E, 0x0A);
            sleep_ms(7);
        }
    });
    for (int i = 0; i < 3; i++) {
        threads.emplace_back([&] {
            roburoc4_pump_reader reader{};
            roburoc4_sample samples[5];
            roburoc4_facts facts{};
            facts.size = sizeof facts;
            while (running) {
                roburoc4_pump_wait_samples(p, &reader, 10000);
                roburoc4_pump_read_samples(p, &reader, samples, 5);
                roburoc4_pump_take_events(p, &reader);
                EXPECT_EQ(on_client(p, roburoc4_client_facts, roburoc4_udp_now_us(), &facts),
                          ROBUROC4_OK);
            }
        });
    }
    sleep_ms(1000);
    running = false;
    for (std::thread &thread : threads) {
        thread.join();
    }
    EXPECT_EQ(roburoc4_pump_close(p), ROBUROC4_OK);
    EXPECT_TRUE(eventually([&] { return zeros_at_the_end(robot.commands()) >= 3; }));
}

} // namespace
