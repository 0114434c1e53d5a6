#include "maide/conformance/test_chain.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/parse_number.hpp"
#include "maide/conformance/chain_oracle.hpp"

namespace maide {
namespace {

constexpr std::string_view cache_link = "cache";

// The parts between separators; one at least.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

template <typename Number>
void parse_into(std::optional<Number>& field, const std::string& key, const std::string& value) {
  field = parse_number<Number>(value);
  if (!field) throw UsageError("'" + value + "' is no value of " + key + " (--eq)");
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
  const std::string_view known = link.method != nullptr ? link.method->options : "";
  const std::vector<std::string_view> keys = split(known, ' ');
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equals = std::min(parts[i].find('='), parts[i].size());
    Setting setting{std::string(parts[i].substr(0, equals)),
                    std::string(parts[i].substr(std::min(equals + 1, parts[i].size())))};
    std::replace(setting.key.begin(), setting.key.end(), '_', '-');
    if (setting.key.empty() || std::find(keys.begin(), keys.end(), setting.key) == keys.end()) {
      throw UsageError("the equivalence method '" + std::string(parts.front()) +
                       "' has no option '" + setting.key +
                       "'; it has: " + (known.empty() ? "none" : std::string(known)));
    }
    TestMethodOptions tried;
    apply(setting, tried);
    link.settings.push_back(std::move(setting));
  }
  return link;
}

void TestChain::apply(const Setting& setting, TestMethodOptions& options) {
  const auto& [key, value] = setting;
  if (key == "extra-states") parse_into(options.extra_states, key, value);
  if (key == "max-tests") parse_into(options.max_tests, key, value);
  if (key == "min-length") parse_into(options.min_length, key, value);
  if (key == "max-length") parse_into(options.max_length, key, value);
  if (key == "restart-probability") parse_into(options.restart_probability, key, value);
  if (key == "infix-min") parse_into(options.infix_min, key, value);
  if (key == "infix-mean") parse_into(options.infix_mean, key, value);
  if (key == "infix-inputs") options.infix_inputs = find_infix_inputs(value);
  if (key == "prefix-states") options.prefix_states = find_prefix_states(value);
  if (key == "suffix-words") options.suffix_words = find_suffix_words(value);
  if (key == "ways") parse_into(options.ways, key, value);
  if (key == "walks") parse_into(options.walks, key, value);
  if (key == "walk-length") parse_into(options.walk_length, key, value);
  if (key == "seed") {
    std::optional<std::uint64_t> seed;
    parse_into(seed, key, value);
    options.seed = *seed;
  }
}

bool TestChain::has(std::string_view method) const {
  return std::any_of(links_.begin(), links_.end(), [&](const Link& link) {
    return link.method != nullptr && link.method->name == method;
  });
}

void TestChain::require(std::string_view option) const {
  std::string theirs;
  for (const Link& link : links_) {
    const std::string_view known = link.method != nullptr ? link.method->options : "";
    const std::vector<std::string_view> keys = split(known, ' ');
    if (std::find(keys.begin(), keys.end(), option) != keys.end()) return;
    theirs += theirs.empty() ? "" : "; ";
    theirs += link.method != nullptr ? link.method->name : cache_link;
    theirs += " has: ";
    theirs += known.empty() ? "none" : known;
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
    for (const Setting& setting : link.settings) apply(setting, own);
    oracles.push_back(link.method->make(context, own));
  }
  if (oracles.size() == 1) return std::move(oracles.front());
  return std::make_unique<ChainOracle>(std::move(oracles));
}

}  // namespace maide
