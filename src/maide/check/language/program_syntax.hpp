// The syntax tree of a control program, between its parser and its unrolling into an automaton.
// Names are resolved to symbols while parsing, where their place is known.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "maide/check/language/program.hpp"

namespace maide::program_syntax {

struct Statement;
using Block = std::vector<Statement>;

// What comes back from a model, and what is done then.
struct Arm {
  bool is_quiet = false;
  Symbol output = 0;  // unless quiet
  int line = 0, column = 0;
  std::unique_ptr<Block> body;
};

struct Statement {
  enum class Kind : std::uint8_t {
    give,    // `input` to `model`, then one of `arms` (none: nothing is awaited)
    wait,    // one of `arms` of `model`
    loop,    // `body`
    repeat,  // `body`, `count` times
    choice,  // `body` or `otherwise`
    skip,
    stop,
  };
  Kind kind = Kind::skip;
  int line = 0, column = 0;
  std::vector<std::uint32_t> labels;  // indices into Tree::labels
  std::uint32_t model = 0;
  Symbol input = 0;
  std::uint32_t count = 0;
  std::vector<Arm> arms;
  std::unique_ptr<Block> body, otherwise;
};

struct Tree {
  Block statements;
  std::vector<std::string> labels;
};

Tree parse(const ScalarText& text, std::span<const ProgramInterface> models);

// The first statement of each block that control never reaches, as far as the text alone tells.
std::vector<SourcePosition> find_unreachable(const Tree& tree, const std::string& file);

// Throws ParseError with `position` as the file for places in the tree.
Program unroll(const Tree& tree, const std::string& name, const SourcePosition& position);

}  // namespace maide::program_syntax
