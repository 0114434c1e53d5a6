// The two implementations of what can come next (system/steps.hpp): by the book, and packed. In
// every state that is reached they give the same steps, in the same order and with the same texts,
// and each code leads back to where the step came from.
#include "maide/check/system/steps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "joint_systems.hpp"
#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/packed/packed_steps.hpp"
#include "maide/check/system/components.hpp"

namespace maide {
namespace {

// A step as an implementation gives it, told in full.
struct Told {
  GlobalState next;
  std::size_t actor = 0;
  std::uint32_t action = 0;
  bool is_cut = false;
  Step step;
  GlobalState before;
  StepText text;
  bool operator==(const Told&) const = default;
};

template <typename Steps>
Told tell(const Steps& steps, const typename Steps::State& next, GlobalState after,
          std::size_t actor, std::uint32_t action, bool is_cut, std::uint64_t code) {
  after.is_cut = false;  // the packed state does not say so
  const StepBefore undone = steps.undo(next, code);
  actor = std::min(actor, steps.system().programs.size());  // of whatever part of nobody
  return {std::move(after),       actor, action, is_cut, undone.step, undone.before,
          steps.text(undone.step)};
}

std::vector<Told> tell(const StepsByTheBook& steps, const GlobalState& state,
                       const WantedSteps& wanted) {
  std::vector<Told> all;
  steps.by_event(state, wanted,
                 [&](const GlobalState& next, std::size_t actor, std::uint32_t action, bool is_cut,
                     std::uint64_t code) {
                   all.push_back(tell(steps, next, next, actor, action, is_cut, code));
                 });
  return all;
}

template <std::size_t words>
std::vector<Told> tell(const PackedSteps<words>& steps, const GlobalState& state,
                       const WantedSteps& wanted) {
  std::vector<Told> all;
  steps.by_event(
      steps.packed().template pack<words>(state), wanted,
      [&](const PackedState<words>& next, std::size_t actor, std::uint32_t action, bool is_cut,
          std::uint64_t code) {
        all.push_back(tell(steps, next, steps.packed().unpack(next), actor, action, is_cut, code));
      });
  return all;
}

bool is_of(const System& system, const Told& told, const WantedSteps& wanted) {
  return is_wanted(system, told.step, wanted);
}

// All that somebody may ask for in this state, by its steps.
std::vector<WantedSteps> questions(const System& system, const std::vector<Told>& all) {
  std::vector<WantedSteps> asked{{}};
  for (const Told& told : all) {
    asked.push_back({told.step.actor, {}});
    for (const ModelUse& event : events_of(system, told.step)) {
      asked.push_back({told.step.actor, event});
      asked.push_back({{}, event});
    }
  }
  return asked;
}

// The number of states that were compared.
std::size_t compare(const System& system, std::size_t limit) {
  const PackedSystem packed(system);
  const StepsByTheBook book(system);
  std::size_t count = 0;
  with_words(packed.words(), [&](auto words) {
    const PackedSteps<words.value> tables(packed);
    EXPECT_EQ(packed.unpack(tables.initial()), book.initial());
    EXPECT_GE(tables.actors(), book.actors());  // nobody has parts
    std::set<std::vector<std::uint32_t>> known;
    std::deque<GlobalState> open;
    const auto visit = [&](const GlobalState& state) {
      std::vector<std::uint32_t> key(state.models.begin(), state.models.end());
      key.insert(key.end(), state.programs.begin(), state.programs.end());
      if (known.size() < limit && known.insert(std::move(key)).second) open.push_back(state);
    };
    visit(book.initial());
    for (; !open.empty() && !testing::Test::HasFailure(); open.pop_front(), ++count) {
      const GlobalState& state = open.front();
      const std::vector<Told> all = tell(book, state, {});
      ASSERT_EQ(all, tell(tables, state, {})) << system.file;
      for (const Told& told : all) {
        ASSERT_EQ(told.before, state);
        ASSERT_EQ(told.next.models, apply(system, state, told.step).models);
      }
      for (const WantedSteps& wanted : questions(system, all)) {
        std::vector<Told> filtered;
        for (const Told& told : all) {
          if (is_of(system, told, wanted)) filtered.push_back(told);
        }
        ASSERT_EQ(tell(book, state, wanted), filtered);
        ASSERT_EQ(tell(tables, state, wanted), filtered);
      }
      for (const Told& told : all) {
        if (!told.is_cut) visit(told.next);
      }
    }
  });
  return count;
}

TEST(Steps, AreTheSameByTheBookAndPacked) {
  Random random(31);
  constexpr test::JointSystemKinds everything{true, true, true, true, true};
  std::size_t states = 0, nobodys = 0;
  for (int i = 0; i < 300 && !HasFailure(); ++i) {
    const System system =
        i % 3 == 0 ? test::random_system(random)
                   : test::random_joint_system(random, {1, 3, 3, 0.3, 0.3},
                                               i % 3 == 1 ? test::JointSystemKinds{} : everything);
    nobodys += system.nobodys_actions.size();
    states += compare(system, 100);
  }
  EXPECT_GT(states, 1000U);
  EXPECT_GT(nobodys, 50U);
}

TEST(Steps, OfTheExamplesAreTheSame) {
  int systems = 0;
  for (const std::string folder : {"architectures", "case-study-1", "case-study-2"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(MAIDE_SOURCE_DIR "/examples/" + folder)) {
      if (entry.path().extension() != ".yaml") continue;
      const std::string text = read_file(entry.path());
      if (text.find("learn:") != std::string::npos) continue;
      const System system = parse_system(text, entry.path(), read_requested_model);
      for (const auto& programs : find_components(system)) {
        compare(SystemPart(system, programs).system(), 60);
      }
      if (HasFailure()) FAIL() << entry.path();
      ++systems;
    }
  }
  EXPECT_GE(systems, 30) << systems;
}

}  // namespace
}  // namespace maide
