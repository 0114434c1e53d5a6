#include "maide/extract/type_names.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

namespace maide::extract {
namespace {

std::string without_templates(std::string_view type) {
  std::string plain;
  int depth = 0;
  for (const char character : type) {
    if (character == '<') ++depth;
    if (depth == 0) plain += character;
    if (character == '>' && depth > 0) --depth;
  }
  return plain;
}

bool take_word(std::string_view& type, std::string_view word) {
  if (!type.starts_with(word)) return false;
  type.remove_prefix(word.size());
  return true;
}

}  // namespace

std::string template_arguments(std::string_view type) {
  const std::size_t begin = type.find('<');
  const std::size_t end = type.rfind('>');
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return {};
  return std::string(type.substr(begin + 1, end - begin - 1));
}

std::string class_of_type(std::string_view type) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::string_view word :
         {"const ", "volatile ", "static ", "mutable ", "inline ", "constexpr ", "typename ",
          "struct ", "class ", "extern ", "unsigned ", "signed ", " ", "::"}) {
      changed = take_word(type, word) || changed;
    }
  }
  while (!type.empty() && (type.back() == '&' || type.back() == '*' || type.back() == ' ')) {
    type.remove_suffix(1);
  }
  if (type.ends_with(" const")) return class_of_type(type.substr(0, type.size() - 6));
  for (const std::string_view pointer :
       {"std::shared_ptr<", "std::unique_ptr<", "std::weak_ptr<", "std::reference_wrapper<"}) {
    if (!type.starts_with(pointer)) continue;
    const std::string inner = template_arguments(type);
    return class_of_type(inner);
  }
  std::string plain = without_templates(type);
  for (const std::string_view suffix : {"::SharedPtr", "::ConstSharedPtr", "::UniquePtr",
                                        "::ConstUniquePtr", "::WeakPtr", "::Ptr", "::ConstPtr"}) {
    if (plain.ends_with(suffix)) return plain.substr(0, plain.size() - suffix.size());
  }
  return plain;
}

bool is_pointer_type(std::string_view type) {
  while (!type.empty() && (type.back() == '&' || type.back() == ' ')) type.remove_suffix(1);
  const std::string plain = without_templates(type);
  return type.ends_with("*") || plain.ends_with("_ptr") || plain.ends_with("Ptr");
}

bool is_weak_type(std::string_view type) {
  return type.find("weak_ptr") != std::string_view::npos || type.ends_with("WeakPtr") ||
         type.ends_with("*");
}

bool is_plain_type(std::string_view name) {
  static const std::set<std::string_view> names{
      "bool",         "char",           "int",           "long",          "short",
      "float",        "double",         "void",          "unsigned",      "signed",
      "long long",    "long int",       "long double",   "unsigned int",  "unsigned char",
      "size_t",       "std::size_t",    "ssize_t",       "int8_t",        "int16_t",
      "int32_t",      "int64_t",        "uint8_t",       "uint16_t",      "uint32_t",
      "uint64_t",     "std::int8_t",    "std::int16_t",  "std::int32_t",  "std::int64_t",
      "std::uint8_t", "std::uint16_t",  "std::uint32_t", "std::uint64_t", "wchar_t",
      "char16_t",     "std::nullptr_t", "uint",          "std::ptrdiff_t"};
  return names.contains(name);
}

bool is_decimal(const std::string& text) {
  const bool is_octal = text.size() > 1 && text[0] == '0';
  return !text.empty() && !is_octal && text.find_first_not_of("0123456789") == std::string::npos;
}

std::string unit_of_time(std::string_view word) {
  static const std::map<std::string_view, std::string> units{
      {"nanoseconds", "ns"}, {"microseconds", "us"}, {"milliseconds", "ms"},
      {"seconds", "s"},      {"minutes", "min"},     {"hours", "h"}};
  const auto unit = units.find(word);
  return unit == units.end() ? "" : unit->second;
}

std::string milliseconds_of(const std::string& time) {
  static const std::map<std::string_view, double> factors{{"ns", 1e-6}, {"us", 1e-3}, {"ms", 1},
                                                          {"s", 1e3},   {"min", 6e4}, {"h", 36e5}};
  double number = 0;
  const auto [end, error] = std::from_chars(time.data(), time.data() + time.size(), number);
  const auto factor = factors.find({end, time.data() + time.size()});
  const bool is_time = error == std::errc{} && factor != factors.end() && number >= 0;
  const double all = is_time ? number * factor->second : 0;
  if (!is_time || all > 1e9) return {};
  return std::to_string(static_cast<std::int64_t>(std::max(1.0, all + 0.5)));
}

std::string last_part(std::string_view name) {
  const std::size_t at = name.rfind("::");
  return std::string(at == std::string_view::npos ? name : name.substr(at + 2));
}

std::string outer_part(std::string_view name) {
  const std::size_t at = name.rfind("::");
  return std::string(at == std::string_view::npos ? std::string_view{} : name.substr(0, at));
}

}  // namespace maide::extract
