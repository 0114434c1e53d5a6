#include "maide/check/verdict/cause.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "maide/check/verdict/waiting.hpp"

namespace maide {
namespace {

class CauseFinder {
 public:
  CauseFinder(const System& system, const Trace& trace)
      : system_(system), trace_(trace), states_(replay(system, trace)) {}

  Cause run() {
    const std::size_t first = trace_.loop_start.value_or(trace_.steps.size());
    for (std::size_t at = states_.size(); at-- > first;) {
      for (const std::uint32_t program : blocked_programs(system_, states_[at])) {
        if (steps_from(first, program) || !seen_.insert(program).second) continue;
        add(find_waiting(system_, trace_, states_, at, program), states_[at]);
      }
    }
    return cause_;
  }

 private:
  bool steps_from(std::size_t first, std::uint32_t program) const {
    return std::any_of(trace_.steps.begin() + static_cast<std::ptrdiff_t>(first),
                       trace_.steps.end(), [&](const Step& step) { return step.actor == program; });
  }

  void add(const Waiting& waiting, const GlobalState& state) {
    const std::string who =
        name_of(running_callback(system_, state, waiting.program), waiting.program);
    for (const WayOut& way : waiting.ways) {
      for (const Helper& helper : way.helpers) add(who, helper);
    }
    for (const ServiceWait& wait : waiting.services) {
      // Who serves is asked to where a request is there, and who takes where an answer is.
      if (wait.taker && wait.is_answered) add(who, *wait.taker);
      if (wait.server && (wait.is_requested || wait.is_served)) add(who, *wait.server);
      if (wait.loss) cause_.losing.insert(system_.models[wait.model].name);
    }
    if (waiting.account && waiting.account->lost() > 0) {
      cause_.losing.insert(system_.models[waiting.model].name);
    }
  }

  void add(const std::string& waiting, const Helper& helper) {
    const Obstacle obstacle = helper.obstacle;
    if (obstacle != Obstacle::own_thread && obstacle != Obstacle::own_group &&
        obstacle != Obstacle::no_thread && obstacle != Obstacle::busy) {
      return;
    }
    cause_.hindrances.insert({waiting, name_of(helper.callback, helper.program), obstacle});
    if (helper.callback) cause_.nodes.insert(system_.callbacks[*helper.callback].node);
    for (const std::uint32_t holder : helper.holders) {
      cause_.nodes.insert(system_.callbacks[holder].node);
    }
  }

  std::string name_of(std::optional<std::uint32_t> callback, std::uint32_t program) const {
    return callback ? system_.callbacks[*callback].name : system_.programs[program].name;
  }

  const System& system_;
  const Trace& trace_;
  std::vector<GlobalState> states_;
  std::set<std::uint32_t> seen_;
  Cause cause_;
};

}  // namespace

Cause find_cause(const System& system, const Trace& trace) {
  return CauseFinder(system, trace).run();
}

}  // namespace maide
