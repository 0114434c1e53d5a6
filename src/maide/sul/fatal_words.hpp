// Words that end the system. A reproducible crash or hang is an observation like any other. Its
// step has one event, `crash` or `hang`, by the actor of the input. Other events of that step are
// dropped, because what a dying system says is a race. Behind that step there is no system, so
// nothing is taken any more.
//
// This file makes such a step and the answers to the rest of a query. It also remembers fatal
// words, so that none of them costs another process.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "maide/sul/sul.hpp"

namespace maide {

// `crash` and `hang`, the outputs that stand for an end; no system may have outputs of its own of
// these names.
bool is_end_output(std::string_view name);
// The word ended in a crash or a hang.
bool is_fatal(WordEnd end);

// Makes the last step of `answer`, whose `end` is fatal, what such a step is. Not without steps.
void mark_fatal_step(SulAnswer& answer, const SulInfo& info);

// Answers the rest of `query` behind a crash or a hang: every input is refused. Under av, Delta
// first takes the output `crash` or `hang`, which waits in the queue. Other answers are not
// changed.
void answer_rest(SulAnswer& answer, const SulQuery& query, const SulInfo& info);

// A word that ends the system, up to and with the input that does it.
struct FatalWord {
  Word inputs;
  WordEnd end = WordEnd::crash;
  std::string reason;  // in words, or "" where only the end is known
};

// The fatal words that were met, as a tree; for both translations.
class FatalWords {
 public:
  // Remembers an answer that ended in a crash or a hang; does nothing with others. O(length).
  void add(const SulAnswer& answer, Translation translation);
  // The same of outputs as a Mealy machine gives them: known from elsewhere (a cache on disk).
  void add(const Word& inputs, const std::vector<std::string>& outputs, const SulInfo& info,
           Translation translation);
  // `query` has been answered by such an end: whoever asks the very same again doubts it.
  void mark_asked(const SulQuery& query);
  // The answer to `query`, up to the fatal step, if it runs into a fatal word; `attempts` is 0,
  // for it was not run. Once only for each word: then it is to be run. O(length).
  std::optional<SulAnswer> find(const SulQuery& query);

  // Those of a translation, in the order in which they were met.
  const std::vector<FatalWord>& list(Translation translation) const {
    return lists_[static_cast<std::size_t>(translation)];
  }

 private:
  struct Node {
    std::map<Symbol, std::uint32_t> children;
    SulStep step;                         // of the edge that leads here
    std::optional<std::uint32_t> listed;  // place in the list: the word ends here
  };
  std::array<std::vector<Node>, 2> trees_;  // by translation; node 0 is the root
  std::array<std::vector<FatalWord>, 2> lists_;
  std::array<std::set<Word>, 2> asked_;
};

}  // namespace maide
