/* SPDX-License-Identifier: MIT
 *
 * Fuzzing the reader of udpserver.cfg: any text gives a configuration that is good, or an error
 * that says where and what, and then nothing has changed.
 */
#include "config_file.h"
#include "fuzz.h"
#include "roburoc4.h"
#include "roburoc4_sim.h"

using namespace roburoc4_tests;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    ExactBlock text(Bytes(data, data + size));
    roburoc4_sim_config config;
    roburoc4_sim_config before;
    roburoc4_sim_config_init(&config, sizeof config);
    std::memcpy(&before, &config, sizeof config);
    for (const std::size_t capacity : {0U, 1U, 16U, 200U}) {
        std::memcpy(&config, &before, sizeof config);
        ExactBlock error(capacity, 0x5A);
        char *place = capacity == 0 ? nullptr : reinterpret_cast<char *>(error.data());
        const roburoc4_result result = sim_config_read(
            &config, reinterpret_cast<const char *>(text.data()), text.size(), place, capacity);
        if (result >= 0) {
            expect(roburoc4_sim_config_error(&config) == nullptr, "what is read can be used");
            continue;
        }
        expect(result == ROBUROC4_ERR_VALUE, "a text that cannot be used is a bad value");
        expect(std::memcmp(&config, &before, sizeof config) == 0, "and changes nothing");
        expect(capacity == 0 || std::memchr(error.data(), 0, capacity) != nullptr,
               "the error has an end");
    }
    return 0;
}
