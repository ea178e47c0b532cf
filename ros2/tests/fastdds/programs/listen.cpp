// SPDX-License-Identifier: MIT
//
// Usage: listen: prints all that it discovers in the domain of $ROS_DOMAIN_ID, and each sample of
// topics of known types, as lines of JSON, until stdin ends.
//
// It subscribes as `ros2 topic echo` does: reliably, and to what was sent before where that is
// offered. A sample is decoded by Fast DDS's own type support and encoded again: "same" says
// whether that gave the bytes that came.
#include "node.h"
#include "ros_typesPubSubTypes.h"

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

#include <condition_variable>
#include <cstring>
#include <deque>
#include <iostream>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include <unistd.h>

namespace {

std::mutex printing;

void print(const std::string &line) {
    const std::lock_guard<std::mutex> lock(printing);
    std::cout << line << std::endl;
}

std::string hex(const unsigned char *bytes, std::size_t size) {
    static const char digits[] = "0123456789abcdef";
    std::string result;
    for (std::size_t i = 0; i < size; ++i) {
        result += digits[bytes[i] >> 4];
        result += digits[bytes[i] & 15];
    }
    return result;
}

/// Topics, types and user data of ROS 2 need no escapes; others are shown without what would.
std::string text(const std::string &raw) {
    std::string result = "\"";
    for (const char c : raw) {
        result += (c < ' ' || c == '"' || c == '\\') ? '?' : c;
    }
    return result + '"';
}

template <class Guid> std::string name_of(const Guid &guid) {
    return text(hex(guid.guidPrefix.value, 12) + hex(guid.entityId.value, 4));
}

thread_local std::vector<unsigned char> arrived;

/// Notes the bytes of what it decodes.
template <class Type> struct Noting : Type {
    bool deserialize(rtps::SerializedPayload_t *payload, void *data) override {
        arrived.assign(payload->data, payload->data + payload->length);
        return Type::deserialize(payload, data);
    }
};

struct Recorder : fast::DataReaderListener {
    std::string topic;
    fast::TypeSupport type;

    bool same(void *data) {
        const std::uint32_t size = type->getSerializedSizeProvider(data)();
        rtps::SerializedPayload_t payload(size);
        std::memset(payload.data, 0, size);
        const bool whole = type->serialize(data, &payload) && payload.length <= arrived.size() &&
                           arrived.size() - payload.length < 4 && payload.length >= 4;
        // What follows in the last word pads; the encapsulation's options count it.
        return whole && std::memcmp(payload.data, arrived.data(), 2) == 0 &&
               std::memcmp(payload.data + 4, arrived.data() + 4, payload.length - 4) == 0;
    }

    void on_data_available(fast::DataReader *reader) override {
        void *data = type->createData();
        fast::SampleInfo info;
        while (reader->take_next_sample(data, &info) ==
               eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
            const std::int64_t when = now_ns();
            if (info.valid_data) {
                print("{\"sample\": " + text(topic) + ", \"time_ns\": " + std::to_string(when) +
                      ", \"same\": " + (same(data) ? "true" : "false") +
                      ", \"writer\": " + name_of(info.sample_identity.writer_guid()) +
                      ", \"cdr\": " + text(hex(arrived.data(), arrived.size())) + "}");
            }
        }
        type->deleteData(data);
    }

    void
    on_requested_incompatible_qos(fast::DataReader *,
                                  const fast::RequestedIncompatibleQosStatus &status) override {
        print("{\"incompatible\": " + text(topic) +
              ", \"policy\": " + std::to_string(status.last_policy_id) + "}");
    }
};

template <class Qos> std::string shown(const Qos &qos) {
    const auto &user = qos.m_userData.getValue();
    const auto &lease = qos.m_liveliness.lease_duration;
    const auto &deadline = qos.m_deadline.period;
    const auto seconds = [](const eprosima::fastrtps::Duration_t &time) {
        return time.is_infinite() ? std::string("null") : std::to_string(time.to_ns() / 1e9);
    };
    return std::string(", \"reliable\": ") +
           (qos.m_reliability.kind == fast::RELIABLE_RELIABILITY_QOS ? "true" : "false") +
           ", \"durability\": " + std::to_string(qos.m_durability.kind) +
           ", \"lease_s\": " + seconds(lease) + ", \"deadline_s\": " + seconds(deadline) +
           ", \"user_data\": " + text(std::string(user.begin(), user.end()));
}

struct Offer {
    std::string topic, type;
    bool latched;
};

class Explorer : public fast::DomainParticipantListener {
  public:
    std::mutex guard;
    std::condition_variable found;
    std::deque<Offer> offers;

    void on_participant_discovery(fast::DomainParticipant *,
                                  rtps::ParticipantDiscoveryInfo &&discovery) override {
        using Info = rtps::ParticipantDiscoveryInfo;
        const auto &info = discovery.info;
        const auto &user = info.m_userData;
        const char *event = discovery.status == Info::DISCOVERED_PARTICIPANT ? "found"
                            : discovery.status == Info::REMOVED_PARTICIPANT  ? "ended"
                            : discovery.status == Info::DROPPED_PARTICIPANT  ? "lost"
                                                                             : "changed";
        print(std::string("{\"participant\": ") + name_of(info.m_guid) + ", \"event\": \"" + event +
              "\", \"lease_s\": " + std::to_string(info.m_leaseDuration.to_ns() / 1e9) +
              ", \"user_data\": " + text(std::string(user.begin(), user.end())) + "}");
    }

    void on_publisher_discovery(fast::DomainParticipant *,
                                rtps::WriterDiscoveryInfo &&discovery) override {
        const auto &info = discovery.info;
        const bool gone = discovery.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER;
        endpoint("writer", info, gone);
        if (!gone) {
            const std::lock_guard<std::mutex> lock(guard);
            const bool latched =
                info.m_qos.m_durability.kind == fast::TRANSIENT_LOCAL_DURABILITY_QOS;
            offers.push_back({info.topicName().c_str(), info.typeName().c_str(), latched});
            found.notify_one();
        }
    }

    void on_subscriber_discovery(fast::DomainParticipant *,
                                 rtps::ReaderDiscoveryInfo &&discovery) override {
        endpoint("reader", discovery.info,
                 discovery.status == rtps::ReaderDiscoveryInfo::REMOVED_READER);
    }

  private:
    template <class Info> void endpoint(const char *kind, const Info &info, bool gone) {
        print(std::string("{\"endpoint\": \"") + kind + "\", \"guid\": " + name_of(info.guid()) +
              ", \"gone\": " + (gone ? "true" : "false") +
              ", \"topic\": " + text(info.topicName().c_str()) +
              ", \"type\": " + text(info.typeName().c_str()) + shown(info.m_qos) + "}");
    }
};

template <class... Types> std::map<std::string, fast::TypeSupport> noting() {
    std::map<std::string, fast::TypeSupport> types;
    for (auto *type : {static_cast<fast::TopicDataType *>(new Noting<Types>)...}) {
        types.emplace(type->getName(), fast::TypeSupport(type));
    }
    return types;
}

} // namespace

int main() {
    Explorer explorer;
    auto *participant = make_participant(&explorer);
    auto *subscriber = participant->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
    auto types =
        noting<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType,
               geometry_msgs::msg::dds_::Twist_PubSubType,
               geometry_msgs::msg::dds_::TwistStamped_PubSubType,
               nav_msgs::msg::dds_::Odometry_PubSubType, rcl_interfaces::msg::dds_::Log_PubSubType,
               rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_PubSubType,
               sensor_msgs::msg::dds_::BatteryState_PubSubType,
               sensor_msgs::msg::dds_::Joy_PubSubType, sensor_msgs::msg::dds_::Range_PubSubType,
               std_msgs::msg::dds_::Bool_PubSubType, std_msgs::msg::dds_::Empty_PubSubType,
               std_msgs::msg::dds_::String_PubSubType, tf2_msgs::msg::dds_::TFMessage_PubSubType>();
    std::set<std::string> heard;

    std::thread(([] {
        char byte;
        while (read(0, &byte, 1) > 0) {
        }
        _exit(0);
    })).detach();
    for (;;) {
        std::unique_lock<std::mutex> lock(explorer.guard);
        explorer.found.wait(lock, [&] { return !explorer.offers.empty(); });
        const auto [topic, type, latched] = explorer.offers.front();
        explorer.offers.pop_front();
        lock.unlock();
        const auto known = types.find(type);
        if (known == types.end() || !heard.insert(topic).second) {
            continue;
        }
        known->second.register_type(participant);
        auto *recorder = new Recorder; // for as long as the program lives
        recorder->topic = topic;
        recorder->type = known->second;
        subscriber->create_datareader(
            participant->create_topic(topic, type, fast::TOPIC_QOS_DEFAULT),
            as_node(subscriber->get_default_datareader_qos(), latched, 100), recorder);
    }
}
