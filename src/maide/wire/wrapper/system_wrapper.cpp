#include "maide/wire/wrapper/system_wrapper.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <numeric>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/wire/wrapper/actor_thread.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"

namespace maide {
namespace {

std::string describe(WordEnd end) {
  switch (end) {
    case WordEnd::crash: return "died";
    case WordEnd::hang: return "does not come to rest";
    case WordEnd::aborted: return "was aborted";
    case WordEnd::complete: break;
  }
  return "is done";
}

SulAnswer play_each_input_once(WrapperSession& session) {
  Word word(session.info().inputs.size());
  std::iota(word.begin(), word.end(), Symbol{0});
  return session.run({std::move(word), Translation::eager}, [] { return false; });
}

// "write -> quiet, read -> message"
std::string describe_steps(const SulAnswer& answer, const SulInfo& info) {
  std::string text;
  for (std::size_t i = 0; i < answer.steps.size(); ++i) {
    text += fmt::format("{}{} -> {}", text.empty() ? "" : ", ", info.inputs[answer.inputs[i]].name,
                        mealy_output(answer.steps[i], Translation::eager));
  }
  return text;
}

// "cyclonedds 0.10.2", or "port" where the middleware has no version of its own.
std::string describe_version(const SulInfo& info) {
  const auto version = info.versions.find(info.name);
  return version == info.versions.end() ? info.name : info.name + " " + version->second;
}

}  // namespace

std::string run_self_test(SystemWrapper& wrapper) {
  const std::string name = wrapper.description().name;
  Watchdog watchdog([name](const std::string& work) {
    fmt::print(stderr, "maide-wrap-{}: {} did not end in time\n", name, work);
    std::fflush(stderr);
    ::_exit(static_cast<int>(ExitStatus::system_failed));
  });
  WrapperSession session(wrapper, &watchdog);
  const SulInfo& info = session.configure({});
  SulAnswer answer;
  std::string stuck;
  try {
    answer = play_each_input_once(session);
    stuck = session.end_instance();
  } catch (const std::exception& error) {
    throw WrapperError(error.what(), describe_version(info));
  }
  const std::string steps = describe_steps(answer, info);
  if (answer.end != WordEnd::complete) {
    throw WrapperError("the system " + describe(answer.end) + " after " + steps,
                       describe_version(info));
  }
  if (!stuck.empty()) {
    throw WrapperError("the call of " + stuck + " does not end with its word",
                       describe_version(info));
  }
  bool observed = false;
  for (const SulStep& step : answer.steps) observed |= !step.events.empty();
  if (!observed) throw WrapperError("nothing was observed: " + steps, describe_version(info));
  return describe_version(info) + ": " + steps;
}

}  // namespace maide
