// SPDX-License-Identifier: MIT
//
// Usage: call SERVICE TYPE: a client of a service, such as /stop std_srvs::srv::dds_::Trigger, on
// the topics of ROS 2. Sends each line of stdin, a request in hexadecimal, once the service is
// there, and prints its answers likewise; prints "ready" first, and ends with stdin.
#include "bytes.h"

#include <iostream>
#include <mutex>
#include <thread>

namespace {

struct Answers : fast::DataReaderListener {
    void on_data_available(fast::DataReader *reader) override {
        std::vector<unsigned char> bytes;
        fast::SampleInfo info;
        while (reader->take_next_sample(&bytes, &info) ==
               eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
            if (!info.valid_data) {
                continue;
            }
            std::string text = "answer ";
            for (const unsigned char byte : bytes) {
                char digits[3];
                std::snprintf(digits, sizeof digits, "%02x", byte);
                text += digits;
            }
            std::cout << text << std::endl;
        }
    }
};

} // namespace

int main(int argc, char **argv) {
    if (argc < 3) {
        fail("usage: call SERVICE TYPE [other]");
    }
    const std::string service = argv[1], type = argv[2];
    auto *participant = make_participant();
    auto *writer = make_writer(participant, "rq" + service + "Request",
                               fast::TypeSupport(new Bytes((type + "_Request_").c_str())), false,
                               argc > 3 ? "" : "clientid=1.2.3;");
    fast::TypeSupport answer(new Bytes((type + "_Response_").c_str()));
    answer.register_type(participant);
    auto *subscriber = participant->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
    Answers answers;
    auto *reader = subscriber->create_datareader(
        participant->create_topic("rr" + service + "Reply", answer.get_type_name(),
                                  fast::TOPIC_QOS_DEFAULT),
        as_node(subscriber->get_default_datareader_qos(), false), &answers);
    fast::PublicationMatchedStatus asked;
    fast::SubscriptionMatchedStatus answered;
    do {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        writer->get_publication_matched_status(asked);
        reader->get_subscription_matched_status(answered);
    } while (asked.current_count == 0 || answered.current_count == 0);
    std::cout << "ready" << std::endl;
    std::string line;
    while (std::getline(std::cin, line)) {
        std::vector<unsigned char> bytes = from_hex(line);
        writer->write(&bytes);
    }
    std::_Exit(0);
}
