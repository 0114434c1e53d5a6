#include "maide/check/tree/system_tree.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "maide/base/text.hpp"
#include "maide/check/language/code_parser.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {

const TreeNode* TreeNode::find(std::string_view child) const {
  for (const TreeNode& node : children) {
    if (node.name != nullptr && node.name->value == child) return &node;
  }
  return nullptr;
}

const std::vector<TreeNode>& SystemTree::entries(std::string_view section) const {
  static const std::vector<TreeNode> none;
  const TreeNode* const node = root.find(section);
  return node == nullptr ? none : node->children;
}

void for_each_code(const TreeNode& node, const std::function<void(const syntax::Code&)>& visit) {
  if (node.code) visit(*node.code);
  for (const TreeNode& child : node.children) for_each_code(child, visit);
}

namespace {

std::string in_single_quotes(std::string_view text) { return "'" + std::string(text) + "'"; }

class TreeReader {
 public:
  explicit TreeReader(const YamlDocument& document) : document_(document) {
    for (const YamlEntry& section : document.root.entries) {
      auto* const names = section.key.value == "constants"    ? &names_.constants
                          : section.key.value == "procedures" ? &names_.procedures
                          : section.key.value == "models" || section.key.value == "topics" ||
                                  section.key.value == "services"
                              ? &names_.models
                              : nullptr;
      if (names == nullptr) continue;
      for (const YamlEntry& entry : section.value.entries) {
        names->push_back(entry.key.value.substr(0, entry.key.value.find_first_of("[( ")));
      }
    }
    note_variables(document.root);
    const YamlNode* const nodes = document.root.find("nodes");
    if (nodes == nullptr) return;
    for (const YamlEntry& node : nodes->entries) note_variables(node.value);
  }

  TreeNode read_root() const {
    TreeNode root;
    root.yaml = &document_.root;
    root.key = keys_at("").front();
    read_map(root, "");
    return root;
  }

 private:
  [[noreturn]] void fail(const std::string& message, const YamlNode& node) const {
    throw ParseError(message, document_.position(node));
  }

  // The words behind `var`, for messages.
  void note_variables(const YamlNode& map) {
    const YamlNode* const variables = map.find("variables");
    if (variables == nullptr) return;
    const std::vector<std::string> words = split_words(variables->value);
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
      if (words[i] == "var") names_.variables.push_back(words[i + 1]);
    }
  }
  static std::vector<std::string> split_words(std::string_view text) {
    std::vector<std::string> words;
    bool is_inside = false;
    for (const char c : text) {
      const bool is_word = is_letter(c) || is_digit(c) || c == '_';
      if (is_word && !is_inside) words.emplace_back();
      if (is_word) words.back() += c;
      is_inside = is_word;
    }
    return words;
  }

  ScalarText text_of(const YamlNode& node) const {
    return ScalarText(node.value, document_.text, document_.position(node));
  }

  // "model 'via'", "'with'", "a system file".
  static std::string what_is(const TreeNode& node) {
    const std::string_view what = node.key->what;
    if (what.empty()) return in_single_quotes(node.name->value);
    const bool has_name = node.key->path.ends_with("/*") && !what.starts_with("a ") &&
                          !what.starts_with('\'') && !what.starts_with("what");
    return std::string(what) + (has_name ? " " + in_single_quotes(name_in_messages(node)) : "");
  }
  // Of an array without its indices.
  static std::string name_in_messages(const TreeNode& node) {
    if (node.declared) return node.declared->name.text;
    return node.head ? node.head->name.text : node.name->value;
  }

  // The entries of a map, its keys being distinct words, and among `known` unless that is empty.
  void check_keys(const TreeNode& node, const std::vector<std::string>& known) const {
    const std::string what = what_is(node);
    if (!node.yaml->is_map()) fail(what + " must be a map (key: value)", *node.yaml);
    std::set<std::string> seen;
    for (const YamlEntry& entry : node.yaml->entries) {
      if (entry.key.is_null() && !entry.key.value.empty()) {
        fail("a key of " + what + " must be a word, and to YAML `" + entry.key.value +
                 "` is none: put it in quotes",
             entry.key);
      }
      if (!entry.key.is_scalar() || entry.key.value.empty()) {
        fail("a key of " + what + " must be a word", entry.key);
      }
      const std::string& key = entry.key.value;
      if (!known.empty() && std::find(known.begin(), known.end(), key) == known.end()) {
        fail(what + " has no key " + in_single_quotes(key) +
                 "; it may have: " + known_instead(key, known),
             entry.key);
      }
      if (!seen.insert(key).second) fail(in_single_quotes(key) + " is there twice", entry.key);
    }
  }

  void read_map(TreeNode& node, const std::string& path) const {
    const std::vector<std::string> known = keys_below(path);
    check_keys(node, known);
    for (const YamlEntry& entry : node.yaml->entries) {
      TreeNode& child = node.children.emplace_back();
      child.yaml = &entry.value;
      child.name = &entry.key;
      read(child, (path.empty() ? "" : path + "/") + entry.key.value);
    }
    // What a built-in model is made with are numbers.
    if (node.find("use") == nullptr) return;
    for (TreeNode& child : node.children) {
      if (child.name->value != "with" && child.name->value != "readers_with") continue;
      for (TreeNode& option : child.children) {
        if (option.children.empty() && option.yaml->is_scalar()) read_number(option);
        for (TreeNode& own : option.children) read_number(own);
      }
    }
  }

  void read_entries(TreeNode& node, const std::string& path) const {
    check_keys(node, {});
    for (const YamlEntry& entry : node.yaml->entries) {
      TreeNode& child = node.children.emplace_back();
      child.yaml = &entry.value;
      child.name = &entry.key;
      read_name(child, node.key->names);
      read(child, path + "/*");
    }
  }

  void read_name(TreeNode& node, NameKind kind) const {
    const ScalarText text = text_of(*node.name);
    switch (kind) {
      case NameKind::plain: break;
      case NameKind::declared: {
        syntax::Declared declared;
        if (text.value().find('[') == std::string::npos) {
          // Names of old files need not be identifiers.
          const SourcePosition place = text.position(0);
          declared.name = {text.value(), true, {place.line, place.column}};
        } else {
          declared = syntax::parse_declared(text);
        }
        node.declared = std::make_shared<const syntax::Declared>(std::move(declared));
        break;
      }
      case NameKind::head:
        node.head = std::make_shared<const syntax::Head>(syntax::parse_head(text));
        break;
      case NameKind::reference:
        node.named = std::make_shared<const syntax::Reference>(syntax::parse_reference(text));
        break;
      case NameKind::output:
        node.output = std::make_shared<const syntax::Event>(syntax::parse_output(text));
        break;
    }
  }

  // Where a text or a map may stand, the value decides.
  static const Key* key_for(const YamlNode& value, const std::vector<const Key*>& keys) {
    for (const Key* key : keys) {
      const bool is_for_maps = key->kind == FieldKind::map || key->kind == FieldKind::entries;
      if (is_for_maps == value.is_map()) return key;
    }
    return keys.front();
  }

  void read(TreeNode& node, const std::string& path) const {
    node.key = key_for(*node.yaml, keys_at(path));
    switch (node.key->kind) {
      case FieldKind::map: read_map(node, path); break;
      case FieldKind::entries: read_entries(node, path); break;
      case FieldKind::options: read_options(node); break;
      case FieldKind::word: read_word(node); break;
      case FieldKind::names: read_names(node); break;
      case FieldKind::texts: check_texts(node); break;
      case FieldKind::number: read_number(node); break;
      case FieldKind::timer:
        check_scalar(node);
        node.timer =
            std::make_shared<const syntax::Timer>(syntax::parse_timer(text_of(*node.yaml)));
        break;
      default: read_text(node); break;
    }
  }

  void check_scalar(const TreeNode& node) const {
    if (node.yaml->is_scalar() && !node.yaml->is_null()) return;
    if (node.key->kind == FieldKind::variables) {
      fail("'variables' must be a text, as in variables: \"var n: 0..3; var ok: bool;\"",
           *node.yaml);
    }
    fail(what_is(node) + (node.key->kind == FieldKind::formula ? " must be a formula or a map"
                                                               : " must be a text"),
         *node.yaml);
  }

  void check_texts(const TreeNode& node) const {
    if (!node.yaml->is_list()) return check_scalar(node);
    for (const YamlEntry& one : node.yaml->entries) {
      if (one.value.is_scalar() && !one.value.is_null()) continue;
      fail(what_is(node) + " must be a text, or a list of texts", one.value);
    }
  }

  void read_options(TreeNode& node) const {
    check_keys(node, {});
    for (const YamlEntry& entry : node.yaml->entries) {
      TreeNode& option = node.children.emplace_back();
      option.key = node.key;
      option.yaml = &entry.value;
      option.name = &entry.key;
      if (!entry.value.is_scalar() || entry.value.is_null()) {
        fail("an option's value must be a text", entry.value);
      }
    }
  }

  void read_word(const TreeNode& node) const {
    const std::vector<std::string> known = values_of(*node.key);
    if (node.yaml->is_map() && node.key->path == "nodes/*/groups/*") {
      fail("a group is one of " + join(known) +
               ": all groups of a node run on the node's executor, so what another executor is to "
               "run goes into a node of its own",
           *node.yaml);
    }
    check_scalar(node);
    const std::string& word = node.yaml->value;
    if (std::find(known.begin(), known.end(), word) != known.end()) return;
    fail(what_is(node) + " is one of " + join(known) + ", not " + in_single_quotes(word) +
             did_you_mean(word, known),
         *node.yaml);
  }

  void read_names(TreeNode& node) const {
    if (!node.yaml->is_list()) {
      read_reference(node);
      return;
    }
    for (const YamlEntry& entry : node.yaml->entries) {
      TreeNode& one = node.children.emplace_back();
      one.key = node.key;
      one.yaml = &entry.value;
      read_reference(one);
    }
  }
  void read_reference(TreeNode& node) const {
    if (!node.yaml->is_scalar() || node.yaml->is_null()) {
      fail("a program's or node's name must be a text", *node.yaml);
    }
    node.reference =
        std::make_shared<const syntax::Reference>(syntax::parse_reference(text_of(*node.yaml)));
  }

  void read_number(TreeNode& node) const {
    check_scalar(node);
    const std::vector<std::string> others = values_of(*node.key);
    if (std::find(others.begin(), others.end(), node.yaml->value) != others.end()) return;
    node.number =
        std::make_shared<const syntax::Term>(syntax::parse_expression(text_of(*node.yaml)));
  }

  void read_text(TreeNode& node) const {
    check_scalar(node);
    const auto code = [&](syntax::Code (*parse)(const ScalarText&, const syntax::KnownNames&)) {
      node.code = std::make_shared<const syntax::Code>(parse(text_of(*node.yaml), names_));
    };
    const std::vector<std::string> others = values_of(*node.key);
    if (std::find(others.begin(), others.end(), node.yaml->value) != others.end()) return;
    switch (node.key->kind) {
      case FieldKind::program: code(syntax::parse_program); break;
      case FieldKind::procedure: code(syntax::parse_procedure); break;
      case FieldKind::callback: code(syntax::parse_callback); break;
      case FieldKind::variables:
        node.code =
            std::make_shared<const syntax::Code>(syntax::parse_variables(text_of(*node.yaml)));
        break;
      case FieldKind::taken: read_taken(node); break;
      case FieldKind::formula: read_formula(node); break;
      case FieldKind::name: read_reference(node); break;
      default: break;
    }
  }

  void read_taken(TreeNode& node) const {
    const ScalarText text = text_of(*node.yaml);
    const std::size_t end = text.value().find_first_of("[.!");
    if (end == std::string::npos || end == 0) {
      throw ParseError("'takes' names a model and its input or output, as in \"image.read\"",
                       text.position(0));
    }
    node.taken = std::make_shared<const syntax::Taken>(syntax::parse_taken(text));
  }

  void read_formula(TreeNode& node) const {
    const ScalarText text = text_of(*node.yaml);
    if (text.has_tag()) {
      fail("to YAML, this '!' begins a tag and no formula: put the formula in quotes", *node.yaml);
    }
    node.formula = std::make_shared<const syntax::Formula>(syntax::parse_formula(text));
  }

  const YamlDocument& document_;
  syntax::KnownNames names_;
};

}  // namespace

SystemTree read_tree(std::string_view text, const std::string& file) {
  auto document = std::make_shared<const YamlDocument>(read_yaml(text, file, "a system file"));
  TreeNode root = TreeReader(*document).read_root();
  return {std::move(document), std::move(root)};
}

}  // namespace maide
