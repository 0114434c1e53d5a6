#include "maide/report/ways_out_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "maide/base/text.hpp"
#include "maide/check/rules/model_words.hpp"

namespace maide {
namespace {

constexpr std::size_t most_ways = 4;  // in one sentence

class WaysOutText {
 public:
  WaysOutText(const System& system, const Waiting& waiting) : system_(system), waiting_(waiting) {}

  std::string write() const {
    std::vector<std::string> clauses;
    for (const ServiceWait& wait : waiting_.services) clauses.push_back(describe(wait));
    std::vector<const WayOut*> ways;
    for (const WayOut& way : waiting_.ways) {
      if (!is_for_answer(way)) ways.push_back(&way);
    }
    const bool has_helper =
        std::ranges::any_of(ways, [](const WayOut* way) { return !way->helpers.empty(); });
    if (ways.size() > 1 && !has_helper) {
      clauses.emplace_back("no program would ever make any of it possible");
      ways.clear();
    }
    const std::size_t shown = std::min(ways.size(), most_ways);
    for (std::size_t i = 0; i < shown; ++i) {
      for (std::string& clause : describe(*ways[i], ways.size() == 1)) {
        if (std::ranges::find(clauses, clause) == clauses.end()) {
          clauses.push_back(std::move(clause));
        }
      }
    }
    if (shown < ways.size()) {
      clauses.push_back(fmt::format("{} more", counted(ways.size() - shown, "way out")));
    }
    return join(clauses, "; ");
  }

 private:
  const Program& own() const { return system_.programs[waiting_.program]; }

  // ---- Who, and what keeps him ----

  std::string name_of(const Helper& helper) const {
    return helper.callback ? system_.callbacks[*helper.callback].name
                           : system_.programs[helper.program].name;
  }

  std::string names_of(const std::vector<std::uint32_t>& callbacks) const {
    std::vector<std::string> names;
    for (const std::uint32_t callback : callbacks) {
      const std::string& name = system_.callbacks[callback].name;
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    return list_words(names);
  }

  // "the group g", "a's own group".
  std::string group_of(std::uint32_t callback) const {
    const CallbackInstance& instance = system_.callbacks[callback];
    return instance.group.empty() ? instance.node + "'s own group" : "the group " + instance.group;
  }

  const ExecutorInstance& executor_of(std::uint32_t callback) const {
    return system_.executors[system_.callbacks[callback].executor];
  }

  std::string the_thread_of(std::uint32_t callback) const {
    return "the one of " + executor_of(callback).name;
  }

  // What keeps the helper, as the rest of a sentence whose subject he is; "" if nothing does.
  std::string obstacle_of(const Helper& helper) const {
    switch (helper.obstacle) {
      case Obstacle::none: return "";
      case Obstacle::ended:
        return system_.programs[helper.program].may_die() ? "has died" : "has ended";
      case Obstacle::passed: return "never comes there again";
      case Obstacle::not_started: return "has nothing to start for";
      case Obstacle::own_thread:
        if (helper.holders.empty()) {
          return fmt::format("finds no idle thread: {} waits here",
                             the_thread_of(*helper.callback));
        }
        return fmt::format("finds no idle thread: {} runs {}, which waits",
                           the_thread_of(*helper.callback), names_of(helper.holders));
      case Obstacle::own_group:
        return fmt::format("is in {}, which {} has while it waits", group_of(*helper.callback),
                           names_of(helper.holders));
      case Obstacle::busy:
        if (helper.holders.empty()) return "does not start: nothing spins its executor now";
        if (executor_of(*helper.callback).threads > 1) {
          return fmt::format("is in {}, which {} has", group_of(*helper.callback),
                             names_of(helper.holders));
        }
        return fmt::format("finds no idle thread: {} runs {}", the_thread_of(*helper.callback),
                           names_of(helper.holders));
      case Obstacle::no_thread: break;
    }
    const ExecutorInstance& executor = executor_of(*helper.callback);
    return fmt::format("finds no idle thread: {} {} of {} run {}",
                       executor.threads == 2 ? "both" : "all",
                       executor.threads == 2 ? "threads" : counted(executor.threads, "thread"),
                       executor.name, names_of(helper.holders));
  }

  // ---- Ways out of a select ----

  // "make x == true", "make late true", "make q.read -> message possible".
  std::string effect_of(const WayOut& way, bool is_only) const {
    if (way.guard) {
      const bool is_name = way.guard->text.find_first_of(" !(") == std::string::npos;
      return "make " + way.guard->text + (is_name ? " true" : " hold");
    }
    std::vector<std::string> steps;
    for (const ProgramEdge& edge : way.edges) {
      steps.push_back(describe_edge(system_, own(), edge));
    }
    steps = without_values(steps);
    const bool is_condition = std::ranges::all_of(way.edges, [&](const ProgramEdge& edge) {
      const auto uses = own().uses_of(edge);
      return std::ranges::all_of(uses, [&](const ModelUse& use) {
        return system_.models[use.model].source == ModelInstance::Source::variable;
      });
    });
    const std::string text = list_words(steps, " or ");
    if (is_condition) return "make " + text;
    return is_only ? "make that possible" : "make " + text + " possible";
  }

  std::vector<std::string> describe(const WayOut& way, bool is_only) const {
    const std::string effect = effect_of(way, is_only);
    const std::string only = way.helpers.size() == 1 ? "only " : "";
    std::vector<std::string> clauses, able, unable;
    for (const ModelUse& use : way.refused) {
      const ModelInstance& model = system_.models[use.model];
      if (model.source != ModelInstance::Source::built_in) continue;
      clauses.push_back(model.name + " " + describe_refusal(model, use.index));
    }
    for (const Helper& helper : way.helpers) {
      const std::string obstacle = obstacle_of(helper);
      if (obstacle.empty()) {
        able.push_back(name_of(helper));
      } else {
        unable.push_back(
            fmt::format("{}{} would {}, but it {}", only, name_of(helper), effect, obstacle));
      }
    }
    // Who can come to it counts more than those that cannot.
    if (!able.empty()) {
      clauses.push_back(fmt::format("{}{} would {}", only, list_words(able), effect));
    } else if (unable.empty()) {
      clauses.push_back("no program would ever " + effect);
    } else {
      clauses.insert(clauses.end(), unable.begin(), unable.end());
    }
    return clauses;
  }

  // ---- Answers of services ----

  bool is_for_answer(const WayOut& way) const {
    return std::ranges::any_of(way.edges, [&](const ProgramEdge& edge) {
      const auto events = own().events_of(edge);
      return std::ranges::any_of(events, [&](const ModelUse& event) {
        return event.kind == ModelUse::Kind::take &&
               std::ranges::any_of(waiting_.services, [&](const ServiceWait& wait) {
                 return wait.model == event.model;
               });
      });
    });
  }

  std::string describe(const ServiceWait& wait) const {
    const std::string& service = system_.models[wait.model].name;
    const std::string taking = wait.taker ? obstacle_of(*wait.taker) : "";
    const std::string serving = wait.server ? obstacle_of(*wait.server) : "";
    std::string text;
    if (wait.is_answered) {
      text = "its answer has come";
      if (!taking.empty())
        text += fmt::format(", but {}, which takes it, {}", name_of(*wait.taker), taking);
      return text;
    }
    if (wait.is_coming) return "its answer is on its way";
    if (wait.is_requested || wait.is_served) {
      text = wait.is_requested ? "its request is not served"
                               : "its request is served, but not answered";
      if (!serving.empty()) text += fmt::format(": {} {}", name_of(*wait.server), serving);
      if (!taking.empty() && taking == serving) {
        text += fmt::format(", nor does {}, which would take the answer", name_of(*wait.taker));
      } else if (!taking.empty()) {
        text += fmt::format("; {}, which would take the answer, {}", name_of(*wait.taker), taking);
      }
      return text;
    }
    if (!wait.loss && wait.has_asked && wait.server && wait.server->obstacle == Obstacle::ended) {
      return fmt::format("{}, which would answer, {}", name_of(*wait.server), serving);
    }
    if (!taking.empty()) {
      text = fmt::format("{}, which takes the answer, {}; ", name_of(*wait.taker), taking);
    }
    if (wait.loss) return text + describe(wait, *wait.loss);
    return text + (wait.has_asked ? "nothing of it is on its way in " + service
                                  : "it has sent no request to " + service);
  }

  std::string describe(const ServiceWait& wait, const ServiceLoss& loss) const {
    const ModelInstance& model = system_.models[wait.model];
    const ServiceInstance* const service = find_service(system_, wait.model);
    const std::string by = loss.by ? service->clients[*loss.by] : "another client";
    const std::string& own = service->clients[loss.client];
    const std::string keeps =
        fmt::format("({} keeps the last {})", model.name, model.automaton.origin.at("depth"));
    const std::size_t step = loss.step + 1;
    if (!loss.is_answer) {
      return fmt::format("its request was pushed out at step {} by {}, before {} served it {}",
                         step, by == own ? "its next one" : by + "'s", service->server, keeps);
    }
    return fmt::format("its answer was pushed out at step {} by {}, before it was taken {}", step,
                       by == own ? "the next one" : "the answer to " + by, keeps);
  }

  const System& system_;
  const Waiting& waiting_;
};

}  // namespace

std::string list_words(const std::vector<std::string>& words, const std::string& last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? last : ", ";
    text += words[i];
  }
  return text;
}

std::string describe_ways_out(const System& system, const Waiting& waiting) {
  return WaysOutText(system, waiting).write();
}

}  // namespace maide
