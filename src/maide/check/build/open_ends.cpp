#include "maide/check/build/open_ends.hpp"

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "maide/base/text.hpp"
#include "maide/check/build/references.hpp"

namespace maide {
namespace {

constexpr Value most_values = 1000;

syntax::Term number_term(Value value, TextPlace place) {
  syntax::Term term;
  term.kind = syntax::Term::Kind::number;
  term.value = value;
  term.place = term.begin = place;
  return term;
}

std::optional<Value> number_in(std::string_view text) {
  Value value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// "3", "true", "go".
syntax::Term value_term(const std::string& text, TextPlace place) {
  if (const auto number = number_in(text)) return number_term(*number, place);
  syntax::Term term;
  term.place = term.begin = place;
  if (text == "true" || text == "false") {
    term.kind = syntax::Term::Kind::boolean;
    term.value = text == "true" ? 1 : 0;
    return term;
  }
  term.kind = syntax::Term::Kind::name;
  term.name = {text, true, place};
  return term;
}

syntax::Code code_of(syntax::Block block, const SourcePosition& position) {
  syntax::Code code;
  code.file = position.file;
  code.begin = code.end = code.last = {position.line, position.column};
  code.block = std::move(block);
  return code;
}

std::uint32_t add_program(Declarations& file, const std::string& name, syntax::Code code,
                          const SourcePosition& position) {
  if (file.programs.size() == max_components) throw ParseError("too many programs", position);
  file.take_name(name, position);
  ProgramDeclaration program;
  program.name = name;
  program.process = "one of " + name;
  program.position = position;
  program.is_anybody = true;
  program.code = std::make_shared<const syntax::Code>(std::move(code));
  file.programs.push_back(std::move(program));
  return static_cast<std::uint32_t>(file.programs.size() - 1);
}

std::string without_blanks(std::string text) {
  std::erase(text, ' ');
  return text;
}

// A bound of a range: a number, or a constant.
std::optional<Value> bound_in(const Declarations& file, const std::string& text) {
  if (const auto number = number_in(text)) return number;
  const auto constant = file.names.constants.find(text);
  if (constant == file.names.constants.end()) return std::nullopt;
  if (constant->second.kind != ValueKind::integer) return std::nullopt;
  return constant->second.value;
}

}  // namespace

bool says(const TreeNode& entry, std::string_view key) {
  const TreeNode* const field = entry.find(key);
  return field != nullptr && field->is("true");
}

std::uint32_t silent_anybody(Declarations& file, const SourcePosition& position) {
  if (!file.silent_anybody) {
    syntax::Statement skip;
    skip.kind = syntax::Statement::Kind::skip;
    skip.place = {position.line, position.column};
    syntax::Block block;
    block.statements.push_back(std::move(skip));
    file.silent_anybody = add_program(file, anybody, code_of(std::move(block), position), position);
  }
  return *file.silent_anybody;
}

std::uint32_t busy_anybody(Declarations& file, const DeclaredArray& array, std::uint64_t member,
                           const std::string& input, const std::vector<std::string>& values,
                           const SourcePosition& position) {
  using Kind = syntax::Statement::Kind;
  const TextPlace place{position.line, position.column};
  syntax::Term model;
  model.kind = syntax::Term::Kind::name;
  model.place = model.begin = place;
  model.name = {array.name, true, place};
  for (const Value index : member_indices(array.dimensions, member)) {
    model.has_indices = true;
    model.operands.push_back(number_term(index, place));
  }
  syntax::Statement select;
  select.kind = Kind::select;
  select.place = place;
  select.is_idle = true;
  for (std::size_t i = 0; i < std::max<std::size_t>(values.size(), 1); ++i) {
    syntax::SelectArm& arm = select.select_arms.emplace_back();
    arm.kind = syntax::SelectArm::Kind::input;
    arm.place = place;
    arm.model = model;
    arm.event.name = {input, true, place};
    if (values.empty()) continue;
    arm.event.has_arguments = true;
    for (const std::string_view value : split(values[i], ',')) {
      arm.event.arguments.push_back({false, value_term(std::string(value), place)});
    }
  }
  syntax::Statement loop;
  loop.kind = Kind::loop;
  loop.place = place;
  loop.body.statements.push_back(std::move(select));
  syntax::Block block;
  block.statements.push_back(std::move(loop));
  return add_program(file, array.member(member) + "." + anybody,
                     code_of(std::move(block), position), position);
}

std::vector<std::string> values_of_anybody(Declarations& file, const TreeNode& entry) {
  std::vector<std::string> values;
  const TreeNode* const field = entry.find("values");
  if (field == nullptr) return values;
  const auto add = [&](std::string text, const YamlNode& node) {
    if (std::ranges::find(values, text) != values.end()) {
      file.tree().fail("the value '" + text + "' is there twice", node);
    }
    values.push_back(std::move(text));
  };
  const auto read = [&](const YamlNode& node) {
    const std::string& text = node.value;
    const std::size_t dots = text.find("..");
    if (dots == std::string::npos) {
      if (text.empty() || text.find_first_of("()") != std::string::npos) {
        file.tree().fail("a value is a word, a number, `LOW..HIGH`, or several with commas", node);
      }
      return add(without_blanks(text), node);
    }
    const auto low = bound_in(file, without_blanks(text.substr(0, dots)));
    const auto high = bound_in(file, without_blanks(text.substr(dots + 2)));
    if (!low || !high || *low > *high || *high - *low >= most_values) {
      file.tree().fail(
          "'" + text + "' is no range of at most " + std::to_string(most_values) + " numbers",
          node);
    }
    for (Value value = *low; value <= *high; ++value) add(std::to_string(value), node);
  };
  if (field->yaml->is_list()) {
    for (const YamlEntry& one : field->yaml->entries) read(one.value);
  } else {
    read(*field->yaml);
  }
  for (const std::string& value : values) {
    const auto commas = [](const std::string& text) { return std::ranges::count(text, ','); };
    if (commas(value) != commas(values.front())) {
      file.tree().fail("each value has as many parts as the others", *field);
    }
    for (const std::string_view part : split(value, ',')) {
      program_syntax::read_value(std::string(part), file.words);  // a word is known from here on
    }
  }
  return values;
}

}  // namespace maide
