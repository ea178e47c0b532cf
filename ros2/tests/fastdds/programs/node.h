// SPDX-License-Identifier: MIT
//
// A DDS participant as rmw_fastrtps_cpp makes one, and what its programs share.
#ifndef ROBUROC4_TESTS_ROS2_NODE_H
#define ROBUROC4_TESTS_ROS2_NODE_H

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

inline std::int64_t now_ns() {
    using namespace std::chrono;
    return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
}

[[noreturn]] inline void fail(const std::string &why) {
    std::fprintf(stderr, "%s\n", why.c_str());
    std::exit(1);
}

/// Of the domain in $ROS_DOMAIN_ID. UDP only: shared memory would outlive a killed program.
inline fast::DomainParticipant *
make_participant(fast::DomainParticipantListener *listener = nullptr) {
    const char *domain = std::getenv("ROS_DOMAIN_ID");
    fast::DomainParticipantQos qos = fast::PARTICIPANT_QOS_DEFAULT;
    const std::string enclave = "enclave=/;";
    qos.user_data().setValue(std::vector<rtps::octet>(enclave.begin(), enclave.end()));
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(
        std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>());
    auto *made = fast::DomainParticipantFactory::get_instance()->create_participant(
        domain ? std::atoi(domain) : 0, qos, listener, fast::StatusMask::none());
    return made ? made : (fail("no participant"), nullptr);
}

/// As a node has it: rclcpp's default, or one that also wants what was sent before.
template <class Qos> Qos as_node(Qos qos, bool latched, int depth = 10) {
    qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind =
        latched ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
    qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = depth;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    return qos;
}

inline fast::DataWriter *make_writer(fast::DomainParticipant *participant, const std::string &topic,
                                     const fast::TypeSupport &type, bool latched = false,
                                     const std::string &user_data = "") {
    type.register_type(participant);
    auto *publisher = participant->create_publisher(fast::PUBLISHER_QOS_DEFAULT);
    fast::DataWriterQos qos = as_node(publisher->get_default_datawriter_qos(), latched);
    qos.user_data().setValue(std::vector<rtps::octet>(user_data.begin(), user_data.end()));
    auto *made = publisher->create_datawriter(
        participant->create_topic(topic, type.get_type_name(), fast::TOPIC_QOS_DEFAULT), qos);
    return made ? made : (fail("no writer of " + topic), nullptr);
}

#endif
