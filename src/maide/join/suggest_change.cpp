#include "maide/join/suggest_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/rules/wire.hpp"
#include "maide/check/verdict/cause.hpp"
#include "maide/check/verdict/races.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/join/late_changes.hpp"
#include "maide/join/system_variant.hpp"
#include "maide/join/valued_queue.hpp"

namespace maide {
namespace {

constexpr std::size_t most_repeats = 8;  // different numbers of repetitions
constexpr std::size_t most_constants = 16;
constexpr std::int64_t most_below = 16;  // values of a constant that are all checked
constexpr std::int64_t most_longer = 8;  // times as long a queue
constexpr Value most_spoken_of = 64;     // of a variable's range: messages that are tried
constexpr std::uint64_t memory_mib = 1024;
constexpr std::chrono::seconds seconds_between_notes{10};
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
      if (result.trace) causes_.emplace(result.name, cause_of(system, result));
    }
    for (const Repeat& repeat : repeats_) burst_ = std::max(burst_, repeat.count);
    for (const ModelInstance& model : system.models) {
      if (model.source == ModelInstance::Source::variable) note_range(model.type);
    }
    for (const Program& program : system.programs) {
      for (const ProgramVariable& variable : program.variables) note_range(variable.type);
    }
    if (constants_.size() > most_constants) constants_.clear();
  }

  Suggestions run() {
    const auto is_node_of_cause = [this](const NodeChange& change) {
      return is_in_cause(&Cause::nodes, change.node);
    };
    const auto is_losing = [this](const DepthPlace& place) {
      return is_in_cause(&Cause::losing, place.name);
    };
    try_nodes(is_node_of_cause);
    try_depths(is_losing);
    if (needs_late_message()) try_late_changes();
    try_other_models();
    for (const ModelInstance& model : system_.models) try_settings(model);
    try_nodes(std::not_fn(is_node_of_cause));
    try_depths(std::not_fn(is_losing));
    try_constants();
    try_fewer_repetitions();
    try_other_repetitions();
    if (result_.changes.empty()) try_one_depth();
    if (!result_.changes.empty()) result_.in_part.clear();
    for (const auto& [property, change] : result_.in_part) result_.of_one_cause.erase(property);
    if (!result_.changes.empty()) result_.of_one_cause.clear();
    return std::move(result_);
  }

 private:
  // Programs that count so far send as many.
  void note_range(const ValueType& type) {
    if (type.kind != ValueKind::integer || type.high < 0 || type.high > most_spoken_of) return;
    burst_ = std::max(burst_, static_cast<std::uint32_t>(type.high));
  }

  static Cause cause_of(const System& system, const PropertyResult& result) {
    const Shown shown = shown_part(system, result);
    return find_cause(shown.part.system(), shown.trace);
  }

  bool is_in_cause(std::set<std::string> Cause::*names, const std::string& name) const {
    return std::ranges::any_of(
        causes_, [&](const auto& entry) { return (entry.second.*names).contains(name); });
  }

  struct Outcome {
    bool holds = false;       // everything that was asked for
    bool is_unknown = false;  // what was learned ends too soon, or the time
    std::uint64_t states = 0;
    std::vector<std::string> mended;  // properties, if none was broken
    bool mends_any = false;           // a property, whatever becomes of others
    // Properties, if none was broken, that are violated from another cause, with what is said of
    // that.
    std::map<std::string, std::string> otherwise;
  };

  Outcome check(const SystemVariant& variant) {
    Outcome outcome;
    if (options_.control.should_stop()) return outcome;
    const std::optional<System> changed =
        make_variant(system_, variant, options_.models, options_.control);
    if (!changed) return outcome;
    ++result_.tried;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_note_ > seconds_between_notes) {
      note(fmt::format("{} changes were checked so far", result_.tried));
      last_note_ = now;
    }
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
      // `error` is there only where a program can come to one.
      const auto before = before_.find(property.name);
      const bool held = before == before_.end() || before->second == Verdict::holds;
      const bool holds = property.verdict == Verdict::holds;
      if (!held && holds) outcome.mended.push_back(property.name);
      outcome.mends_any = outcome.mends_any || (!held && holds);
      breaks = breaks || (held && !holds);
      if (!held && property.trace && has_another_cause(*changed, property)) {
        outcome.otherwise.emplace(
            property.name, options_.explain ? options_.explain(*changed, property) : std::string());
      }
    }
    if (breaks) outcome.mended.clear();
    if (breaks) outcome.otherwise.clear();
    return outcome;
  }

  // Nothing hinders on this run what hindered before. A run is shown that is as near as any, or
  // almost, so this cause lies farther away than the other one did, or that one is gone.
  bool has_another_cause(const System& changed, const PropertyResult& result) const {
    const auto before = causes_.find(result.name);
    if (before == causes_.end() || before->second.hindrances.empty()) return false;
    const std::set<Hindrance> now = cause_of(changed, result).hindrances;
    return std::ranges::none_of(before->second.hindrances,
                                [&](const Hindrance& one) { return now.contains(one); });
  }

  void found(const std::string& change, const Outcome& outcome, const std::string& how) {
    std::string line = fmt::format("{} ({}checked: {} states)", change, how, outcome.states);
    std::vector<std::string>& changes = result_.changes;
    if (std::ranges::find(changes, line) == changes.end()) {
      changes.push_back(std::move(line));
    }
  }

  void try_other_models() {
    const std::map<std::string, InterfaceAutomaton> models = find_models_nearby(system_);
    for (const ModelInstance& instance : system_.models) {
      if (!has_model(instance)) continue;
      for (const auto& [name, automaton] : models) {
        if (name == instance.origin || automaton == instance.read_automaton()) continue;
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

  struct LearnedWith {
    Learned learned;
    std::vector<OptionSpec> options;  // of that system
  };

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
      learned_.emplace(instance.name, LearnedWith{*learned, specs});
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
    if (std::ranges::find(option.allowed, value) == option.allowed.end()) {
      return;
    }
    Learned changed = learned;
    for (const std::string& key : keys_that_count(learned.with, option.key, specs)) {
      value_of(changed.with, key) = value;
    }
    if (changed.with == learned.with) return;
    fit_size(changed.with, specs);
    const Outcome outcome = learn_and_check(instance, changed);
    if (outcome.holds) found(change_of(instance, learned, changed), outcome, "learned and ");
  }

  // The smallest number that is enough: up to as many messages as programs speak of.
  void raise(const ModelInstance& instance, const Learned& learned,
             const std::vector<OptionSpec>& specs, const OptionSpec& option) {
    Learned changed = learned;
    const std::vector<std::string> keys = keys_that_count(learned.with, option.key, specs);
    std::optional<std::uint32_t> before;
    std::map<std::string, std::uint32_t> own;
    for (const std::string& key : keys) {
      const auto number = parse_number<std::uint32_t>(value_of(changed.with, key));
      if (!number) return;
      own.emplace(key, *number);
      before = std::min(before.value_or(*number), *number);
    }
    std::uint32_t high = burst_;
    if (!before || *before >= high || std::int64_t{high} > option.most) return;
    std::uint32_t low = *before;  // is not enough; `high` is
    const auto set_all = [&](std::uint32_t number) {
      for (const auto& [key, value] : own) {
        value_of(changed.with, key) = std::to_string(std::max(number, value));
      }
    };
    const auto outcome_of = [&](std::uint32_t number) {
      set_all(number);
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
    set_all(high);
    found(change_of(instance, learned, changed), best, "learned and ");
  }

  // The setting's value under the key as it is written there, `-` and `_` being the same.
  static std::string& value_of(With& with, const std::string& key) {
    for (auto& [own, value] : with) {
      if (plain(own) == plain(key)) return value;
    }
    return with[key];
  }

  // The keys whose values the ends have: where `pub-depth` is not what it is by itself, it is the
  // writer's depth, and `depth` is the reader's alone.
  static std::vector<std::string> keys_that_count(const With& with, const std::string& key,
                                                  const std::vector<OptionSpec>& specs) {
    std::vector<std::string> keys;
    for (const std::string prefix : {"pub-", "sub-"}) {
      const auto spec = std::ranges::find(specs, prefix + key, &OptionSpec::key);
      const auto own = std::ranges::find_if(
          with, [&](const auto& entry) { return plain(entry.first) == plain(prefix + key); });
      if (spec == specs.end() || own == with.end() || own->second == spec->default_value) continue;
      keys.push_back(own->first);
    }
    if (keys.size() < 2) keys.push_back(key);
    return keys;
  }

  std::string change_of(const ModelInstance& instance, const Learned& before,
                        const Learned& after) const {
    return fmt::format("{}: {} with {}", instance.name, before.name,
                       describe_settings(after.with, before.with));
  }

  // As many messages in flight as the programs may send; false if it is so already.
  bool fit_size(With& with, const std::vector<OptionSpec>& specs) const {
    const bool has_size =
        std::ranges::any_of(specs, [](const OptionSpec& spec) { return spec.key == "size"; });
    if (!has_size) return false;
    std::string& size = value_of(with, "size");
    if (parse_number<std::uint32_t>(size).value_or(0) >= burst_) return false;
    size = std::to_string(burst_);
    return true;
  }

  // What is the same without being said is not said.
  static void drop_defaults(With& with, const std::vector<OptionSpec>& specs) {
    for (const OptionSpec& spec : specs) {
      std::erase_if(with, [&](const auto& entry) {
        return same_key(entry.first, spec.key) && entry.second == spec.default_value;
      });
    }
  }

  InterfaceAutomaton model_of(const ModelInstance& instance, const Learned& learned) {
    ModelRequest request;
    request.instance = instance.name;
    request.learn = learned.name;
    request.position = instance.position;
    With with = learned.with;
    drop_defaults(with, learned_.at(instance.name).options);
    request.with.assign(with.begin(), with.end());
    const auto known = made_.find({learned.name, with});
    if (known != made_.end()) return known->second;
    return made_.emplace(std::pair(learned.name, with), options_.models(request)).first->second;
  }

  Outcome learn_and_check(const ModelInstance& instance, const Learned& learned) {
    return check({{}, {{instance.name, model_of(instance, learned)}}, {}});
  }

  // Of each node the first cure, which is the smallest.
  template <typename IsWanted>
  void try_nodes(const IsWanted& is_wanted) {
    std::set<std::string> cured;
    for (const NodeChange& change : list_node_changes(system_)) {
      if (!is_wanted(change) || cured.contains(change.node)) continue;
      const Outcome outcome = check({{}, {}, {}, change.text});
      for (const std::string& property : outcome.mended) {
        result_.in_part.emplace(property, change.description + "; " + change.lines);
      }
      for (const auto& [property, reason] : outcome.otherwise) {
        result_.of_one_cause.emplace(property,
                                     fmt::format("{}; {}{}{}", change.description, change.lines,
                                                 reason.empty() ? "" : "; what is left: ", reason));
      }
      if (!outcome.holds) continue;
      cured.insert(change.node);
      found(change.description, outcome, "");
      result_.changes.back() += "; " + change.lines;
    }
  }

  template <typename IsWanted>
  void try_depths(const IsWanted& is_wanted) {
    for (const DepthPlace& place : find_depths(system_)) {
      if (!is_wanted(place)) continue;
      const auto longer = nearest(place.value, most_longer * place.value, [&](std::int64_t value) {
        return check({{}, {}, {}, with_depth(text(), place, value)});
      });
      if (!longer) continue;
      found(fmt::format("{}: {} {} in place of {}", place.name, place.option, longer->first,
                        place.value),
            longer->second, "");
    }
  }

  // ---- Messages that come too late ----

  // At rest, where what is sent arrives at once, some violated property holds.
  bool needs_late_message() {
    if (!has_late_messages(system_)) return false;
    const std::size_t tried = result_.tried;
    SystemVariant at_rest;
    at_rest.deliveries = Deliveries::at_rest;
    const Outcome outcome = check(at_rest);
    result_.tried = tried;
    return outcome.mends_any;
  }

  void try_late_changes() {
    std::set<std::string> helped;  // connections, by one place
    for (const LateChange& change : list_late_changes(system_)) {
      if (change.is_of_several && helped.contains(change.connection)) continue;
      const Outcome outcome = check({{}, {}, {}, change.text});
      if (!outcome.holds) continue;
      helped.insert(change.connection);
      found(change.description, outcome, "");
    }
    for (const WriterDepth& place : find_writer_depths(system_)) {
      const std::int64_t most =
          std::max<std::int64_t>(most_longer * place.value, WireRules::least_room);
      const auto deeper = nearest(place.value, most, [&](std::int64_t value) {
        return check({{}, {}, {}, with_writer_depth(system_, place, value).text});
      });
      if (!deeper) continue;
      found(fmt::format("{}: its writers keep {} messages in place of {}", place.name,
                        deeper->first, place.value),
            deeper->second, "");
      result_.changes.back() += "; " + with_writer_depth(system_, place, deeper->first).lines;
    }
  }

  // ---- One depth for several ----

  // A queue whose depth is a number: in the file, or an option with which its model was learned.
  struct Queue {
    std::string name;
    std::int64_t depth = 0;
    std::optional<DepthPlace> place;
    const ModelInstance* instance = nullptr;
    std::string key{};  // of the option
  };

  std::vector<Queue> find_queues() {
    std::vector<Queue> queues;
    for (const DepthPlace& place : find_depths(system_)) {
      queues.push_back({place.name, place.value, place});
    }
    for (const ModelInstance& instance : system_.models) {
      const auto learned = learned_.find(instance.name);
      if (learned == learned_.end()) continue;
      for (const OptionSpec& option : learned->second.options) {
        if (option.keeps_more != raised || std::int64_t{burst_} > option.most) continue;
        With with = learned->second.learned.with;
        const auto depth = parse_number<std::int64_t>(value_of(with, option.key));
        if (!depth) continue;
        queues.push_back({instance.name, *depth, std::nullopt, &instance, option.key});
        break;
      }
    }
    std::erase_if(queues, [&](const Queue& queue) { return queue.depth >= burst_; });
    return queues;
  }

  Outcome with_one_depth(const std::vector<Queue>& queues, std::int64_t depth) {
    SystemVariant variant;
    for (const Queue& queue : queues) {
      if (queue.depth >= depth) continue;
      if (queue.place) {
        variant.text =
            with_depth(variant.text.empty() ? text() : variant.text, *queue.place, depth);
        continue;
      }
      Learned changed = learned_.at(queue.instance->name).learned;
      value_of(changed.with, queue.key) = std::to_string(depth);
      variant.models.emplace(queue.instance->name, model_of(*queue.instance, changed));
    }
    return check(variant);
  }

  // Where each queue alone is not enough: the fewest and the smallest that are.
  void try_one_depth() {
    std::vector<Queue> queues = find_queues();
    if (queues.size() < 2) return;
    try {
      if (!with_one_depth(queues, burst_).holds) return;
      for (std::size_t i = queues.size(); i-- > 0 && queues.size() > 1;) {
        std::vector<Queue> fewer = queues;
        fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
        if (with_one_depth(fewer, burst_).holds) queues = std::move(fewer);
      }
      std::int64_t shortest = burst_;
      for (const Queue& queue : queues) shortest = std::min(shortest, queue.depth);
      const auto enough = nearest(
          shortest, burst_, [&](std::int64_t depth) { return with_one_depth(queues, depth); });
      if (!enough) return;
      const auto& [depth, outcome] = *enough;
      std::map<std::string, std::vector<std::string>> changes;
      for (const Queue& queue : queues) {
        if (queue.depth >= depth) continue;
        changes[fmt::format("{} {} in place of {}", queue.place ? queue.place->option : queue.key,
                            depth, queue.depth)]
            .push_back(queue.name);
      }
      std::vector<std::string> lines;
      for (const auto& [change, names] : changes) {
        lines.push_back(change + " at " + join(names, " and "));
      }
      found("together: " + join(lines, ", "), outcome, "");
    } catch (const Error& error) {
      note(fmt::format("one depth for several was not tried: {}", error.what()));
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
  std::uint32_t burst_ = 0;  // messages that programs speak of: repetitions, ranges of variables
  std::map<std::string, LearnedWith> learned_;                       // by instance
  std::map<std::pair<std::string, With>, InterfaceAutomaton> made_;  // by system and settings
  std::vector<std::string> properties_;
  std::map<std::string, Verdict> before_;  // by property
  std::map<std::string, Cause> causes_;    // of those that are violated
  std::chrono::steady_clock::time_point last_note_ = std::chrono::steady_clock::now();
  Suggestions result_;
};

}  // namespace

Suggestions suggest_changes(const System& system, const CheckReport& before,
                            const SuggestOptions& options) {
  return ChangeSearch(system, before, options).run();
}

}  // namespace maide
