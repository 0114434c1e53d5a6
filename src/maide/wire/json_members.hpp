// Members of a JSON object that came from the other side, each checked for its type before it is
// used; what is wrong is a ProtocolError that names the member.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/json.hpp"

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

}  // namespace maide::protocol
