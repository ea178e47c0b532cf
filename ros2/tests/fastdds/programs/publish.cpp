// SPDX-License-Identifier: MIT
//
// Usage: publish TOPIC TYPE: publishes each line of stdin, a payload in hexadecimal, whatever it
// holds, once somebody subscribes to TOPIC; prints "ready" then, and ends with stdin.
#include "bytes.h"

#include <iostream>
#include <thread>

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
        std::vector<unsigned char> bytes = from_hex(line);
        writer->write(&bytes);
    }
    writer->wait_for_acknowledgments({2, 0});
}
