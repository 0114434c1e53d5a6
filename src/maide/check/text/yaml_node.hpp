// A YAML document as a tree that loses nothing: each value and key with its place, its style and
// the comments around it. The events of libyaml (K. Simonov; YAML 1.1) say where scalars, keys and
// brackets begin and end. Comments are no events: they are what stands between the tokens, for no
// other `#` does.
//
//   # a queue              entry `q`: before = {"# a queue"}, comment = "# small"
//   q: {size: 2}  # small  its value: a map in braces, with one entry
//
// An alias is a copy of what its anchor names, so that readers meet values alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text_cursor.hpp"

namespace maide {

struct YamlEntry;

struct YamlNode {
  enum class Kind : std::uint8_t { scalar, map, list };
  enum class Style : std::uint8_t {
    plain,
    single_quoted,
    double_quoted,
    literal,
    folded,
    block,
    flow
  };
  static constexpr std::size_t nowhere = ~std::size_t{0};

  Kind kind = Kind::scalar;
  Style style = Style::plain;
  std::string value;               // of a scalar
  std::string tag;                 // empty: none; "!" is a tag, too
  std::string anchor;              // the name behind `&`
  std::string alias;               // the name behind `*`, if it is a copy
  std::vector<YamlEntry> entries;  // of a map; of a list its values, with empty keys
  // Where it stands in the text: bytes, tag and anchor included. Nowhere: it was made.
  std::size_t begin = nowhere, end = nowhere;
  TextPlace place{0, 0};          // of `begin`; columns are bytes
  std::vector<std::string> tail;  // of a block: comments behind its last entry; "" is a blank line

  YamlNode();
  explicit YamlNode(std::string text, Style how = Style::plain);
  static YamlNode make_map(Style how = Style::block);
  // "a" of one name, else "[a, b]".
  static YamlNode make_names(const std::vector<std::string>& names);

  bool is_scalar() const { return kind == Kind::scalar; }
  bool is_map() const { return kind == Kind::map; }
  bool is_list() const { return kind == Kind::list; }
  bool is_quoted() const { return style == Style::single_quoted || style == Style::double_quoted; }
  bool is_lines() const { return style == Style::literal || style == Style::folded; }
  // What YAML takes for nothing: no text, `~`, `null`, without quotes.
  bool is_null() const;

  // The value behind a key of a map; null if there is none, or this is no map. O(entries).
  const YamlNode* find(std::string_view key) const;
  YamlNode* find(std::string_view key);
  // The value behind that key, which is added at the end unless it is there. Of no map makes one.
  YamlNode& at(std::string_view key, Style how = Style::flow);
  YamlNode& set(std::string_view key, YamlNode value);
  void remove(std::string_view key);
};

struct YamlEntry {
  YamlNode key, value;
  std::vector<std::string> before{};  // comments on lines of their own; "" is a blank line
  std::string comment{};  // at the end of the line where the key stands or the value ends
  // Comments stand where none has a place in this tree: between a key and its text, in braces. The
  // entry is written as it stands.
  bool is_kept = false;
};

// An anchor or an alias stands in it.
bool has_reference(const YamlNode& node);

// Whether both have the same keys and values in the same order, however they are written.
bool is_same_value(const YamlNode& one, const YamlNode& other);

struct YamlDocument {
  std::string file;  // for messages
  std::string text;
  YamlNode root;
  bool is_kept = false;  // directives or comments stand outside of the root: as with an entry

  SourcePosition position(const YamlNode& node) const {
    return {file, node.place.line, node.place.column};
  }
  // The node as it is written.
  std::string_view source(const YamlNode& node) const {
    return std::string_view(text).substr(node.begin, node.end - node.begin);
  }
};

inline constexpr std::size_t max_yaml_bytes = std::size_t{4} << 20;

// Throws ParseError, with the place and in plain words: the text is not YAML, empty, several
// documents or larger than max_yaml_bytes; brackets or blocks are nested 100 deep; aliases make
// more than a million values. `what`: "a system file". O(text).
YamlDocument read_yaml(std::string_view text, std::string file, std::string_view what);

}  // namespace maide
