// What reading a file of YAML comes down to: maps with known keys, texts, and errors that name the
// place in the file.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/text/scalar_text.hpp"

namespace maide {

class YamlReader {
 public:
  using Entries = std::vector<std::pair<YAML::Node, YAML::Node>>;

  // Keeps a reference to the text. `file` is for messages.
  YamlReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  SourcePosition at(const YAML::Node& node) const;
  [[noreturn]] void fail(const std::string& message, const YAML::Node& node) const;
  // The document, which is not empty. Throws ParseError.
  YAML::Node load() const;
  // The entries of a map, its keys being distinct scalars, and among `known` unless that is empty.
  Entries entries(const YAML::Node& node, const std::string& what,
                  const std::vector<std::string>& known) const;
  std::string scalar(const YAML::Node& node, const std::string& what) const;
  ScalarText text_of(const YAML::Node& node) const;
  template <typename Value>
  Value one_of(const YAML::Node& node, const std::string& what,
               const std::vector<std::pair<std::string, Value>>& values) const {
    const std::string word = scalar(node, what);
    std::vector<std::string> known;
    for (const auto& [name, value] : values) {
      if (name == word) return value;
      known.push_back(name);
    }
    fail(what + " is one of " + join(known) + ", not '" + word + "'" + did_you_mean(word, known),
         node);
  }

 private:
  // What yaml-cpp says of the line, from 0, as somebody says it who knows what files look like.
  std::string in_plain_words(const std::string& message, int line) const;
  // yaml-cpp recurses for each level; no system file has more than a handful.
  void check_nesting() const;

  std::string_view text_;
  std::string file_;
};

}  // namespace maide
