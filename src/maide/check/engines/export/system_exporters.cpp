#include "maide/check/engines/export/system_exporters.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <deque>
#include <limits>
#include <map>
#include <ostream>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/text.hpp"
#include "maide/check/engines/export/promela_system.hpp"
#include "maide/check/engines/export/step_action.hpp"
#include "maide/check/packed/packed_steps.hpp"
#include "maide/formats/dot_syntax.hpp"

namespace maide {
namespace {

std::uint64_t default_bytes() {
  return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE)) / 4 * 3;
}

constexpr std::array<SystemExporter, 5> table{{
    {"promela", "Promela, SPIN's language", false,
     [](std::ostream& out, const System& system, const SystemExportOptions&) {
       out << write_promela(system).text;
     }},
    {"aut", "the graph of its states, for CADP, mCRL2 and LTSmin", true,
     [](std::ostream& out, const System& system, const SystemExportOptions& options) {
       write_aut(out, system, options.bytes != 0 ? options.bytes : default_bytes(),
                 options.control);
     }},
    {"smv", "the language of NuSMV and nuXmv", false,
     [](std::ostream& out, const System& system, const SystemExportOptions&) {
       write_smv(out, system);
     }},
    {"mcrl2", "mCRL2, the process algebra", false,
     [](std::ostream& out, const System& system, const SystemExportOptions&) {
       write_mcrl2(out, system);
     }},
    {"pins", "C++, a plug-in that LTSmin's engines explore", false,
     [](std::ostream& out, const System& system, const SystemExportOptions&) {
       write_pins(out, system, system.properties);
     }},
}};

}  // namespace

std::span<const SystemExporter> system_exporters() { return table; }

const SystemExporter& find_system_exporter(std::string_view name) {
  return find_row(system_exporters(), "format of systems", name);
}

namespace {

// States in the order of their discovery, and a hash table that finds a state's number.
template <std::size_t words>
class NumberedStates {
 public:
  using State = PackedState<words>;

  std::uint64_t size() const { return states_.size(); }
  const State& operator[](std::uint64_t number) const { return states_[number]; }
  std::uint64_t bytes() const {
    return states_.size() * sizeof(State) + slots_.size() * sizeof(std::uint32_t);
  }

  std::uint32_t number_of(const State& state) {
    if ((states_.size() + 1) * 2 > slots_.size()) grow();
    std::uint32_t& slot = slots_[place_of(state)];
    if (slot == unused) {
      slot = static_cast<std::uint32_t>(states_.size());
      states_.push_back(state);
    }
    return slot;
  }

 private:
  static constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();

  // Where the state is, or where it would be.
  std::size_t place_of(const State& state) const {
    std::uint64_t hash = hash_start;
    for (const std::uint64_t word : state) hash = hash_step(hash ^ (hash >> 31), word);
    std::size_t place = (hash ^ (hash >> 32)) & (slots_.size() - 1);
    while (slots_[place] != unused && states_[slots_[place]] != state) {
      place = (place + 1) & (slots_.size() - 1);
    }
    return place;
  }

  void grow() {
    slots_.assign(slots_.empty() ? 1024 : slots_.size() * 2, unused);
    for (std::size_t number = 0; number < states_.size(); ++number) {
      slots_[place_of(states_[number])] = static_cast<std::uint32_t>(number);
    }
  }

  std::deque<State> states_;
  std::vector<std::uint32_t> slots_;  // a power of two of them, at least half unused
};

template <std::size_t words>
class GraphWriter {
 public:
  GraphWriter(const PackedSystem& packed, std::uint64_t bytes, const RunControl& control)
      : steps_(packed),
        system_(packed.system()),
        bytes_(bytes),
        control_(control),
        names_(system_) {}

  GraphSize write(std::ostream& out) {
    states_.number_of(steps_.initial());
    std::uint64_t transitions = 0;
    walk("exploring", [&](std::uint64_t, const Step&, std::uint32_t) { ++transitions; });
    out << fmt::format("des (0, {}, {})\n", transitions, states_.size());
    walk("writing", [&](std::uint64_t from, const Step& step, std::uint32_t to) {
      out << fmt::format("({}, {}, {})\n", from, label(action_of(system_, step)), to);
    });
    return {states_.size(), transitions};
  }

 private:
  // Calls `visit(from, step, to)` for every step; finds and numbers states as it goes.
  template <typename Visit>
  void walk(std::string_view phase, Visit visit) {
    for (std::uint64_t number = 0; number < states_.size(); ++number) {
      if (number % 1024 == 0) watch(phase, number);
      const auto self = static_cast<std::uint32_t>(number);
      const auto state = states_[number];
      steps_.for_each(state, [&](const auto& next, std::size_t, std::uint32_t, bool is_cut,
                                 std::uint64_t code) {
        visit(number, steps_.undo(next, code).step, is_cut ? self : states_.number_of(next));
      });
    }
  }

  void watch(std::string_view phase, std::uint64_t done) const {
    control_.check("the export");
    control_.report({phase, states_.size(), 0, 0, done, 0});
    if (states_.bytes() <= bytes_ && states_.size() < (std::uint64_t{1} << 31)) return;
    throw Error(ExitStatus::inconclusive,
                fmt::format("the state graph needs more than {} MiB of memory: it has more than {} "
                            "states ({})",
                            bytes_ >> 20, states_.size(), system_.file));
  }

  const std::string& label(const StepAction& action) {
    const auto [entry, is_new] = labels_.try_emplace(action);
    if (is_new) entry->second = quote_dot_label(names_.of(action));
    return entry->second;
  }

  PackedSteps<words> steps_;
  const System& system_;
  std::uint64_t bytes_;
  const RunControl& control_;
  NumberedStates<words> states_;
  ActionNames names_;
  std::map<StepAction, std::string> labels_;
};

}  // namespace

GraphSize write_aut(std::ostream& out, const System& system, std::uint64_t bytes,
                    const RunControl& control) {
  const PackedSystem packed(system);
  return with_words(packed.words(), [&](auto count) {
    return GraphWriter<count.value>(packed, bytes, control).write(out);
  });
}

}  // namespace maide
