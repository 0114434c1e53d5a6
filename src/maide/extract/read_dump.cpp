#include "maide/extract/read_dump.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/extract/dump_expressions.hpp"
#include "maide/extract/dump_statements.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

class ConfigurationReader {
 public:
  ConfigurationReader(const DumpConfiguration& dump, Sources& sources)
      : dump_(dump),
        sources_(sources),
        variables_(dump.variables.size(), none),
        expressions_(dump, variables_, functions_),
        statements_(dump, expressions_, variables_) {}

  void read() {
    add_classes();
    add_variables();
    add_functions();
    for (const auto& [index, body] : bodies_) read_body(index, body);
    for (const int variable : with_initialiser_) read_initialiser(variable);
    count_mentions();
    check_bodies();
    check_outside();
  }

 private:
  const DumpToken& at(int token) const { return dump_.tokens[static_cast<std::size_t>(token)]; }
  const DumpScope& scope(int index) const { return dump_.scopes[static_cast<std::size_t>(index)]; }
  static bool is_class(const DumpScope& scope) {
    return scope.type == "Class" || scope.type == "Struct" || scope.type == "Union";
  }
  bool is(int token, std::string_view text) const {
    return token >= 0 && token < static_cast<int>(dump_.tokens.size()) && at(token).text == text;
  }

  std::string name_of(int index) const {
    if (index == nothing) return {};
    const DumpScope& here = scope(index);
    std::string outer;
    for (int i = here.outer; i != nothing; i = scope(i).outer) {
      if (!is_class(scope(i)) && scope(i).type != "Namespace") continue;
      outer = name_of(i);
      break;
    }
    if (!is_class(here) && here.type != "Namespace" && here.type != "Enum") return outer;
    if (here.name.empty()) return outer;
    return outer.empty() ? here.name : outer + "::" + here.name;
  }

  void add_classes() {
    for (std::size_t i = 0; i < dump_.scopes.size(); ++i) {
      const DumpScope& here = scope(static_cast<int>(i));
      const bool is_enumeration = here.type == "Enum";
      if ((!is_class(here) && !is_enumeration) || here.begin == nothing) continue;
      Class& entry = sources_.classes[name_of(static_cast<int>(i))];
      const Place place = expressions_.place(here.begin);
      if (!entry.name.empty() && entry.place != place && !is_enumeration) {
        sources_.faults.emplace_back(place, "another class of the name " + entry.name);
      }
      entry.name = name_of(static_cast<int>(i));
      entry.is_enumeration = is_enumeration;
      entry.place = place;
    }
    for (const DumpClass& type : dump_.classes) {
      if (type.scope == nothing) continue;
      Class& entry = sources_.classes[name_of(type.scope)];
      if (!entry.bases.empty()) continue;
      for (const int token : type.bases) {
        int end = token;
        while (!is(end, ",") && !is(end, "{") && !is(end, ";")) {
          end = is(end, "<") && at(end).link != nothing ? at(end).link + 1 : end + 1;
        }
        entry.bases.push_back(class_of_type(expressions_.text(token, end)));
      }
    }
  }

  void add_variables() {
    std::map<std::pair<Place, std::string>, int> known;
    for (std::size_t i = 0; i < sources_.variables.size(); ++i) {
      const Variable& variable = sources_.variables[i];
      known[{variable.place, variable.name}] = static_cast<int>(i);
    }
    for (std::size_t i = 0; i < dump_.variables.size(); ++i) {
      const DumpVariable& found = dump_.variables[i];
      if (found.name == nothing) continue;
      Variable variable;
      variable.name = at(found.name).text;
      variable.place = expressions_.place(found.name);
      const auto place = known.find({variable.place, variable.name});
      const std::string text = is_member(found) ? declaration_of(found) : "";
      if (place != known.end() && is_member(found)) {
        variables_[i] = place->second;
        if (sources_.variables[static_cast<std::size_t>(place->second)].text != text) {
          sources_.faults.emplace_back(variable.place,
                                       "code that differs from configuration to configuration");
        }
        continue;
      }
      variable.text = text;
      variable.type = found.type_begin == nothing || found.type_end == nothing
                          ? ""
                          : expressions_.text(found.type_begin, found.type_end + 1);
      variable.is_reference = found.is_reference;
      variable.is_pointer = found.is_pointer;
      variable.is_array = is(found.name + 1, "[");
      const bool says_const = variable.type.starts_with("const ");
      if (variable.is_array && found.is_const && !says_const) variable.type.insert(0, "const ");
      variable.is_static = found.is_static;
      variable.is_extern = found.is_extern;
      variable.is_local = found.access == "Local" || found.access == "Argument";
      if (is_member(found)) variable.of_class = name_of(found.scope);
      variables_[i] = static_cast<int>(sources_.variables.size());
      if (!variable.of_class.empty()) {
        sources_.classes[variable.of_class].members.push_back(variables_[i]);
      }
      if (!variable.is_local) with_initialiser_.push_back(static_cast<int>(i));
      sources_.variables.push_back(std::move(variable));
    }
  }

  // From its name to the end of its first value.
  std::string declaration_of(const DumpVariable& variable) const {
    const auto end_of = [&](int token) {
      while (token < static_cast<int>(dump_.tokens.size()) && !is(token, ";")) {
        token = at(token).link > token ? at(token).link + 1 : token + 1;
      }
      return token;
    };
    int end = end_of(variable.name);
    // The front end makes `int k; k = 1;` of `int k = 1;`.
    if (is(end + 1, at(variable.name).text) && is(end + 2, "=")) end = end_of(end + 1);
    return expressions_.text(variable.name, end);
  }

  bool is_member(const DumpVariable& variable) const {
    return variable.scope != nothing && is_class(scope(variable.scope)) &&
           variable.access != "Local" && variable.access != "Argument";
  }

  void add_functions() {
    std::map<Place, std::vector<int>> known;
    for (std::size_t i = 0; i < sources_.functions.size(); ++i) {
      known[sources_.functions[i].place].push_back(static_cast<int>(i));
    }
    for (const bool are_lambdas : {false, true}) {
      for (std::size_t i = 0; i < dump_.functions.size(); ++i) {
        if ((dump_.functions[i].type == "Lambda") == are_lambdas) {
          add_function(static_cast<int>(i), known);
        }
      }
    }
  }

  void add_function(int index, const std::map<Place, std::vector<int>>& known) {
    const DumpFunction& found = dump_.functions[static_cast<std::size_t>(index)];
    const int body = body_of(index);
    note_declaration(found, body != nothing);
    if (body == nothing || found.token == nothing) return;
    Function function = make(found);
    // With parameters and initialisers.
    function.text = expressions_.text(function.is_lambda ? body : found.token, at(body).link + 1);
    if (function.is_lambda && is_skipped(body)) return;
    const auto here = known.find(function.place);
    if (!function.is_lambda && here != known.end()) {
      for (const int other : here->second) {
        const Function& same = sources_.functions[static_cast<std::size_t>(other)];
        if (same.name != function.name || same.of_class != function.of_class) continue;
        functions_[index] = other;  // a header's, of another file, or of another configuration
        skipped_.insert(body);
        if (same.text != function.text) {  // a macro means something else here
          sources_.faults.emplace_back(function.place,
                                       "code that differs from configuration to configuration");
        }
        return;
      }
    }
    functions_[index] = static_cast<int>(sources_.functions.size());
    bodies_.emplace_back(index, body);
    sources_.functions.push_back(std::move(function));
  }

  // A lambda is a part of the function around it, and read with that.
  bool is_skipped(int brace) const {
    return std::ranges::any_of(skipped_,
                               [&](int body) { return body < brace && brace < at(body).link; });
  }

  // What is declared and has no body in this file may have one in a file that is read later.
  void note_declaration(const DumpFunction& found, bool has_body) {
    if (found.scope == nothing) return;
    const bool is_own = is_class(scope(found.scope));
    const std::string scope_name = name_of(found.scope);
    if (is_own) sources_.classes[scope_name].declared.insert(found.name);
    if (has_body || found.type == "Lambda" || found.declared == nothing || is_made(found)) return;
    Declaration declaration;
    declaration.name = scope_name.empty() ? found.name : scope_name + "::" + found.name;
    declaration.is_method = is_own;
    declaration.parameters = parameter_types_of(found);
    sources_.declarations.push_back(std::move(declaration));
  }

  // `= default`, `= delete`, or a pure one: no body is elsewhere.
  bool is_made(const DumpFunction& found) const {
    if (!is(found.declared + 1, "(")) return false;
    int i = at(found.declared + 1).link + 1;
    while (i > 0 && !is(i, ";") && !is(i, "{") && !is(i, "=")) ++i;
    return is(i, "=") && (is(i + 1, "default") || is(i + 1, "delete"));
  }

  std::vector<std::string> parameter_types_of(const DumpFunction& found) const {
    std::vector<std::string> types;
    for (const int argument : found.arguments) {
      std::string type;
      if (argument != nothing) {
        const DumpVariable& variable = dump_.variables[static_cast<std::size_t>(argument)];
        if (variable.type_begin != nothing && variable.type_end != nothing) {
          type = expressions_.text(variable.type_begin, variable.type_end + 1);
        }
      }
      types.push_back(type);
    }
    return types;
  }

  int body_of(int function) const {
    for (const DumpScope& here : dump_.scopes) {
      if (here.function == function && (here.type == "Function" || here.type == "Lambda")) {
        return here.begin;
      }
    }
    return nothing;
  }

  Function make(const DumpFunction& found) {
    Function function;
    function.name = found.name;
    function.place = expressions_.place(found.token);
    function.is_lambda = found.type == "Lambda";
    function.is_constructor = found.type.find("Constructor") != std::string::npos;
    function.is_destructor = found.type == "Destructor";
    if (function.is_destructor) function.name = "~" + function.name;
    function.is_static = found.is_static;
    function.is_virtual = found.is_virtual;
    for (int token : {found.token, found.declared}) {
      if (token == nothing || function.is_lambda || !is(token + 1, "(")) continue;
      for (int i = at(token + 1).link + 1;
           i != nothing && !is(i, "{") && !is(i, ";") && !is(i, ":"); ++i) {
        if (is(i, "override") || is(i, "final")) function.is_virtual = true;
        if (is(i, "noexcept")) function.is_noexcept = true;
      }
    }
    if (found.scope != nothing) {
      std::string& owner = is_class(scope(found.scope)) ? function.of_class : function.scope;
      owner = name_of(found.scope);
    }
    for (const int argument : found.arguments) add_parameter(function, argument);
    return function;
  }

  void add_parameter(Function& function, int argument) {
    function.defaults.emplace_back();
    const int variable =
        argument == nothing ? none : variables_[static_cast<std::size_t>(argument)];
    function.parameters.push_back(variable);
    std::string type;
    if (argument != nothing) {
      const DumpVariable& found = dump_.variables[static_cast<std::size_t>(argument)];
      if (found.type_begin != nothing && found.type_end != nothing) {
        type = expressions_.text(found.type_begin, found.type_end + 1);
      }
      if (found.name != nothing && is(found.name + 1, "=") && at(found.name + 1).right != nothing) {
        function.defaults.back().push_back(expressions_.read(at(found.name + 1).right));
      }
    }
    function.parameter_types.push_back(type);
  }

  void read_body(int function, int body) {
    const DumpFunction& found = dump_.functions[static_cast<std::size_t>(function)];
    Function& target = sources_.functions[static_cast<std::size_t>(functions_[function])];
    if (!target.is_lambda && is(found.token + 1, "(")) {
      const int close = at(found.token + 1).link;
      if (target.is_constructor) read_initialisers(close + 1, body, target);
    }
    target.body = statements_.read_block(body);
  }

  // : member(arguments), Base{arguments} {
  void read_initialisers(int begin, int body, Function& target) {
    int token = begin;
    while (token < body && !is(token, ":")) ++token;
    for (++token; token < body;) {
      Initialiser initialiser;
      initialiser.place = expressions_.place(token);
      const int first = token;
      while (token < body && !is(token, "(") && !is(token, "{")) {
        token = is(token, "<") && at(token).link != nothing ? at(token).link + 1 : token + 1;
      }
      if (token >= body) {
        sources_.faults.emplace_back(initialiser.place, "an initialiser of no known form");
        return;
      }
      initialiser.member = class_of_type(expressions_.text(first, token));
      const int inner = at(token).right != nothing                 ? at(token).right
                        : at(token).left > token && is(token, "{") ? at(token).left
                                                                   : nothing;
      initialiser.arguments = expressions_.read_arguments(inner);
      if (inner == nothing && at(token).link != token + 1) {
        sources_.faults.emplace_back(initialiser.place, "an initialiser of no known form");
      }
      target.initialisers.push_back(std::move(initialiser));
      token = at(token).link + 1;
      if (is(token, ",")) ++token;
    }
  }

  void read_initialiser(int variable) {
    const int name = dump_.variables[static_cast<std::size_t>(variable)].name;
    Variable& target =
        sources_
            .variables[static_cast<std::size_t>(variables_[static_cast<std::size_t>(variable)])];
    std::vector<Expression> arguments;
    target.is_set = statements_.read_initialiser(name, arguments);
    target.has_value = target.is_set || is(name + 1, "(") || is(name + 1, "{");
    target.arguments = std::move(arguments);
  }

  void count_mentions() {
    std::map<Mention, int> here;
    for (const DumpToken& token : dump_.tokens) {
      if (token.is_name) ++here[{token.file, token.line, token.text}];
    }
    for (const auto& [mention, count] : here) {
      int& most = sources_.mentions[mention];
      most = std::max(most, count);
    }
  }

  // Each token of a body that was read is in a tree.
  void check_bodies() {
    static const std::set<std::string> silent{"(", ")", ",", "]", "}", ">", ";"};
    for (const auto& [function, body] : bodies_) {
      for (int i = body; i <= at(body).link; ++i) {
        const bool is_silent = silent.contains(at(i).text);
        const int uses = expressions_.uses(i);
        if (uses == 1 || is_silent) continue;
        sources_.faults.emplace_back(expressions_.place(i),
                                     "'" + at(i).text +
                                         (uses == 0 ? "' is in no tree" : "' is in two trees") +
                                         " of the front end");
        i = at(body).link;
      }
    }
  }

  // A namespace that is opened again has the scope of the first time.
  bool opens_namespace(int brace) const {
    int i = brace - 1;
    while (i > 0 && (at(i).is_name || is(i, "::")) && !is(i, "namespace")) --i;
    return is(i, "namespace");
  }

  // Code that is in no body: calls of macros that are not known, templates that are not made.
  void check_outside() {
    for (int i = 0; i < static_cast<int>(dump_.tokens.size()); ++i) {
      const DumpToken& token = at(i);
      if (token.scope == nothing) continue;
      const DumpScope& here = scope(token.scope);
      const bool is_body = here.type == "Function" || here.type == "Lambda";
      if (is_body && here.begin == i) {
        i = token.link;
        continue;
      }
      if (token.text != "{" || token.link == nothing || expressions_.uses(i) > 0) continue;
      const bool is_known = std::ranges::any_of(
          dump_.scopes, [i](const DumpScope& scope) { return scope.begin == i; });
      if (is_known || is(i - 1, "=") || token.link == i + 1 || opens_namespace(i)) continue;
      sources_.faults.emplace_back(expressions_.place(i), "code in braces that is no function's");
      i = token.link;
    }
  }

  const DumpConfiguration& dump_;
  Sources& sources_;
  std::vector<int> variables_;
  std::map<int, int> functions_;
  DumpExpressions expressions_;
  DumpStatements statements_;
  std::vector<std::pair<int, int>> bodies_;  // function of the dump, its brace
  std::set<int> skipped_;
  std::vector<int> with_initialiser_;
};

}  // namespace

void read_configuration(const DumpConfiguration& dump, Sources& sources) {
  ConfigurationReader(dump, sources).read();
}

}  // namespace maide::extract
