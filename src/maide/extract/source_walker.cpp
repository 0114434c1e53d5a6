#include "maide/extract/source_walker.hpp"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/type_names.hpp"

namespace maide::extract {

SourceWalker::SourceWalker(const Sources& sources, const ApiTable& table, Model& model,
                           std::set<std::string>& mixed)
    : walk_(sources, table, model, mixed),
      expressions_(walk_),
      statements_(walk_),
      calls_(walk_),
      objects_(walk_),
      rows_(walk_) {
  walk_.expressions = &expressions_;
  walk_.statements = &statements_;
  walk_.calls = &calls_;
  walk_.objects = &objects_;
  walk_.rows = &rows_;
}

void SourceWalker::make_globals() {
  for (std::size_t i = 0; i < walk_.sources.variables.size(); ++i) {
    const Variable& variable = walk_.sources.variables[i];
    const bool is_global = !variable.is_local && (variable.of_class.empty() || variable.is_static);
    if (!is_global || variable.is_extern || variable.type.empty()) continue;
    Value value;
    const Program program = walk_.writer.write(Phase::start, none, [&] {
      value = objects_.first_value(variable, variable.arguments, variable.is_set, variable.place);
    });
    if (has_steps(program.code)) {
      walk_.writer.hole(variable.place, "a global variable whose first value communicates", true);
    }
    const bool is_kept = value.matters() || value.kind == Value::Kind::text;
    if (!is_kept) value = walk_.values.data_of(static_cast<int>(i));
    walk_.values.declare_global(static_cast<int>(i), std::move(value));
  }
}

Program SourceWalker::run(const Value& callable, const std::vector<Value>& arguments, Phase phase,
                          int node) {
  walk_.is_main_over = false;
  Program program =
      walk_.writer.write(phase, node, [&] { calls_.call_value(callable, arguments, Place{}); });
  main_is_over_ = std::exchange(walk_.is_main_over, false);
  return program;
}

Program SourceWalker::make_alone(const Class& entry) {
  std::vector<Value> arguments;
  for (const int maker : walk_.names.all_methods(entry, last_part(entry.name))) {
    arguments.clear();
    const Function& function = walk_.function(maker);
    for (std::size_t i = 0; i < function.parameters.size() && function.defaults[i].empty(); ++i) {
      arguments.push_back(data_value(class_of_type(function.parameter_types[i])));
    }
  }
  return walk_.writer.write(Phase::start, none,
                            [&] { objects_.make(entry.name, arguments, entry.place); });
}

}  // namespace maide::extract
