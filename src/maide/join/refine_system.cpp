#include "maide/join/refine_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/join/at_rest.hpp"
#include "maide/join/replay.hpp"
#include "maide/join/replay_plan.hpp"

namespace maide {
namespace {

class Refiner {
 public:
  Refiner(const std::filesystem::path& path, Engine& engine, const CheckRequest& request,
          const RefinementOptions& options)
      : path_(path),
        text_(read_file(path, request.options.control)),
        engine_(engine),
        request_(request),
        options_(options) {}

  RefinedCheck run() {
    do {
      read_and_check();
    } while (refine());
    decide();
    return std::move(result_);
  }

 private:
  const RunControl& control() const { return request_.options.control; }

  void read_and_check() {
    requests_.clear();
    real_.clear();
    at_rest_ = System();
    static_cast<CheckedSystem&>(result_) = check_system_text(
        text_, path_.string(), engine_, request_,
        record_requests(make_learning_source(options_.models), requests_), options_.settings);
    options_.models.note = {};  // where models come from is told once
    confirmed_.clear();
  }

  // True if a model is another now.
  bool refine() {
    for (PropertyResult& property : result_.report.properties) {
      if (property.verdict == Verdict::inconclusive || !property.trace) continue;
      const std::optional<Deviation> deviation = try_on_real_system(property);
      if (!deviation) continue;
      if (learn_from(*deviation, property)) return true;
    }
    const bool is_violated =
        std::ranges::any_of(result_.report.properties, [](const auto& property) {
          return property.verdict == Verdict::violated && property.trace;
        });
    return !is_violated && test_models();
  }

  // How the real system left the counterexample; nothing if it followed.
  std::optional<Deviation> try_on_real_system(const PropertyResult& property) {
    // What is late on its way cannot be made so on a real system.
    const bool is_late = !result_.system.nobodys_actions.empty();
    if (is_late && at_rest_.programs.empty()) {
      at_rest_ = parse_system(text_, path_.string(), make_learning_source(options_.models),
                              control(), options_.settings, Deliveries::at_rest);
    }
    const System& system = is_late ? at_rest_ : result_.system;
    Trace trace = *property.trace;
    if (is_late) {
      auto at_rest = find_run_at_rest(result_.system, property.name, trace, system, control());
      if (!at_rest) {
        result_.report.assumptions.push_back(property.name + ": not tried: needs " +
                                             describe_late_message(result_.system, trace));
        return std::nullopt;
      }
      trace = std::move(at_rest->trace);
    }
    if (real_.empty()) real_ = open_real_systems(system, requests_, {1, "", control()});
    std::optional<Deviation> deviation;
    for (std::size_t attempt = 0; attempt < options_.most_attempts; ++attempt) {
      play_on_real_system(
          system, real_, {&trace, 1}, {3, control()},
          [&](std::size_t, ReplayedRun run) { deviation = std::move(run.deviation); });
      if (!deviation || deviation->kind != Deviation::Kind::other_answer) break;
    }
    if (!deviation) {
      confirmed_.push_back(property.name);
      for (const std::string& line : find_unplayed(system, {&trace, 1}).models) {
        result_.report.assumptions.push_back(property.name + ": " + line);
      }
      for (std::string& assumption : find_assumptions(system, trace)) {
        result_.report.assumptions.push_back(property.name + ": " + assumption);
      }
    }
    return deviation;
  }

  // True if the model is another now; else the property is inconclusive, and says why.
  bool learn_from(const Deviation& deviation, PropertyResult& property) {
    const ModelInstance& instance = result_.system.models[deviation.model];
    const ModelRequest& request = request_of(instance, requests_);
    const std::string difference = fmt::format(
        "the real system does not follow this counterexample: {}, after {}: expected "
        "{}, seen {}",
        instance.name, join(deviation.word, " "), deviation.expected, deviation.seen);
    if (!deviation.refutes_model()) return doubt(property, difference);
    if (request.learn.empty()) {
      return doubt(property, difference + "; the model is a file, so it is not refined");
    }
    if (!request.values.empty()) {
      return doubt(property, difference +
                                 "; the model is made of one without values, so it is not "
                                 "refined");
    }
    if (result_.rounds.size() >= options_.most_rounds) {
      return doubt(property, difference + fmt::format("; {} refinements were not enough",
                                                      options_.most_rounds));
    }
    const bool tests_again =
        retested_.contains(kept_model_path(folder_of(options_.models, request), request));
    const Refinement refinement = refine_learned_model(
        request, {deviation.word, tests_again, options_.seed}, options_.models);
    if (!refinement.is_new) {
      return doubt(property, difference + "; asked again, it does what the model says");
    }
    add_round({instance.name, "the counterexample to " + property.name, deviation.word,
               deviation.expected, deviation.seen, refinement.states_before,
               refinement.states_after});
    return true;
  }

  bool doubt(PropertyResult& property, std::string reason) {
    property.verdict = Verdict::inconclusive;
    property.reason = std::move(reason);
    return false;
  }

  // Tests every learned model that a program uses. True if one is another now, or weak no more:
  // then the system is to be checked again.
  bool test_models() {
    if (is_tested_) return false;
    std::set<std::filesystem::path> seen;  // instances that share a model
    bool is_stronger = false;
    for (const auto& [name, request] : requests_) {
      if (request.learn.empty() || !request.values.empty()) {
        untested_.insert(name + (request.learn.empty() ? " is a file" : " was made with values"));
        continue;
      }
      const std::filesystem::path kept =
          kept_model_path(folder_of(options_.models, request), request);
      if (!seen.insert(kept).second) continue;
      if (result_.rounds.size() >= options_.most_rounds) return false;
      const Refinement refinement = refine_learned_model(
          request, {{}, true, options_.seed + result_.rounds.size()}, options_.models);
      if (refinement.is_new) {
        retested_.insert(kept);
        add_round({name, "a test", {}, "", "", refinement.states_before, refinement.states_after});
        return true;
      }
      tests_[name] = refinement.tests;
      is_stronger = is_stronger || refinement.is_stronger;
    }
    // The models are the same, but a verdict that leaned on a weak one may stand now.
    is_tested_ = is_stronger;
    return is_stronger;
  }

  void add_round(RefinementRound round) {
    tests_.clear();
    untested_.clear();
    is_tested_ = false;
    result_.rounds.push_back(std::move(round));
    if (options_.on_round) options_.on_round(result_.rounds.back());
  }

  // The verdict of all, after some may have become inconclusive, and what it rests on.
  void decide() {
    CheckReport& report = result_.report;
    report.verdict = Verdict::holds;
    for (const Verdict verdict : {Verdict::inconclusive, Verdict::violated}) {
      for (const PropertyResult& property : report.properties) {
        if (property.verdict == verdict) report.verdict = verdict;
      }
    }
    for (const std::string& name : confirmed_) {
      report.assumptions.push_back(
          result_.system.callbacks.empty()
              ? "the real system followed the counterexample to " + name
              : "the real connections followed the counterexample to " + name +
                    "; executors were not asked (`maide replay` asks them)");
    }
    for (const auto& [name, tests] : tests_) {
      report.assumptions.push_back(
          fmt::format("{} was tested again on the real system after the verdict: {}", name, tests));
    }
    for (const std::string& name : untested_) {
      report.assumptions.push_back(name + " and was not tested");
    }
  }

  const std::filesystem::path& path_;
  const std::string text_;
  Engine& engine_;
  const CheckRequest& request_;
  RefinementOptions options_;
  ModelRequests requests_;
  System at_rest_;  // the system last checked, as it is played; empty: not read
  std::vector<std::unique_ptr<RealSystem>> real_;  // of the models that were checked last
  std::vector<std::string> confirmed_;             // properties whose violation is real
  std::map<std::string, std::string> tests_;       // of the models, after the verdict
  std::set<std::string> untested_;
  bool is_tested_ = false;  // all models, since the last one changed
  // Models that `learning:` tests too little: what its tests do not find would be forgotten again.
  std::set<std::filesystem::path> retested_;
  RefinedCheck result_;
};

}  // namespace

std::string to_string(const RefinementRound& round) {
  std::string text = fmt::format("{}: refined from {} to {} states by {}", round.instance,
                                 round.states_before, round.states_after, round.cause);
  if (!round.word.empty()) {
    text += fmt::format(": after {} the model says {}, the real system {}", join(round.word, " "),
                        round.expected, round.seen);
  }
  return text;
}

RefinedCheck check_and_refine(const std::filesystem::path& path, Engine& engine,
                              const CheckRequest& request, const RefinementOptions& options) {
  require_fitting(engine, request.options);
  return Refiner(path, engine, request, options).run();
}

}  // namespace maide
