// The DOT language (Graphviz), as far as models need it: one directed graph with its attributes.
// Understood: comments, quoted names with escapes and +, defaults of nodes and edges, chains, and
// subgraphs (flattened), HTML labels (their words alone). Ignored: ports and `strict`. The texts
// inside labels and attributes, escapes and lists of actors, are here too.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/error.hpp"

namespace maide {

// A list of attributes, by the place of its newest entry. All lists lie in one arena, as linked
// lists that share their tails. So a default costs nothing for each node and edge that it applies
// to.
using DotAttributes = std::uint32_t;
inline constexpr DotAttributes no_dot_attributes = ~DotAttributes{0};

struct DotGraph {
  struct Attribute {
    std::string key, value;
    DotAttributes older = no_dot_attributes;
    TextPlace place;  // of the value
  };
  struct Node {
    std::string name;
    TextPlace place;  // first mention
    DotAttributes attributes = no_dot_attributes;
  };
  struct Edge {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    DotAttributes attributes = no_dot_attributes;
    TextPlace place;  // of the arrow
  };

  std::string name;
  DotAttributes attributes = no_dot_attributes;  // of the graph itself, not of its subgraphs
  std::vector<Node> nodes;                       // in order of first mention
  std::vector<Edge> edges;                       // in order
  std::vector<Attribute> arena;

  // The value in force, or null. O(length of the list).
  const Attribute* find(DotAttributes list, std::string_view key) const;
};

// Throws ParseError (file:line:column). O(text), and edges between subgraphs cost what they
// stand for (at most some millions).
DotGraph parse_dot(std::string_view text, const std::string& file);

// What a label stands for: Graphviz leaves all backslash sequences but \" to those who read labels.
std::string unescape_dot_label(std::string_view value);
// A quoted DOT identifier that unescapes to `text`.
std::string quote_dot_label(std::string_view text);

// Actors in one attribute: "writer: ?write !written; reader: ?read !message". Names that hold white
// space, ':', ';' or '"' are quoted.
std::string actors_to_text(std::span<const Actor> actors);
// Throws UsageError (without a place).
std::vector<Actor> actors_from_text(std::string_view text);

}  // namespace maide
