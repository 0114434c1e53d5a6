// What the walkers share while they go through functions as they would run.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/api_table.hpp"
#include "maide/extract/code_writer.hpp"
#include "maide/extract/model.hpp"
#include "maide/extract/name_lookup.hpp"
#include "maide/extract/sources.hpp"
#include "maide/extract/type_names.hpp"
#include "maide/extract/value_store.hpp"

namespace maide::extract {

class CallWalker;
class ExpressionWalker;
class ObjectMaker;
class RowReader;
class StatementWalker;

struct Walk {
  Walk(const Sources& all_sources, const ApiTable& api, Model& found, std::set<std::string>& mixed)
      : sources(all_sources),
        table(api),
        model(found),
        names(sources, table),
        writer(model),
        values(sources, model, writer, mixed) {}

  const Sources& sources;
  const ApiTable& table;
  Model& model;
  NameLookup names;
  CodeWriter writer;
  ValueStore values;
  std::set<int> read;       // functions that were gone through
  std::set<int> main_uses;  // nodes whose ends main uses
  int main_executor = none;
  bool is_main_over = false;  // nothing that stands behind is done
  int acting_calls = 0;       // of the statement: those of rows that did something

  StatementWalker* statements = nullptr;
  ExpressionWalker* expressions = nullptr;
  CallWalker* calls = nullptr;
  ObjectMaker* objects = nullptr;
  RowReader* rows = nullptr;

  // main does nothing behind this: it spins for ever, or nothing of it is heard of any more.
  void end_main() {
    is_main_over = !writer.is_conditional();
    writer.raise(writer.fresh("over"));
  }

  const Variable& variable(int index) const {
    return sources.variables[static_cast<std::size_t>(index)];
  }
  const Function& function(int index) const {
    return sources.functions[static_cast<std::size_t>(index)];
  }
  // Whether a function may change what it is given there.
  bool may_be_written(const Function& called, std::size_t parameter) const {
    const std::string& type = called.parameter_types[parameter];
    const int index = called.parameters[parameter];
    const bool is_reference = index == none ? type.ends_with("&") : variable(index).is_reference;
    return is_reference && !type.starts_with("const ");
  }
  Entity& entity(int index) { return model.entities[static_cast<std::size_t>(index)]; }
  Object& object(int index) { return model.objects[static_cast<std::size_t>(index)]; }
  int node_of(const Value& value) {
    return value.kind == Value::Kind::object ? object(value.index).node : none;
  }
};

inline Value data_value(std::string type = {}) {
  Value value;
  value.type = std::move(type);
  return value;
}

inline Value unknown_value() { return data_value("?"); }

// What a wait returned, which that variable of the program says.
inline Value status_value(const std::string& variable, int program) {
  Value value;
  value.kind = Value::Kind::status;
  value.condition = variable;
  value.program = program;
  return value;
}

// std::chrono::seconds(5) is `5s`, if the number is known.
inline Value length_of_time(const std::string& name, const std::string& type,
                            const std::vector<Value>& arguments) {
  Value value = data_value(type);
  if (type != "std::chrono::duration" || arguments.size() != 1) return value;
  value.text = arguments[0].text;
  if (!value.text.empty()) value.text += unit_of_time(last_part(name));
  return value;
}

// Whether a number or length of time is below 0.
enum class Sign : std::uint8_t { positive, negative, unknown };
inline Sign sign_of(const Value& value) {
  const bool is_number = value.kind == Value::Kind::number || value.type == "std::chrono::duration";
  if (!is_number || value.text.empty()) return Sign::unknown;
  return value.text.starts_with('-') ? Sign::negative : Sign::positive;
}

inline std::string negation(const std::string& condition) {
  if (condition.empty()) return {};
  if (condition == "true") return "false";
  if (condition == "false") return "true";
  return "!(" + condition + ")";
}

inline bool any_matters(const std::vector<Value>& values) {
  for (const Value& value : values) {
    if (value.matters()) return true;
  }
  return false;
}

}  // namespace maide::extract
