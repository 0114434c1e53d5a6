#include "maide/check/tree/edit.hpp"

#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "maide/check/tree/print.hpp"

namespace maide {
namespace {

// The node of `copy` that stands where `wanted` stands in `node`, of which it is a copy.
YamlNode* find_in_copy(const YamlNode& node, const YamlNode& wanted, YamlNode& copy) {
  if (&node == &wanted) return &copy;
  for (std::size_t i = 0; i < node.entries.size(); ++i) {
    YamlNode* const found = find_in_copy(node.entries[i].value, wanted, copy.entries[i].value);
    if (found != nullptr) return found;
  }
  return nullptr;
}

}  // namespace

std::string with_value(const YamlDocument& document, const YamlNode& node,
                       const std::string& value) {
  if (has_reference(document.root)) {
    YamlDocument changed = document;
    if (YamlNode* const found = find_in_copy(document.root, node, changed.root)) {
      *found = YamlNode(value);
      return print_system(changed);
    }
  }
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
