// Programs of a system file while they are made: statements as trees, what is left of them when
// what does nothing is taken out, and their text.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/sources.hpp"

namespace maide::extract {

struct Code {
  enum class Kind : std::uint8_t {
    step,    // text, a statement
    set,     // text = value: a variable of the program, which costs no step
    branch,  // if (text); arms: then, else. `*`: any
    loop,    // arms: the body
    select,  // arms with heads
    timed,   // text, which ends with a time limit; arms: what is done when it is over
    leave,   // the loop
  };
  Kind kind = Kind::step;
  std::string text, value;
  Place place;
  struct Arm {
    std::string head;
    std::vector<Code> code;
  };
  std::vector<Arm> arms;
};

// A variable of a program, of the values given; the first is its first.
struct CodeVariable {
  std::string name;
  std::vector<std::string> values;  // empty: a bool, at first false
};

// Takes out branches that do nothing, and assignments to variables of the program that no condition
// reads. Loops stay, unless nothing is in them that could go round for ever.
void simplify(std::vector<Code>& code);

// Whether anything is left that costs a step.
bool has_steps(const std::vector<Code>& code);

// Takes out steps of this text, wherever they stand.
void drop_step(std::vector<Code>& code, const std::string& text);

// Names that stand in conditions.
void collect_words(const std::vector<Code>& code, std::set<std::string>& words);

// The text of the program; each statement on a line, with its place in the sources.
std::string print_code(const std::vector<Code>& code, const std::vector<CodeVariable>& variables);

}  // namespace maide::extract
