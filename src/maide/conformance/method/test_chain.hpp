// Equivalence methods in a row, as `--eq` has them: names with commas between, each with options of
// its own behind colons, such as
//
//   w:extra-states=1,random-hads:max-tests=5000:infix-mean=4
//
// Each method is asked only if those before it found nothing. What was observed already comes
// first, whether the row begins with `cache` or not, because it costs nothing. `perfect` is the
// exception: its counterexamples are the shortest that there are, so nothing comes before it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/conformance/method/test_methods.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"

namespace maide {

// Several equivalence oracles one after the other, cheap ones first: each is asked only if those
// before it found nothing.
class ChainOracle : public EquivalenceOracle {
 public:
  explicit ChainOracle(std::vector<std::unique_ptr<EquivalenceOracle>> links)
      : links_(std::move(links)) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  // Those of all links, joined by "; ".
  std::string guarantee() const override;
  // In each dimension the most that a link reached in the last query, unless that refuted the
  // hypothesis.
  Strength strength() const override;
  // That of the link that misses most.
  TestCost cost_of_missing() const override;

 private:
  std::vector<std::unique_ptr<EquivalenceOracle>> links_;
  std::size_t begun_ = 0;  // links that have a say in the strength
};

class TestChain {
 public:
  // Throws UsageError for unknown methods, for options that a method does not look at, and for
  // values that are none. Empty: the default method.
  explicit TestChain(std::string_view text);

  const std::string& text() const { return text_; }
  // Whether the method of this name is one of the row's.
  bool has(std::string_view method) const;
  // Throws UsageError, with the methods and what they look at, if none of them looks at the option.
  void require(std::string_view option) const;

  // The oracle; options of a link go before those given here. Keeps references to the context's
  // parts. Throws UsageError where a method cannot work on it.
  std::unique_ptr<EquivalenceOracle> make(const TestMethodContext& context,
                                          const TestMethodOptions& options) const;

 private:
  struct Setting {
    std::string key, value;
  };
  struct Link {
    const TestMethodEntry* method;  // null: what is in the cache
    std::vector<Setting> settings;
  };
  static Link parse_link(std::string_view text);

  std::string text_;
  std::vector<Link> links_;
};

}  // namespace maide
