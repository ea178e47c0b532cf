/* SPDX-License-Identifier: MIT
 *
 * protocol_doc_test.cpp - the hex in docs/PROTOCOL.md is the hex that the codec is tested on: its
 * fenced blocks ```hex NAME are vectors of conformance/telegrams.json, and there is no other.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "hex.h"
#include "vectors.h"

using namespace roburoc4_tests;

namespace {

std::string page() {
    return ROBUROC4_SOURCE_DIR "/docs/PROTOCOL.md";
}

struct Document {
    std::map<std::string, std::string> examples; /* hex, by the name of its block */
    std::string prose;                           /* all lines outside of those blocks */
    std::string faults;
};

Document read_document(std::istream &file) {
    const std::string fence = "```", opening = "```hex ";
    Document document;
    std::string line, name;
    bool inside = false;
    while (std::getline(file, line)) {
        if (!inside && line.compare(0, opening.size(), opening) == 0) {
            inside = true;
            name = line.substr(opening.size());
            if (!document.examples.emplace(name, "").second)
                document.faults += "shown twice: " + name + "\n";
        } else if (inside && line == fence) {
            inside = false;
        } else if (inside) {
            document.examples[name] += line + "\n";
        } else {
            document.prose += line + "\n";
        }
    }
    if (inside)
        document.faults += "block without an end: " + name + "\n";
    return document;
}

/** Three or more pairs of hex digits in a row, which should be in an example; "" if there are
 * none. */
std::string loose_bytes(const std::string &prose) {
    std::istringstream words(prose);
    std::string word, run;
    while (words >> word) {
        word.erase(std::remove(word.begin(), word.end(), '`'), word.end());
        const bool byte =
            word.size() == 2 && word.find_first_not_of("0123456789ABCDEFabcdef") == word.npos;
        if (!byte)
            run.clear();
        else
            run.append(word).append(" ");
        if (run.size() >= 9)
            return run;
    }
    return "";
}

Document protocol_page() {
    std::ifstream file(page());
    EXPECT_TRUE(file.is_open()) << page() << " is not there";
    return read_document(file);
}

TEST(ProtocolDocument, ShowsTelegramsOnceAndAsTested) {
    Document document = protocol_page();
    EXPECT_EQ("", document.faults);
    EXPECT_LE(10U, document.examples.size());
    for (const Vector &vector : vectors) {
        const auto shown = document.examples.find(vector.name);
        if (shown == document.examples.end())
            continue;
        EXPECT_EQ(to_hex(from_hex(vector.hex)), to_hex(from_hex(shown->second))) << vector.name;
        document.examples.erase(shown);
    }
    for (const auto &left : document.examples)
        ADD_FAILURE() << "shown, but not tested: " << left.first;
}

TEST(ProtocolDocument, HasNoBytesOutsideOfItsExamples) {
    EXPECT_EQ("", loose_bytes(protocol_page().prose));
}

TEST(ProtocolDocumentReader, SeesFaults) {
    std::istringstream text("```hex get\n01 00\n```\n```hex get\n02\n```\n```hex open\n");
    const Document document = read_document(text);
    EXPECT_EQ("shown twice: get\nblock without an end: open\n", document.faults);
    EXPECT_EQ("01 00\n02\n", document.examples.at("get"));
    EXPECT_EQ("FF 06 00 ", loose_bytes("send `FF 06 00` now"));
    EXPECT_EQ("", loose_bytes("channels 00, 01 and 10 20 of 3"));
}

} // namespace
