#include "maide/check/text/yaml_reader.hpp"

#include <algorithm>
#include <set>

#include "maide/check/text/tokens.hpp"

namespace maide {
namespace {

constexpr std::size_t max_file_bytes = std::size_t{4} << 20;
constexpr int max_depth = 100;  // of nesting: yaml-cpp recurses

}  // namespace

SourcePosition YamlReader::at(const YAML::Node& node) const {
  const YAML::Mark mark = node.Mark();
  if (mark.is_null()) return {file_, 0, 0};
  return {file_, mark.line + 1, mark.column + 1};
}

void YamlReader::fail(const std::string& message, const YAML::Node& node) const {
  throw ParseError(message, at(node));
}

void YamlReader::check_nesting() const {
  int depth = 0, line = 1, column = 0;
  for (const char c : text_) {
    ++column;
    if (c == '\n') {
      ++line;
      column = 0;
    }
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') depth = std::max(0, depth - 1);
    if (depth > max_depth) throw ParseError("brackets nested too deeply", {file_, line, column});
  }
}

std::string YamlReader::in_plain_words(const std::string& message, int line) const {
  const std::vector<std::string_view> lines = split_lines(text_);
  if (line >= 0 && static_cast<std::size_t>(line) < lines.size()) {
    const std::string_view text = lines[static_cast<std::size_t>(line)];
    if (text.substr(0, text.find_first_not_of(" \t")).find('\t') != std::string_view::npos) {
      return "lines are indented with blanks, and here is a tab";
    }
  }
  constexpr std::pair<std::string_view, std::string_view> known[] = {
      {"end of map flow not found", "a '{' is not closed, or a ',' is missing between its entries"},
      {"end of sequence flow not found", "a '[' is not closed, or a ',' is missing in it"},
      {"end of map not found", "this line is indented like none above it"},
      {"illegal map value",
       "a text with ': ' in it is in quotes, and a key begins a line or stands in braces"},
      {"the referenced anchor is not defined", "a text that begins with '*' is in quotes"},
  };
  for (const auto& [theirs, ours] : known) {
    if (message == theirs) return std::string(ours);
  }
  return message;
}

YAML::Node YamlReader::load() const {
  if (text_.size() > max_file_bytes) {
    throw ParseError("a system file has at most 4 MiB", {file_, 0, 0});
  }
  check_nesting();
  try {
    std::vector<YAML::Node> documents = YAML::LoadAll(std::string(text_));
    if (documents.empty() || documents[0].IsNull()) {
      throw ParseError("the system file is empty", {file_, 1, 1});
    }
    if (documents.size() > 1) fail("a system file is one YAML document", documents[1]);
    return documents[0];
  } catch (const YAML::Exception& error) {
    throw ParseError("not YAML: " + in_plain_words(error.msg, error.mark.line),
                     {file_, error.mark.line + 1, error.mark.column + 1});
  }
}

YamlReader::Entries YamlReader::entries(const YAML::Node& node, const std::string& what,
                                        const std::vector<std::string>& known) const {
  if (!node.IsMap()) fail(what + " must be a map (key: value)", node);
  Entries result;
  std::set<std::string> seen;
  for (const auto& entry : node) {
    if (entry.first.IsNull()) {
      fail("a key of " + what + " must be a word, and to YAML `null` is none: put it in quotes",
           entry.first);
    }
    if (!entry.first.IsScalar() || entry.first.Scalar().empty()) {
      fail("a key of " + what + " must be a word", entry.first);
    }
    const std::string& key = entry.first.Scalar();
    if (!known.empty() && std::find(known.begin(), known.end(), key) == known.end()) {
      fail(what + " has no key '" + key + "'; it may have: " + known_instead(key, known),
           entry.first);
    }
    if (!seen.insert(key).second) fail("'" + key + "' is there twice", entry.first);
    result.emplace_back(entry.first, entry.second);
  }
  return result;
}

std::string YamlReader::scalar(const YAML::Node& node, const std::string& what) const {
  if (!node.IsScalar()) fail(what + " must be a text", node);
  return node.Scalar();
}

ScalarText YamlReader::text_of(const YAML::Node& node) const {
  return ScalarText(node.Scalar(), text_, at(node));
}

}  // namespace maide
