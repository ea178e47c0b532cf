/* SPDX-License-Identifier: MIT
 *
 * names_test.cpp - the constants and names of the header against the manual's tables, which are
 * copied here independently from the manual; and the texts for results.
 */
#include <gtest/gtest.h>

#include <cstdint>
#include <iterator>
#include <limits>
#include <set>
#include <string>

#include "roburoc4.h"

namespace {

/** A channel as the manual's table numbers it; "" where it "exists but is not used". */
struct Row {
    uint32_t id;
    const char *name;
};

/* Manual 5.5.1. None of its tables has a row 02. */
const Row analog_inputs[] = {{0, "Front telemeter voltage"}, {1, "Rear telemeter voltage"},
                             {3, "Battery voltage"},         {4, "Game pad \"LJ\" Left/Right"},
                             {5, "Game pad \"LJ\" Down/Up"}, {6, "Game pad \"RJ\" Left/Right"},
                             {7, "Game pad \"RJ\" Down/Up"}, {8, "Game pad \"LT\""},
                             {9, "Game pad \"RT\""}};
const Row digital_inputs[] = {{0, "Front bumper"},
                              {1, "Rear bumper"},
                              {3, ""},
                              {4, ""},
                              {5, ""},
                              {6, ""},
                              {7, ""},
                              {8, ""},
                              {9, "Game pad \"A\" button"},
                              {10, "Game pad \"B\" button"},
                              {11, "Game pad \"X\" button"},
                              {12, "Game pad \"Y\" button"},
                              {13, "Game pad \"Back\" button"},
                              {14, "Game pad \"Start\" button"},
                              {15, "Game pad \"D\" down button"},
                              {16, "Game pad \"D\" left button"},
                              {17, "Game pad \"D\" right button"},
                              {18, "Game pad \"D\" up button"},
                              {19, "Game pad \"LJ\" click"},
                              {20, "Game pad \"RJ\" click"},
                              {21, "Game pad \"LB\" button"},
                              {22, "Game pad \"RB\" button"}};
const Row digital_outputs[] = {{0, "Watchdog"}, {1, ""}, {3, ""}, {4, ""},
                               {5, ""},         {6, ""}, {7, ""}};

/** The entry with an id in the table: its index on the wire. */
uint32_t wire_index(uint32_t id) {
    return id <= 1 ? id : id - 1;
}

template <size_t rows> void check_names(uint32_t io_type, const Row (&table)[rows]) {
    for (const Row &row : table)
        EXPECT_STREQ(row.name, roburoc4_client_channel_name(nullptr, io_type, wire_index(row.id)))
            << "table id " << row.id;
}

TEST(Names, EveryChannelOfTheManualIsAtItsWireIndex) { // 5.5.1
    check_names(ROBUROC4_IO_ANALOG_INPUT, analog_inputs);
    check_names(ROBUROC4_IO_DIGITAL_INPUT, digital_inputs);
    check_names(ROBUROC4_IO_DIGITAL_OUTPUT, digital_outputs);
}

TEST(Names, ChannelsThatTheManualDoesNotHaveAreNull) {
    for (const uint32_t far : {64u, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
        for (uint32_t io_type = 0; io_type < 6; io_type++)
            EXPECT_EQ(nullptr, roburoc4_client_channel_name(nullptr, io_type, far)) << io_type;
    }
    EXPECT_EQ(nullptr,
              roburoc4_client_channel_name(nullptr, ROBUROC4_IO_ANALOG_INPUT, ROBUROC4_AI_COUNT));
    EXPECT_EQ(nullptr,
              roburoc4_client_channel_name(nullptr, ROBUROC4_IO_ANALOG_OUTPUT, ROBUROC4_AO_COUNT));
    EXPECT_EQ(nullptr,
              roburoc4_client_channel_name(nullptr, ROBUROC4_IO_DIGITAL_INPUT, ROBUROC4_DI_COUNT));
    EXPECT_EQ(nullptr,
              roburoc4_client_channel_name(nullptr, ROBUROC4_IO_DIGITAL_OUTPUT, ROBUROC4_DO_COUNT));
    EXPECT_EQ(nullptr, roburoc4_client_channel_name(nullptr, 4, 0));
    EXPECT_EQ(nullptr, roburoc4_client_channel_name(nullptr, 0xFFFFFFFFu, 0));
}

TEST(Names, ServicesAreTheManuals) { // 4.2.1
    EXPECT_STREQ("Directory", roburoc4_name(ROBUROC4_NAME_SERVICE, 0x0000));
    EXPECT_STREQ("Notification", roburoc4_name(ROBUROC4_NAME_SERVICE, 0x0001));
    EXPECT_STREQ("IOCard", roburoc4_name(ROBUROC4_NAME_SERVICE, 0x0002));
    EXPECT_STREQ("Telemeter", roburoc4_name(ROBUROC4_NAME_SERVICE, 0x0003));
    EXPECT_STREQ("Battery", roburoc4_name(ROBUROC4_NAME_SERVICE, 0x0004));
    EXPECT_STREQ("Localization", roburoc4_name(ROBUROC4_NAME_SERVICE, 0x0005));
    EXPECT_STREQ("Differential", roburoc4_name(ROBUROC4_NAME_SERVICE, 0x0006));
    EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_SERVICE, 7));
    EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_SERVICE, 0xFFFFFFFFu));
}

TEST(Names, BatteryStatesAreTheManuals) { // 4.2.4.6
    EXPECT_STREQ("Charging", roburoc4_name(ROBUROC4_NAME_BATTERY, 0));
    EXPECT_STREQ("Charged", roburoc4_name(ROBUROC4_NAME_BATTERY, 1));
    EXPECT_STREQ("Ok", roburoc4_name(ROBUROC4_NAME_BATTERY, 2));
    EXPECT_STREQ("Critical", roburoc4_name(ROBUROC4_NAME_BATTERY, 3));
    EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_BATTERY, 4));
    EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_BATTERY, 0xFFFFFFFFu));
}

TEST(Names, OfAnUnknownKindThereIsNone) {
    for (const uint32_t what : {6U, 0xFFFFFFFFU})
        EXPECT_EQ(nullptr, roburoc4_name(what, 0));
}

TEST(Names, StatesOfAClient) {
    const char *const names[] = {"idle",  "connecting", "discovering", "subscribing",
                                 "ready", "lost",       "closing"};
    for (uint32_t state = 0; state < std::size(names); state++)
        EXPECT_STREQ(names[state], roburoc4_name(ROBUROC4_NAME_STATE, state));
    EXPECT_STREQ("ready", roburoc4_name(ROBUROC4_NAME_STATE, ROBUROC4_STATE_READY));
    EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_STATE, 7));
    EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_STATE, 0xFFFFFFFFu));
}

TEST(Names, EveryEventHasItsOwnSentence) {
    std::set<std::string> seen;
    for (uint32_t event = ROBUROC4_EVENT_STATE; event <= ROBUROC4_EVENT_STOP_UNCONFIRMED;
         event <<= 1) {
        const char *text = roburoc4_name(ROBUROC4_NAME_EVENT, event);
        ASSERT_NE(nullptr, text) << event;
        EXPECT_TRUE(seen.insert(text).second) << text;
    }
    EXPECT_STREQ("the state of the connection changed",
                 roburoc4_name(ROBUROC4_NAME_EVENT, ROBUROC4_EVENT_STATE));
    EXPECT_STREQ("disarmed: drive commands are refused",
                 roburoc4_name(ROBUROC4_NAME_EVENT, ROBUROC4_EVENT_DISARMED));
    EXPECT_STREQ("arming is possible now",
                 roburoc4_name(ROBUROC4_NAME_EVENT, ROBUROC4_EVENT_ARMABLE));
    EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_EVENT, 0));
    EXPECT_EQ(nullptr,
              roburoc4_name(ROBUROC4_NAME_EVENT, ROBUROC4_EVENT_READY | ROBUROC4_EVENT_LOST));
    EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_EVENT, ROBUROC4_EVENT_STOP_UNCONFIRMED << 1));
}

TEST(Names, ChangesHaveASentenceForEachDirection) {
    const struct {
        uint32_t event;
        const char *began, *ended;
    } changes[] = {
        {ROBUROC4_EVENT_OVERRIDE, "[A] is held on the game pad: the pad drives the robot",
         "[A] on the game pad was released"},
        {ROBUROC4_EVENT_OTHER_COMMANDER, "another client commands the robot",
         "no other client commands the robot any more"},
        {ROBUROC4_EVENT_INHIBITED, "motion inhibited: the robot does not follow its commands",
         "the robot follows its commands again, or none is given"},
    };
    for (const auto &change : changes) {
        EXPECT_STREQ(change.began, roburoc4_name(ROBUROC4_NAME_EVENT_BEGAN, change.event));
        EXPECT_STREQ(change.ended, roburoc4_name(ROBUROC4_NAME_EVENT_ENDED, change.event));
    }
    for (const uint32_t other :
         std::initializer_list<uint32_t>{0, ROBUROC4_EVENT_STATE, ROBUROC4_EVENT_STOP_CONFIRMED,
                                         ROBUROC4_EVENT_BATTERY_LOW, ROBUROC4_EVENT_ARMABLE}) {
        EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_EVENT_BEGAN, other)) << other;
        EXPECT_EQ(nullptr, roburoc4_name(ROBUROC4_NAME_EVENT_ENDED, other)) << other;
    }
}

/** Copied here again: if a text were missing, whatever follows in memory would look like one. */
const struct {
    roburoc4_result code;
    const char *text;
} sentences[] = {
    {ROBUROC4_ERR_ARGUMENT, "argument out of range"},
    {ROBUROC4_ERR_BUFFER, "buffer too small"},
    {ROBUROC4_ERR_SHORT, "datagram shorter than its layout"},
    {ROBUROC4_ERR_KIND, "datagram of another kind"},
    {ROBUROC4_ERR_VALUE, "impossible value in datagram, or several channels with this name"},
    {ROBUROC4_ERR_ROBOT, "the robot answered with an error"},
    {ROBUROC4_ERR_SIZE, "struct size differs from the library's"},
    {ROBUROC4_ERR_CONFIG, "configuration value out of range"},
    {ROBUROC4_ERR_STATE, "client not started, or closing"},
    {ROBUROC4_ERR_NOT_KNOWN, "not reported by the robot yet: wait, then try again"},
    {ROBUROC4_ERR_INDEX, "no channel, entry or control has this number or name"},
    {ROBUROC4_ERR_RESERVED, "output 0 belongs to the robot: use output 1 or above"},
    {ROBUROC4_ERR_NOT_FINITE, "NaN or infinity: give finite numbers"},
    {ROBUROC4_ERR_UNMATCHED, "answer to no open request"},
    {ROBUROC4_ERR_UNEXPECTED_STATUS, "status not subscribed to"},
    {ROBUROC4_ERR_OLD, "status not newer than the last"},
    {ROBUROC4_ERR_TIMEOUT,
     "the robot did not answer any of the tries: check the link, then try again"},
    {ROBUROC4_ERR_DISARMED, "not armed: call arm() before drive()"},
    {ROBUROC4_ERR_NOT_READY, "not connected: check power, cable and address, or wait"},
    {ROBUROC4_ERR_NO_DIFFERENTIAL,
     "no usable differential service: set differential_id if you know it"},
    {ROBUROC4_ERR_LIMITS, "the robot's speed limits are not usable: check its properties"},
    {ROBUROC4_ERR_STALE_DIFFERENTIAL,
     "no recent differential status: check the link and the status period, then arm again"},
    {ROBUROC4_ERR_STALE_IOCARD,
     "no recent IO card status: check the link and the status period, then arm again"},
    {ROBUROC4_ERR_OVERRIDE_UNKNOWN,
     "game pad input unknown: wait a minute for its text, else set override_index or "
     "allow_unknown_override"},
    {ROBUROC4_ERR_OVERRIDE, "game pad override: release [A] on the game pad"},
    {ROBUROC4_ERR_MOVING,
     "the robot is moving, or has a target: wait until it is at rest, or stop it"},
    {ROBUROC4_ERR_OTHER_COMMANDER, "another client commands the robot: end the other program"},
    {ROBUROC4_ERR_LOST, "the robot fell silent: check cable and power, then arm again"},
    {ROBUROC4_ERR_REBOOT, "the robot restarted: check it, then arm again"},
    {ROBUROC4_ERR_CLOCK, "the clock went back: find out what sets this machine's clock"},
    {ROBUROC4_ERR_INHIBITED,
     "the robot does not follow its commands: check emergency stops, brakes selector and bumpers"},
    {ROBUROC4_ERR_STOP_CALLED, "stopped by stop(): call arm() to drive again"},
    {ROBUROC4_ERR_LAPSED,
     "the program did not renew its drive command in time: call arm() to drive again"},
    {ROBUROC4_ERR_UPLINK,
     "commands reach the robot late or not at all: check the link, then arm again"},
    {ROBUROC4_ERR_UNITS,
     "these look like mm/s or degrees: give at most 5 m/s and 10 rad/s, and angles in radians"},
    {ROBUROC4_ERR_SUBSCRIPTION_REFUSED,
     "no subscription to statuses that driving needs: the robot refused it (its list may be full: "
     "restart it) or has no such service"},
    {ROBUROC4_ERR_SYSTEM, "the operating system refused"},
    {ROBUROC4_ERR_RESOLVE,
     "host name has no address: check the spelling, or give the address in numbers"},
    {ROBUROC4_ERR_CLOSED, "already closed, or made before a fork: connect again"},
    {ROBUROC4_ERR_BUSY,
     "another thread drives a move with this pump: wait for its end, or stop it"},
    {ROBUROC4_ERR_ADDRESS, "not an address: give HOST or HOST:PORT, such as 192.168.0.2:60000"},
};

TEST(ResultText, IsAnOwnSentenceForEachCode) {
    std::set<std::string> texts = {"ok", "unknown error"};
    std::set<roburoc4_result> unused;
    for (roburoc4_result code = -1000; code < 0; code++)
        unused.insert(code);
    for (const auto &[code, text] : sentences) {
        EXPECT_STREQ(text, roburoc4_result_text(code)) << code;
        EXPECT_TRUE(texts.insert(text).second) << code << ": " << text;
        EXPECT_EQ(1U, unused.erase(code)) << code;
    }
    unused.insert(std::numeric_limits<roburoc4_result>::min());
    for (const roburoc4_result code : unused)
        EXPECT_STREQ("unknown error", roburoc4_result_text(code)) << code;
    for (const roburoc4_result fine : {0, 1, 57, std::numeric_limits<roburoc4_result>::max()})
        EXPECT_STREQ("ok", roburoc4_result_text(fine));
}

} // namespace
