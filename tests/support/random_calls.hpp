// Random sequences of calls on an object, shrunk when one fails: what is reported is a seed and a
// short list of calls, to be pasted into the regressions of the test (after mobical: Biere, Fleury
// & Heisinger, "CaDiCaL", and Zeller & Hildebrandt, "Simplifying and isolating failure-inducing
// input", IEEE TSE 2002).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/random_automata.hpp"
#include "maide/base/random.hpp"

namespace maide::test {

// What `kind` means, and what it does with `value`, is for the test to say.
struct Call {
  std::uint32_t kind = 0, value = 0;
};
using Calls = std::vector<Call>;

// A world made from `seed`, and what is done with it.
struct Scenario {
  std::uint64_t seed = 0;
  Calls calls;
};

// Plays a scenario from the start; says what went wrong, "" if nothing did.
using PlayCalls = std::function<std::string(const Scenario& scenario)>;

// "{7, {{0, 12}, {3, 4}}}".
inline std::string to_text(const Scenario& scenario) {
  std::string text = "{" + std::to_string(scenario.seed) + ", {";
  for (const Call& call : scenario.calls) {
    text += (text.back() == '{' ? "{" : ", {") + std::to_string(call.kind) + ", " +
            std::to_string(call.value) + "}";
  }
  return text + "}}";
}

// Leaves out calls, many at once first, and makes values smaller, as long as the scenario still
// fails. What is left fails, and fails no more without any one of its calls.
inline Scenario shrink(Scenario failing, const PlayCalls& play) {
  const auto still_fails = [&](const Scenario& candidate) { return !play(candidate).empty(); };
  for (std::size_t size = failing.calls.size(); size > 0;) {
    bool is_shorter = false;
    for (std::size_t start = 0; start < failing.calls.size();) {
      Scenario candidate = failing;
      const auto first = candidate.calls.begin() + static_cast<std::ptrdiff_t>(start);
      const auto rest = static_cast<std::ptrdiff_t>(std::min(size, candidate.calls.size() - start));
      candidate.calls.erase(first, first + rest);
      if (still_fails(candidate)) {
        failing = std::move(candidate);
        is_shorter = true;
      } else {
        start += size;
      }
    }
    if (size > 1) {
      size = (size + 1) / 2;
    } else if (!is_shorter) {
      break;
    }
  }
  for (std::size_t i = 0; i < failing.calls.size(); ++i) {
    for (std::uint32_t value = 0; value < failing.calls[i].value; value = 2 * value + 1) {
      Scenario candidate = failing;
      candidate.calls[i].value = value;
      if (!still_fails(candidate)) continue;
      failing = std::move(candidate);
      break;
    }
  }
  return failing;
}

inline void expect_no_failure(const Scenario& scenario, const PlayCalls& play) {
  if (play(scenario).empty()) return;
  const Scenario small = shrink(scenario, play);
  ADD_FAILURE() << play(small) << "\nto be kept among the regressions: " << to_text(small);
}

// So many scenarios of so many calls, drawn from one seed; stops at the first that fails.
struct RandomCalls {
  std::uint64_t seed = 1;
  std::size_t scenarios = 1, calls = 1;
  std::uint32_t kinds = 1, values = 1;  // both are drawn below these
};

inline void expect_no_failure(const RandomCalls& options, const PlayCalls& play) {
  for (std::size_t i = 0; i < options.scenarios; ++i) {
    Scenario scenario{options.seed + i, {}};
    Random random(scenario.seed);
    for (std::size_t call = 0; call < options.calls; ++call) {
      const auto kind = static_cast<std::uint32_t>(random.below(options.kinds));
      scenario.calls.push_back({kind, static_cast<std::uint32_t>(random.below(options.values))});
    }
    expect_no_failure(scenario, play);
    if (testing::Test::HasFailure()) return;
  }
}

// Thrown where a promise is broken; other exceptions come from what is tested.
struct Broken {
  std::string promise;
};

inline void promise(bool is_kept, const std::string& what) {
  if (!is_kept) throw Broken{what};
}

// Plays the calls, one by one, and finish(); what went wrong, and at which of them. `make` makes
// what they are called on from the seed.
template <typename Make>
std::string play_calls(const Scenario& scenario, Make&& make) {
  std::size_t done = 0;
  try {
    auto world = make(scenario.seed);
    for (; done < scenario.calls.size(); ++done) world->call(scenario.calls[done]);
    world->finish();
  } catch (const Broken& broken) {
    return broken.promise + " (call " + std::to_string(done) + ")";
  } catch (const std::exception& error) {
    return std::string(error.what()) + " (call " + std::to_string(done) + ")";
  }
  return "";
}

inline Word random_word(Random& random, std::size_t inputs, std::size_t longest) {
  Word word(1 + random.below(longest));
  for (Symbol& input : word) input = static_cast<Symbol>(random.below(inputs));
  return word;
}

inline Mealy random_machine(std::uint64_t seed, std::size_t most_states) {
  Random random(seed);
  return random_mealy({.states = random.between(1, most_states),
                       .inputs = random.between(1, 4),
                       .outputs = random.between(1, 3)},
                      random);
}

}  // namespace maide::test
