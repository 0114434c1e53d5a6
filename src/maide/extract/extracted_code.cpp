#include "maide/extract/extracted_code.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace maide::extract {
namespace {

void add_words(const std::string& text, std::set<std::string>& words) {
  std::string word;
  for (const char c : text + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
      word += c;
    } else if (!word.empty()) {
      words.insert(word);
      word.clear();
    }
  }
}

bool is_empty(const Code& code) {
  for (const Code::Arm& arm : code.arms) {
    if (!arm.code.empty()) return false;
  }
  return true;
}

// One pass; true if something was taken out.
bool simplify_once(std::vector<Code>& code, const std::set<std::string>& read) {
  bool changed = false;
  std::vector<Code> kept;
  for (Code& statement : code) {
    for (Code::Arm& arm : statement.arms) changed = simplify_once(arm.code, read) || changed;
    const bool is_idle = (statement.kind == Code::Kind::branch && is_empty(statement)) ||
                         (statement.kind == Code::Kind::set && !read.contains(statement.text));
    if (is_idle) {
      changed = true;
    } else {
      kept.push_back(std::move(statement));
    }
  }
  code = std::move(kept);
  return changed;
}

class CodePrinter {
 public:
  std::string text;

  void print(const std::vector<Code>& code, int depth) {
    for (const Code& statement : code) print(statement, depth);
  }

 private:
  static std::string place(const Code& statement) {
    if (statement.place.line == 0) return {};
    std::string name = to_string(statement.place);
    std::ranges::replace(name, '"', '_');
    std::ranges::replace(name, '\\', '_');
    return " at \"" + name + "\"";
  }
  static std::string indent(int depth) {
    return std::string(static_cast<std::size_t>(depth) * 2, ' ');
  }

  void print(const Code& statement, int depth) {
    text += indent(depth);
    switch (statement.kind) {
      case Code::Kind::step:
        text += statement.text.substr(0, statement.text.size() - 1) + place(statement) + ";\n";
        break;
      case Code::Kind::set: text += statement.text + " = " + statement.value + ";\n"; break;
      case Code::Kind::leave: text += "break;\n"; break;
      case Code::Kind::branch: print_branch(statement, depth); break;
      case Code::Kind::loop: print_block("loop", statement, depth); break;
      case Code::Kind::timed: print_block(statement.text, statement, depth); break;
      case Code::Kind::select: print_select(statement, depth); break;
    }
  }

  void print_branch(const Code& statement, int depth) {
    const bool is_choice = statement.text == "*" || statement.text == "fair *";
    text += "if " + (is_choice ? statement.text : "(" + statement.text + ")") + " {\n";
    print(statement.arms[0].code, depth + 1);
    text += indent(depth) + "}";
    if (statement.arms.size() > 1 && !statement.arms[1].code.empty()) {
      text += " else {\n";
      print(statement.arms[1].code, depth + 1);
      text += indent(depth) + "}";
    }
    text += place(statement) + "\n";
  }

  void print_block(const std::string& head, const Code& statement, int depth) {
    text += head + " {\n";
    print(statement.arms[0].code, depth + 1);
    text += indent(depth) + "}" + place(statement) + "\n";
  }

  void print_select(const Code& statement, int depth) {
    text += "select {\n";
    for (const Code::Arm& arm : statement.arms) {
      text += indent(depth + 1) + arm.head + " {\n";
      print(arm.code, depth + 2);
      text += indent(depth + 1) + "}\n";
    }
    text += indent(depth) + "}" + place(statement) + "\n";
  }
};

}  // namespace

void collect_words(const std::vector<Code>& code, std::set<std::string>& words) {
  for (const Code& statement : code) {
    if (statement.kind == Code::Kind::branch) add_words(statement.text, words);
    if (statement.kind == Code::Kind::set) add_words(statement.value, words);
    for (const Code::Arm& arm : statement.arms) collect_words(arm.code, words);
  }
}

void simplify(std::vector<Code>& code) {
  for (bool changed = true; changed;) {
    std::set<std::string> read;
    collect_words(code, read);
    changed = simplify_once(code, read);
  }
}

void drop_step(std::vector<Code>& code, const std::string& text) {
  std::erase_if(code, [&](const Code& statement) {
    return statement.kind == Code::Kind::step && statement.text == text;
  });
  for (Code& statement : code) {
    for (Code::Arm& arm : statement.arms) drop_step(arm.code, text);
  }
}

bool has_steps(const std::vector<Code>& code) {
  for (const Code& statement : code) {
    if (statement.kind == Code::Kind::step || statement.kind == Code::Kind::loop ||
        statement.kind == Code::Kind::select || statement.kind == Code::Kind::timed) {
      return true;
    }
    for (const Code::Arm& arm : statement.arms) {
      if (has_steps(arm.code)) return true;
    }
  }
  return false;
}

std::string print_code(const std::vector<Code>& code, const std::vector<CodeVariable>& variables) {
  std::set<std::string> words;
  collect_words(code, words);
  std::string text;
  for (const CodeVariable& variable : variables) {
    if (!words.contains(variable.name)) continue;
    std::string type = "bool";
    if (!variable.values.empty()) {
      type = "{";
      for (const std::string& value : variable.values) {
        type += (type.size() > 1 ? ", " : "") + value;
      }
      type += "}";
    }
    text += "var " + variable.name + ": " + type + ";\n";
  }
  CodePrinter printer;
  printer.print(code, 0);
  text += printer.text;
  return text.empty() ? "skip;\n" : text;
}

}  // namespace maide::extract
