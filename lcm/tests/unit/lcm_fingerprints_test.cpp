/* SPDX-License-Identifier: MIT
 *
 * Released LCM types never change, so that old logs stay readable. Each type's fingerprint, which
 * depends on its fields' names, types and order, is kept in lcm_fingerprints.txt.
 */
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "bot_core_pose_t.h"
#include "roburoc4_lcm.h"

namespace {

const std::filesystem::path root = ROBUROC4_SOURCE_DIR;

#define TYPE(name)                                                                                 \
    { #name, static_cast < std::uint64_t>(__roburoc4_lcm_##name##_get_hash()) }

std::map<std::string, std::uint64_t> compiled() {
    return {
        TYPE(battery_status_t),      TYPE(bridge_state_t),   TYPE(bridge_statistics_t),
        TYPE(differential_status_t), TYPE(drive_command_t),  TYPE(iocard_status_t),
        TYPE(localization_status_t), TYPE(output_command_t), TYPE(relocalize_command_t),
        TYPE(robot_properties_t),    TYPE(stop_command_t),   TYPE(telemeter_status_t),
        TYPE(telemeter_t),           TYPE(move_command_t),   TYPE(move_status_t),
    };
}

} // namespace

TEST(LcmFingerprints, AreThoseOfTheGoldenFile) {
    std::ostringstream now;
    for (const auto &[name, fingerprint] : compiled())
        now << name << " 0x" << std::hex << fingerprint << std::dec << '\n';
    std::ifstream file(root / "lcm/tests/unit/lcm_fingerprints.txt");
    std::stringstream golden;
    golden << file.rdbuf();
    EXPECT_EQ(golden.str(), now.str())
        << "A released type must not change. Make a new type, and publish both for a while.";
}

TEST(LcmFingerprints, CoverEveryType) {
    const auto types = compiled();
    std::size_t files = 0;
    for (const auto &entry : std::filesystem::directory_iterator(root / "lcm/types")) {
        EXPECT_TRUE(types.count(entry.path().stem().string())) << entry.path();
        files++;
    }
    EXPECT_EQ(types.size(), files);
}

TEST(LcmFingerprints, OfThePoseIsThatOfLibbot2) {
    EXPECT_EQ(0x2e16efb052b0105eULL, static_cast<std::uint64_t>(__bot_core_pose_t_get_hash()));
}
