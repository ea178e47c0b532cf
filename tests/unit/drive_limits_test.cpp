/* SPDX-License-Identifier: MIT
 *
 * Limits: scale, then optionally keep the curve, then clamp; NaN and infinity are never sent.
 */
#include "client_bench.h"
#include "drawn.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace roburoc4_tests;

namespace {

constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();
constexpr float inf_f = std::numeric_limits<float>::infinity();

/** What leaves for these speeds. */
Command sent_for(const roburoc4_config &config, const roburoc4_differential_properties &limits,
                 float linear, float angular) {
    ScriptedRobot robot;
    robot.differential = limits;
    Armed bench(robot, config);
    EXPECT_EQ(ROBUROC4_OK, bench.drive(linear, angular));
    bench.pump();
    EXPECT_EQ(1U, bench.commands().size());
    return bench.commands().empty() ? Command{} : bench.commands().back();
}

roburoc4_differential_properties usual_limits() {
    return ScriptedRobot().differential;
}

void expect_sent(const Command &sent, float linear, float angular) {
    EXPECT_FLOAT_EQ(linear, sent.linear);
    EXPECT_FLOAT_EQ(angular, sent.angular);
}

} // namespace

TEST(Limits, WithinThemSpeedsLeaveAsTheyAre) {
    for (const float v : {-2.6F, -1.0F, -1e-6F, 0.0F, 0.1F, 2.6F})
        for (const float w : {-6.5F, -0.3F, 0.0F, 6.5F}) {
            const Command sent = sent_for(unlimited_config(), usual_limits(), v, w);
            EXPECT_EQ(v, sent.linear);
            EXPECT_EQ(w, sent.angular);
        }
}

TEST(Limits, OfTheRobotClamp) {
    auto limits = usual_limits();
    limits.max_linear_m_s = 1.5F;
    limits.min_linear_m_s = -0.5F;
    limits.max_angular_rad_s = 2;
    limits.min_angular_rad_s = -3;
    expect_sent(sent_for(unlimited_config(), limits, 2, 5), 1.5F, 2);
    expect_sent(sent_for(unlimited_config(), limits, -2, -5), -0.5F, -3);
}

TEST(Limits, CeilingsOfTheConfigurationAlwaysApplyToo) {
    auto limits = usual_limits();
    limits.max_linear_m_s = 100;
    limits.min_linear_m_s = -100;
    limits.max_angular_rad_s = 100;
    limits.min_angular_rad_s = -100;
    expect_sent(sent_for(default_config(), limits, 5, -10), 1, -1.5F);
    roburoc4_config config = default_config();
    config.max_linear_m_s = 0.4F;
    config.max_angular_rad_s = 0.7F;
    expect_sent(sent_for(config, limits, -5, 10), -0.4F, 0.7F);
    expect_sent(sent_for(config, limits, 0.39F, -0.69F), 0.39F, -0.69F);
}

TEST(Limits, OfZeroPreventAllMotion) {
    auto limits = usual_limits();
    limits.max_linear_m_s = 0;
    limits.max_angular_rad_s = limits.min_angular_rad_s = 0;
    expect_sent(sent_for(unlimited_config(), limits, 1, 1), 0, 0);
    expect_sent(sent_for(unlimited_config(), limits, -1, -1), -1, 0);
}

TEST(Limits, ScaleComesBeforeTheClamp) {
    roburoc4_config config = unlimited_config();
    config.scale_linear = 1.3F;
    config.scale_angular = 0.5F;
    expect_sent(sent_for(config, usual_limits(), 1, 1), 1.3F, 0.5F);
    expect_sent(sent_for(config, usual_limits(), 2.5F, -6), 2.6F, -3);
}

TEST(Limits, ACeilingBoundsTheSpeedBeforeAndAfterItIsScaled) {
    for (const float scale : {0.5F, 1.0F, 2.0F}) {
        roburoc4_config config = default_config();
        config.scale_linear = config.scale_angular = scale;
        const float most = std::min(scale, 1.0F);
        expect_sent(sent_for(config, usual_limits(), 5, -10), most * 1.0F, most * -1.5F);
        expect_sent(sent_for(config, usual_limits(), 0.4F, 0.4F), scale * 0.4F, scale * 0.4F);
    }
}

TEST(Limits, ScaledSpeedsAreRoundedAsFloatsAre) {
    std::mt19937_64 random(drawn_seed());
    std::uniform_real_distribution<float> scale(0.01F, 10), speed(-0.25F, 0.25F);
    for (int i = 0; i < 300; i++) {
        roburoc4_config config = unlimited_config();
        config.scale_linear = scale(random);
        config.scale_angular = scale(random);
        const float v = speed(random), w = speed(random) * (i % 3 == 0 ? 1e-30F : 1);
        const Command sent = sent_for(config, usual_limits(), v, w);
        EXPECT_EQ(v * config.scale_linear, sent.linear) << v << " by " << config.scale_linear;
        EXPECT_EQ(w * config.scale_angular, sent.angular) << w << " by " << config.scale_angular;
    }
}

TEST(Limits, TheGreatestSpeedsAtTheGreatestScaleAreClamped) {
    roburoc4_config config = unlimited_config();
    config.scale_linear = 10;
    config.scale_angular = 10;
    expect_sent(sent_for(config, usual_limits(), 5, -10), 2.6F, -6.5F);
    config.options = ROBUROC4_OPTION_KEEP_CURVATURE;
    const float outer = 50 + 100 * 0.34F;
    expect_sent(sent_for(config, usual_limits(), -5, 10), -2.6F * 50 / outer, 2.6F * 100 / outer);
}

TEST(Limits, ZeroPassesUntouched) {
    roburoc4_config config = unlimited_config();
    config.scale_linear = 10;
    config.scale_angular = 0.01F;
    config.options = ROBUROC4_OPTION_KEEP_CURVATURE;
    const Command sent = sent_for(config, usual_limits(), 0, 0);
    EXPECT_EQ(0.0F, sent.linear);
    EXPECT_EQ(0.0F, sent.angular);
}

TEST(Limits, AStopSequenceNeedsNoUsableLimits) {
    ScriptedRobot robot;
    robot.differential.max_linear_m_s = nan_f;
    robot.differential.min_angular_rad_s = 3;
    Ready bench(robot);
    bench.pause();
    bench.run(second);
    ASSERT_GE(bench.commands().size(), 3U);
    for (const Command &c : bench.commands())
        EXPECT_TRUE(c.zero());
}

/* ---- mistakes of units ---- */

TEST(Units, SpeedsBeyondAnyRobotAreRefusedAndStoreNothing) {
    roburoc4_config config = unlimited_config();
    config.scale_linear = config.scale_angular = 0.01F; /* judged before scaling */
    Armed bench(config);
    const float most = std::numeric_limits<float>::max();
    const std::array<float, 2> mistakes[] = {{300, 0},    {-300, 0},    {0, 45},     {0, -45},
                                             {5.001F, 0}, {-5.001F, 0}, {0, 10.01F}, {0, -10.01F},
                                             {most, 0},   {0, -most},   {300, 45}};
    for (const auto &[linear, angular] : mistakes) {
        EXPECT_EQ(ROBUROC4_ERR_UNITS, bench.drive(linear, angular)) << linear << ' ' << angular;
        EXPECT_EQ(0, bench.facts().driving);
    }
    bench.run(second);
    EXPECT_EQ(0U, bench.commands().size());
    EXPECT_EQ(1, bench.facts().armed);
    EXPECT_EQ(ROBUROC4_OK, bench.drive(ROBUROC4_MAX_DRIVE_M_S, -ROBUROC4_MAX_DRIVE_RAD_S));
}

TEST(Units, AMistakeDoesNotRenewALease) {
    Armed bench;
    const std::uint64_t granted_us = bench.now_us;
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
    for (int i = 0; i < 20; i++) {
        bench.run(20 * ms);
        EXPECT_EQ(ROBUROC4_ERR_UNITS, bench.drive(500, 0));
    }
    EXPECT_EQ(0U, bench.speeds(granted_us + 250 * ms));
}

/* ---- not finite ---- */

TEST(NotFinite, IsRefusedAndStoresNothing) {
    Armed bench;
    for (const float bad :
         {nan_f, -nan_f, inf_f, -inf_f, std::numeric_limits<float>::signaling_NaN()}) {
        EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, bench.drive(bad, 0));
        EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, bench.drive(0, bad));
        EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, bench.drive(bad, bad));
        EXPECT_EQ(0, bench.facts().driving);
    }
    bench.run(second);
    EXPECT_EQ(0U, bench.commands().size());
}

TEST(NotFinite, DoesNotRenewALease) {
    Armed bench;
    const std::uint64_t granted_us = bench.now_us;
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
    for (int i = 0; i < 20; i++) {
        bench.run(20 * ms);
        EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, bench.drive(nan_f, 0));
    }
    EXPECT_EQ(0U, bench.speeds(granted_us + 250 * ms));
}

TEST(NotFinite, OfEveryBitPatternIsRefused) {
    Armed bench;
    for (std::uint32_t fraction = 0; fraction < 0x800000; fraction += 0x1235) {
        for (const std::uint32_t sign : {0U, 0x80000000U}) {
            const std::uint32_t bits = sign | 0x7F800000U | fraction;
            float value;
            memcpy(&value, &bits, sizeof value);
            ASSERT_EQ(ROBUROC4_ERR_NOT_FINITE, bench.drive(value, 0)) << std::hex << bits;
        }
    }
}

/* ---- keeping the curve ---- */

TEST(KeepCurvature, IsOffByDefault) {
    expect_sent(sent_for(unlimited_config(), usual_limits(), 2.6F, 3), 2.6F, 3);
}

TEST(KeepCurvature, ReducesBothSpeedsByOneFactor) {
    roburoc4_config config = unlimited_config();
    config.options = ROBUROC4_OPTION_KEEP_CURVATURE;
    auto limits = usual_limits();
    limits.width_m = 0.5F;
    const float share = 2.6F / 3.1F; /* the outer wheels would run at 2.6 + 2 * 0.25 m/s */
    expect_sent(sent_for(config, limits, 2.6F, 2), 2.6F * share, 2 * share);
    expect_sent(sent_for(config, limits, -2.6F, 2), -2.6F * share, 2 * share);
    expect_sent(sent_for(config, limits, 2.6F, -2), 2.6F * share, -2 * share);
    expect_sent(sent_for(config, limits, 1, 2), 1, 2);
    expect_sent(sent_for(config, limits, 0.1F, 10), 0.1F * 0.65F, 6.5F);
    const Command greatest = sent_for(config, limits, 0.1F, 6.5F);
    EXPECT_EQ(0.1F, greatest.linear) << "as it is, to the last digit";
    EXPECT_EQ(6.5F, greatest.angular);
    limits.min_linear_m_s = -1.3F; /* backwards it is slower */
    expect_sent(sent_for(config, limits, -2.6F, 2), -1.3F * 2.6F / 3.1F, 1.3F * 2 / 3.1F);
}

TEST(KeepCurvature, KeepsTheCurveOfAWideRobot) {
    roburoc4_config config = unlimited_config();
    config.options = ROBUROC4_OPTION_KEEP_CURVATURE;
    auto limits = usual_limits();
    limits.width_m = 2;
    expect_sent(sent_for(config, limits, 1, 6), 2.6F / 7, 6 * 2.6F / 7);
    expect_sent(sent_for(config, limits, -1, 6), -2.6F / 7, 6 * 2.6F / 7);
}

/** In double precision, independent of the client's code. */
std::array<double, 2> expected_speeds(const roburoc4_config &config, float width_m, double linear,
                                      double angular) {
    const double most[2] = {
        std::min(2.6F, config.max_linear_m_s * std::min(config.scale_linear, 1.0F)),
        std::min(6.5F, config.max_angular_rad_s * std::min(config.scale_angular, 1.0F))};
    double speeds[2] = {linear * double{config.scale_linear},
                        angular * double{config.scale_angular}};
    const double wanted[2] = {std::abs(speeds[0]) + std::abs(speeds[1]) * double{width_m} / 2,
                              std::abs(speeds[1])};
    double share = 1;
    for (int axis = 0; axis < 2; axis++) {
        if ((config.options & ROBUROC4_OPTION_KEEP_CURVATURE) != 0 && wanted[axis] > 0)
            share = std::min(share, most[axis] / wanted[axis]);
    }
    return {std::clamp(speeds[0] * share, -most[0], most[0]),
            std::clamp(speeds[1] * share, -most[1], most[1])};
}

TEST(KeepCurvature, IsExactToTheLastDigitsOfAFloat) {
    std::mt19937 random(1);
    const auto any = [&](double least, double most) {
        const double size = std::exp(
            std::uniform_real_distribution<double>(std::log(least), std::log(most))(random));
        return static_cast<float>(random() % 2 == 0 ? size : -size);
    };
    for (int i = 0; i < 300; i++) {
        roburoc4_config config = unlimited_config();
        config.options = i % 3 == 0 ? 0 : ROBUROC4_OPTION_KEEP_CURVATURE;
        config.scale_linear = std::abs(any(0.01, 10));
        config.scale_angular = std::abs(any(0.01, 10));
        auto limits = usual_limits();
        limits.width_m = std::abs(any(0.02, 9));
        const float linear = any(1e-14, 4.99), angular = any(1e-14, 9.99);
        const auto expected = expected_speeds(config, limits.width_m, linear, angular);
        const Command sent = sent_for(config, limits, linear, angular);
        EXPECT_NEAR(expected[0], sent.linear, std::abs(expected[0]) * 1e-6) << linear << angular;
        EXPECT_NEAR(expected[1], sent.angular, std::abs(expected[1]) * 1e-6) << linear << angular;
    }
}

TEST(KeepCurvature, ADirectionThatTheRobotDoesNotHaveHasNoCurve) {
    roburoc4_config config = unlimited_config();
    config.options = ROBUROC4_OPTION_KEEP_CURVATURE;
    auto limits = usual_limits();
    limits.min_linear_m_s = 0;
    expect_sent(sent_for(config, limits, -1, 2), 0, 2);
}

TEST(KeepCurvature, IsOffIfTheWidthIsImplausible) {
    roburoc4_config config = unlimited_config();
    config.options = ROBUROC4_OPTION_KEEP_CURVATURE;
    for (const float width : {0.0F, -0.68F, nan_f, inf_f, -inf_f, 1e9F}) {
        auto limits = usual_limits();
        limits.width_m = width;
        expect_sent(sent_for(config, limits, 2.6F, 3), 2.6F, 3);
    }
}
