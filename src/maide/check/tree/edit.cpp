#include "maide/check/tree/edit.hpp"

#include <stdexcept>
#include <string_view>
#include <utility>

namespace maide {

std::string with_value(const YamlDocument& document, const YamlNode& node,
                       const std::string& value) {
  std::string text = document.text;
  return text.replace(node.begin, node.end - node.begin, value);
}

std::string with_word(const std::string& text, TextPlace place, const std::string& word) {
  TextCursor cursor(text, "", TextCursor::Columns::bytes);
  while (!cursor.at_end() && cursor.place().line < place.line) cursor.take();
  while (!cursor.at_end() && cursor.place().column < place.column) cursor.take();
  const std::size_t begin = cursor.offset();
  const std::string_view old =
      cursor.take_while([](char c) { return is_letter(c) || is_digit(c) || c == '_'; });
  if (old.empty()) throw std::out_of_range("no word stands there");
  return std::string(text).replace(begin, old.size(), word);
}

YamlNode difference(const YamlNode& after, const YamlNode& before) {
  YamlNode changed = YamlNode::make_map(YamlNode::Style::flow);
  for (const YamlEntry& entry : after.entries) {
    const YamlNode* const old = before.find(entry.key.value);
    if (old != nullptr && is_same_value(entry.value, *old)) continue;
    const bool is_inside = old != nullptr && old->is_map() && entry.value.is_map();
    changed.set(entry.key.value, is_inside ? difference(entry.value, *old) : entry.value);
  }
  return changed;
}

}  // namespace maide
