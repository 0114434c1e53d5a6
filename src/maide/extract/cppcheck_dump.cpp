#include "maide/extract/cppcheck_dump.hpp"

#include <charconv>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"

namespace maide::extract {
namespace {

struct XmlTag {
  std::string_view name;
  bool is_end = false;
  std::map<std::string_view, std::string_view> attributes;
};

// The tags of a text that has no text between them, as dumps are.
class XmlTags {
 public:
  XmlTags(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  bool next(XmlTag& tag) {
    const std::size_t begin = text_.find('<', at_);
    if (begin == std::string_view::npos) return false;
    at_ = begin + 1;
    tag.attributes.clear();
    tag.is_end = peek() == '/';
    if (tag.is_end || peek() == '?') ++at_;
    tag.name = word();
    for (;;) {
      while (peek() == ' ' || peek() == '\n' || peek() == '\t') ++at_;
      if (peek() == '/' || peek() == '?') ++at_;
      if (peek() == '>') return ++at_, true;
      const std::string_view name = word();
      if (name.empty() || peek() != '=') fail();
      ++at_;
      if (peek() != '"') fail();
      const std::size_t end = text_.find('"', ++at_);
      if (end == std::string_view::npos) fail();
      tag.attributes[name] = text_.substr(at_, end - at_);
      at_ = end + 1;
    }
  }

 private:
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  std::string_view word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() &&
           std::string_view(" =/>\n\t?").find(text_[at_]) == std::string_view::npos)
      ++at_;
    return text_.substr(begin, at_ - begin);
  }
  [[noreturn]] void fail() const {
    throw ParseError("what cppcheck wrote is no XML at byte " + std::to_string(at_), {file_});
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
};

std::string unescape(std::string_view text) {
  static const std::vector<std::pair<std::string_view, char>> entities{
      {"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    bool is_entity = false;
    for (const auto& [name, character] : entities) {
      if (!text.substr(i).starts_with(name)) continue;
      plain += character;
      i += name.size() - 1;
      is_entity = true;
      break;
    }
    if (!is_entity) plain += text[i];
  }
  return plain;
}

int number(std::string_view text) {
  int value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// One configuration is read whole before references get their indices.
class ConfigurationReader {
 public:
  explicit ConfigurationReader(DumpConfiguration& out) : out_(out) {}

  void take(const XmlTag& tag) {
    if (tag.name == "token") return add_token(tag);
    if (tag.name == "scope") return take_scope(tag);
    if (tag.name == "function") return take_function(tag);
    if (tag.name == "arg" && !tag.is_end) return add_argument(tag);
    if (tag.name == "type" && !tag.is_end) {
      refer(tag, "classScope", scopes_,
            [this, at = out_.classes.size()](int scope) { out_.classes[at].scope = scope; });
      out_.classes.emplace_back();
    }
    if (tag.name == "derivedFrom") {
      refer(tag, "nameTok", tokens_, [this, at = out_.classes.size() - 1](int token) {
        out_.classes[at].bases.push_back(token);
      });
    }
    if (tag.name == "var") take_variable(tag);
  }

  void finish() {
    for (const auto& set : pending_) set();
    for (std::size_t i = 0; i < out_.scopes.size(); ++i) {
      for (const int function : functions_of_scope_[static_cast<int>(i)]) {
        out_.functions[static_cast<std::size_t>(function)].scope = static_cast<int>(i);
      }
    }
  }

 private:
  using Ids = std::unordered_map<std::string_view, int>;

  static std::string_view get(const XmlTag& tag, std::string_view name) {
    const auto found = tag.attributes.find(name);
    return found == tag.attributes.end() ? std::string_view{} : found->second;
  }
  static bool is(const XmlTag& tag, std::string_view name) { return get(tag, name) == "true"; }

  // What an id means is known when all is read. Unknown ids stay `nothing`.
  void refer(const XmlTag& tag, std::string_view name, const Ids& ids,
             std::function<void(int)> set) {
    const std::string_view id = get(tag, name);
    if (id.empty() || id == "0") return;
    pending_.emplace_back([id, &ids, set = std::move(set)] {
      if (const auto found = ids.find(id); found != ids.end()) set(found->second);
    });
  }

  void add_token(const XmlTag& tag) {
    const std::size_t at = out_.tokens.size();
    tokens_[get(tag, "id")] = static_cast<int>(at);
    DumpToken token;
    token.text = unescape(get(tag, "str"));
    token.original = unescape(get(tag, "originalName"));
    token.file = unescape(get(tag, "file"));
    token.line = number(get(tag, "linenr"));
    token.column = number(get(tag, "column"));
    token.is_name = get(tag, "type") == "name";
    token.is_string = get(tag, "type") == "string";
    token.is_number = get(tag, "type") == "number";
    token.is_cast = is(tag, "isCast");
    token.is_macro = is(tag, "isExpandedMacro");
    const auto link = [&](std::string_view name, const Ids& ids, int DumpToken::*member) {
      refer(tag, name, ids, [this, at, member](int to) { out_.tokens[at].*member = to; });
    };
    link("link", tokens_, &DumpToken::link);
    link("astParent", tokens_, &DumpToken::parent);
    link("astOperand1", tokens_, &DumpToken::left);
    link("astOperand2", tokens_, &DumpToken::right);
    link("scope", scopes_, &DumpToken::scope);
    link("function", functions_, &DumpToken::function);
    link("variable", variables_, &DumpToken::variable);
    out_.tokens.push_back(std::move(token));
  }

  void take_scope(const XmlTag& tag) {
    if (tag.is_end) return;
    const std::size_t at = out_.scopes.size();
    scopes_[get(tag, "id")] = static_cast<int>(at);
    scope_ = static_cast<int>(at);
    DumpScope scope;
    scope.type = unescape(get(tag, "type"));
    scope.name = unescape(get(tag, "className"));
    const auto link = [&](std::string_view name, const Ids& ids, int DumpScope::*member) {
      refer(tag, name, ids, [this, at, member](int to) { out_.scopes[at].*member = to; });
    };
    link("bodyStart", tokens_, &DumpScope::begin);
    link("bodyEnd", tokens_, &DumpScope::end);
    link("nestedIn", scopes_, &DumpScope::outer);
    link("function", functions_, &DumpScope::function);
    out_.scopes.push_back(std::move(scope));
  }

  void take_function(const XmlTag& tag) {
    if (tag.is_end) return;
    const std::size_t at = out_.functions.size();
    functions_[get(tag, "id")] = static_cast<int>(at);
    functions_of_scope_[scope_].push_back(static_cast<int>(at));
    DumpFunction function;
    function.name = unescape(get(tag, "name"));
    function.type = get(tag, "type");
    function.is_virtual = is(tag, "hasVirtualSpecifier") || is(tag, "isImplicitlyVirtual");
    function.is_static = is(tag, "isStatic");
    refer(tag, "token", tokens_, [this, at](int to) { out_.functions[at].token = to; });
    refer(tag, "tokenDef", tokens_, [this, at](int to) { out_.functions[at].declared = to; });
    out_.functions.push_back(std::move(function));
  }

  void add_argument(const XmlTag& tag) {
    const std::size_t at = out_.functions.size() - 1;
    out_.functions[at].arguments.push_back(nothing);
    const std::size_t place = out_.functions[at].arguments.size() - 1;
    refer(tag, "variable", variables_,
          [this, at, place](int to) { out_.functions[at].arguments[place] = to; });
  }

  void take_variable(const XmlTag& tag) {
    if (tag.is_end || get(tag, "nameToken").empty()) return;  // of a list of a scope
    const std::size_t at = out_.variables.size();
    variables_[get(tag, "id")] = static_cast<int>(at);
    DumpVariable variable;
    variable.access = get(tag, "access");
    variable.is_reference = is(tag, "isReference");
    variable.is_pointer = is(tag, "isPointer");
    variable.is_static = is(tag, "isStatic");
    variable.is_const = is(tag, "isConst");
    variable.is_extern = is(tag, "isExtern");
    const auto link = [&](std::string_view name, const Ids& ids, int DumpVariable::*member) {
      refer(tag, name, ids, [this, at, member](int to) { out_.variables[at].*member = to; });
    };
    link("nameToken", tokens_, &DumpVariable::name);
    link("typeStartToken", tokens_, &DumpVariable::type_begin);
    link("typeEndToken", tokens_, &DumpVariable::type_end);
    link("scope", scopes_, &DumpVariable::scope);
    out_.variables.push_back(std::move(variable));
  }

  DumpConfiguration& out_;
  Ids tokens_, scopes_, functions_, variables_;
  std::map<int, std::vector<int>> functions_of_scope_;
  std::vector<std::function<void()>> pending_;
  int scope_ = nothing;
};

}  // namespace

Dump read_cppcheck_dump(std::string_view text, const std::string& file) {
  Dump dump;
  XmlTags tags(text, file);
  XmlTag tag;
  bool is_ended = false;
  while (tags.next(tag)) {
    if (tag.name == "file" && tag.attributes.contains("name")) {
      dump.files.push_back(unescape(tag.attributes["name"]));
    }
    is_ended = is_ended || (tag.name == "dumps" && tag.is_end);
    if (tag.name != "dump" || tag.is_end) continue;
    DumpConfiguration& configuration = dump.configurations.emplace_back();
    configuration.name = unescape(tag.attributes["cfg"]);
    ConfigurationReader reader(configuration);
    bool is_closed = false;
    while (!is_closed && tags.next(tag)) {
      is_closed = tag.name == "dump" && tag.is_end;
      reader.take(tag);
    }
    if (!is_closed) throw ParseError("what cppcheck wrote breaks off", {file});
    reader.finish();
  }
  if (!is_ended || dump.configurations.empty()) {
    throw ParseError("what cppcheck wrote breaks off", {file});
  }
  return dump;
}

}  // namespace maide::extract
