#include "maide/wire/protocol/json_members.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "maide/wire/protocol/protocol.hpp"

namespace maide::protocol {

std::string excerpt(std::string_view line) {
  constexpr std::size_t longest = 60;
  std::string text(line.substr(0, longest));
  for (char& letter : text) {
    if (static_cast<unsigned char>(letter) < 0x20 || static_cast<unsigned char>(letter) >= 0x7f) {
      letter = '?';
    }
  }
  return text + (line.size() > longest ? "..." : "");
}

Json parse_object(std::string_view line) {
  Json json = Json::parse(line, nullptr, false);
  if (json.is_discarded()) throw ProtocolError("a line is not JSON: " + excerpt(line));
  if (!json.is_object()) throw ProtocolError("a line is not a JSON object: " + excerpt(line));
  return json;
}

const Json* find_member(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? nullptr : &*found;
}

const Json& member(const Json& json, const char* key) {
  const Json* found = find_member(json, key);
  if (found == nullptr) throw ProtocolError(fmt::format("'{}' is missing", key));
  return *found;
}

std::string to_text(const Json& json, const char* what) {
  if (!json.is_string()) throw ProtocolError(fmt::format("'{}' is not a string", what));
  return json.get<std::string>();
}

std::string text_member(const Json& json, const char* key) {
  return to_text(member(json, key), key);
}

std::string text_member(const Json& json, const char* key, const char* otherwise) {
  const Json* found = find_member(json, key);
  return found == nullptr ? otherwise : to_text(*found, key);
}

bool flag_member(const Json& json, const char* key) {
  const Json* found = find_member(json, key);
  if (found == nullptr) return false;
  if (!found->is_boolean()) throw ProtocolError(fmt::format("'{}' is not true or false", key));
  return found->get<bool>();
}

std::uint64_t to_number(const Json& json, const char* what, std::uint64_t most) {
  // A number that was written -1 is no unsigned one.
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > most) {
    throw ProtocolError(fmt::format("'{}' is not a whole number from 0 to {}", what, most));
  }
  return json.get<std::uint64_t>();
}

std::int64_t signed_member(const Json& json, const char* key, std::int64_t otherwise) {
  const Json* found = find_member(json, key);
  if (found == nullptr) return otherwise;
  if (!found->is_number_integer()) throw ProtocolError(fmt::format("'{}' is not a number", key));
  return found->get<std::int64_t>();
}

std::chrono::microseconds duration_member(const Json& json, const char* key) {
  constexpr std::uint64_t most = std::uint64_t{1} << 50;
  const Json* found = find_member(json, key);
  if (found == nullptr) return {};
  return std::chrono::microseconds(to_number(*found, key, most));
}

std::uint64_t id_member(const Json& json) {
  return to_number(member(json, "id"), "id", ~std::uint64_t{0});
}

const Json& list_member(const Json& json, const char* key) {
  static const Json empty = Json::array();
  const Json* found = find_member(json, key);
  if (found == nullptr) return empty;
  if (!found->is_array()) throw ProtocolError(fmt::format("'{}' is not a list", key));
  return *found;
}

std::vector<std::string> texts_member(const Json& json, const char* key) {
  std::vector<std::string> texts;
  for (const Json& item : list_member(json, key)) texts.push_back(to_text(item, key));
  return texts;
}

std::map<std::string, std::string> map_member(const Json& json, const char* key) {
  std::map<std::string, std::string> map;
  const Json* found = find_member(json, key);
  if (found == nullptr) return map;
  if (!found->is_object()) throw ProtocolError(fmt::format("'{}' is not an object", key));
  for (const auto& [name, value] : found->items()) map[name] = to_text(value, key);
  return map;
}

}  // namespace maide::protocol
