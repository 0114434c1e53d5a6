#include "maide/workflow/suggest_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/check/explore/engine.hpp"
#include "maide/check/language/system_file.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/workflow/open_system.hpp"
#include "maide/workflow/system_variant.hpp"
#include "maide/workflow/valued_queue.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 50;   // model files beside those in use
constexpr std::size_t most_repeats = 8;  // different numbers of repetitions
constexpr std::size_t most_constants = 16;
constexpr std::int64_t most_below = 16;  // values of a constant that are all checked
constexpr std::int64_t most_longer = 8;  // times as long a queue
constexpr std::uint64_t memory_mib = 1024;
constexpr std::string_view raised = "+";  // OptionSpec::keeps_more

// The settings of a system to be learned.
using With = std::map<std::string, std::string>;

std::string describe_settings(const With& with, const With& before) {
  std::vector<std::string> parts;
  for (const auto& [key, value] : with) {
    const auto old = before.find(key);
    if (old == before.end()) parts.push_back(fmt::format("{}={}", key, value));
    if (old != before.end() && old->second != value) {
      parts.push_back(fmt::format("{}={} in place of {}", key, value, old->second));
    }
  }
  return join(parts);
}

class ChangeSearch {
 public:
  ChangeSearch(const System& system, const CheckReport& before, const SuggestOptions& options)
      : system_(system),
        options_(options),
        repeats_(find_repeats(system)),
        constants_(find_constants(system)) {
    for (const PropertyResult& result : before.properties) {
      properties_.push_back(result.name);
      before_.emplace(result.name, result.verdict);
    }
    for (const Repeat& repeat : repeats_) burst_ = std::max(burst_, repeat.count);
    if (constants_.size() > most_constants) constants_.clear();
  }

  Suggestions run() {
    try_other_models();
    for (const ModelInstance& model : system_.models) try_settings(model);
    try_nodes();
    try_depths();
    try_constants();
    try_fewer_repetitions();
    try_other_repetitions();
    if (!result_.changes.empty()) result_.in_part.clear();
    return std::move(result_);
  }

 private:
  struct Outcome {
    bool holds = false;       // everything that was asked for
    bool is_unknown = false;  // what was learned ends too soon, or the time
    std::uint64_t states = 0;
    std::vector<std::string> mended;  // properties, if none was broken
  };

  Outcome check(const SystemVariant& variant) {
    Outcome outcome;
    if (options_.control.should_stop()) return outcome;
    const std::optional<System> changed =
        make_variant(system_, variant, options_.models, options_.control);
    if (!changed) return outcome;
    ++result_.tried;
    CheckRequest request;
    request.properties = properties_;
    request.options.memory_mib = memory_mib;
    request.options.control = options_.control;
    const auto limit = deadline_in(options_.seconds_each);
    auto& deadline = request.options.control.deadline;
    deadline = deadline ? std::min(*deadline, limit) : limit;
    NativeEngine engine;
    const CheckReport report = check_system(*changed, engine, request);
    outcome.holds = report.verdict == Verdict::holds;
    outcome.is_unknown = report.verdict == Verdict::inconclusive;
    bool breaks = false;
    for (const PropertyResult& property : report.properties) {
      outcome.states = std::max(outcome.states, property.states);
      const bool held = before_.at(property.name) == Verdict::holds;
      const bool holds = property.verdict == Verdict::holds;
      if (!held && holds) outcome.mended.push_back(property.name);
      breaks = breaks || (held && !holds);
    }
    if (breaks) outcome.mended.clear();
    return outcome;
  }

  void found(const std::string& change, const Outcome& outcome, const std::string& how) {
    result_.changes.push_back(
        fmt::format("{} ({}checked: {} states)", change, how, outcome.states));
  }

  // Model files in the folders of those in use.
  std::map<std::string, InterfaceAutomaton> models_nearby() const {
    std::map<std::string, InterfaceAutomaton> models;
    const fs::path home = fs::path(system_.file).parent_path();
    std::set<fs::path> folders;
    for (const ModelInstance& model : system_.models) {
      models.emplace(model.origin, model.automaton);
      if (fs::path(model.origin).has_extension()) {
        folders.insert(fs::path(model.origin).parent_path());
      }
    }
    for (const fs::path& folder : folders) {
      std::set<fs::path> files;
      std::error_code ignored;
      for (const auto& entry : fs::directory_iterator(home / folder, ignored)) {
        if (entry.path().extension() == ".dot") files.insert(entry.path());
      }
      for (const fs::path& file : files) {
        if (models.size() > most_files) break;
        try {
          Model model = read_model(file);
          auto* automaton = std::get_if<InterfaceAutomaton>(&model);
          if (automaton != nullptr) {
            models.emplace((folder / file.filename()).string(), std::move(*automaton));
          }
        } catch (const Error&) {
          continue;  // a picture, or another tool's file
        }
      }
    }
    return models;
  }

  void try_other_models() {
    const std::map<std::string, InterfaceAutomaton> models = models_nearby();
    for (const ModelInstance& instance : system_.models) {
      for (const auto& [name, automaton] : models) {
        if (name == instance.origin || automaton == instance.automaton) continue;
        const Outcome outcome = check({{}, {{instance.name, automaton}}, {}});
        if (!outcome.holds) continue;
        found(fmt::format("{}: {} in place of {}", instance.name, name, instance.origin), outcome,
              "");
      }
    }
  }

  // The system that an instance was learned from, with its settings.
  struct Learned {
    std::string name;
    With with;
  };

  static std::optional<Learned> find_learned(const ModelInstance& instance) {
    const auto origin = instance.automaton.origin.find("sul");
    if (origin == instance.automaton.origin.end()) return std::nullopt;
    // Another system has no model with these values yet.
    if (instance.automaton.origin.contains(std::string(values_key))) return std::nullopt;
    Learned learned;
    try {
      for (const std::string& word : split_shell_words(origin->second)) {
        const std::size_t equals = word.find('=');
        if (learned.name.empty()) {
          learned.name = word;
        } else if (equals == std::string::npos) {
          return std::nullopt;
        } else {
          learned.with[word.substr(0, equals)] = word.substr(equals + 1);
        }
      }
    } catch (const Error&) {
      return std::nullopt;
    }
    if (learned.name.empty() || learned.name.find(':') != std::string::npos) return std::nullopt;
    return learned;
  }

  static std::string plain(std::string key) {
    std::replace(key.begin(), key.end(), '-', '_');
    return key;
  }

  void try_settings(const ModelInstance& instance) {
    const std::optional<Learned> learned = find_learned(instance);
    if (!learned || !options_.models) return;
    const auto attempt = [&](const std::string& what, const auto& work) {
      try {
        work();
      } catch (const Error& error) {
        note(fmt::format("{} was not tried: {}", what, error.what()));
      }
    };
    attempt("another setting of " + instance.name, [&] {
      const SystemSpec spec = parse_system_spec(learned->name, {});
      std::vector<OptionSpec> specs = list_system_options(spec, {}, options_.control);
      // Numbers first: a larger one changes less than another kind of system.
      std::stable_partition(specs.begin(), specs.end(),
                            [](const OptionSpec& option) { return option.keeps_more == raised; });
      for (const OptionSpec& option : specs) {
        if (option.keeps_more.empty() || options_.control.should_stop()) continue;
        attempt(fmt::format("another {} of {}", option.key, instance.name), [&] {
          option.keeps_more == raised ? raise(instance, *learned, specs, option)
                                      : set(instance, *learned, specs, option);
        });
      }
    });
  }

  void set(const ModelInstance& instance, const Learned& learned,
           const std::vector<OptionSpec>& specs, const OptionSpec& option) {
    const std::string& value = option.keeps_more;
    if (std::find(option.allowed.begin(), option.allowed.end(), value) == option.allowed.end()) {
      return;
    }
    Learned changed = learned;
    std::string& now = value_of(changed.with, option.key);
    if (now == value) return;
    now = value;
    fit_size(changed.with, specs);
    const Outcome outcome = learn_and_check(instance, changed);
    if (outcome.holds) found(change_of(instance, learned, changed), outcome, "learned and ");
  }

  // The smallest number that is enough: up to the largest number of repetitions, which is as many
  // messages as programs speak of.
  void raise(const ModelInstance& instance, const Learned& learned,
             const std::vector<OptionSpec>& specs, const OptionSpec& option) {
    Learned changed = learned;
    const std::optional<std::uint32_t> before =
        parse_number<std::uint32_t>(value_of(changed.with, option.key));
    std::uint32_t high = burst_;
    if (!before || *before >= high || std::int64_t{high} > option.most) return;
    std::uint32_t low = *before;  // is not enough; `high` is
    const auto outcome_of = [&](std::uint32_t number) {
      value_of(changed.with, option.key) = std::to_string(number);
      Outcome outcome = learn_and_check(instance, changed);
      if (outcome.is_unknown && fit_size(changed.with, specs)) {
        outcome = learn_and_check(instance, changed);
      }
      return outcome;
    };
    Outcome best = outcome_of(high);
    if (!best.holds) return;
    while (high - low > 1 && !options_.control.should_stop()) {
      const std::uint32_t middle = low + (high - low) / 2;
      const Outcome outcome = outcome_of(middle);
      (outcome.holds ? high : low) = middle;
      if (outcome.holds) best = outcome;
    }
    value_of(changed.with, option.key) = std::to_string(high);
    found(change_of(instance, learned, changed), best, "learned and ");
  }

  // The setting's value under the key as it is written there, `-` and `_` being the same.
  static std::string& value_of(With& with, const std::string& key) {
    for (auto& [own, value] : with) {
      if (plain(own) == plain(key)) return value;
    }
    return with[key];
  }

  std::string change_of(const ModelInstance& instance, const Learned& before,
                        const Learned& after) const {
    return fmt::format("{}: {} with {}", instance.name, before.name,
                       describe_settings(after.with, before.with));
  }

  // As many messages in flight as the programs may send; false if it is so already.
  bool fit_size(With& with, const std::vector<OptionSpec>& specs) const {
    const bool has_size = std::any_of(specs.begin(), specs.end(),
                                      [](const OptionSpec& spec) { return spec.key == "size"; });
    if (!has_size) return false;
    std::string& size = value_of(with, "size");
    if (parse_number<std::uint32_t>(size).value_or(0) >= burst_) return false;
    size = std::to_string(burst_);
    return true;
  }

  Outcome learn_and_check(const ModelInstance& instance, const Learned& learned) {
    ModelRequest request;
    request.instance = instance.name;
    request.learn = learned.name;
    request.position = instance.position;
    request.with.assign(learned.with.begin(), learned.with.end());
    return check({{}, {{instance.name, options_.models(request)}}, {}});
  }

  // Of each node the first cure, which is the smallest.
  void try_nodes() {
    std::set<std::string> cured;
    for (const NodeChange& change : list_node_changes(text())) {
      if (cured.contains(change.node)) continue;
      const Outcome outcome = check({{}, {}, {}, change.text});
      for (const std::string& property : outcome.mended) {
        result_.in_part.emplace(property, change.description);
      }
      if (!outcome.holds) continue;
      cured.insert(change.node);
      found(change.description, outcome, "");
    }
  }

  void try_depths() {
    for (const DepthPlace& place : find_depths(text())) {
      const auto longer = nearest(place.value, most_longer * place.value, [&](std::int64_t value) {
        return check({{}, {}, {}, with_depth(text(), place, value)});
      });
      if (!longer) continue;
      found(fmt::format("{}: {} {} in place of {}", place.name, place.option, longer->first,
                        place.value),
            longer->second, "");
    }
  }

  const std::string& text() const {
    static const std::string none;
    const auto source = system_.sources.find(system_.file);
    return source == system_.sources.end() ? none : source->second;
  }

  // ---- Constants
  // ----------------------------------------------------------------------------------

  Outcome with_value(const NumberConstant& constant, std::int64_t value) {
    NumberConstant changed = constant;
    changed.value = value;
    return check({{}, {}, {changed}});
  }

  // The nearest values below and above that are enough, of all constants the smallest change first.
  void try_constants() {
    std::multimap<std::int64_t, std::pair<std::string, Outcome>> found_by_change;
    for (const NumberConstant& constant : constants_) {
      std::int64_t most = 2 * std::max<std::int64_t>(constant.value, burst_);
      for (const NumberConstant& other : constants_) most = std::max(most, other.value);
      for (const std::int64_t end : {std::int64_t{1}, most}) {
        const auto change = nearest(
            constant.value, end, [&](std::int64_t value) { return with_value(constant, value); });
        if (!change) continue;
        const auto& [value, outcome] = *change;
        found_by_change.emplace(std::abs(value - constant.value),
                                std::pair(describe(constant, value), outcome));
      }
    }
    for (const auto& [change, what] : found_by_change) found(what.first, what.second, "");
  }

  // On the way from the value to `end`: the first, in ever larger steps, with which everything
  // holds, and then the nearest one up to there, as if all farther ones held, too.
  template <typename OutcomeOf>
  std::optional<std::pair<std::int64_t, Outcome>> nearest(std::int64_t from, std::int64_t end,
                                                          const OutcomeOf& outcome_of) {
    const std::int64_t sign = end < from ? -1 : 1;
    const std::int64_t farthest = (end - from) * sign;
    std::int64_t low = 0, high = 0;  // distances: `low` is not enough, `high` is
    Outcome best;
    for (std::int64_t step = 1; low < farthest && !options_.control.should_stop(); step *= 2) {
      high = std::min(low + step, farthest);
      best = outcome_of(from + sign * high);
      if (best.holds) break;
      low = high;
    }
    if (!best.holds) return std::nullopt;
    while (high - low > 1 && !options_.control.should_stop()) {
      const std::int64_t middle = low + (high - low) / 2;
      const Outcome outcome = outcome_of(from + sign * middle);
      (outcome.holds ? high : low) = middle;
      if (outcome.holds) best = outcome;
    }
    return std::pair(from + sign * high, best);
  }

  std::string describe(const NumberConstant& constant, std::int64_t value) {
    bool holds_below = value < constant.value && value <= most_below;
    for (std::int64_t below = value - 1; holds_below && below >= 1; --below) {
      holds_below = with_value(constant, below).holds;
    }
    return fmt::format("with {} {} {} it holds, in place of {} in line {}", constant.name,
                       holds_below ? "<=" : "=", value, constant.value, constant.line);
  }

  std::vector<std::uint32_t> different_counts() const {
    std::set<std::uint32_t> counts;
    for (const Repeat& repeat : repeats_) counts.insert(repeat.count);
    std::vector<std::uint32_t> result(counts.begin(), counts.end());
    if (result.size() > most_repeats) result.clear();
    return result;
  }

  std::vector<Repeat> with_count(std::uint32_t before, std::uint32_t after) const {
    std::vector<Repeat> changed;
    for (Repeat repeat : repeats_) {
      if (repeat.count != before) continue;
      repeat.count = after;
      changed.push_back(repeat);
    }
    return changed;
  }

  static std::string describe(const std::vector<Repeat>& changed, std::uint32_t before) {
    std::vector<std::string> lines;
    for (const Repeat& repeat : changed) lines.push_back(std::to_string(repeat.line));
    return fmt::format("`repeat {}` in place of `repeat {}` in line{} {}", changed.front().count,
                       before, lines.size() == 1 ? "" : "s", join(lines, " and "));
  }

  // Equal numbers mean the same thing, mostly, so they change together. The largest number that is
  // few enough, if one is: more of them never helps, which is tried out and not relied on.
  void try_fewer_repetitions() {
    for (const std::uint32_t count : different_counts()) {
      const auto outcome_of = [&](std::uint32_t number) {
        return check({with_count(count, number), {}, {}});
      };
      if (count < 2) continue;
      Outcome best = outcome_of(1);
      if (!best.holds) continue;
      std::uint32_t low = 1, high = count;
      while (high - low > 1 && !options_.control.should_stop()) {
        const std::uint32_t middle = low + (high - low) / 2;
        const Outcome outcome = outcome_of(middle);
        (outcome.holds ? low : high) = middle;
        if (outcome.holds) best = outcome;
      }
      found(describe(with_count(count, low), count), best, "");
    }
  }

  void try_other_repetitions() {
    const std::vector<std::uint32_t> counts = different_counts();
    for (const Repeat& repeat : repeats_) {
      for (const std::uint32_t count : counts) {
        if (count == repeat.count) continue;
        Repeat changed = repeat;
        changed.count = count;
        const Outcome outcome = check({{changed}, {}, {}});
        if (outcome.holds) found(describe({changed}, repeat.count), outcome, "");
      }
    }
  }

  void note(const std::string& line) const {
    if (options_.note) options_.note(line);
  }

  const System& system_;
  const SuggestOptions& options_;
  std::vector<Repeat> repeats_;
  std::vector<NumberConstant> constants_;
  std::uint32_t burst_ = 0;  // the largest number of repetitions
  std::vector<std::string> properties_;
  std::map<std::string, Verdict> before_;  // by property
  Suggestions result_;
};

}  // namespace

Suggestions suggest_changes(const System& system, const CheckReport& before,
                            const SuggestOptions& options) {
  return ChangeSearch(system, before, options).run();
}

}  // namespace maide
