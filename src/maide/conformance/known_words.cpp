#include "maide/conformance/known_words.hpp"

#include <fmt/format.h>

#include "maide/conformance/test_suite.hpp"

namespace maide {
namespace {

class ListedSuite : public TestSuite {
 public:
  explicit ListedSuite(const std::vector<Word>& words) : words_(words) {}
  bool next(Word& word) override {
    if (next_ == words_.size()) return false;
    word = words_[next_++];
    return true;
  }
  std::optional<std::uint64_t> size() const override { return words_.size(); }

 private:
  const std::vector<Word>& words_;
  std::size_t next_ = 0;
};

}  // namespace

std::optional<Word> KnownWords::find_counterexample(const Mealy& hypothesis,
                                                    const RunControl& control) {
  ListedSuite suite(words_);
  return runner_.run(suite, hypothesis, control);
}

std::string KnownWords::guarantee() const {
  return fmt::format("right about {} word{} that earlier models gave", words_.size(),
                     words_.size() == 1 ? "" : "s");
}

}  // namespace maide
