// Error outputs end a session, such as "connection closed". The user names them. Behind one, every
// input is answered by one and the same output, whatever that is, so nothing is left to learn and
// nothing need be asked (error-aware L#: Kruger, Junges & Rot, arXiv 2602.21674, 2026). In a
// protocol most transitions end the session, so most words of a learner and its tests go on behind
// an end.
//
// This is an assumption. No answer to a shorter word can show that it is wrong. So there are two
// oracles:
//
//   ErrorOutputCheck  passes everything on, and throws where an answer refutes the assumption
//   ErrorAwareOracle  stands on top of it, and answers what the assumption answers
//
// To find out whether the assumption is right, a word is asked of the check alone
// (conformance/method/known_words.hpp).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/lsharp/observation_tree.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

// Names of outputs; '*' stands for any characters.
class ErrorOutputs {
 public:
  ErrorOutputs() = default;
  explicit ErrorOutputs(std::vector<std::string> patterns) : patterns_(std::move(patterns)) {}

  bool empty() const { return patterns_.empty(); }
  bool contains(std::string_view output) const;

 private:
  std::vector<std::string> patterns_;
};

class ErrorOutputCheck : public OracleDecorator {
 public:
  // Keeps a reference to `system`.
  ErrorOutputCheck(OutputOracle& system, ErrorOutputs errors)
      : OracleDecorator(system), errors_(std::move(errors)) {}

  using OutputOracle::ask;
  // Throws UsageError for an answer in which an error output is followed by two outputs, or by
  // another one than in an answer before.
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

  bool is_error(Symbol output);
  // What came behind this error output; nothing if it was not seen yet.
  std::optional<Symbol> rest(Symbol error) const;
  // Answers in which something came behind an error output.
  std::uint64_t confirmations() const { return confirmations_; }

 private:
  void check(const MealyAnswer& answer);

  ErrorOutputs errors_;
  std::vector<bool> is_error_;      // by output
  std::map<Symbol, Symbol> rests_;  // by error output
  std::uint64_t confirmations_ = 0;
};

class ErrorAwareOracle : public OracleDecorator {
 public:
  // Keeps a reference to `check`.
  explicit ErrorAwareOracle(ErrorOutputCheck& check)
      : OracleDecorator(check), check_(check), tree_(check.inputs().size()) {}

  using OutputOracle::ask;
  // Words whose beginning is known to end the session are not asked. Trees are asked without what
  // follows error outputs. One query more for each error output that is new.
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;
  bool is_error(Symbol output) const { return check_.is_error(output); }

 private:
  bool play(const Query& query, const MealyAnswer& known, MealyAnswer& answer);
  bool look_up(const Query& query, MealyAnswer& answer);
  void keep(const MealyAnswer& answer);
  void find_rests(std::span<const MealyAnswer> answers, const RunControl& control);
  Query without_ends(const Query& query);

  ErrorOutputCheck& check_;
  ObservationTree tree_;  // of the words that end the session, up to its end
};

// The outputs of the hypothesis that end the session, by output, where the oracle is error-aware;
// empty if none does.
std::vector<bool> find_error_outputs(const Mealy& hypothesis, const OutputOracle& oracle);

}  // namespace maide
