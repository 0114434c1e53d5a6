// The IA translator of Aarts & Vaandrager ("Learning I/O automata", CONCUR 2010). With it any
// learner of Mealy machines learns an interface automaton. Towards the learner it is a system that
// answers Mealy queries; towards the system it is a client of a Sul. Invariant: outputs are
// numbered in query order, never in arrival order.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/sul/fatal_words.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// A Mealy machine's answer to a Query.
struct MealyAnswer {
  Word inputs;                      // the word, or the path taken in the tree
  Word outputs;                     // one for each input, fewer when the word was aborted
  WordEnd end = WordEnd::complete;  // behind a crash or a hang, all inputs are refused
  std::uint32_t attempts = 1;
  std::chrono::microseconds reset_duration{0};   // time of the reset
  std::chrono::microseconds reset_wait{0};       // the part of it that the query waited for
  std::chrono::microseconds system_duration{0};  // time in the steps, the reset not included
  std::chrono::microseconds settling{0};         // the part of it in which nothing came any more
};

// The options by which a model or a cache knows its system again: all but those that version 0.1
// did not have, where they say what it did. So models and caches of 0.1 are of the same system.
std::map<std::string, std::string> identifying_options(const SulInfo& info);

// What a model learned from the system says of where it came from: "sul" (name and options),
// "versions", and "bound" where there is one.
Origin describe_origin(const SulInfo& info);

class IaTranslator {
 public:
  // Keeps a reference to `sul`. Throws UsageError if the system cannot be learned in this
  // translation, or names an output with a reserved name.
  IaTranslator(Sul& sul, Translation translation);

  Translation translation() const { return translation_; }
  const SulInfo& info() const { return sul_.info(); }
  const Alphabet& inputs() const { return inputs_; }    // the system's, and Delta last under av
  const Alphabet& outputs() const { return outputs_; }  // grows as outputs are seen

  // Answers in the order of the queries, in whatever order the system answered them. A crash or a
  // hang is an answer, too. A word that begins with a known fatal word is not run again, unless the
  // very same word is asked once more (a vote). A word that was aborted throws WrapperError naming
  // the word. O(batch) resets.
  std::vector<MealyAnswer> run(std::span<const Query> batch, const RunControl& control = {});
  // As above, but hands over what was answered when the call ends early by an exception.
  using PartialSink = std::function<void(std::size_t index, const MealyAnswer& answer)>;
  std::vector<MealyAnswer> run(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& on_early_end);
  // Words that end the system, each up to the input that does it, in the order in which they came.
  const std::vector<FatalWord>& fatal_words() const { return fatal_words_.list(translation_); }
  // Takes an answer that is known from elsewhere, by the names of its outputs. If it ends in a
  // crash or a hang, the word will not be run again.
  void remember(const Word& inputs, const std::vector<std::string>& outputs);
  // Symbol of an output that is known from elsewhere (a cache on disk).
  Symbol intern_output(std::string_view name) { return outputs_.intern(name); }

  // The interface automaton that a learned machine stands for, minimised, with the system's actors,
  // hidden returns and origin. Throws UsageError if the machine breaks the translation's
  // assumptions.
  InterfaceAutomaton to_interface_automaton(const Mealy& machine) const;
  InterfaceAutomaton to_interface_automaton(const NondeterministicMealy& machine) const;

 private:
  MealyAnswer to_mealy_answer(SulAnswer raw, const SulQuery& query);
  std::vector<Actor> actors() const;
  void run_unknown(std::span<const SulQuery> queries,
                   std::vector<std::optional<SulAnswer>>& answers, const RunControl& control);

  Sul& sul_;
  Translation translation_;
  Alphabet inputs_, outputs_;
  FatalWords fatal_words_;
};

}  // namespace maide
