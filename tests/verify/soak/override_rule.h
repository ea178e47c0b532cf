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

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace soak {

/** Whether a text names button [A] of a game pad, whatever its case, punctuation and order; one
 *  that has other words, too ("Game pad A LED"), only resembles it. */
enum class Fit : std::uint8_t { no, resembles, exact };
Fit fit_of(const std::string &text);

class OverrideRule {
  public:
    static constexpr int unknown = -1;

    void set_counts(std::int32_t analog_inputs, std::int32_t analog_outputs,
                    std::int32_t digital_inputs, std::int32_t digital_outputs,
                    std::uint32_t boot = 0);
    void text_read(std::int32_t index, const std::string &text, std::uint32_t boot = 0);
    void text_refused(std::int32_t index, std::uint32_t boot = 0);
    void user_set(std::int32_t index) { /* below 0: to be found */
        user_index_ = index;
    }
    /** The input that may be taken for [A], or unknown. */
    int index() const;
    /** Whether a text resembles [A]'s: then a client may rather not know. */
    bool doubtful() const;
    /** What is known, for messages. */
    std::string text() const;
    /** What was read before this start of the robot does not count any more. */
    void forget_before(std::uint32_t boot);

  private:
    enum class Text : std::uint8_t { missing, names_a, resembles, other, refused };
    struct Answer {
        Text text = Text::missing;
        std::uint32_t boot = 0;
    };
    void set(std::int32_t index, Text text, std::uint32_t boot);
    std::ptrdiff_t count(Text text) const;

    bool counts_known_ = false, manual_counts_ = false;
    std::uint32_t counts_boot_ = 0;
    std::int32_t user_index_ = unknown;
    std::vector<Answer> texts_;
};

} // namespace soak

#endif
