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

Fit fit_of(const std::string &text) {
    static const std::vector<std::string> known = {"",        "a",        "game",  "pad",
                                                   "gamepad", "joystick", "button"};
    const std::vector<std::string> words = words_of(text);
    const auto has = [&words](const char *word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    if (!has("a") || !(has("gamepad") || (has("game") && has("pad")) || has("joystick")))
        return Fit::no;
    for (const std::string &word : words)
        if (std::find(known.begin(), known.end(), word) == known.end())
            return Fit::resembles;
    return Fit::exact;
}

void OverrideRule::set_counts(std::int32_t analog_inputs, std::int32_t analog_outputs,
                              std::int32_t digital_inputs, std::int32_t digital_outputs,
                              std::uint32_t boot) {
    manual_counts_ = (analog_inputs == 9 || analog_inputs == 10) && analog_outputs == 0 &&
                     digital_outputs == 8 && (digital_inputs == 22 || digital_inputs == 23);
    counts_known_ = true;
    counts_boot_ = boot;
    texts_.resize(static_cast<std::size_t>(digital_inputs));
}

void OverrideRule::set(std::int32_t index, Text text, std::uint32_t boot) {
    if (index >= 0 && static_cast<std::size_t>(index) < texts_.size())
        texts_[static_cast<std::size_t>(index)] = {text, boot};
}

void OverrideRule::text_read(std::int32_t index, const std::string &text, std::uint32_t boot) {
    const Text kinds[] = {Text::other, Text::resembles, Text::names_a};
    set(index, kinds[static_cast<int>(fit_of(text))], boot);
}

void OverrideRule::text_refused(std::int32_t index, std::uint32_t boot) {
    set(index, Text::refused, boot);
}

void OverrideRule::forget_before(std::uint32_t boot) {
    counts_known_ = counts_boot_ >= boot;
    for (Answer &answer : texts_)
        if (answer.boot < boot)
            answer = Answer();
}

std::ptrdiff_t OverrideRule::count(Text text) const {
    return std::count_if(texts_.begin(), texts_.end(),
                         [text](const Answer &answer) { return answer.text == text; });
}

std::string OverrideRule::text() const {
    return std::to_string(texts_.size()) + " texts, of which " +
           std::to_string(count(Text::missing)) + " are missing, " +
           std::to_string(count(Text::refused)) + " refused, " +
           std::to_string(count(Text::names_a)) + " name [A]";
}

bool OverrideRule::doubtful() const {
    return count(Text::resembles) != 0;
}

int OverrideRule::index() const {
    if (user_index_ >= 0)
        return user_index_;
    if (!counts_known_ || count(Text::missing) != 0 || count(Text::names_a) > 1)
        return unknown;
    for (std::size_t i = 0; i < texts_.size(); i++)
        if (texts_[i].text == Text::names_a)
            return static_cast<int>(i);
    const std::size_t table = texts_.size() == 23 ? 9 : 8;
    return manual_counts_ && texts_[table].text == Text::refused ? static_cast<int>(table)
                                                                 : unknown;
}

} // namespace soak
