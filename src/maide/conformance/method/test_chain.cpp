#include "maide/conformance/method/test_chain.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"

namespace maide {

std::optional<Word> ChainOracle::find_counterexample(const Mealy& hypothesis,
                                                     const RunControl& control) {
  begun_ = 0;
  for (const auto& link : links_) {
    ++begun_;
    if (auto counterexample = link->find_counterexample(hypothesis, control)) {
      begun_ = 0;
      return counterexample;
    }
  }
  return std::nullopt;
}

std::string ChainOracle::guarantee() const {
  std::string text;
  for (const auto& link : links_) text += (text.empty() ? "" : "; ") + link->guarantee();
  return text;
}

Strength ChainOracle::strength() const {
  Strength all;
  for (std::size_t link = 0; link < begun_; ++link) {
    const Strength one = links_[link]->strength();
    all.exact = all.exact || one.exact;
    all.extra_states = std::max(all.extra_states, one.extra_states);
    all.chained = std::max(all.chained, one.chained);
    all.pumped = std::max(all.pumped, one.pumped);
    all.random += one.random;
  }
  return all;
}

TestCost ChainOracle::cost_of_missing() const {
  TestCost most;
  for (const auto& link : links_) {
    const TestCost one = link->cost_of_missing();
    if (one.words > most.words) most = one;
  }
  return most;
}

namespace {

constexpr std::string_view cache_link = "cache";

// Whether the link looks at the option: what is in the cache looks at none.
bool heeds(const TestMethodEntry* method, std::string_view option) {
  return method != nullptr && maide::heeds(*method, option);
}

std::string options_of(const TestMethodEntry* method) {
  return method == nullptr || method->options.empty() ? "none" : std::string(method->options);
}

std::string near_option(const TestMethodEntry* method, std::string_view key) {
  const std::string options = options_of(method);
  std::vector<std::string> names;
  for (const std::string_view name : split(options, ' ')) names.emplace_back(name);
  return did_you_mean(key, names);
}

}  // namespace

TestChain::TestChain(std::string_view text)
    : text_(text.empty() ? test_methods().front().name : text) {
  for (const std::string_view link : split(text_, ',')) links_.push_back(parse_link(link));
}

TestChain::Link TestChain::parse_link(std::string_view text) {
  const std::vector<std::string_view> parts = split(text, ':');
  Link link{nullptr, {}};
  if (parts.front() != cache_link) link.method = &find_test_method(parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equals = std::min(parts[i].find('='), parts[i].size());
    Setting setting{std::string(parts[i].substr(0, equals)),
                    std::string(parts[i].substr(std::min(equals + 1, parts[i].size())))};
    std::replace(setting.key.begin(), setting.key.end(), '_', '-');
    if (!heeds(link.method, setting.key)) {
      throw UsageError("the equivalence method '" + std::string(parts.front()) +
                       "' has no option '" + setting.key + "'; it has: " + options_of(link.method) +
                       near_option(link.method, setting.key));
    }
    TestMethodOptions tried;
    try {
      set_test_option(tried, setting.key, setting.value);
    } catch (const UsageError& error) {
      throw UsageError(std::string(error.what()) + " (--eq)");
    }
    link.settings.push_back(std::move(setting));
  }
  return link;
}

bool TestChain::has(std::string_view method) const {
  return std::ranges::any_of(links_, [&](const Link& link) {
    return link.method != nullptr && link.method->name == method;
  });
}

void TestChain::require(std::string_view option) const {
  std::string theirs;
  for (const Link& link : links_) {
    if (heeds(link.method, option)) return;
    theirs += theirs.empty() ? "" : "; ";
    theirs += link.method != nullptr ? link.method->name : cache_link;
    theirs += " has: " + options_of(link.method);
  }
  throw UsageError("no equivalence method of '" + text_ + "' has the option '" +
                   std::string(option) + "'; " + theirs);
}

std::unique_ptr<EquivalenceOracle> TestChain::make(const TestMethodContext& context,
                                                   const TestMethodOptions& options) const {
  std::vector<std::unique_ptr<EquivalenceOracle>> oracles;
  const Link& first = links_.front();
  const bool is_perfect = first.method != nullptr && first.method->name == "perfect";
  if (context.cache != nullptr && !is_perfect) {
    oracles.push_back(context.cache->make_consistency_test());
  }
  for (const Link& link : links_) {
    if (link.method == nullptr) continue;
    TestMethodOptions own = options;
    for (const auto& [key, value] : link.settings) set_test_option(own, key, value);
    oracles.push_back(link.method->make(context, own));
  }
  if (oracles.size() == 1) return std::move(oracles.front());
  return std::make_unique<ChainOracle>(std::move(oracles));
}

}  // namespace maide
