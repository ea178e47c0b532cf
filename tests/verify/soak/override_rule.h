/* SPDX-License-Identifier: MIT
 *
 * override_rule.h - which digital input may be taken for game pad [A], by what the robot said:
 *
 *   - the index that the user set; else
 *   - the one input whose text names it, once the robot sent or refused the text of every input
 *     (another text may fit as well: then it is unknown which); else
 *   - the manual's index, if the robot refused to give that input's text, no other text fits, and
 *     the counts are the manual's.
 *
 * In every other case the override is unknown. Texts are compared by words.
 */
#ifndef ROBUROC4_SOAK_OVERRIDE_RULE_H
#define ROBUROC4_SOAK_OVERRIDE_RULE_H

#include <cstdint>
#include <string>
#include <vector>

namespace soak {

/** Whether a text names button [A] of a game pad, whatever its case, punctuation and order. */
bool names_pad_a(const std::string &text);

class OverrideRule {
  public:
    static constexpr int unknown = -1;

    void set_counts(std::int32_t analog_inputs, std::int32_t analog_outputs,
                    std::int32_t digital_inputs, std::int32_t digital_outputs);
    void text_read(std::int32_t index, const std::string &text);
    void text_refused(std::int32_t index);
    void user_set(std::int32_t index) { /* below 0: to be found */
        user_index_ = index;
    }
    /** The input that may be taken for [A], or unknown. */
    int index() const;

  private:
    enum class Text : std::uint8_t { missing, names_a, other, refused };
    bool manual_counts_ = false;
    std::int32_t user_index_ = unknown;
    std::vector<Text> texts_;
};

} // namespace soak

#endif
