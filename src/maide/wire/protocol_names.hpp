// How the values of enumerations are called in messages, for both directions.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include "maide/wire/json_members.hpp"
#include "maide/wire/protocol.hpp"

namespace maide::protocol {

template <typename Value, std::size_t size>
using Names = std::array<std::pair<const char*, Value>, size>;

// The value of that name; a ProtocolError, which says what it should have been, if there is none.
template <typename Value, std::size_t size>
Value find_name(const std::string& name, const char* what, const Names<Value, size>& names) {
  for (const auto& [known, value] : names) {
    if (name == known) return value;
  }
  throw ProtocolError(std::string("unknown ") + what + " '" + excerpt(name) + "'");
}

template <typename Value, std::size_t size>
const char* name_of(Value value, const Names<Value, size>& names) {
  for (const auto& [name, known] : names) {
    if (value == known) return name;
  }
  return names.front().first;  // not reached: the tables are complete
}

inline constexpr Names<OptionSpec::Kind, 4> kind_names = {{{"choice", OptionSpec::Kind::choice},
                                                           {"list", OptionSpec::Kind::list},
                                                           {"integer", OptionSpec::Kind::integer},
                                                           {"text", OptionSpec::Kind::text}}};
inline constexpr Names<ErrorCode, 4> code_names = {{{"option", ErrorCode::option},
                                                    {"token", ErrorCode::token},
                                                    {"protocol", ErrorCode::protocol},
                                                    {"system", ErrorCode::system}}};
inline constexpr Names<StepStatus, 5> status_names = {{{"taken", StepStatus::taken},
                                                       {"refused", StepStatus::refused},
                                                       {"unexplored", StepStatus::unexplored},
                                                       {"absorbed", StepStatus::absorbed},
                                                       {"delta", StepStatus::delta}}};
inline constexpr Names<WordEnd, 4> end_names = {{{"complete", WordEnd::complete},
                                                 {"crash", WordEnd::crash},
                                                 {"hang", WordEnd::hang},
                                                 {"aborted", WordEnd::aborted}}};
inline constexpr Names<Translation, 2> translation_names = {
    {{"eager", Translation::eager}, {"av", Translation::av}}};
inline constexpr Names<AtBound, 2> at_bound_names = {
    {{"refuse", AtBound::refuse}, {"absorb", AtBound::absorb}}};

// An option as it stands in a hello.
Json option_json(const OptionSpec& spec);

}  // namespace maide::protocol
