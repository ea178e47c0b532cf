// SPDX-License-Identifier: MIT
//
// Usage: publish TOPIC TYPE: publishes each line of stdin, a payload in hexadecimal, whatever it
// holds, once somebody subscribes to TOPIC; prints "ready" then, and ends with stdin.
#include "node.h"

#include <cstring>
#include <iostream>
#include <thread>
#include <vector>

namespace {

struct Bytes : fast::TopicDataType {
    explicit Bytes(const char *name) {
        setName(name);
        m_typeSize = 65536;
        m_isGetKeyDefined = false;
    }
    bool serialize(void *data, rtps::SerializedPayload_t *payload) override {
        const auto &bytes = *static_cast<std::vector<unsigned char> *>(data);
        std::memcpy(payload->data, bytes.data(), bytes.size());
        payload->length = static_cast<std::uint32_t>(bytes.size());
        return true;
    }
    bool deserialize(rtps::SerializedPayload_t *, void *) override {
        return false;
    }
    std::function<std::uint32_t()> getSerializedSizeProvider(void *data) override {
        return [data] {
            return static_cast<std::uint32_t>(
                static_cast<std::vector<unsigned char> *>(data)->size());
        };
    }
    void *createData() override {
        return new std::vector<unsigned char>;
    }
    void deleteData(void *data) override {
        delete static_cast<std::vector<unsigned char> *>(data);
    }
    bool getKey(void *, rtps::InstanceHandle_t *, bool) override {
        return false;
    }
};

} // namespace

int main(int argc, char **argv) {
    if (argc != 3) {
        fail("usage: publish TOPIC TYPE");
    }
    auto *writer = make_writer(make_participant(), argv[1], fast::TypeSupport(new Bytes(argv[2])));
    fast::PublicationMatchedStatus matched;
    while (writer->get_publication_matched_status(matched), matched.current_count == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::cout << "ready" << std::endl;
    std::string line;
    while (std::getline(std::cin, line)) {
        std::vector<unsigned char> bytes;
        for (std::size_t i = 0; i + 1 < line.size(); i += 2) {
            bytes.push_back(static_cast<unsigned char>(std::stoi(line.substr(i, 2), nullptr, 16)));
        }
        writer->write(&bytes);
    }
    writer->wait_for_acknowledgments({2, 0});
}
