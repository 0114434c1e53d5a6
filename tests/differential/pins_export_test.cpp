// Systems as plug-ins of LTSmin against their meaning (check/system/system.hpp). This program
// stands in for LTSmin: it has the functions that a plug-in calls, loads compiled exports and
// explores them. In every state the transitions are the system's steps, labels say what the meaning
// says, and what the matrices promise is tried out. LTSmin itself does the same where it is
// installed (ltsmin_systems_test.cpp).
#include <dlfcn.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "joint_systems.hpp"
#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/export/step_action.hpp"
#include "maide/check/engines/export/system_exporters.hpp"
#include "random_system.hpp"

// ---- What LTSmin has for its plug-ins, in our own words ----

namespace {

struct Matrix {
  int rows = 0, columns = 0;
  std::vector<bool> bits;
  bool at(int row, int column) const {
    return bits.at(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(column));
  }
};

std::map<const void*, Matrix> matrices;  // by the memory that the plug-in gave them

}  // namespace

extern "C" {

struct lts_type_s {
  std::vector<std::string> types;
  std::vector<int> formats;
  std::vector<std::string> slots, labels, edge_labels;
};
struct chunk {
  std::uint32_t len;
  char* data;
};
struct list {
  int count;
  int item[1];
};
struct transition_info {
  int* labels;
  int group;
  int por_proviso;
};
using transition_callback = void (*)(void*, transition_info*, int*, int*);

struct grey_box_model {
  lts_type_s type;
  std::map<int, std::string> actions;
  std::vector<int> initial;
  int (*next_of_group)(grey_box_model*, int, int*, transition_callback, void*) = nullptr;
  int (*next_of_all)(grey_box_model*, int*, transition_callback, void*) = nullptr;
  int (*label)(grey_box_model*, int, int*) = nullptr;
  void (*all_labels)(grey_box_model*, int*, int*) = nullptr;
  void (*labels_of_kind)(grey_box_model*, int, int*, int*) = nullptr;
  int (*groups_of_edge)(grey_box_model*, int, int, int*) = nullptr;
  std::map<int, list*> label_kinds;
  list** guards = nullptr;
  std::map<std::string, void*> parts;  // matrices, by what they say
};

void dm_create(void* memory, int rows, int columns) {
  matrices[memory] = {
      rows, columns,
      std::vector<bool>(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns))};
}
void dm_set(void* memory, int row, int column) {
  Matrix& matrix = matrices.at(memory);
  if (row < 0 || row >= matrix.rows || column < 0 || column >= matrix.columns) {
    throw std::out_of_range("dm_set");
  }
  matrix.bits[static_cast<std::size_t>(row) * static_cast<std::size_t>(matrix.columns) +
              static_cast<std::size_t>(column)] = true;
}
lts_type_s* lts_type_create() { return new lts_type_s; }
int lts_type_put_type(lts_type_s* type, const char* name, int format, int* is_new) {
  *is_new = 1;
  type->types.emplace_back(name);
  type->formats.push_back(format);
  return static_cast<int>(type->types.size()) - 1;
}
void lts_type_set_state_length(lts_type_s* type, int length) {
  type->slots.resize(static_cast<std::size_t>(length));
}
void lts_type_set_state_name(lts_type_s* type, int slot, const char* name) {
  type->slots.at(static_cast<std::size_t>(slot)) = name;
}
void lts_type_set_state_typeno(lts_type_s* type, int slot, int number) {
  EXPECT_LT(static_cast<std::size_t>(slot), type->slots.size());
  EXPECT_EQ(type->types.at(static_cast<std::size_t>(number)), "state");
}
void lts_type_set_edge_label_count(lts_type_s* type, int count) {
  type->edge_labels.resize(static_cast<std::size_t>(count));
}
void lts_type_set_edge_label_name(lts_type_s* type, int label, const char* name) {
  type->edge_labels.at(static_cast<std::size_t>(label)) = name;
}
void lts_type_set_edge_label_typeno(lts_type_s* type, int, int number) {
  EXPECT_EQ(type->types.at(static_cast<std::size_t>(number)), "action");
}
void lts_type_set_state_label_count(lts_type_s* type, int count) {
  type->labels.resize(static_cast<std::size_t>(count));
}
void lts_type_set_state_label_name(lts_type_s* type, int label, const char* name) {
  type->labels.at(static_cast<std::size_t>(label)) = name;
}
void lts_type_set_state_label_typeno(lts_type_s* type, int, int number) {
  EXPECT_LT(static_cast<std::size_t>(number), type->types.size());
}
void lts_type_validate(lts_type_s* type) {
  for (const auto& names : {type->slots, type->labels}) {
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  }
  EXPECT_EQ(type->edge_labels, std::vector<std::string>{"action"});
}
void pins_chunk_put_at(grey_box_model* model, int, chunk text, int index) {
  EXPECT_TRUE(model->actions.emplace(index, std::string(text.data, text.len)).second);
}
void GBsetLTStype(grey_box_model* model, lts_type_s* type) {
  model->type = *type;
  delete type;
}
void GBsetInitialState(grey_box_model* model, int* state) {
  model->initial.assign(state, state + model->type.slots.size());
}
void GBsetNextStateLong(grey_box_model* model, decltype(grey_box_model::next_of_group) function) {
  model->next_of_group = function;
}
void GBsetNextStateAll(grey_box_model* model, decltype(grey_box_model::next_of_all) function) {
  model->next_of_all = function;
}
void GBsetStateLabelLong(grey_box_model* model, decltype(grey_box_model::label) function) {
  model->label = function;
}
void GBsetStateLabelsAll(grey_box_model* model, decltype(grey_box_model::all_labels) function) {
  model->all_labels = function;
}
void GBsetStateLabelsGroup(grey_box_model* model,
                           decltype(grey_box_model::labels_of_kind) function) {
  model->labels_of_kind = function;
}
void GBsetGroupsOfEdge(grey_box_model* model, decltype(grey_box_model::groups_of_edge) function) {
  model->groups_of_edge = function;
}
void GBsetStateLabelGroupInfo(grey_box_model* model, int kind, list* labels) {
  model->label_kinds[kind] = labels;
}
void GBsetGuardsInfo(grey_box_model* model, list** guards) { model->guards = guards; }
void GBsetStateLabelInfo(grey_box_model* model, void* matrix) { model->parts["seen"] = matrix; }
void GBsetDMInfo(grey_box_model* model, void* matrix) { model->parts["all"] = matrix; }
void GBsetDMInfoRead(grey_box_model* model, void* matrix) { model->parts["read"] = matrix; }
void GBsetDMInfoMayWrite(grey_box_model* model, void* matrix) { model->parts["may"] = matrix; }
void GBsetDMInfoMustWrite(grey_box_model* model, void* matrix) { model->parts["must"] = matrix; }
void GBsetGuardNESInfo(grey_box_model* model, void* matrix) { model->parts["enable"] = matrix; }
void GBsetGuardNDSInfo(grey_box_model* model, void* matrix) { model->parts["disable"] = matrix; }
void GBsetGuardCoEnabledInfo(grey_box_model* model, void* matrix) {
  model->parts["coexist"] = matrix;
}
void GBsetDoNotAccordInfo(grey_box_model* model, void* matrix) { model->parts["against"] = matrix; }

}  // extern "C"

namespace maide {
namespace {

using State = std::vector<int>;

// One transition: its group, its action's number and the state after it.
struct Transition {
  int group = 0, action = 0;
  State next;
  auto operator<=>(const Transition&) const = default;
};

// A plug-in that is loaded.
class Plugin {
 public:
  explicit Plugin(const std::filesystem::path& file) : library_(::dlopen(file.c_str(), RTLD_NOW)) {
    if (library_ == nullptr) throw std::runtime_error(::dlerror());
    EXPECT_NE(::dlsym(library_, "pins_plugin_name"), nullptr);
    const auto init =
        reinterpret_cast<void (*)(grey_box_model*)>(::dlsym(library_, "pins_model_init"));
    if (init == nullptr) throw std::runtime_error("no pins_model_init");
    init(&model_);
  }
  ~Plugin() {
    for (int group = 0; group < groups(); ++group) std::free(model_.guards[group]);
    std::free(model_.guards);
    for (const auto& [kind, labels] : model_.label_kinds) std::free(labels);
    for (const auto& [name, memory] : model_.parts) {
      matrices.erase(memory);
      std::free(memory);
    }
    ::dlclose(library_);
  }
  Plugin(const Plugin&) = delete;
  Plugin& operator=(const Plugin&) = delete;

  const grey_box_model& model() const { return model_; }
  const Matrix& matrix(const std::string& name) const { return matrices.at(model_.parts.at(name)); }
  int groups() const { return matrix("all").rows; }
  int slots() const { return static_cast<int>(model_.type.slots.size()); }
  int guards() const { return model_.label_kinds.at(1)->count; }
  // Of a group.
  std::vector<int> guards_of(int group) const {
    const list* found = model_.guards[group];
    return {found->item, found->item + found->count};
  }

  std::vector<Transition> next(State state) {
    std::vector<Transition> found;
    const int count = model_.next_of_all(&model_, state.data(), add, &(found_ = &found));
    EXPECT_EQ(static_cast<std::size_t>(count), found.size());
    return found;
  }
  std::vector<Transition> next(State state, int group) {
    std::vector<Transition> found;
    const int count = model_.next_of_group(&model_, group, state.data(), add, &(found_ = &found));
    EXPECT_EQ(static_cast<std::size_t>(count), found.size());
    return found;
  }
  int label(State state, int number) { return model_.label(&model_, number, state.data()); }
  // Of a label with a name.
  bool is_true(const std::string& name, State state) {
    const auto& names = model_.type.labels;
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) throw std::runtime_error("no label " + name);
    return label(std::move(state), static_cast<int>(at - names.begin())) != 0;
  }
  std::vector<int> labels(State state) {
    std::vector<int> all(model_.type.labels.size()), some(all.size(), -1);
    model_.all_labels(&model_, state.data(), all.data());
    model_.labels_of_kind(&model_, 1, state.data(), some.data());
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(all[i], label(state, static_cast<int>(i)));
      EXPECT_EQ(some[i], static_cast<int>(i) < guards() ? all[i] : -1);
    }
    return all;
  }

 private:
  static void add(void* context, transition_info* info, int* next, int* copied) {
    auto& found = **static_cast<std::vector<Transition>**>(context);
    EXPECT_EQ(copied, nullptr);
    // LTSmin's reduction wants a state's transitions in the order of their groups.
    EXPECT_TRUE(found.empty() || found.back().group <= info->group);
    found.push_back({info->group, info->labels[0], State(next, next + slots_of_current_)});
  }
  void* library_;
  grey_box_model model_;
  std::vector<Transition>* found_ = nullptr;

 public:
  static inline std::size_t slots_of_current_ = 0;  // of the plug-in that is explored
};

// Exports and compiles the system.
std::filesystem::path compile(const System& system, const std::filesystem::path& folder) {
  std::ostringstream text;
  write_pins(text, system, system.properties);
  write_file_atomically(folder / "system.cpp", text.str());
  const SubprocessResult compiled = run_program(
      {MAIDE_CXX_COMPILER, "-std=c++17", "-O0", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC",
       "-o", (folder / "system.so").string(), (folder / "system.cpp").string()});
  if (!compiled.succeeded()) throw std::runtime_error(compiled.err);
  return folder / "system.so";
}

// The plug-in's state of a system's.
State slots_of(const System& system, const GlobalState& state, std::size_t slots) {
  State result(state.programs.begin(), state.programs.end());
  result.resize(actor_count(system), 0);  // nobody's
  result.insert(result.end(), state.models.begin(), state.models.end());
  if (result.size() < slots) result.push_back(is_error(system, state) ? 1 : 0);
  return result;
}

// Some step is no progress.
bool some_step_is_idle(const System& system) {
  if (std::any_of(system.nobodys_actions.begin(), system.nobodys_actions.end(),
                  [](const NobodysAction& action) { return !action.counts_for_deadlock; })) {
    return true;
  }
  return std::any_of(system.programs.begin(), system.programs.end(), [](const Program& program) {
    return std::any_of(program.edges.begin(), program.edges.end(),
                       [&](const ProgramEdge& edge) { return !program.is_progress(edge); });
  });
}

// What was met, of all systems.
struct Totals {
  std::size_t deadlocks = 0, errors = 0, cuts = 0, independent_pairs = 0, accordant_pairs = 0;
};

class Comparison {
 public:
  Comparison(const System& system, Plugin& plugin, Totals& totals)
      : system_(system), plugin_(plugin), totals_(totals), names_(system) {
    Plugin::slots_of_current_ = static_cast<std::size_t>(plugin.slots());
    has_idle_steps_ = some_step_is_idle(system);
  }

  // Every state of the system, but at most so many.
  void explore(std::size_t limit) {
    visit(initial_state(system_));
    EXPECT_EQ(states_.front(), plugin_.model().initial);
    for (std::size_t at = 0; at < open_.size() && at < limit; ++at) {
      const GlobalState state = open_[at];  // a copy: more are found
      const State slots = states_[at];
      compare_steps(state, slots);
      compare_labels(state, slots);
      if (testing::Test::HasFailure()) return;
    }
    states_.resize(std::min(states_.size(), limit));
  }

  // What the matrices say, of the states that were seen.
  void try_matrices() {
    for (const State& state : states_) {
      const std::vector<int> labels = plugin_.labels(state);
      std::vector<std::vector<Transition>> next;
      for (int group = 0; group < plugin_.groups(); ++group) {
        next.push_back(plugin_.next(state, group));
        const auto guards = plugin_.guards_of(group);
        const bool is_enabled = std::all_of(guards.begin(), guards.end(), [&](int guard) {
          return labels[static_cast<std::size_t>(guard)] != 0;
        });
        EXPECT_EQ(is_enabled, !next.back().empty()) << "group " << group;
      }
      try_dependencies(state, labels, next);
      try_guards(labels, next);
      try_accordance(next);
      if (testing::Test::HasFailure()) return;
    }
  }

  std::size_t states() const { return states_.size(); }

 private:
  void visit(const GlobalState& state) {
    State slots = slots_of(system_, state, static_cast<std::size_t>(plugin_.slots()));
    if (!seen_.insert(slots).second) return;
    open_.push_back(state);
    states_.push_back(std::move(slots));
  }

  void compare_steps(const GlobalState& state, const State& slots) {
    std::multiset<std::pair<std::string, State>> expected, found, in_groups;
    for (const Step& step : enabled_steps(system_, state)) {
      GlobalState next = apply(system_, state, step);
      totals_.cuts += next.is_cut ? 1 : 0;
      if (next.is_cut) next = state;
      expected.emplace(names_.of(action_of(system_, step)), slots_of(system_, next, slots.size()));
      visit(next);
    }
    const auto add = [&](const Transition& transition, auto& all) {
      all.emplace(plugin_.model().actions.at(transition.action), transition.next);
      std::vector<int> groups(static_cast<std::size_t>(plugin_.groups()));
      const int count =
          plugin_.model().groups_of_edge(nullptr, 0, transition.action, groups.data());
      groups.resize(static_cast<std::size_t>(count));
      EXPECT_THAT(groups, testing::Contains(transition.group));
    };
    for (const Transition& transition : plugin_.next(slots)) add(transition, found);
    for (int group = 0; group < plugin_.groups(); ++group) {
      for (const Transition& transition : plugin_.next(slots, group)) add(transition, in_groups);
    }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(in_groups, expected);
  }

  void compare_labels(const GlobalState& state, const State& slots) {
    const bool is_dead = is_deadlock(system_, state);
    EXPECT_EQ(plugin_.is_true("deadlock", slots), is_dead);
    EXPECT_EQ(plugin_.is_true("error", slots), is_error(system_, state));
    const std::vector<Step> steps = enabled_steps(system_, state);
    EXPECT_EQ(
        plugin_.is_true("beyond", slots),
        std::any_of(steps.begin(), steps.end(), [](const Step& step) { return step.is_cut; }));
    if (!has_idle_steps_) {
      EXPECT_EQ(steps.empty() && !plugin_.is_true("valid_end_state", slots), is_dead);
    }
    for (const Property& property : system_.properties) {
      if (!why_no_label(system_, property).empty()) continue;
      const auto value = [&](const Atom& atom, std::size_t) {
        return is_true(atom, system_, state, nullptr);
      };
      EXPECT_EQ(plugin_.is_true("always_" + property.name, slots),
                is_error(system_, state) || holds_on_lasso(property.formula->left, 1, 0, value))
          << property.name;
    }
    totals_.deadlocks += is_dead ? 1 : 0;
    totals_.errors += is_error(system_, state) ? 1 : 0;
  }

  // Slots that a group or label does not read make no difference, and those that it does not write
  // stay.
  void try_dependencies(const State& state, const std::vector<int>& labels,
                        const std::vector<std::vector<Transition>>& next) {
    const State& other = states_[states_.size() / 2];
    for (int slot = 0; slot < plugin_.slots(); ++slot) {
      const auto at = static_cast<std::size_t>(slot);
      State changed = state;
      changed[at] = other[at];
      for (int group = 0; group < plugin_.groups(); ++group) {
        const bool may_write = plugin_.matrix("may").at(group, slot);
        EXPECT_EQ(may_write, plugin_.matrix("must").at(group, slot));
        EXPECT_EQ(plugin_.matrix("all").at(group, slot),
                  may_write || plugin_.matrix("read").at(group, slot));
        for (const Transition& transition : next[static_cast<std::size_t>(group)]) {
          EXPECT_TRUE(may_write || transition.next[at] == state[at]);
        }
        if (plugin_.matrix("read").at(group, slot)) continue;
        std::vector<Transition> expected = next[static_cast<std::size_t>(group)];
        for (Transition& transition : expected) {
          if (!may_write) transition.next[at] = changed[at];
        }
        EXPECT_EQ(plugin_.next(changed, group), expected);
      }
      for (std::size_t label = 0; label < labels.size(); ++label) {
        const auto number = static_cast<int>(label);
        if (plugin_.matrix("seen").at(number, slot)) continue;
        EXPECT_EQ(plugin_.label(changed, number), labels[label]);
      }
    }
  }

  void try_guards(const std::vector<int>& labels,
                  const std::vector<std::vector<Transition>>& next) {
    for (int group = 0; group < plugin_.groups(); ++group) {
      for (const Transition& transition : next[static_cast<std::size_t>(group)]) {
        const std::vector<int> after = plugin_.labels(transition.next);
        for (std::size_t label = 0; label < labels.size(); ++label) {
          const auto number = static_cast<int>(label);
          if (labels[label] < after[label]) {
            EXPECT_TRUE(plugin_.matrix("enable").at(number, group)) << label << " by " << group;
          } else if (labels[label] > after[label]) {
            EXPECT_TRUE(plugin_.matrix("disable").at(number, group)) << label << " by " << group;
          }
        }
      }
    }
    for (int one = 0; one < plugin_.guards(); ++one) {
      for (int other = 0; other < plugin_.guards(); ++other) {
        if (labels[static_cast<std::size_t>(one)] != 0 &&
            labels[static_cast<std::size_t>(other)] != 0) {
          EXPECT_TRUE(plugin_.matrix("coexist").at(one, other)) << one << " and " << other;
        }
      }
    }
  }

  // Groups that accord leave each other possible, and both orders come to the same states.
  void try_accordance(const std::vector<std::vector<Transition>>& next) {
    const auto ends = [&](int first, int second) -> std::optional<std::set<State>> {
      std::set<State> found;
      for (const Transition& transition : next[static_cast<std::size_t>(first)]) {
        const auto then = plugin_.next(transition.next, second);
        if (then.empty()) return std::nullopt;
        for (const Transition& end : then) found.insert(end.next);
      }
      return found;
    };
    for (int one = 0; one < plugin_.groups(); ++one) {
      for (int other = 0; other < plugin_.groups(); ++other) {
        if (one == other || next[static_cast<std::size_t>(one)].empty() ||
            next[static_cast<std::size_t>(other)].empty()) {
          continue;
        }
        const auto there = ends(one, other), back = ends(other, one);
        const bool is_independent = there && back && *there == *back;
        totals_.independent_pairs += is_independent ? 1 : 0;
        if (plugin_.matrix("against").at(one, other)) continue;
        ++totals_.accordant_pairs;
        EXPECT_TRUE(is_independent) << one << " and " << other;
      }
    }
  }

  const System& system_;
  Plugin& plugin_;
  Totals& totals_;
  ActionNames names_;
  bool has_idle_steps_ = false;
  std::set<State> seen_;
  std::vector<GlobalState> open_;
  std::vector<State> states_;
};

// A condition over the places of the first program and of the last.
Property random_invariant(const System& system, const std::string& name) {
  const auto atom = [&](Atom::Kind kind, std::size_t owner) {
    FormulaNode node;
    node.op = FormulaNode::Operator::atom;
    node.atom = {kind, static_cast<std::uint32_t>(owner), 0};
    return std::make_shared<const FormulaNode>(node);
  };
  FormulaNode one, both, always;
  one.op = FormulaNode::Operator::negation;
  one.left = system.programs.back().labels.empty()
                 ? atom(Atom::Kind::end, system.programs.size() - 1)
                 : atom(Atom::Kind::label, system.programs.size() - 1);
  both.op = FormulaNode::Operator::implication;
  both.left = std::make_shared<const FormulaNode>(one);
  both.right = atom(Atom::Kind::end, 0);
  always.op = FormulaNode::Operator::globally;
  always.left = std::make_shared<const FormulaNode>(both);
  Property property;
  property.name = name;
  property.formula = std::make_shared<const FormulaNode>(always);
  return property;
}

// Whether it has a dozen states, and a run that is cut if that is asked for.
bool is_worth_a_compiler(const System& system, bool wants_cut) {
  std::vector<GlobalState> open{initial_state(system)};
  bool has_cut = false;
  for (std::size_t at = 0; at < open.size() && at < 100; ++at) {
    const GlobalState state = open[at];
    for (const Step& step : enabled_steps(system, state)) {
      const GlobalState next = apply(system, state, step);
      has_cut = has_cut || next.is_cut;
      const bool is_new = std::find(open.begin(), open.end(), next) == open.end();
      if (!next.is_cut && is_new) open.push_back(next);
    }
  }
  return open.size() >= 12 && (has_cut || !wants_cut);
}

TEST(PinsExport, RandomSystemsAreExploredStepByStep) {
  constexpr int count = 24;
  constexpr std::size_t most_states = 150;
  Random random(58);
  Totals totals;
  for (int compared = 0; compared < count;) {
    const test::JointSystemKinds kinds{true, compared % 3 == 1, true, false, compared % 2 == 1};
    System system = compared % 3 == 0
                        ? test::random_system(random)
                        : test::random_joint_system(random, {1, 3, 3, 0.5, 0.5}, kinds);
    const bool wants_cut = compared % 4 < 2;
    if (wants_cut) {
      for (ModelInstance& model : system.models) model.when_unexplored = WhenUnexplored::stop;
    }
    if (!is_worth_a_compiler(system, wants_cut)) continue;
    system.properties = {random_invariant(system, "condition")};
    const TempDir folder;
    Plugin plugin(compile(system, folder.path()));
    Comparison comparison(system, plugin, totals);
    comparison.explore(most_states);
    comparison.try_matrices();
    ++compared;
    ASSERT_FALSE(HasFailure()) << test::show(system)
                               << read_file((folder.path() / "system.cpp").string());
  }
  EXPECT_GT(totals.deadlocks, 10U);
  EXPECT_GT(totals.errors, 5U);
  EXPECT_GT(totals.cuts, 5U);
  EXPECT_GT(totals.accordant_pairs, 100U);
  // Most of what is independent wherever it was met is known to be.
  EXPECT_GT(totals.accordant_pairs * 2, totals.independent_pairs);
}

// With shared variables, topics, executors, and what is always true of them.
TEST(PinsExport, ExamplesAreExploredStepByStep) {
  Totals totals;
  std::size_t conditions = 0;
  for (const char* name : {"cell", "double-buffer-mended", "election", "heartbeats", "lifecycle"}) {
    const std::string file =
        fmt::format("{}/examples/architectures/{}.yaml", MAIDE_SOURCE_DIR, name);
    const System system = read_system(file);
    for (const Property& property : system.properties) {
      conditions += why_no_label(system, property).empty() ? 1 : 0;
    }
    const TempDir folder;
    Plugin plugin(compile(system, folder.path()));
    Comparison comparison(system, plugin, totals);
    comparison.explore(400);
    comparison.try_matrices();
    EXPECT_GT(comparison.states(), 15U) << name;
    ASSERT_FALSE(HasFailure()) << name;
  }
  EXPECT_GT(conditions, 0U);
}

}  // namespace
}  // namespace maide
