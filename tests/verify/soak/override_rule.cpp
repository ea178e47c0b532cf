/* SPDX-License-Identifier: MIT */
#include "override_rule.h"

#include <algorithm>
#include <cctype>

namespace soak {

namespace {

std::vector<std::string> words_of(const std::string &text) {
    std::vector<std::string> words(1);
    for (const char letter : text) {
        const auto character = static_cast<unsigned char>(letter);
        if (std::isalnum(character) != 0)
            words.back() += static_cast<char>(std::tolower(character));
        else if (!words.back().empty())
            words.emplace_back();
    }
    return words;
}

} // namespace

bool names_pad_a(const std::string &text) {
    const std::vector<std::string> words = words_of(text);
    const auto has = [&words](const char *word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    return has("a") && (has("gamepad") || (has("game") && has("pad")) || has("joystick"));
}

void OverrideRule::set_counts(std::int32_t analog_inputs, std::int32_t analog_outputs,
                              std::int32_t digital_inputs, std::int32_t digital_outputs) {
    manual_counts_ = analog_inputs == 9 && analog_outputs == 0 && digital_outputs == 8 &&
                     (digital_inputs == 22 || digital_inputs == 23);
    texts_.resize(static_cast<std::size_t>(digital_inputs), Text::missing);
}

void OverrideRule::text_read(std::int32_t index, const std::string &text) {
    if (index >= 0 && static_cast<std::size_t>(index) < texts_.size())
        texts_[static_cast<std::size_t>(index)] = names_pad_a(text) ? Text::names_a : Text::other;
}

void OverrideRule::text_refused(std::int32_t index) {
    if (index >= 0 && static_cast<std::size_t>(index) < texts_.size())
        texts_[static_cast<std::size_t>(index)] = Text::refused;
}

int OverrideRule::index() const {
    if (user_index_ >= 0)
        return user_index_;
    if (texts_.empty() || std::count(texts_.begin(), texts_.end(), Text::missing) != 0)
        return unknown;
    const auto fitting = std::count(texts_.begin(), texts_.end(), Text::names_a);
    if (fitting > 1)
        return unknown;
    if (fitting == 1)
        return static_cast<int>(std::find(texts_.begin(), texts_.end(), Text::names_a) -
                                texts_.begin());
    const std::size_t table = texts_.size() == 23 ? 9 : 8;
    return manual_counts_ && texts_[table] == Text::refused ? static_cast<int>(table) : unknown;
}

} // namespace soak
