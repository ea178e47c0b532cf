/* SPDX-License-Identifier: MIT
 *
 * Give a harness the files of a folder, one after the other: a corpus as an ordinary test, and a
 * finding of a fuzzer again, with any compiler.
 */
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <set>

#include "fuzz.h"

namespace {

void replay(const std::filesystem::path &file) {
    std::ifstream in(file, std::ios::binary);
    if (!in)
        roburoc4_tests::broken("cannot read " + file.string());
    const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    std::cout << file.filename().string() << std::endl; /* the last one is the culprit */
    const auto *bytes = reinterpret_cast<const std::uint8_t *>(text.data());
    LLVMFuzzerTestOneInput(bytes, text.size());
}

} // namespace

int main(int argc, char **argv) {
    std::set<std::filesystem::path> files;
    for (int i = 1; i < argc; i++) {
        if (!std::filesystem::is_directory(argv[i])) {
            files.insert(argv[i]);
            continue;
        }
        for (const auto &entry : std::filesystem::directory_iterator(argv[i]))
            files.insert(entry.path());
    }
    for (const auto &file : files)
        replay(file);
    std::cout << files.size() << " inputs, no promise broken\n";
    return files.empty() ? 2 : 0; /* an empty folder tests nothing */
}
