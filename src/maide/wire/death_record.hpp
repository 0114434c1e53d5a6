// What is known of a word in which the wrapper died: where each time, and what that means. A death
// proves nothing by itself, for anybody may kill a process; but deaths at the same step behind the
// same answers, alone in a fresh process, are the system's own doing, and an observation.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/sul/sul.hpp"

namespace maide {

// One death of the wrapper while it had a word to answer.
struct Death {
  WordEnd end = WordEnd::crash;  // hang: it did not come to rest, or gave no sign of life
  std::string reason;            // in words
  // The steps that were over, where that is known.
  std::optional<std::vector<SulStep>> before;
  bool in_reset = false;  // it had not even begun
};

class DeathRecord {
 public:
  enum class Verdict : std::uint8_t {
    ask_again,
    reproducible,  // last() is what the word does
    hopeless,      // it dies again and again, at differing places
  };
  // A crash is reproducible at the third death, of which two are known to be at the same place: the
  // first may be anybody's. A hang, which nobody does from outside and which costs a step limit
  // each time, at the second at the same place.
  Verdict add(Death death);

  std::uint32_t count() const { return static_cast<std::uint32_t>(deaths_.size()); }
  const std::vector<Death>& deaths() const { return deaths_; }
  const Death& last() const { return deaths_.back(); }

 private:
  std::vector<Death> deaths_;
};

}  // namespace maide
