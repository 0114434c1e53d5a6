// The cache's votes on contradictions. Invariant: a vote on a word counts the output to its last
// input in runs that agree with the tree before it, so a word's prefixes are settled before it is;
// and tree and file say the same at any time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "maide/learn/cache/known_answers.hpp"
#include "maide/learn/oracle/output_oracle.hpp"
#include "maide/learn/oracle/vote.hpp"

namespace maide {

class CacheFile;

class CacheVotes {
 public:
  // Asks the system, whatever is known.
  using Asker = std::function<std::vector<MealyAnswer>(std::span<const Query> queries)>;

  // While one lives, words are being asked again; `on_vote` is told of the outermost.
  class Scope {
   public:
    // Null: there are no votes.
    explicit Scope(CacheVotes* votes);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    CacheVotes* votes_;
  };

  // Keeps references; `file` may be null. Throws UsageError for options that cannot be.
  CacheVotes(const VoteOptions& options, std::function<void(bool begins)> on_vote,
             KnownAnswers& known, CacheFile* file);

  std::uint32_t most_attempts() const { return options_.most_attempts; }
  std::uint64_t corrections() const { return corrections_; }
  bool is_watching() const { return !watched_.empty(); }

  // Counts a fresh answer for every word that is watched.
  void count_answer(const MealyAnswer& answer);
  // Asks a word that is in the tree until its last output is decided, which was the `other` one
  // just now; true if the tree was changed, there or before. Throws NondeterminismError.
  bool decide(const Word& word, Symbol other, const Asker& ask);
  // A word whose answer was looked up in this run and has been corrected since; once.
  std::optional<Word> take_corrected();

  // All words that were voted on.
  std::vector<Contradiction> contradictions() const;
  // Between two calls. Throws std::logic_error.
  void check_invariants() const;

 private:
  // The outputs seen to a word's last input, where the others were as in the tree.
  struct Watched {
    Ballot ballot;
    Word before;  // the two outputs that contradicted each other; they have no vote
  };

  bool impose(const Word& word, Symbol output);
  Contradiction describe(const Word& word) const;

  VoteOptions options_;
  std::function<void(bool)> on_vote_;
  KnownAnswers& known_;
  CacheFile* file_;
  int depth_ = 0;                      // of votes that are being held
  std::map<Word, Watched> watched_;    // each word that was ever contradicted
  std::vector<Contradiction> closed_;  // of words whose prefix was corrected since
  std::optional<Word> corrected_;      // a word handed up whose answer was corrected since
  std::uint64_t corrections_ = 0;
};

}  // namespace maide
