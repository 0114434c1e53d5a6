// What is asked of a system: a word, or a decision tree (an input, then a subtree for each output),
// so that adaptive learners and tests do not pay a reset a branch. Two levels share the shape:
// `Query` speaks the learner's symbols (inputs and outputs of a Mealy machine); `SulQuery` names
// the expected outputs by text, as they cross the wire.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/alphabet.hpp"

namespace maide {

// Which Mealy machine stands for an interface automaton (design: "Translations").
enum class Translation : std::uint8_t {
  eager,  // one step is an input and all outputs until quiescence
  av,     // Aarts & Vaandrager (CONCUR 2010): inputs answer "+", the extra input Delta takes one
          // output, or says "delta"; while outputs are due inputs are refused
};
std::string_view to_string(Translation translation);  // "eager", "av"

// A tree of inputs: node 0 is asked first; after an output without a branch of its own the query
// ends. `Output` is Symbol (learner's side) or std::string (on the wire).
template <typename Output>
struct BasicDecisionTree {
  struct Node {
    Symbol input = 0;
    std::vector<std::pair<Output, std::uint32_t>> branches;  // output -> index of the next node
  };
  std::vector<Node> nodes;
};

using DecisionTree = BasicDecisionTree<Symbol>;

// A question in the symbols of a Mealy machine.
using Query = std::variant<Word, DecisionTree>;

// A question to a system. Inputs are indices into SulInfo::inputs; under Translation::av the index
// one past the last stands for Delta. Branches are keyed by mealy_output() of the step.
struct SulQuery {
  std::variant<Word, BasicDecisionTree<std::string>> inputs;
  Translation translation = Translation::eager;
};

}  // namespace maide
