// A system file as a tree: sections, entries and fields with their places, texts of programs and
// formulas as trees of their own. It is checked against the table of keys (schema.hpp) and parsed
// whole, and nothing is asked about what a name means. The document below keeps what was written,
// comments and all, for who prints or edits it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/language/code.hpp"
#include "maide/check/text/scalar_text.hpp"
#include "maide/check/text/yaml_node.hpp"
#include "maide/check/tree/schema.hpp"

namespace maide {

// A field or an entry of the file.
struct TreeNode {
  const Key* key = nullptr;
  const YamlNode* yaml = nullptr;  // what stands there
  const YamlNode* name = nullptr;  // the key before it; null: it is a value in a list, or the root
  std::vector<TreeNode> children;  // of maps, entries and options; of names one each

  // What was read, by the key's kind and by how its name is read. One is there at most.
  std::shared_ptr<const syntax::Code> code;
  std::shared_ptr<const syntax::Taken> taken;
  std::shared_ptr<const syntax::Formula> formula;
  std::shared_ptr<const syntax::Term> number;  // null: one of the key's values stands there
  std::shared_ptr<const syntax::Timer> timer;
  std::shared_ptr<const syntax::Reference> reference;
  // Of the name.
  std::shared_ptr<const syntax::Declared> declared;
  std::shared_ptr<const syntax::Head> head;
  std::shared_ptr<const syntax::Event> output;
  std::shared_ptr<const syntax::Reference> named;

  const TreeNode* find(std::string_view child) const;
  const std::string& text() const { return yaml->value; }
  const std::string& name_text() const { return name->value; }
  // Of a word: whether it is this one.
  bool is(std::string_view word) const { return yaml->is_scalar() && yaml->value == word; }
  bool is_map() const { return key->kind == FieldKind::map; }
};

struct SystemTree {
  std::shared_ptr<const YamlDocument> document;
  TreeNode root;

  const std::string& file() const { return document->file; }
  SourcePosition at(const YamlNode& node) const { return document->position(node); }
  SourcePosition at(const TreeNode& node) const { return at(*node.yaml); }
  SourcePosition at_name(const TreeNode& node) const { return at(*node.name); }
  [[noreturn]] void fail(const std::string& message, const YamlNode& node) const {
    throw ParseError(message, at(node));
  }
  [[noreturn]] void fail(const std::string& message, const TreeNode& node) const {
    fail(message, *node.yaml);
  }
  [[noreturn]] void fail_at_name(const std::string& message, const TreeNode& node) const {
    fail(message, *node.name);
  }
  // The entries of a section; none if it is not there.
  const std::vector<TreeNode>& entries(std::string_view section) const;
};

// Calls visit(code) for each program, procedure and callback.
void for_each_code(const TreeNode& node, const std::function<void(const syntax::Code&)>& visit);

// Throws ParseError for everything that can be wrong before a name means something: YAML, unknown
// keys and words, syntax of names, programs and formulas.
SystemTree read_tree(std::string_view text, const std::string& file);

}  // namespace maide
