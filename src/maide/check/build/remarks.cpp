// What looks like an oversight in a system, a line each.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/build/build_system.hpp"
#include "maide/check/rules/model_words.hpp"

namespace maide {
namespace {

class RemarkWriter {
 public:
  explicit RemarkWriter(System& system) : system_(system) {}

  void note_what_is_unknown() {
    std::vector<std::string> depths, code;
    for (const ModelInstance& model : system_.models) {
      const std::string place = " (" + to_string(model.position) + ")";
      if (has_unknown_depth(model.automaton)) depths.push_back(model.name + place);
      if (const auto callback = find_unknown_code(model.automaton))
        code.push_back(*callback + place);
    }
    if (!depths.empty()) {
      system_.remarks.push_back(
          "'depth: unknown': write how many messages are kept, as in 'depth: 10', for " +
          join(depths, ", "));
    }
    if (!code.empty()) {
      system_.remarks.push_back("'do: unknown': write what is done, or 'skip;', for " +
                                join(code, ", "));
    }
  }

  void note_unused_models() {
    std::set<std::uint32_t> used;
    for (const Program& program : system_.programs) {
      used.insert(program.names.begin(), program.names.end());
    }
    for (std::uint32_t index = 0; index < system_.models.size(); ++index) {
      const ModelInstance& model = system_.models[index];
      if (used.contains(index) || model.source == ModelInstance::Source::variable ||
          model.source == ModelInstance::Source::wire) {
        continue;
      }
      system_.remarks.push_back("no program uses model '" + model.name + "' (" +
                                to_string(model.position) + ")");
    }
  }

  // As in a file whose programs are still to be written.
  void note_silent_connections() {
    std::set<std::uint32_t> written;  // models
    for (const Program& program : system_.programs) {
      for (const ProgramEdge& edge : program.edges) {
        for (const ModelUse& event : program.events_of(edge)) {
          if (event.kind != ModelUse::Kind::give) continue;
          const std::string& input =
              system_.models[event.model].automaton.inputs().name(event.index);
          if (input.starts_with("write")) written.insert(event.model);
        }
      }
    }
    std::vector<std::string> silent;
    for (const TopicInstance& topic : system_.topics) {
      const bool is_written =
          std::any_of(topic.readers.begin(), topic.readers.end(), [&](const auto& reader) {
            return written.contains(reader.model) ||
                   system_.models[reader.model].source == ModelInstance::Source::anybody;
          });
      if (!is_written) silent.push_back("writes " + topic.name);
    }
    for (const ServiceInstance& service : system_.services) {
      const auto& actions = system_.models[service.model].actions;
      const bool is_asked = std::any_of(actions.begin(), actions.end(), [](const auto& action) {
        return action.name.starts_with("send");
      });
      const bool is_open = std::ranges::find(service.clients, "anybody") != service.clients.end();
      if (!is_asked && !is_open) silent.push_back("asks " + service.name);
    }
    const bool is_known = std::none_of(
        system_.models.begin(), system_.models.end(),
        [](const ModelInstance& model) { return find_unknown_code(model.automaton).has_value(); });
    if (!silent.empty() && is_known)
      system_.remarks.push_back("no program " + join(silent, ", or "));
  }

  void note_ends_that_never_match() {
    for (const ModelInstance& model : system_.models) {
      const std::string mismatch = describe_mismatch(model);
      if (mismatch.empty()) continue;
      system_.remarks.push_back(model.name + " delivers nothing: " + mismatch + " (" +
                                to_string(model.position) + ")");
    }
  }

  void note_unused_variables(const std::vector<VariableName>& unused) {
    for (const VariableName& variable : unused) {
      system_.remarks.push_back("no program uses variable '" + variable.leaf.name + "' (" +
                                to_string(variable.position) + ")");
    }
  }

  void note_unreachable_statements() {
    for (const Program& program : system_.programs) {
      for (const SourcePosition& place : program.unreachable) {
        system_.remarks.push_back("program " + program.name +
                                  " never comes to this statement: the one before it does not end "
                                  "(" +
                                  to_string(place) + ")");
      }
    }
  }

  void note_idle_atoms() {
    for (const Property& property : system_.properties) {
      for (const Atom& atom : atoms_of(property.formula)) {
        if (atom.is_event() || atom.kind == Atom::Kind::expression) continue;
        const Program& program = system_.programs[atom.owner];
        const bool is_end = atom.kind == Atom::Kind::end;
        if (is_end ? program.may_end() : program.may_reach(atom.symbol)) continue;
        system_.remarks.push_back("in property '" + property.name + "', " + program.name + "@" +
                                  (is_end ? "end" : program.labels[atom.symbol]) +
                                  " never holds: " + program.name +
                                  (is_end ? " never ends" : " never comes there") + " (" +
                                  to_string(property.position) + ")");
      }
    }
  }

 private:
  System& system_;
};

}  // namespace

void add_remarks(System& system, const std::vector<VariableName>& unused) {
  RemarkWriter writer(system);
  writer.note_what_is_unknown();
  writer.note_unused_models();
  writer.note_silent_connections();
  writer.note_ends_that_never_match();
  writer.note_unused_variables(unused);
  writer.note_unreachable_statements();
  writer.note_idle_atoms();
}

}  // namespace maide
