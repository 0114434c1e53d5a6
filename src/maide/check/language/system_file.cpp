#include "maide/check/language/system_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

constexpr std::size_t max_file_bytes = std::size_t{4} << 20;
constexpr std::size_t max_components = 200;  // models, and programs
constexpr std::size_t max_properties = 1000;
constexpr int max_depth = 100;  // of YAML nesting: its parser recurses

using Entries = std::vector<std::pair<YAML::Node, YAML::Node>>;

class SystemReader {
 public:
  SystemReader(std::string_view text, const std::string& file, const ModelSource& source)
      : text_(text), source_(source) {
    system_.file = file;
    system_.sources.emplace(file, text);
  }

  System read() {
    if (text_.size() > max_file_bytes) {
      throw ParseError("a system file has at most 4 MiB", {system_.file, 0, 0});
    }
    check_nesting();
    const YAML::Node root = load();
    const Entries sections = entries(root, "a system file", {"models", "programs", "properties"});
    const auto section = [&](std::string_view name) {
      for (const auto& [key, value] : sections) {
        if (key.Scalar() == name) return value;
      }
      return YAML::Node(YAML::NodeType::Undefined);
    };
    if (!section("programs")) throw ParseError("there is no 'programs:'", at(root));
    if (const YAML::Node models = section("models")) read_models(models);
    interfaces_ = system_.interfaces();
    read_programs(section("programs"));
    if (const YAML::Node properties = section("properties")) read_properties(properties);
    remark_on_unused_models();
    remark_on_unreachable_statements();
    remark_on_idle_atoms();
    return std::move(system_);
  }

 private:
  SourcePosition at(const YAML::Node& node) const {
    const YAML::Mark mark = node.Mark();
    if (mark.is_null()) return {system_.file, 0, 0};
    return {system_.file, mark.line + 1, mark.column + 1};
  }

  [[noreturn]] void fail(const std::string& message, const YAML::Node& node) const {
    throw ParseError(message, at(node));
  }

  // yaml-cpp recurses for each level; no system file has more than a handful.
  void check_nesting() const {
    int depth = 0, line = 1;
    for (const char c : text_) {
      if (c == '\n') ++line;
      if (c == '[' || c == '{') ++depth;
      if (c == ']' || c == '}') depth = std::max(0, depth - 1);
      if (depth > max_depth)
        throw ParseError("brackets nested too deeply", {system_.file, line, 0});
    }
  }

  YAML::Node load() const {
    try {
      std::vector<YAML::Node> documents = YAML::LoadAll(std::string(text_));
      if (documents.empty() || documents[0].IsNull()) {
        throw ParseError("the system file is empty", {system_.file, 1, 1});
      }
      if (documents.size() > 1) fail("a system file is one YAML document", documents[1]);
      return documents[0];
    } catch (const YAML::Exception& error) {
      throw ParseError("not YAML: " + error.msg,
                       {system_.file, error.mark.line + 1, error.mark.column + 1});
    }
  }

  // The entries of a map, its keys being distinct scalars, and among `known` unless that is empty.
  Entries entries(const YAML::Node& node, const std::string& what,
                  const std::vector<std::string>& known) const {
    if (!node.IsMap()) fail(what + " must be a map (key: value)", node);
    Entries result;
    std::set<std::string> seen;
    for (const auto& entry : node) {
      if (!entry.first.IsScalar() || entry.first.Scalar().empty()) {
        fail("a key of " + what + " must be a word", entry.first);
      }
      const std::string& key = entry.first.Scalar();
      if (!known.empty() && std::find(known.begin(), known.end(), key) == known.end()) {
        fail(what + " has no key '" + key + "'; it may have: " + join(known), entry.first);
      }
      if (!seen.insert(key).second) fail("'" + key + "' is there twice", entry.first);
      result.emplace_back(entry.first, entry.second);
    }
    return result;
  }

  std::string scalar(const YAML::Node& node, const std::string& what) const {
    if (!node.IsScalar()) fail(what + " must be a text", node);
    return node.Scalar();
  }

  ScalarText text_of(const YAML::Node& node) const {
    return ScalarText(node.Scalar(), text_, at(node));
  }

  template <typename Value>
  Value one_of(const YAML::Node& node, const std::string& what,
               const std::vector<std::pair<std::string, Value>>& values) const {
    const std::string word = scalar(node, what);
    std::vector<std::string> known;
    for (const auto& [name, value] : values) {
      if (name == word) return value;
      known.push_back(name);
    }
    fail(what + " is one of " + join(known) + ", not '" + word + "'", node);
  }

  void read_models(const YAML::Node& section) {
    for (const auto& [key, value] : entries(section, "'models'", {})) {
      if (system_.models.size() == max_components) fail("too many models", key);
      read_model(key, value);
    }
  }

  void read_model(const YAML::Node& key, const YAML::Node& value) {
    ModelInstance model;
    model.name = key.Scalar();
    model.position = at(key);
    ModelRequest request;
    request.instance = model.name;
    bool has_file = false;
    for (const auto& [name, node] :
         entries(value, "model '" + model.name + "'",
                 {"file", "learn", "with", "learning", "when_unexplored", "when_weak"})) {
      const std::string& word = name.Scalar();
      if (word == "when_unexplored") {
        model.when_unexplored = one_of<WhenUnexplored>(node, "'when_unexplored'",
                                                       {{"stop", WhenUnexplored::stop},
                                                        {"wait", WhenUnexplored::wait},
                                                        {"drop", WhenUnexplored::drop}});
      } else if (word == "when_weak") {
        model.when_weak = one_of<WhenWeak>(
            node, "'when_weak'",
            {{"inconclusive", WhenWeak::inconclusive}, {"accept", WhenWeak::accept}});
      } else if (word == "with" || word == "learning") {
        auto& options = word == "with" ? request.with : request.learning;
        for (const auto& [option, setting] : entries(node, "'" + word + "'", {})) {
          options.emplace_back(option.Scalar(), scalar(setting, "an option's value"));
        }
      } else {
        if (!request.position.file.empty()) fail("a model has 'file' or 'learn', not both", name);
        request.position = at(node);
        has_file = word == "file";
        (has_file ? model.origin : request.learn) = scalar(node, "'" + word + "'");
        if (node.Scalar().empty()) fail("'" + word + "' is empty", node);
      }
    }
    if (request.position.file.empty()) {
      fail("model '" + model.name + "' needs 'file:' or 'learn:'", key);
    }
    if (has_file && !(request.with.empty() && request.learning.empty())) {
      fail("'with' and 'learning' go with 'learn'; a model from a file has its options behind it",
           key);
    }
    if (has_file) {
      request.file = std::filesystem::path(system_.file).parent_path() / model.origin;
    } else {
      model.origin = request.learn;
      model.is_learned = true;
    }
    model.automaton = source_(request);
    if (model.automaton.size() == 0) fail("model '" + model.name + "' has no state", key);
    system_.models.push_back(std::move(model));
  }

  void read_programs(const YAML::Node& section) {
    for (const auto& [key, value] : entries(section, "'programs'", {})) {
      if (system_.programs.size() == max_components) fail("too many programs", key);
      if (value.IsMap()) {
        entries(value, "program '" + key.Scalar() + "'", {"source", "entry"});
        fail("programs out of sources are not built yet: write '" + key.Scalar() +
                 "' in the program language",
             value);
      }
      scalar(value, "program '" + key.Scalar() + "'");
      system_.programs.push_back(parse_program(key.Scalar(), text_of(value), interfaces_));
    }
    if (system_.programs.empty()) fail("there is no program", section);
  }

  void read_properties(const YAML::Node& section) {
    for (const auto& [key, value] : entries(section, "'properties'", {})) {
      if (system_.properties.size() == max_properties) fail("too many properties", key);
      if (key.Scalar() == "deadlock" || key.Scalar() == "stuck") {
        fail("'" + key.Scalar() + "' is always there; give this property another name", key);
      }
      read_property(key, value);
    }
  }

  void read_property(const YAML::Node& key, const YAML::Node& value) {
    Property property;
    property.name = key.Scalar();
    property.position = at(key);
    if (value.IsScalar()) {
      property.formula = formula(value);
    } else {
      bool has_fairness = false, is_invariant = false;
      for (const auto& [name, node] : entries(value, "property '" + property.name + "'",
                                              {"ltl", "always", "never", "fairness"})) {
        if (name.Scalar() == "fairness") {
          has_fairness = true;
          property.fairness = one_of<Fairness>(
              node, "'fairness'",
              {{"none", Fairness::none}, {"weak", Fairness::weak}, {"strong", Fairness::strong}});
          continue;
        }
        if (property.formula || property.never) {
          fail("a property has one of 'ltl', 'always' and 'never'", name);
        }
        if (name.Scalar() == "never") {
          property.kind = Property::Kind::never;
          property.never = read_never(node);
          continue;
        }
        is_invariant = name.Scalar() == "always";
        scalar(node, "'" + name.Scalar() + "'");
        property.formula = is_invariant ? invariant(node) : formula(node);
      }
      if (!property.formula && !property.never) {
        fail("a property needs 'ltl:', 'always:' or 'never:'", key);
      }
      if (is_invariant && has_fairness) fail("an invariant does not depend on fairness", key);
    }
    system_.properties.push_back(std::move(property));
  }

  Formula formula(const YAML::Node& node) const {
    if (!node.IsScalar()) fail("a property must be a formula or a map", node);
    const ScalarText text = text_of(node);
    if (text.has_tag()) {
      fail("to YAML, this '!' begins a tag and no formula: put the formula in quotes", node);
    }
    return parse_formula(text, {system_.programs, interfaces_});
  }

  Formula invariant(const YAML::Node& node) const {
    Formula expression = formula(node);
    if (!is_boolean(expression)) {
      fail("'always' takes an expression without X, F, G, U, R, W; use 'ltl' for those", node);
    }
    return std::make_shared<FormulaNode>(
        FormulaNode{FormulaNode::Operator::globally, {}, std::move(expression), nullptr});
  }

  // The automaton of a file, whose name is relative to the system file's folder.
  std::shared_ptr<const LtlAutomaton> read_never(const YAML::Node& node) const {
    const std::filesystem::path file =
        std::filesystem::path(system_.file).parent_path() / scalar(node, "'never'");
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
      fail("there is no file '" + file.string() + "'", node);
    }
    return std::make_shared<LtlAutomaton>(
        read_hoa(read_file(file), file.string(), {system_.programs, interfaces_}));
  }

  void remark_on_unused_models() {
    std::set<std::uint32_t> used;
    for (const Program& program : system_.programs) {
      for (const ProgramEdge& edge : program.edges) {
        if (edge.kind != ProgramEdge::Kind::choice) used.insert(edge.model);
      }
    }
    for (std::uint32_t index = 0; index < system_.models.size(); ++index) {
      const ModelInstance& model = system_.models[index];
      if (used.contains(index)) continue;
      system_.remarks.push_back("no program uses model '" + model.name + "' (" +
                                to_string(model.position) + ")");
    }
  }

  void remark_on_unreachable_statements() {
    for (const Program& program : system_.programs) {
      for (const SourcePosition& place : program.unreachable) {
        system_.remarks.push_back("program " + program.name +
                                  " never comes to this statement: the one before it does not end "
                                  "(" +
                                  to_string(place) + ")");
      }
    }
  }

  // Atoms that hold nowhere, for the program never ends, or never comes to the label.
  void remark_on_idle_atoms() {
    for (const Property& property : system_.properties) {
      for (const Atom& atom : atoms_of(property.formula)) {
        if (atom.is_event()) continue;
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

  std::string_view text_;
  const ModelSource& source_;
  System system_;
  std::vector<ProgramInterface> interfaces_;
};

}  // namespace

InterfaceAutomaton read_requested_model(const ModelRequest& request) {
  if (!request.learn.empty()) {
    throw ParseError("model '" + request.instance + "' is to be learned: run `maide learn " +
                         request.learn + " -o model.dot` and name the file here",
                     request.position);
  }
  std::error_code ignored;
  if (!std::filesystem::exists(request.file, ignored)) {
    throw ParseError("there is no file '" + request.file.string() + "'", request.position);
  }
  Model model = read_model(request.file);
  if (auto* automaton = std::get_if<InterfaceAutomaton>(&model)) return std::move(*automaton);
  throw ParseError("'" + request.file.string() +
                       "' is a Mealy machine and programs meet interface automata (?input, "
                       "!output): `maide learn sim:" +
                       request.file.filename().string() +
                       " -o model.dot --translation eager` makes one of it",
                   request.position);
}

System parse_system(std::string_view text, const std::string& file, const ModelSource& source) {
  return SystemReader(text, file, source).read();
}

System read_system(const std::filesystem::path& path, const ModelSource& source,
                   const RunControl& control) {
  const std::string text = read_file(path, control);
  return parse_system(text, path.string(), source);
}

}  // namespace maide
