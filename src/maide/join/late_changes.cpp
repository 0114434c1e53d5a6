#include "maide/join/late_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/check/system/components.hpp"
#include "maide/check/tree/edit.hpp"
#include "maide/check/tree/print.hpp"
#include "maide/check/tree/system_tree.hpp"
#include "maide/join/system_variant.hpp"

namespace maide {
namespace {

using syntax::Statement;
using SelectKind = syntax::SelectArm::Kind;

constexpr std::int64_t usual_depth = 10;  // of a writer that says nothing

// Connections, without indices, that are late, or lose what is on its way.
std::set<std::string> find_connections(const System& system, bool ConnectionInstance::*is) {
  std::set<std::string> names;
  for (const ConnectionInstance& connection : system.connections) {
    if (connection.is_late && connection.*is) names.insert(array_of(connection.name));
  }
  return names;
}

bool is_service(const System& system, const std::string& name) {
  return std::ranges::any_of(system.services, [&](const ServiceInstance& service) {
    return array_of(service.name) == name;
  });
}

// With one blank for several, and for the ends of lines.
std::string on_one_line(const std::string& text) {
  std::string line;
  for (const char letter : text) {
    const bool is_blank = letter == ' ' || letter == '\n';
    if (is_blank && line.ends_with(' ')) continue;
    line += is_blank ? ' ' : letter;
  }
  return line;
}

// Changes of programs' texts: words put in, or other words in place of some.
class CodeChanger {
 public:
  explicit CodeChanger(const System& system)
      : system_(system),
        text_(text_of(system)),
        late_(find_connections(system, &ConnectionInstance::is_late)),
        losing_(find_connections(system, &ConnectionInstance::loses)) {}

  std::vector<LateChange> list() {
    const SystemTree tree = read_tree(text_, system_.file);
    for_each_code(tree.root, [&](const syntax::Code& code) {
      syntax::for_each_statement(code.block, [&](const Statement& statement) { add(statement); });
    });
    std::vector<LateChange> changes = std::move(waits_);
    add_all_waits(changes);
    changes.insert(changes.end(), others_.begin(), others_.end());
    return changes;
  }

 private:
  // A piece of the text: its first byte and the one behind its last.
  struct Piece {
    std::size_t begin = 0, end = 0;
  };

  void add(const Statement& statement) {
    if (statement.kind == Statement::Kind::select) return add_select(statement);
    const bool is_give =
        statement.kind == Statement::Kind::give || statement.kind == Statement::Kind::give_arms;
    const std::string& connection = statement.model.name.text;
    if (!is_give || !late_.contains(connection)) return;
    if (statement.kind == Statement::Kind::give_arms) {
      if (statement.event.name.is("tryread")) add_retry(statement);
    } else if (!is_service(system_, connection)) {
      if (is_sending(statement.event.name.text)) add_wait(statement);
    } else if (statement.event.name.is("receive") && losing_.contains(connection)) {
      add_asking(statement);
    }
  }

  std::optional<std::size_t> offset_of(TextPlace place) const {
    std::size_t begin = 0;
    for (int line = 1; line < place.line; ++line) {
      const std::size_t end = text_.find('\n', begin);
      if (end == std::string::npos) return std::nullopt;
      begin = end + 1;
    }
    const std::size_t offset = begin + static_cast<std::size_t>(place.column) - 1;
    return offset < text_.size() ? std::optional(offset) : std::nullopt;
  }

  // From the place to the semicolon that ends a statement without braces.
  std::optional<Piece> find_statement(TextPlace place) const {
    const auto begin = offset_of(place);
    if (!begin) return std::nullopt;
    const std::size_t end = text_.find_first_of(";{}\n", *begin);
    if (end == std::string::npos || text_[end] != ';') return std::nullopt;
    return Piece{*begin, end + 1};
  }

  // The first pair of braces from there on, without them.
  std::optional<Piece> find_braces(std::size_t from) const {
    const std::size_t open = text_.find('{', from);
    if (open == std::string::npos) return std::nullopt;
    std::size_t depth = 0;
    for (std::size_t at = open; at < text_.size(); ++at) {
      if (text_[at] == '{') ++depth;
      if (text_[at] == '}' && --depth == 0) return Piece{open + 1, at};
    }
    return std::nullopt;
  }

  std::string text_at(const Piece& piece) const {
    return text_.substr(piece.begin, piece.end - piece.begin);
  }

  std::string replaced(const Piece& piece, const std::string& by) const {
    std::string text = text_;
    return text.replace(piece.begin, piece.end - piece.begin, by);
  }

  // ---- At the writer ----------------------------------------------------------------------------

  struct Write {
    std::size_t end = 0;  // of the statement
    std::string model;    // as it is written
    int line = 0;
  };

  void add_wait(const Statement& statement) {
    const auto piece = find_statement(statement.model.begin);
    if (!piece) return;
    const std::string written = text_at(*piece);
    const std::string model = written.substr(0, written.rfind('.', written.find_first_of("(->;")));
    const Write write{piece->end, model, statement.model.begin.line};
    writes_[statement.model.name.text].push_back(write);
    waits_.push_back(
        {statement.model.name.text,
         replaced({piece->end, piece->end}, " wait " + model + " -> arrived;"),
         fmt::format("`wait {} -> arrived;` behind `{}` in line {}", model, written, write.line)});
  }

  void add_all_waits(std::vector<LateChange>& changes) const {
    for (const auto& [connection, writes] : writes_) {
      if (writes.size() < 2) continue;
      std::string text = text_;
      std::vector<std::string> lines;
      for (auto write = writes.rbegin(); write != writes.rend(); ++write) {
        text.insert(write->end, " wait " + write->model + " -> arrived;");
        const std::string line = std::to_string(write->line);
        if (lines.empty() || lines.front() != line) lines.insert(lines.begin(), line);
      }
      changes.push_back(
          {connection, std::move(text),
           fmt::format("`wait {} -> arrived;` behind each write to it (line{} {})",
                       writes.front().model, lines.size() == 1 ? "" : "s", join(lines, " and ")),
           true});
    }
  }

  // ---- At the reader ----------------------------------------------------------------------------

  // `switch m.tryread { message { ... } null { ... } }` in a loop. What follows `null` is kept
  // where control never comes: formulas may name its labels.
  void add_retry(const Statement& statement) {
    const auto begin = offset_of(statement.place);
    if (!begin || text_.compare(*begin, 6, "switch") != 0) return;
    const auto arms = find_braces(*begin);
    if (!arms) return;
    std::string changed = text_at({*begin, arms->begin});
    std::size_t at = arms->begin;
    std::string left_out;
    for (const syntax::Arm& arm : statement.arms) {
      const auto place = offset_of(arm.place);
      const auto body = place ? find_braces(*place) : std::nullopt;
      if (!body || arm.is_quiet || body->begin < at) return;
      const std::string code = text_at(*body);
      if (code.find("break") != std::string::npos || code.find("continue") != std::string::npos) {
        return;
      }
      changed += text_at({at, body->begin});
      const bool is_null = arm.output.name.is("null");
      if (is_null) left_out = code;
      changed += is_null ? " skip; " : code + " break; ";
      at = body->end;
    }
    if (left_out.empty()) return;
    changed += text_at({at, arms->end + 1});
    changed = "loop { " + changed + " }";
    others_.push_back(
        {statement.model.name.text,
         replaced({*begin, arms->end + 1}, changed + " if (1 == 2) {" + left_out + "}"),
         fmt::format("`{}` in line {}: ask again", on_one_line(changed), statement.place.line)});
  }

  // Without `otherwise`, which stays behind a guard that never holds.
  void add_select(const Statement& statement) {
    std::string connection;
    for (const syntax::SelectArm& arm : statement.select_arms) {
      const bool is_of_model = arm.kind == SelectKind::input || arm.kind == SelectKind::output;
      if (is_of_model && late_.contains(arm.model.name.text)) connection = arm.model.name.text;
    }
    if (connection.empty()) return;
    for (const syntax::SelectArm& arm : statement.select_arms) {
      if (arm.kind != SelectKind::otherwise) continue;
      const auto place = offset_of(arm.place);
      constexpr std::string_view word = "otherwise";
      if (!place || text_.compare(*place, word.size(), word) != 0) continue;
      others_.push_back({connection, replaced({*place, *place + word.size()}, "when (1 == 2)"),
                         fmt::format("wait for {} in line {}: no `otherwise`", connection,
                                     statement.place.line)});
    }
  }

  // `s.receive -> answer;` as a time-out after which the request is sent again.
  void add_asking(const Statement& statement) {
    const auto piece = find_statement(statement.model.begin);
    const bool has_body =
        statement.arms.size() != 1 || !statement.arms.front().body.statements.empty();
    if (!piece || has_body) return;
    std::string written = text_at(*piece);
    const std::size_t input = written.find(".receive");
    if (input == std::string::npos) return;
    const std::string model = written.substr(0, input);
    written.pop_back();
    const std::string changed = fmt::format(
        "loop {{ select {{ on {} {{ break; }} timeout 100 {{ {}.send; }} }} }}", written, model);
    others_.push_back({statement.model.name.text, replaced(*piece, changed),
                       fmt::format("`{}` in place of `{};` in line {}", changed, written,
                                   statement.model.begin.line)});
  }

  const System& system_;
  const std::string& text_;
  std::set<std::string> late_, losing_;
  std::vector<LateChange> waits_, others_;
  std::map<std::string, std::vector<Write>> writes_;  // by connection
};

// ---- Two connections as one ---------------------------------------------------------------------

constexpr std::size_t most_pairs_tried = 10;

// A late connection of the file that is no stream, and who has an end of it.
struct LateConnection {
  std::string section, name;
  std::set<std::uint32_t> programs;
};

std::vector<LateConnection> find_late_connections(const System& system,
                                                  const YamlDocument& document) {
  const std::set<std::string> late = find_connections(system, &ConnectionInstance::is_late);
  std::vector<LateConnection> found;
  for (const std::string section : {"models", "topics", "services"}) {
    const YamlNode* const entries = document.root.find(section);
    if (entries == nullptr) continue;
    for (const YamlEntry& entry : entries->entries) {
      const std::string name = array_of(entry.key.value);
      if (!late.contains(name) || entry.value.find("stream") != nullptr) continue;
      found.push_back({section, entry.key.value, {}});
      for (std::uint32_t program = 0; program < system.programs.size(); ++program) {
        for (const std::uint32_t model : models_of(system.programs[program])) {
          const std::string& used = ends_of_wire(system.models[model].name).model;
          if (array_of(used) == name) found.back().programs.insert(program);
        }
      }
    }
  }
  return found;
}

bool have_two_ends_in_common(const LateConnection& one, const LateConnection& other) {
  return std::ranges::count_if(one.programs, [&](std::uint32_t program) {
           return other.programs.contains(program);
         }) >= 2;
}

std::vector<LateChange> list_one_message_changes(const System& system) {
  std::vector<LateChange> changes;
  const YamlDocument before = read_yaml(text_of(system), system.file, "a system file");
  const std::vector<LateConnection> found = find_late_connections(system, before);
  for (auto one = found.begin(); one != found.end(); ++one) {
    for (auto other = one + 1; other != found.end(); ++other) {
      if (!have_two_ends_in_common(*one, *other)) continue;
      if (changes.size() == most_pairs_tried) return changes;
      YamlDocument changed = before;
      for (const LateConnection& each : {*one, *other}) {
        changed.root.at(each.section).at(each.name).set("stream", YamlNode("both"));
      }
      changes.push_back(
          {one->name, print_system(changed),
           fmt::format("{0} and {1} in one message, or on one connection that keeps the order: "
                       "`stream: both` at {0} and {1}",
                       one->name, other->name)});
    }
  }
  return changes;
}

}  // namespace

std::vector<LateChange> list_late_changes(const System& system) {
  if (text_of(system).empty()) return {};
  std::vector<LateChange> changes = CodeChanger(system).list();
  for (LateChange& change : list_one_message_changes(system)) changes.push_back(std::move(change));
  return changes;
}

std::vector<WriterDepth> find_writer_depths(const System& system) {
  std::vector<WriterDepth> places;
  if (text_of(system).empty()) return places;
  const std::set<std::string> late = find_connections(system, &ConnectionInstance::is_late);
  const YamlDocument document = read_yaml(text_of(system), system.file, "a system file");
  for (const std::string section : {"topics", "models"}) {
    const YamlNode* const entries = document.root.find(section);
    if (entries == nullptr) continue;
    for (const YamlEntry& entry : entries->entries) {
      if (!late.contains(array_of(entry.key.value)) || entry.value.find("learn") != nullptr) {
        continue;
      }
      const YamlNode* const with = entry.value.find("with");
      const auto option = [&](const std::string& key) {
        return with == nullptr ? nullptr : with->find(key);
      };
      if (option("size") != nullptr) continue;  // its writer keeps all
      const YamlNode* depth = option("pub-depth");
      if (depth == nullptr) depth = option("depth");
      const auto value =
          depth == nullptr ? std::optional(usual_depth) : parse_number<std::int64_t>(depth->value);
      if (value) places.push_back({section, entry.key.value, *value});
    }
  }
  return places;
}

ChangedText with_writer_depth(const System& system, const WriterDepth& place, std::int64_t value) {
  const YamlDocument before = read_yaml(text_of(system), system.file, "a system file");
  YamlDocument changed = before;
  YamlNode& entry = *changed.root.find(place.section)->find(place.name);
  entry.at("with").set("pub-depth", YamlNode(std::to_string(value)));
  std::vector<std::string> lines;
  for (const YamlEntry& section : difference(changed.root, before.root).entries) {
    lines.push_back(section.key.value + ": " + print_inline(changed, section.value));
  }
  return {print_system(changed), join(lines)};
}

}  // namespace maide
