// Makes the model of a queue with the values of a system file. A queue does not look at values, so
// nobody has to ask the system for all of them. With v values and depth d the model has as many
// states as there are words of v letters up to length d. It is made of three things: the model
// without values, which says how many messages there are; the rule which message is lost when one
// is; and models with two values at small depths, which show that the rule is right. The result is
// then tried on the system with the values of the file.
//
// A connection is refused if it is no queue in this sense: it gives messages again, has several
// ends, or gives messages in another order than they were written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "maide/automata/interface_automaton.hpp"

namespace maide {

// Which message is lost when a write leaves fewer messages than were there before and the new one.
enum class LossRule : std::uint8_t {
  oldest,
  newest,  // the one that is written
};
std::string_view to_string(LossRule rule);  // "the oldest is lost", "the newest is lost"

// What the origin of such a model says of its values, under this key.
inline constexpr std::string_view values_key = "values";

// The option `payload` of a system whose messages carry these values: "values:go,stop".
std::string payload_of(std::span<const std::string> values);

// The model with `write(v)` and `message(v)` for each of `values` in place of `write` and
// `message`. Its states are those of `model`, each with the messages that are there, oldest first.
// Nothing if the rule does not explain the model: the model has no such symbols, or has more or
// fewer messages than the rule says. Throws UsageError beyond `most_states`. O(states).
std::optional<InterfaceAutomaton> make_valued_queue(const InterfaceAutomaton& model,
                                                    std::span<const std::string> values,
                                                    LossRule rule, std::size_t most_states);

}  // namespace maide
