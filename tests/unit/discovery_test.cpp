/* SPDX-License-Identifier: MIT
 *
 * What discovery keeps and what it forgets, when a robot, its directory or its card is another one:
 * discovery.c alone.
 */
#include <gtest/gtest.h>

#include <cstring>
#include <string>

extern "C" {
#include "../../src/machines.h"
}

namespace {

constexpr std::uint16_t kUnknownType = 0x0300;

/* A robot like the manual's, whose texts tell what its services are, and all of them passed. */
class Discovery : public testing::Test {
  protected:
    Discovery() {
        roburoc4_config_init(&config_, sizeof config_);
        roburoc4_discovery_clear(&d_);
        d_.service_count = 3;
        for (std::uint8_t i = 0; i < 3; i++) {
            d_.ids[i] = static_cast<std::uint16_t>(2 + i);
            d_.types[i] = kUnknownType;
            roburoc4_discovery_text_given_up(&d_, LIST_DIRECTORY, i);
        }
        counts_[ROBUROC4_IO_ANALOG_INPUT] = ROBUROC4_AI_COUNT;
        counts_[ROBUROC4_IO_ANALOG_OUTPUT] = ROBUROC4_AO_COUNT;
        counts_[ROBUROC4_IO_DIGITAL_INPUT] = ROBUROC4_DI_COUNT;
        counts_[ROBUROC4_IO_DIGITAL_OUTPUT] = ROBUROC4_DO_COUNT;
        for (std::uint32_t list = 0; list < LIST_DIRECTORY; list++) {
            for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(counts_[list]); i++) {
                roburoc4_discovery_text_given_up(&d_, list, i);
            }
        }
    }
    void text(std::uint32_t index, const std::string &text) {
        roburoc4_discovery_text(&d_, ROBUROC4_IO_DIGITAL_INPUT, index,
                                reinterpret_cast<const std::uint8_t *>(text.data()),
                                static_cast<std::uint32_t>(text.size()));
    }
    /* The next text to request. */
    ask next(text_choice choice) const {
        const requests none{};
        ask found{};
        EXPECT_TRUE(roburoc4_discovery_next_text(&d_, &none, counts_, choice, &found));
        return found;
    }
    roburoc4_result pad() const {
        return roburoc4_discovery_role(&d_, &config_, counts_, ROBUROC4_ROLE_OVERRIDE, 0);
    }

    roburoc4_private_discovery d_{};
    roburoc4_config config_{};
    std::int32_t counts_[4]{};
};

TEST_F(Discovery, IsPassedOnceEachTextWasAnsweredOrGivenUp) {
    EXPECT_TRUE(roburoc4_discovery_services_passed(&d_));
    EXPECT_TRUE(roburoc4_discovery_inputs_passed(&d_, counts_));
    EXPECT_TRUE(roburoc4_discovery_texts_passed(&d_, counts_));
    d_.given_up[LIST_DIRECTORY] &= ~std::uint64_t{4};
    EXPECT_FALSE(roburoc4_discovery_services_passed(&d_));
    EXPECT_FALSE(roburoc4_discovery_texts_passed(&d_, counts_));
    EXPECT_EQ(next(TEXTS_ALL).subject, 2);
}

TEST_F(Discovery, OfARobotThatIsFoundAgainRequestsWhatWasGivenUp) {
    text(8, "Game pad A");
    d_.texts_done = 1;
    EXPECT_TRUE(roburoc4_discovery_inputs_passed(&d_, counts_));
    roburoc4_discovery_doubt(&d_, ROBUROC4_IO_DIGITAL_INPUT, 3, 0);
    roburoc4_discovery_restart(&d_);
    EXPECT_EQ(d_.doubted, 0) << "an answer of before the loss is not believed after it";
    EXPECT_FALSE(roburoc4_discovery_services_passed(&d_));
    EXPECT_FALSE(roburoc4_discovery_inputs_passed(&d_, counts_));
    EXPECT_EQ(next(TEXTS_ALL).max_tries, TEXT_TRIES);
    for (std::uint32_t i = 0; i < ROBUROC4_DI_COUNT; i++) {
        if (i != 8) {
            text(i, "spare");
        }
    }
    EXPECT_EQ(pad(), 8) << "a text that was answered is kept";
}

TEST_F(Discovery, OfAnotherCardForgetsTheTextsOfTheFirst) {
    text(8, "Game pad A");
    text(0, "Front bumper");
    roburoc4_discovery_text_refused(&d_, counts_, ROBUROC4_IO_DIGITAL_INPUT, 8);
    roburoc4_discovery_doubt(&d_, ROBUROC4_IO_DIGITAL_INPUT, 3, 1 << ROBUROC4_ROLE_OVERRIDE);
    d_.texts_done = 1;
    roburoc4_discovery_forget_inputs(&d_);
    EXPECT_EQ(d_.doubted, 0) << "it was about the first card";
    EXPECT_FALSE(roburoc4_discovery_inputs_passed(&d_, counts_));
    const ask first = next(TEXTS_THAT_DECIDE);
    EXPECT_EQ(first.detail, ROBUROC4_IO_DIGITAL_INPUT);
    EXPECT_EQ(first.subject, 0);
    EXPECT_TRUE(roburoc4_discovery_services_passed(&d_)) << "the directory is the same";
    for (std::uint32_t i = 0; i < ROBUROC4_DI_COUNT; i++) {
        text(i, "spare");
    }
    EXPECT_EQ(pad(), ROBUROC4_ERR_NOT_KNOWN) << "neither named nor refused by this card";
    bool certain = true;
    roburoc4_discovery_bumper(&d_, &config_, counts_, ROBUROC4_ROLE_FRONT_BUMPER, &certain);
    EXPECT_FALSE(certain);
}

TEST_F(Discovery, OfAnotherDirectoryReadsItsTexts) {
    roburoc4_discovery_read_texts_again(&d_);
    EXPECT_FALSE(roburoc4_discovery_services_passed(&d_));
    EXPECT_EQ(next(TEXTS_OF_SERVICES).subject, 0);
}

TEST_F(Discovery, RequestsMissingTextsLaterOnlyOnceAllHavePassed) {
    roburoc4_discovery_ask_again(&d_, counts_);
    EXPECT_EQ(d_.text_due, 0) << "the first ones are still requested";
    EXPECT_TRUE(roburoc4_discovery_texts_passed(&d_, counts_));
    d_.texts_done = 1;
    roburoc4_discovery_ask_again(&d_, counts_);
    EXPECT_EQ(d_.text_due, 1);
}

TEST_F(Discovery, ATextThatIsReadTwiceIsNotAmbiguous) {
    for (std::uint32_t i = 0; i < ROBUROC4_DI_COUNT; i++) {
        text(i, i == 8 ? "Game pad A" : "spare");
    }
    text(8, "Game pad A");
    EXPECT_EQ(pad(), 8);
    text(9, "Gamepad A");
    EXPECT_EQ(pad(), ROBUROC4_ERR_NOT_KNOWN);
}

TEST_F(Discovery, OnlyTheIdThatWasSetMayDrive) {
    EXPECT_TRUE(roburoc4_discovery_may_drive(&d_, &config_, 3)) << "nothing says that it is not";
    EXPECT_FALSE(roburoc4_discovery_may_drive(&d_, &config_, 9)) << "it is not listed";
    config_.differential_id = 4;
    EXPECT_TRUE(roburoc4_discovery_may_drive(&d_, &config_, 4));
    EXPECT_FALSE(roburoc4_discovery_may_drive(&d_, &config_, 3));
    config_.differential_id = ROBUROC4_ID_AUTO;
    config_.iocard_id = 3;
    EXPECT_FALSE(roburoc4_discovery_may_drive(&d_, &config_, 3));
    EXPECT_TRUE(roburoc4_discovery_may_drive(&d_, &config_, 4));
}

} // namespace
