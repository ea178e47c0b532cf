/* SPDX-License-Identifier: MIT
 *
 * The machine "discovery": which service has which id and which input is what; and the snapshot
 * that keeps what was found.
 * Alone: what it promises to whoever calls it, also where the joined client never leads it.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

extern "C" {
#include "joined.h"
}

TEST(Snapshot, PropertiesThatAreAllZeroAreNewsTheFirstTime) {
    for (const std::size_t surplus : {0U, 3U}) {
        roburoc4_client client{};
        std::array<std::uint8_t, 128> bytes{};
        const auto events_of = [&](std::uint32_t service, roburoc4_result size) {
            EXPECT_GT(size, 0);
            client.private_events = 0;
            EXPECT_GE(roburoc4_snapshot_properties(&client, service, bytes.data(),
                                                   static_cast<std::size_t>(size) + surplus),
                      0);
            return client.private_events;
        };
        const roburoc4_battery_properties battery{};
        const roburoc4_localization_properties localization{};
        const roburoc4_result battery_size =
            roburoc4_encode_battery_properties(bytes.data(), bytes.size(), 2, &battery);
        EXPECT_EQ(ROBUROC4_EVENT_PROPERTIES, events_of(ROBUROC4_SERVICE_BATTERY, battery_size));
        client.private_discovery.known = 1U << ROBUROC4_SERVICE_BATTERY;
        EXPECT_EQ(0U, events_of(ROBUROC4_SERVICE_BATTERY, battery_size)) << "and not again";
        EXPECT_EQ(ROBUROC4_EVENT_PROPERTIES,
                  events_of(ROBUROC4_SERVICE_LOCALIZATION,
                            roburoc4_encode_localization_properties(bytes.data(), bytes.size(), 2,
                                                                    &localization)));
    }
}

namespace {

struct Directory {
    std::array<std::uint8_t, 64> bytes{};
    roburoc4_directory view{};

    Directory(std::initializer_list<roburoc4_directory_entry> entries) {
        std::array<roburoc4_directory_entry, 8> list{};
        std::copy(entries.begin(), entries.end(), list.begin());
        const roburoc4_result size = roburoc4_encode_directory(bytes.data(), bytes.size(), 2, 0,
                                                               list.data(), entries.size());
        EXPECT_EQ(ROBUROC4_OK,
                  roburoc4_decode_directory(bytes.data(), static_cast<std::size_t>(size), &view));
    }
};

} // namespace

TEST(Discovery, ADirectoryThatDiffersInAnyWayIsAnother) {
    const Directory none{};
    const Directory known{{0, 0}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}};
    const Directory shorter{{0, 0}, {0, 1}};
    const Directory longer{{0, 0}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}, {0, 4}};
    const Directory first_id{{0, 2}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}};
    const Directory first_type{{1, 0}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}};
    const Directory second_id{{0, 0}, {0, 2}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}};
    const Directory last_id{{0, 0}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 7}};
    const Directory last_type{{0, 0}, {0, 1}, {ROBUROC4_TYPE_DRIVE, 6}};
    const std::array<const Directory *, 9> all{
        &none, &known, &shorter, &longer, &first_id, &first_type, &second_id, &last_id, &last_type};
    for (const Directory *one : all) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        EXPECT_FALSE(roburoc4_discovery_directory(&d, &one->view)) << "there is room for it";
        for (const Directory *other : all)
            EXPECT_EQ(one == other, roburoc4_discovery_same(&d, &other->view));
    }
}

TEST(Discovery, WhatADirectoryListsNoMoreCountsNoMore) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    const Directory longer{{0, 0}, {ROBUROC4_TYPE_TELEMETER, 3}, {0x7100, 6}};
    const Directory shorter{{0, 0}, {ROBUROC4_TYPE_TELEMETER, 3}};
    EXPECT_FALSE(roburoc4_discovery_directory(&d, &longer.view));
    EXPECT_TRUE(roburoc4_discovery_may_drive(&d, 6));
    EXPECT_FALSE(roburoc4_discovery_may_drive(&d, 3)) << "telemeters";
    EXPECT_TRUE(roburoc4_discovery_unseen(&d));
    EXPECT_TRUE(roburoc4_discovery_identify(&d));
    EXPECT_EQ(1U << ROBUROC4_SERVICE_TELEMETER | 1U << ROBUROC4_SERVICE_DIFFERENTIAL, d.listed);
    EXPECT_FALSE(roburoc4_discovery_directory(&d, &shorter.view));
    EXPECT_FALSE(roburoc4_discovery_may_drive(&d, 6));
    EXPECT_FALSE(roburoc4_discovery_unseen(&d));
    EXPECT_TRUE(roburoc4_discovery_identify(&d));
    EXPECT_EQ(1U << ROBUROC4_SERVICE_TELEMETER, d.listed);
    EXPECT_EQ(0, d.service_ids[ROBUROC4_SERVICE_DIFFERENTIAL]);
}

/* Of equals the one with the manual's id, else the first. */
TEST(Discovery, AServiceIsChosenByTypeThenByTextThenByTheManualsId) {
    struct Claimant {
        roburoc4_directory_entry entry;
        std::string text;
    };
    const std::array<Claimant, 6> ranks{{{{ROBUROC4_TYPE_DIFFERENTIAL, 6}, "?"},
                                         {{ROBUROC4_TYPE_DIFFERENTIAL, 70}, "?"},
                                         {{0x7100, 6}, "Differential"},
                                         {{0x7100, 80}, "Differential"},
                                         {{0x7100, 6}, "?"},
                                         {{ROBUROC4_TYPE_LASER, 6}, "Differential"}}};
    for (std::size_t better = 0; better < ranks.size(); better++) {
        for (std::size_t worse = better; worse < ranks.size(); worse++) {
            for (const auto &[first, second] :
                 {std::pair{better, worse}, std::pair{worse, better}}) {
                SCOPED_TRACE(std::to_string(first) + " " + std::to_string(second));
                const Directory directory{ranks[first].entry, ranks[second].entry};
                discovery d{};
                roburoc4_discovery_clear(&d);
                EXPECT_FALSE(roburoc4_discovery_directory(&d, &directory.view));
                for (std::uint32_t i = 0; i < 2; i++) {
                    const std::string &text = ranks[i == 0 ? first : second].text;
                    roburoc4_discovery_text(&d, LIST_DIRECTORY, i,
                                            reinterpret_cast<const std::uint8_t *>(text.data()),
                                            static_cast<std::uint32_t>(text.size()));
                }
                const bool none = better + 1 == ranks.size();
                EXPECT_EQ(!none, roburoc4_discovery_identify(&d));
                EXPECT_EQ(none ? 0 : 1 << ROBUROC4_SERVICE_DIFFERENTIAL, d.listed);
                EXPECT_EQ(none ? 0 : ranks[better].entry.id,
                          d.service_ids[ROBUROC4_SERVICE_DIFFERENTIAL]);
                EXPECT_EQ(1, d.identified);
            }
        }
    }
}

TEST(Discovery, AServiceIsTakenForNoOther) {
    struct Case {
        roburoc4_directory_entry entry;
        const char *text;
        int kind; /* or 0 */
    };
    const std::array<Case, 21> cases{{{{ROBUROC4_TYPE_IOCARD, 50}, "?", 2},
                                      {{ROBUROC4_TYPE_TELEMETER, 50}, "?", 3},
                                      {{ROBUROC4_TYPE_LOCALIZATION, 50}, "?", 5},
                                      {{ROBUROC4_TYPE_DIFFERENTIAL, 50}, "?", 6},
                                      {{ROBUROC4_TYPE_DIAGNOSTIC, 2}, "IO card", 0},
                                      {{ROBUROC4_TYPE_LASER, 3}, "Telemeter", 0},
                                      {{ROBUROC4_TYPE_DRIVE, 6}, "Differential", 0},
                                      {{0x7100, 50}, "IO card", 2},
                                      {{0x7100, 50}, "Telemeter", 3},
                                      {{0x7100, 50}, "Battery", 4},
                                      {{0x7100, 50}, "Localization", 5},
                                      {{0x7100, 50}, "Differential", 6},
                                      {{0x7100, 2}, "?", 2},
                                      {{0x7100, 3}, "?", 3},
                                      {{0x7100, 4}, "?", 4},
                                      {{0x7100, 5}, "?", 5},
                                      {{0x7100, 6}, "?", 6},
                                      {{0x7100, 7}, "?", 0},
                                      {{ROBUROC4_TYPE_IOCARD, 0}, "IO card", 0},
                                      {{ROBUROC4_TYPE_DIFFERENTIAL, 1}, "Differential", 0},
                                      {{0x7100, 50}, "?", 0}}};
    for (const Case &c : cases) {
        SCOPED_TRACE(std::to_string(c.entry.type) + " " + std::to_string(c.entry.id) + c.text);
        const Directory directory{c.entry};
        discovery d{};
        roburoc4_discovery_clear(&d);
        EXPECT_FALSE(roburoc4_discovery_directory(&d, &directory.view));
        const std::string text = c.text;
        roburoc4_discovery_text(&d, LIST_DIRECTORY, 0,
                                reinterpret_cast<const std::uint8_t *>(text.data()),
                                static_cast<std::uint32_t>(text.size()));
        EXPECT_EQ(c.kind != 0, roburoc4_discovery_identify(&d));
        EXPECT_EQ(c.kind != 0 ? 1 << c.kind : 0, d.listed);
        for (int kind = 2; kind < ROBUROC4_SERVICE_COUNT; kind++)
            EXPECT_EQ(kind == c.kind ? c.entry.id : 0, d.service_ids[kind]) << kind;
    }
}

TEST(Discovery, EachChangeOfAnIdIsOne) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    const auto changed = [&](std::uint16_t first, std::uint16_t second) {
        const Directory directory{{ROBUROC4_TYPE_TELEMETER, first},
                                  {ROBUROC4_TYPE_TELEMETER, second}};
        EXPECT_FALSE(roburoc4_discovery_directory(&d, &directory.view));
        return roburoc4_discovery_identify(&d);
    };
    for (const std::uint16_t id : std::array<std::uint16_t, 6>{50, 40, 60, 2, 3, 0xFFFF}) {
        EXPECT_TRUE(changed(id, id == 3 ? 2 : 70)) << id;
        EXPECT_EQ(id, d.service_ids[ROBUROC4_SERVICE_TELEMETER]) << "the first of equals";
        EXPECT_FALSE(changed(id, 2)) << id;
        EXPECT_EQ(id, d.service_ids[ROBUROC4_SERVICE_TELEMETER]);
    }
    EXPECT_TRUE(changed(70, 3)) << "the manual's of equals";
    EXPECT_EQ(3, d.service_ids[ROBUROC4_SERVICE_TELEMETER]);
}

/* Only of those above the first two ids something may be unseen, wherever it stands. */
TEST(Discovery, AServiceIsUnseenUntilItsTypeOrTextTellsWhatItIs) {
    for (std::uint32_t place = 0; place < 3; place++) {
        for (const std::uint16_t id : std::array<std::uint16_t, 4>{0, 1, 2, 99}) {
            SCOPED_TRACE(std::to_string(place) + " " + std::to_string(id));
            std::array<roburoc4_directory_entry, 3> entries{};
            for (roburoc4_directory_entry &entry : entries)
                entry = {ROBUROC4_TYPE_LASER, 50};
            entries[place] = {0x7100, id};
            const Directory directory{entries[0], entries[1], entries[2]};
            discovery d{};
            roburoc4_discovery_clear(&d);
            EXPECT_FALSE(roburoc4_discovery_unseen(&d)) << "nothing is listed";
            EXPECT_FALSE(roburoc4_discovery_directory(&d, &directory.view));
            EXPECT_EQ(id > 1, roburoc4_discovery_unseen(&d));
            EXPECT_TRUE(roburoc4_discovery_may_drive(&d, id)) << "it may be anything";
            EXPECT_FALSE(roburoc4_discovery_may_drive(&d, 50));
            roburoc4_discovery_described(&d, LIST_DIRECTORY, place);
            EXPECT_EQ(id > 1, roburoc4_discovery_unseen(&d)) << "its text was not believed";
            const std::uint8_t text[] = "Camera";
            roburoc4_discovery_text(&d, LIST_DIRECTORY, place, text, 6);
            EXPECT_FALSE(roburoc4_discovery_unseen(&d)) << "its text says that it is another";
        }
    }
}

TEST(Discovery, WordsAreLookedForInTheFirst255BytesOfAText) {
    const std::string word = "- Front. BUMPER"; /* signs and blanks do not count */
    const auto found = [&](std::size_t before) {
        roburoc4_private_discovery d{};
        roburoc4_discovery_clear(&d);
        const std::string text = std::string(before, ' ') + word + std::string(65000, ' ');
        return roburoc4_discovery_text(&d, ROBUROC4_IO_DIGITAL_INPUT, 3,
                                       reinterpret_cast<const std::uint8_t *>(text.data()),
                                       static_cast<std::uint32_t>(text.size()));
    };
    EXPECT_TRUE(found(0));
    EXPECT_TRUE(found(255 - word.size()));
    EXPECT_FALSE(found(256 - word.size()));
}

TEST(Discovery, TheSameTextOfTheSameInputAgainIsNotAmbiguous) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    const char text[] = "Front bumper";
    const auto *bytes = reinterpret_cast<const std::uint8_t *>(text);
    const auto take = [&](std::uint32_t index) {
        return roburoc4_discovery_text(&d, ROBUROC4_IO_DIGITAL_INPUT, index, bytes, 12);
    };
    EXPECT_TRUE(take(7));
    EXPECT_TRUE(take(7));
    EXPECT_EQ(7, d.role_texts[ROBUROC4_ROLE_FRONT_BUMPER]);
    EXPECT_TRUE(take(8));
    EXPECT_EQ(ROLE_TEXT_AMBIGUOUS, d.role_texts[ROBUROC4_ROLE_FRONT_BUMPER]);
    EXPECT_TRUE(take(7));
    EXPECT_EQ(ROLE_TEXT_AMBIGUOUS, d.role_texts[ROBUROC4_ROLE_FRONT_BUMPER]) << "and stays so";
    roburoc4_discovery_clear(&d);
    EXPECT_TRUE(take(8));
    EXPECT_TRUE(take(7));
    EXPECT_EQ(ROLE_TEXT_AMBIGUOUS, d.role_texts[ROBUROC4_ROLE_FRONT_BUMPER]) << "in any order";
}

TEST(Discovery, OnlyLettersAndDigitsMakeWords) {
    const auto found = [](char between) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        const std::string text = std::string("Front ") + between + " bumper";
        return roburoc4_discovery_text(&d, ROBUROC4_IO_DIGITAL_INPUT, 3,
                                       reinterpret_cast<const std::uint8_t *>(text.data()),
                                       static_cast<std::uint32_t>(text.size()));
    };
    for (const char sign : std::string(" /:@[`{")) /* those beside letters and digits, too */
        EXPECT_TRUE(found(sign)) << sign;
    for (const char other : std::string("09AZaz"))
        EXPECT_FALSE(found(other)) << other;
}

TEST(Discovery, AWordCountsOnlyWithAllOfItsLetters) {
    const auto claim = [](const std::string &text) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        roburoc4_discovery_text(&d, LIST_DIRECTORY, 0,
                                reinterpret_cast<const std::uint8_t *>(text.data()),
                                static_cast<std::uint32_t>(text.size()));
        return d.claims[0] != CLAIM_OTHER;
    };
    const auto role = [](const std::string &text) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        const auto *bytes = reinterpret_cast<const std::uint8_t *>(text.data());
        const auto length = static_cast<std::uint32_t>(text.size());
        const bool digital =
            roburoc4_discovery_text(&d, ROBUROC4_IO_DIGITAL_INPUT, 0, bytes, length);
        return roburoc4_discovery_text(&d, ROBUROC4_IO_ANALOG_INPUT, 0, bytes, length) || digital;
    };
    const auto expect_all = [](const auto &found, const std::string &word) {
        EXPECT_TRUE(found(word)) << word;
        EXPECT_TRUE(found("my " + word + "s")) << word;
        for (std::size_t i = 0; i < word.size(); i++) {
            std::string other = word;
            other[i] = 'q';
            EXPECT_FALSE(found(other)) << other;
            other = word;
            other.erase(i, 1);
            EXPECT_FALSE(found(other)) << other;
        }
    };
    for (const char *word : {"iocard", "telemeter", "battery", "locali", "differential"})
        expect_all(claim, word);
    for (const char *word : {"gamepadabutton", "frontbumper", "rearbumper", "batteryvoltage"})
        expect_all(role, word);
}

/* Services, digital inputs (among them is the override), analog ones, then outputs; of each no more
 * than a client stores. */
TEST(Discovery, EachTextIsAskedForOnceAndInItsTurn) {
    const std::array<std::int32_t, 4> none{}, usual{9, 2, 22, 8}, full{32, 16, 64, 64},
        beyond{33, 17, 65, std::numeric_limits<std::int32_t>::max()};
    for (const std::array<std::int32_t, 4> &counts : {none, usual, full, beyond}) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        d.service_count = 3;
        d.service_ids[ROBUROC4_SERVICE_IOCARD] = 0x1234;
        const requests nothing_open{};
        for (const std::uint8_t list : std::array<std::uint8_t, 5>{4, 2, 0, 3, 1}) {
            const std::int32_t capacity = list > 1 ? 64 : 32 >> list;
            const std::int32_t length = list == 4 ? 3 : std::min(counts[list], capacity);
            for (std::int32_t i = 0; i < length; i++) {
                SCOPED_TRACE(std::to_string(list) + " " + std::to_string(i));
                ask a{};
                ASSERT_TRUE(
                    roburoc4_discovery_next_text(&d, &nothing_open, counts.data(), true, &a));
                EXPECT_EQ(ROBUROC4_ACTION_QUERY, a.action);
                EXPECT_EQ(list, a.detail);
                EXPECT_EQ(i, a.subject);
                EXPECT_EQ(list == 4 ? ROBUROC4_SERVICE_DIRECTORY : ROBUROC4_SERVICE_IOCARD, a.kind);
                EXPECT_EQ(list == 4 ? 0 : 0x1234, a.target);
                EXPECT_GE(a.max_tries, 10);
                EXPECT_FALSE(roburoc4_discovery_texts_done(&d, counts.data(), true));
                EXPECT_EQ(list != 4, roburoc4_discovery_texts_done(&d, counts.data(), false));
                EXPECT_EQ(list == 4, roburoc4_discovery_next_text(&d, &nothing_open, counts.data(),
                                                                  false, &a));
                roburoc4_discovery_described(&d, list, static_cast<std::uint32_t>(i));
            }
        }
        ask a{};
        EXPECT_FALSE(roburoc4_discovery_next_text(&d, &nothing_open, counts.data(), true, &a));
        EXPECT_TRUE(roburoc4_discovery_texts_done(&d, counts.data(), true));
    }
}

/* Answers come in any order, and some not at all. */
TEST(Discovery, ATextThatIsLeftIsAskedForWhereverItStands) {
    const std::array<std::int32_t, 4> counts{9, 5, 63, 64};
    const std::array<std::uint32_t, 5> lengths{9, 5, 63, 64, 7};
    for (std::uint32_t left = 0; left < 5; left++) {
        for (std::uint32_t index = 0; index < lengths[left]; index++) {
            SCOPED_TRACE(std::to_string(left) + " " + std::to_string(index));
            discovery d{};
            roburoc4_discovery_clear(&d);
            d.service_count = 7;
            for (std::uint32_t list = 0; list < 5; list++)
                for (std::uint32_t i = lengths[list]; i-- > 0;)
                    if (list != left || i != index)
                        roburoc4_discovery_described(&d, list, i);
            requests r{};
            ask a{};
            ASSERT_TRUE(roburoc4_discovery_next_text(&d, &r, counts.data(), true, &a));
            EXPECT_EQ(left, a.detail);
            EXPECT_EQ(index, a.subject);
            EXPECT_FALSE(roburoc4_discovery_texts_done(&d, counts.data(), true));
            EXPECT_EQ(left != 4, roburoc4_discovery_texts_done(&d, counts.data(), false));
            ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
            ask other{};
            EXPECT_FALSE(roburoc4_discovery_next_text(&d, &r, counts.data(), true, &other));
            EXPECT_FALSE(roburoc4_discovery_texts_done(&d, counts.data(), true)) << "it is open";
            roburoc4_discovery_described(&d, left, index);
            EXPECT_TRUE(roburoc4_discovery_texts_done(&d, counts.data(), true));
        }
    }
}

TEST(Discovery, TextsThatAreReadAgainAreAllReadAgain) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    std::fill(std::begin(d.described), std::end(d.described), UINT64_MAX);
    d.done = 1;
    roburoc4_discovery_read_texts_again(&d);
    for (const std::uint64_t list : d.described)
        EXPECT_EQ(0U, list);
    EXPECT_EQ(0, d.done);
}

TEST(Discovery, OfARobotThatIsForgottenOnlyTheUsersWishesStay) {
    discovery d;
    std::memset(&d, 0xA5, sizeof d);
    discovery fresh{};
    fresh.wanted = 0xA5;
    std::fill(std::begin(fresh.claims), std::end(fresh.claims), std::uint8_t{CLAIM_NONE});
    std::fill(std::begin(fresh.role_texts), std::end(fresh.role_texts),
              std::int16_t{ROLE_TEXT_NONE});
    roburoc4_discovery_clear(&d);
    EXPECT_EQ(0, std::memcmp(&fresh, &d, sizeof d));
}

TEST(Discovery, ARestartForgetsWhatWasAgreedAndNoText) {
    discovery d;
    std::memset(&d, 0xA5, sizeof d);
    discovery wanted = d;
    for (std::uint8_t *field :
         {&wanted.identified, &wanted.known, &wanted.refused, &wanted.inserted, &wanted.acked,
          &wanted.declined, &wanted.leaving, &wanted.done})
        *field = 0;
    roburoc4_discovery_restart(&d);
    EXPECT_EQ(0, std::memcmp(&wanted, &d, sizeof d));
}

/* The next id, so that late answers of before do not fit; and that a robot echoed one of ours. */
TEST(Discovery, ATextClaimsTheServiceThatItNamesAndElseNone) {
    const std::array<std::pair<const char *, int>, 10> texts{
        {{"IO card", ROBUROC4_SERVICE_IOCARD},
         {"Telemeters", ROBUROC4_SERVICE_TELEMETER},
         {"battery", ROBUROC4_SERVICE_BATTERY},
         {"Localisation", ROBUROC4_SERVICE_LOCALIZATION},
         {"Localization", ROBUROC4_SERVICE_LOCALIZATION},
         {"The DIFFERENTIAL", ROBUROC4_SERVICE_DIFFERENTIAL},
         {"Camera", CLAIM_OTHER},
         {"000000000000000", CLAIM_OTHER},
         {"zzzzzzzzzzzzzzz", CLAIM_OTHER},
         {"", CLAIM_OTHER}}};
    for (const auto &[text, claim] : texts) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        const std::string copy(text);
        EXPECT_FALSE(roburoc4_discovery_text(&d, LIST_DIRECTORY, 31,
                                             reinterpret_cast<const std::uint8_t *>(copy.data()),
                                             static_cast<std::uint32_t>(copy.size())));
        EXPECT_EQ(claim, d.claims[31]) << text;
    }
}

TEST(Discovery, AServiceThatTurnsOutToBeAnotherIsListedNoMore) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    const Directory known{{0x7001, ROBUROC4_SERVICE_IOCARD}};
    EXPECT_FALSE(roburoc4_discovery_directory(&d, &known.view));
    EXPECT_TRUE(roburoc4_discovery_identify(&d));
    EXPECT_EQ(1U << ROBUROC4_SERVICE_IOCARD, d.listed) << "by the manual's number";
    const char text[] = "Battery";
    roburoc4_discovery_text(&d, LIST_DIRECTORY, 0, reinterpret_cast<const std::uint8_t *>(text), 7);
    EXPECT_TRUE(roburoc4_discovery_identify(&d));
    EXPECT_EQ(1U << ROBUROC4_SERVICE_BATTERY, d.listed);
    EXPECT_EQ(0, d.service_ids[ROBUROC4_SERVICE_IOCARD]);
    EXPECT_EQ(ROBUROC4_SERVICE_IOCARD, d.service_ids[ROBUROC4_SERVICE_BATTERY]);
    EXPECT_FALSE(roburoc4_discovery_identify(&d)) << "nothing changed";
}
