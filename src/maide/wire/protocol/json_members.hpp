// Reads members of a JSON object that came from the other side. Each is checked for its type before
// it is used. Whatever is wrong is a ProtocolError that names the member. The names of enumerations
// in messages are here too.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/wire/protocol/protocol.hpp"

namespace maide::protocol {

// The start of a text that was not understood, for the error.
std::string excerpt(std::string_view text);

Json parse_object(std::string_view line);

// The member, or null if it is not there (or is null).
const Json* find_member(const Json& json, const char* key);
const Json& member(const Json& json, const char* key);
// `what` names the value in the error.
std::string to_text(const Json& json, const char* what);
std::uint64_t to_number(const Json& json, const char* what, std::uint64_t most);

std::string text_member(const Json& json, const char* key);
std::string text_member(const Json& json, const char* key, const char* otherwise);
// false if it is not there.
bool flag_member(const Json& json, const char* key);
std::int64_t signed_member(const Json& json, const char* key, std::int64_t otherwise);
// In microseconds; 0 if it is not there.
std::chrono::microseconds duration_member(const Json& json, const char* key);
std::uint64_t id_member(const Json& json);
// An absent list or map is empty.
const Json& list_member(const Json& json, const char* key);
std::vector<std::string> texts_member(const Json& json, const char* key);
std::map<std::string, std::string> map_member(const Json& json, const char* key);

// How the values of enumerations are called in messages, for both directions.
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
