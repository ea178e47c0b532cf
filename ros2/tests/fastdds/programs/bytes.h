// SPDX-License-Identifier: MIT
//
// A payload as it is, whatever it holds, as a type of any name.
#pragma once

#include "node.h"

#include <cstring>
#include <functional>
#include <string>
#include <vector>

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
    bool deserialize(rtps::SerializedPayload_t *payload, void *data) override {
        static_cast<std::vector<unsigned char> *>(data)->assign(payload->data,
                                                                payload->data + payload->length);
        return true;
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

inline std::vector<unsigned char> from_hex(const std::string &line) {
    std::vector<unsigned char> bytes;
    for (std::size_t i = 0; i + 1 < line.size(); i += 2) {
        bytes.push_back(static_cast<unsigned char>(std::stoi(line.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}
