// SPDX-License-Identifier: MIT
//
// Usage: drive square METRES | drive speed M_S RAD_S, as a node of ROS 2 that knows /odom and
// /cmd_vel and nothing else of the robot: a square to the left by odometry, or one speed until it
// is ended.
#include "node.h"
#include "ros_typesPubSubTypes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iostream>
#include <mutex>
#include <thread>

namespace {

struct Pose {
    double x, y, theta, speed, turning;
};

struct Odometry : fast::DataReaderListener {
    std::mutex guard;
    Pose pose{};
    bool known = false;

    void on_data_available(fast::DataReader *reader) override {
        nav_msgs::msg::dds_::Odometry_ odometry;
        fast::SampleInfo info;
        while (reader->take_next_sample(&odometry, &info) ==
               eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
            if (!info.valid_data) {
                continue;
            }
            const auto &at = odometry.pose().pose();
            const auto &twist = odometry.twist().twist();
            const std::lock_guard<std::mutex> lock(guard);
            pose = {at.position().x(), at.position().y(),
                    2 * std::atan2(at.orientation().z(), at.orientation().w()), twist.linear().x(),
                    twist.angular().z()};
            known = true;
        }
    }

    Pose wait() {
        for (;; std::this_thread::sleep_for(std::chrono::milliseconds(5))) {
            const std::lock_guard<std::mutex> lock(guard);
            if (known) {
                return pose;
            }
        }
    }
};

fast::DataWriter *commands;

/// One command, and the time until the next is due.
void command(double linear_m_s, double angular_rad_s) {
    const std::int64_t now = now_ns();
    geometry_msgs::msg::dds_::TwistStamped_ twist;
    twist.header().stamp().sec(static_cast<std::int32_t>(now / 1000000000));
    twist.header().stamp().nanosec(static_cast<std::uint32_t>(now % 1000000000));
    twist.header().frame_id("base_link");
    twist.twist().linear().x(linear_m_s);
    twist.twist().angular().z(angular_rad_s);
    commands->write(&twist);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

double wrapped(double angle) {
    return std::remainder(angle, 2 * 3.14159265358979);
}

bool still(const Pose &pose) {
    return std::abs(pose.speed) < 0.01 && std::abs(pose.turning) < 0.02;
}

void square(Odometry &odometry, double side) {
    const Pose begin = odometry.wait();
    for (int corner = 0; corner < 4; ++corner) {
        const double heading = begin.theta + corner * 3.14159265358979 / 2;
        Pose from = odometry.wait(), at = from;
        for (double left = side; left > 0.01 || !still(at);) {
            at = odometry.wait();
            left = side - std::hypot(at.x - from.x, at.y - from.y);
            command(left > 0.01 ? std::clamp(0.8 * left, 0.03, 0.4) : 0.0,
                    wrapped(heading - at.theta));
        }
        std::cout << "corner " << at.x << ' ' << at.y << std::endl;
        const double next = heading + 3.14159265358979 / 2;
        for (double left = 1; std::abs(left) > 0.02 || !still(at);) {
            at = odometry.wait();
            left = wrapped(next - at.theta);
            command(0, std::abs(left) > 0.02 ? std::clamp(left, -0.6, 0.6) : 0.0);
        }
    }
    for (int i = 0; i < 5; ++i) {
        command(0, 0);
    }
    std::cout << "done" << std::endl;
}

} // namespace

int main(int argc, char **argv) {
    const std::string what = argc > 1 ? argv[1] : "";
    if (!(what == "square" && argc == 3) && !(what == "speed" && argc == 4)) {
        fail("usage: drive square METRES | drive speed M_S RAD_S");
    }
    auto *participant = make_participant();
    commands =
        make_writer(participant, "rt/cmd_vel",
                    fast::TypeSupport(new geometry_msgs::msg::dds_::TwistStamped_PubSubType));
    fast::TypeSupport type(new nav_msgs::msg::dds_::Odometry_PubSubType);
    type.register_type(participant);
    Odometry odometry;
    auto *subscriber = participant->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
    subscriber->create_datareader(
        participant->create_topic("rt/odom", type.get_type_name(), fast::TOPIC_QOS_DEFAULT),
        as_node(subscriber->get_default_datareader_qos(), false), &odometry);
    fast::PublicationMatchedStatus matched;
    while (commands->get_publication_matched_status(matched), matched.current_count == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    odometry.wait();
    std::cout << "driving" << std::endl;
    if (what == "square") {
        square(odometry, std::atof(argv[2]));
        std::_Exit(0);
    }
    for (;;) {
        command(std::atof(argv[2]), std::atof(argv[3]));
    }
}
