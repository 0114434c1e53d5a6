// Models and topics: where their automata will come from, and who stands at their ends.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/build/declarations.hpp"
#include "maide/check/build/open_ends.hpp"
#include "maide/check/build/references.hpp"
#include "maide/check/rules/open_topic.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {
namespace {

// Of a topic. A write is a step for each set of readers that live.
constexpr std::ptrdiff_t max_mortal_readers = 8;

using Fields = std::vector<const TreeNode*>;

const TreeNode* find(const Fields& fields, std::string_view name) {
  for (const TreeNode* field : fields) {
    if (field->name_text() == name) return field;
  }
  return nullptr;
}

// As it is written, or the value of the constant of that name.
std::string option_value(const Declarations& file, const TreeNode& option) {
  const std::string& value = option.text();
  const auto constant = file.names.constants.find(value);
  if (constant == file.names.constants.end() || option.yaml->style != YamlNode::Style::plain) {
    return value;
  }
  return to_string(constant->second.value, constant->second.kind, file.words);
}

// What a model is made of: its fields, and under `with` these options.
class ModelDeclarer {
 public:
  ModelDeclarer(Declarations& file, const TreeNode& entry, Fields fields, Fields options)
      : file_(file), entry_(entry), fields_(std::move(fields)), options_(std::move(options)) {}

  ModelInstance declare(const std::string& name, ModelOrigin& origin) const {
    ModelInstance model;
    model.name = name;
    model.position = file_.tree().at_name(entry_);
    read_settings(model);
    const TreeNode* const from = source();
    if (from == nullptr) {
      file_.tree().fail_at_name("model '" + name + "' needs 'file:', 'learn:' or 'use:'", entry_);
    }
    if (from->text().empty()) {
      file_.tree().fail("'" + from->name_text() + "' is empty", *from);
    }
    const TreeNode* const learning = find(fields_, "learning");
    if (from->name_text() == "use") {
      if (learning != nullptr && !learning->children.empty()) {
        file_.tree().fail_at_name("'learning' goes with 'learn'", entry_);
      }
      model.source = ModelInstance::Source::built_in;
      model.origin = from->text();
      return model;
    }
    origin.kind = ModelOrigin::Kind::asked;
    ModelRequest& request = origin.request;
    request.instance = name;
    request.position = file_.tree().at(*from);
    for (const TreeNode* option : options_) {
      request.with.emplace_back(option->name_text(), option_value(file_, *option));
    }
    origin.options = options_;
    if (learning != nullptr) {
      for (const TreeNode& option : learning->children) {
        request.learning.emplace_back(option.name_text(), option_value(file_, option));
        origin.options.push_back(&option);
      }
    }
    model.origin = from->text();
    if (from->name_text() == "learn") {
      request.learn = model.origin;
      model.is_learned = true;
      return model;
    }
    if (!origin.options.empty()) {
      file_.tree().fail_at_name(
          "'with' and 'learning' go with 'learn'; a model from a file has its options behind it",
          entry_);
    }
    request.file = std::filesystem::path(file_.tree().file()).parent_path() / model.origin;
    return model;
  }

  // How a built-in model is made, with these indices of its array.
  void declare_built_in(ModelOrigin& origin, const Indices& indices) const {
    const TreeNode* const use = find(fields_, "use");
    if (use == nullptr) return;
    const std::string& kind = use->text();
    if (kind == "condition") return declare_condition(origin, *use);
    origin.built_in = find_built_in(kind);
    if (kind == "mutex") return declare_mutex(origin);
    origin.kind =
        origin.built_in == nullptr ? ModelOrigin::Kind::queue : ModelOrigin::Kind::built_in;
    std::vector<std::string> known{"size", "depth"};
    if (origin.built_in != nullptr) known = {std::string(origin.built_in->option)};
    if (known[0].empty()) {
      if (!options_.empty())
        file_.tree().fail("a " + kind + " has no options", *find(fields_, "with"));
      return;
    }
    std::vector<std::string> allowed = known;
    if (kind == "queue") allowed.insert(allowed.end(), {"pub-depth", "pub-history"});
    check_options(kind, allowed);
    Fields sizes;
    for (const TreeNode* option : options_) {
      if (std::find(known.begin(), known.end(), option->name_text()) != known.end()) {
        sizes.push_back(option);
      }
    }
    if (sizes.size() != 1) {
      std::string forms;
      for (const std::string& name : known) {
        forms += (forms.empty() ? "'with: {" : " or 'with: {") + name + ": N}'";
      }
      file_.tree().fail("a " + kind + " needs " + forms, *use);
    }
    const TreeNode& option = *sizes.front();
    const bool is_depth = option.name_text() == "depth";
    origin.size.has_tryread = file_.asks_at_once;
    if (is_depth && option.text() == unknown_depth) {
      origin.size = {1, true, {}, true, file_.asks_at_once};
      return;
    }
    constexpr std::uint32_t most = 1'000'000;
    origin.count = count_of(constant_of(file_, *option.number, indices), most);
    if (origin.count == 0) {
      file_.tree().fail("'" + option.name_text() + "' goes from 1 to " + std::to_string(most),
                        option);
    }
    origin.size.size = origin.count;
    origin.size.drops_oldest = is_depth;
  }

 private:
  void declare_mutex(ModelOrigin& origin) const {
    check_options("mutex", {"recursive"});
    const TreeNode* const recursive = find(options_, "recursive");
    if (recursive != nullptr && !recursive->is("true") && !recursive->is("false")) {
      file_.tree().fail("'recursive' is 'true' or 'false'", *recursive);
    }
    origin.count = file_.tries_locks ? 1 : 0;
    origin.kind = recursive != nullptr && recursive->is("true") ? ModelOrigin::Kind::recursive_mutex
                                                                : ModelOrigin::Kind::built_in;
  }

  void declare_condition(ModelOrigin& origin, const TreeNode& use) const {
    check_options("condition", {"mutex"});
    origin.kind = ModelOrigin::Kind::condition;
    origin.of_condition = find(options_, "mutex");
    if (origin.of_condition == nullptr) {
      file_.tree().fail("a condition needs 'with: {mutex: NAME}'", use);
    }
  }

  // What connections of ROS 2 and DDS are set up with.
  static bool is_of_middleware(const std::string& option) {
    const std::string_view name = std::string_view(option).substr(
        option.starts_with("pub-") || option.starts_with("sub-") ? 4 : 0);
    return name == "durability" || name == "reliability" || name == "history";
  }

  void check_options(const std::string& kind, const std::vector<std::string>& known) const {
    for (const TreeNode* option : options_) {
      if (std::find(known.begin(), known.end(), option->name_text()) != known.end()) continue;
      if (kind == "queue" && is_of_middleware(option->name_text())) {
        file_.tree().fail_at_name("a queue written by hand has no '" + option->name_text() +
                                      "': that is a middleware's, so write 'learn: cyclonedds' or "
                                      "another one in place of 'use: queue'",
                                  *option);
      }
      file_.tree().fail_at_name("'with' of a " + kind + " has no key '" + option->name_text() +
                                    "'; it may have: " + known_instead(option->name_text(), known),
                                *option);
    }
  }

  void read_settings(ModelInstance& model) const {
    if (const TreeNode* const unexplored = find(fields_, "when_unexplored")) {
      model.when_unexplored = unexplored->is("wait")   ? WhenUnexplored::wait
                              : unexplored->is("drop") ? WhenUnexplored::drop
                                                       : WhenUnexplored::stop;
    }
    if (const TreeNode* const weak = find(fields_, "when_weak")) {
      model.when_weak = weak->is("accept") ? WhenWeak::accept : WhenWeak::inconclusive;
    }
  }

  const TreeNode* source() const {
    const TreeNode* from = nullptr;
    for (const TreeNode* field : fields_) {
      const std::string& word = field->name_text();
      if (word != "file" && word != "learn" && word != "use") continue;
      if (from != nullptr) {
        file_.tree().fail_at_name("a model has one of 'file', 'learn' and 'use'", *field);
      }
      from = field;
    }
    return from;
  }

  Declarations& file_;
  const TreeNode& entry_;
  Fields fields_, options_;
};

Fields fields_of(const TreeNode& entry) {
  Fields fields;
  for (const TreeNode& field : entry.children) fields.push_back(&field);
  return fields;
}
Fields options_of(const TreeNode& entry) {
  const TreeNode* const with = entry.find("with");
  return with == nullptr ? Fields() : fields_of(*with);
}
// What the entry says of how messages get to the model with that number.
void note_delivery(Declarations& file, std::uint32_t number, const TreeNode& entry) {
  std::map<std::string, std::string> options;
  for (const TreeNode* option : options_of(entry)) {
    options.emplace(option->name_text(), option_value(file, *option));
  }
  file.deliveries.emplace(number, read_delivery(file, entry, options));
}

}  // namespace

void declare_models(Declarations& file) {
  for (const TreeNode& entry : file.tree().entries("models")) {
    const DeclaredArray array = declare_array(file, entry);
    if (file.models.size() + array.count() > max_components) {
      file.tree().fail_at_name("too many models", entry);
    }
    const auto first = static_cast<std::uint32_t>(file.models.size());
    ModelName& name =
        file.names.models.emplace(array.name, ModelName{first, array.dimensions, false, {}})
            .first->second;
    const ModelDeclarer declarer(file, entry, fields_of(entry), options_of(entry));
    ModelOrigin origin;
    ModelInstance model = declarer.declare(array.name, origin);
    if (const TreeNode* const ends = entry.find("ends")) {
      const Indices none;
      for (const TreeNode& end : ends->children) {
        if (names_anybody(file, end)) {
          file.tree().fail("`anybody` stands at ends of topics and services", end);
        }
        name.ends.emplace(end.name_text(), References(file, none).ends(end));
      }
      origin.ends = ends->yaml;
    }
    for (std::uint64_t member = 0; member < array.count(); ++member) {
      model.name = array.member(member);
      declarer.declare_built_in(origin, array.indices_of(member));
      const auto number = static_cast<std::uint32_t>(file.models.size());
      note_delivery(file, number, entry);
      file.models.push_back(model);
      file.origins.push_back(origin);
      if (origin.kind == ModelOrigin::Kind::asked) {
        origin.kind = ModelOrigin::Kind::copied;
        origin.first = first;
      }
      if (!name.ends.empty()) file.ends_of.emplace(number, array.name);
    }
  }
}

// ---- Topics -------------------------------------------------------------------------------------

namespace {

// Under `readers_with:` each reader is there once.
void check_own_options(const Declarations& file, const References& references, const TreeNode& own,
                       const std::string& topic) {
  std::set<std::pair<std::uint32_t, std::string>> met;
  for (const TreeNode& entry : own.children) {
    for (const ReaderEnd& end : references.readers(entry, topic)) {
      if (met.emplace(end.program, end.callback).second) continue;
      file.tree().fail_at_name("the options of reader " + end.name + " are there twice", entry);
    }
  }
}

// Those of `with`, each in the place of which the reader's own may stand.
Fields options_of_reader(const References& references, const TreeNode& entry,
                         const std::string& topic, const ReaderEnd& reader) {
  Fields options = options_of(entry);
  const TreeNode* const own = entry.find("readers_with");
  if (own == nullptr) return options;
  for (const TreeNode& settings : own->children) {
    const std::vector<ReaderEnd> meant = references.readers(settings, topic);
    const bool is_meant = std::any_of(meant.begin(), meant.end(), [&](const ReaderEnd& other) {
      return other.program == reader.program && other.callback == reader.callback;
    });
    if (!is_meant) continue;
    for (const TreeNode& option : settings.children) {
      const auto place = std::find_if(options.begin(), options.end(), [&](const TreeNode* other) {
        return other->name_text() == option.name_text();
      });
      if (place == options.end()) {
        options.push_back(&option);
      } else {
        *place = &option;
      }
    }
  }
  return options;
}

// The reader's model, with its own options.
Topic::Reader declare_reader(Declarations& file, const References& references,
                             const TreeNode& entry, const std::string& topic,
                             const Indices& indices, const ReaderEnd& reader) {
  if (file.models.size() == max_components) file.tree().fail_at_name("too many models", entry);
  const ModelDeclarer declarer(file, entry, fields_of(entry),
                               options_of_reader(references, entry, topic, reader));
  ModelOrigin origin;
  ModelInstance model = declarer.declare(topic + "[" + reader.name + "]", origin);
  declarer.declare_built_in(origin, indices);
  if (origin.kind == ModelOrigin::Kind::recursive_mutex) {
    file.tree().fail_at_name("a topic is no mutex that knows who holds it", entry);
  }
  const auto number = static_cast<std::uint32_t>(file.models.size());
  note_delivery(file, number, entry);
  file.models.push_back(std::move(model));
  file.origins.push_back(std::move(origin));
  return {reader.program, number, reader.callback, {}, {}, {}, {}};
}

void read_writers(const References& references, const TreeNode& writers, Topic& topic) {
  for (const std::uint32_t writer : references.writers(writers)) topic.writers.insert(writer);
  const auto add = [&](const TreeNode& one) {
    topic.writer_names.push_back(one.text());
    for (const End& end : references.ends(one)) {
      if (!end.node.empty()) topic.writer_nodes.insert(end.node);
    }
  };
  if (!writers.yaml->is_list()) add(writers);
  for (const TreeNode& one : writers.children) add(one);
}

// Whether its ends meet some time after the start, and what they get then of what was written.
void read_discovery(const Declarations& file, const TreeNode& entry, Topic& topic) {
  const TreeNode* const discovery = entry.find("discovery");
  topic.meets = discovery != nullptr && discovery->is("any");
  const TreeNode* const durability = entry.find("durability");
  if (durability != nullptr && !topic.meets) {
    file.tree().fail(
        "'durability' says what comes to who meets the writer later: write it "
        "beside 'discovery: any'",
        *durability);
  }
  topic.keeps_for_late = durability != nullptr && durability->is("transient_local");
  if (!topic.meets) return;
  for (const TreeNode* const option : options_of(entry)) {
    if (option->name_text().ends_with("durability") && !option->is("volatile")) {
      file.tree().fail(
          "beside 'discovery: any' the topic says it, not 'with': "
          "`durability: transient_local`",
          *option);
    }
  }
}

// The nodes whose clock the topic is.
std::vector<std::uint32_t> nodes_going_by(const Declarations& file, const std::string& topic) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t number = 0; number < file.nodes.size(); ++number) {
    const NodeDeclaration& node = file.nodes[number];
    if (node.clock && node.entry->find("clock")->text() == topic) nodes.push_back(number);
  }
  return nodes;
}

// Of a clock a node keeps the last message.
void keep_the_last(Declarations& file, std::uint32_t model, const NodeDeclaration& node) {
  ModelOrigin& origin = file.origins[model];
  if (origin.kind != ModelOrigin::Kind::queue || !origin.size.drops_oldest) {
    file.tree().fail("a clock is a topic with `use: queue` and `depth`",
                     *node.entry->find("clock"));
  }
  origin.size.size = 1;
}

// What stands in the place of the reader's model where nobody else is at the other end, or at this
// one, than anybody. Of a file it is not known what its inputs and outputs mean.
void check_no_file(const Declarations& file, const TreeNode& entry) {
  if (entry.find("file") == nullptr) return;
  file.tree().fail("where anybody alone writes or reads there is no model: leave out 'file'",
                   *entry.find("file"));
}

Topic::Reader declare_reader_of_anybody(Declarations& file, const TreeNode& entry,
                                        const std::string& topic, const ReaderEnd& reader) {
  check_no_file(file, entry);
  ModelInstance model;
  model.name = topic + "[" + reader.name + "]";
  model.position = file.tree().at_name(entry);
  model.source = ModelInstance::Source::anybody;
  model.awaits_anybody = !says(entry, "fair");
  model.automaton = make_open_topic(values_of_anybody(file, entry), file.asks_at_once);
  const auto number = static_cast<std::uint32_t>(file.models.size());
  file.models.push_back(std::move(model));
  file.origins.emplace_back();
  file.deliveries.emplace(number, DeliveryWish());
  return {reader.program, number, reader.callback, {}, {}, {}, {}};
}

Topic::Reader declare_anybody_who_reads(Declarations& file, const TreeNode& entry,
                                        const std::string& topic) {
  check_no_file(file, entry);
  ModelInstance model;
  model.name = topic + "[" + anybody + "]";
  model.position = file.tree().at_name(entry);
  model.source = ModelInstance::Source::anybody;
  ModelOrigin origin;
  origin.kind = ModelOrigin::Kind::queue;
  origin.size.keeps_nothing = true;
  const auto number = static_cast<std::uint32_t>(file.models.size());
  const std::uint32_t program = silent_anybody(file, model.position);
  file.models.push_back(std::move(model));
  file.origins.push_back(std::move(origin));
  file.deliveries.emplace(number, DeliveryWish());
  return {program, number, "", {}, {}, {}, {}};
}

void check_keys_of_anybody(const Declarations& file, const TreeNode& entry,
                           const std::vector<std::string>& keys, bool is_there,
                           const std::string& what) {
  for (const std::string& key : keys) {
    const TreeNode* const field = entry.find(key);
    if (field == nullptr || is_there) continue;
    file.tree().fail("'" + key + "' goes with `" + what + "`", *field);
  }
}

void declare_topic(Declarations& file, const TreeNode& entry, const DeclaredArray& array,
                   std::uint64_t member) {
  const std::string name = array.member(member);
  const Indices indices = array.indices_of(member);
  Topic topic;
  topic.name = name;
  topic.position = file.tree().at_name(entry);
  const std::vector<std::uint32_t> going_by_it = nodes_going_by(file, name);
  for (const std::string word : {"writers", "readers"}) {
    if (entry.find(word) != nullptr || (!going_by_it.empty() && word == "readers")) continue;
    file.tree().fail_at_name("topic '" + name + "' needs '" + word + ":'", entry);
  }
  const References references(file, indices);
  read_writers(references, *entry.find("writers"), topic);
  const TreeNode* const deliver = entry.find("deliver");
  topic.delivers_one = deliver != nullptr && deliver->is("one");
  read_discovery(file, entry, topic);
  const TreeNode* const readers_field = entry.find("readers");
  std::vector<ReaderEnd> readers;
  if (readers_field != nullptr) readers = references.readers(*readers_field, name);
  const bool has_open_writer = names_anybody(file, *entry.find("writers"));
  const bool has_open_reader = readers_field != nullptr && names_anybody(file, *readers_field);
  const bool is_open = has_open_writer && topic.writers.empty();
  const bool is_read = !readers.empty() || !going_by_it.empty();
  if ((!is_read && !has_open_reader) || (topic.writers.empty() && !has_open_writer)) {
    file.tree().fail_at_name("a topic has a writer and a reader", entry);
  }
  if (!is_read && is_open) {
    file.tree().fail_at_name("a topic that anybody writes is read by somebody of the file", entry);
  }
  check_keys_of_anybody(file, entry, {"values", "fair"}, has_open_writer, "writers: anybody");
  if (has_open_writer) {
    file.open_ends.push_back(name + ": anybody writes" + (is_open ? "" : ", too,") +
                             " at any time" +
                             (says(entry, "fair") ? ", again and again" : ", or never again"));
  }
  if (has_open_writer && !is_open) {
    const std::uint32_t writer =
        busy_anybody(file, array, member, "write", values_of_anybody(file, entry), topic.position);
    file.programs[writer].may_stay_away = !says(entry, "fair");
    topic.writers.insert(writer);
  }
  if (const TreeNode* const own = entry.find("readers_with")) {
    check_own_options(file, references, *own, name);
  }
  for (const ReaderEnd& reader : readers) {
    topic.readers.push_back(is_open
                                ? declare_reader_of_anybody(file, entry, name, reader)
                                : declare_reader(file, references, entry, name, indices, reader));
  }
  if (!is_read) topic.readers.push_back(declare_anybody_who_reads(file, entry, name));
  for (const std::uint32_t node : going_by_it) {
    const ReaderEnd reader{*file.nodes[node].clock, "", file.nodes[node].name + ".clock"};
    if (is_open) {
      topic.readers.push_back(declare_reader_of_anybody(file, entry, name, reader));
      continue;
    }
    topic.readers.push_back(declare_reader(file, references, entry, name, indices, reader));
    keep_the_last(file, topic.readers.back().model, file.nodes[node]);
  }
  const auto mortal = std::count_if(readers.begin(), readers.end(), [&](const auto& end) {
    return file.programs[end.program].may_die;
  });
  if (mortal > max_mortal_readers) {
    file.tree().fail("at most " + std::to_string(max_mortal_readers) +
                         " readers of a topic may die, and of '" + name + "' " +
                         std::to_string(mortal) + " may",
                     *readers_field);
  }
  for (std::size_t i = 0; i < topic.readers.size(); ++i) {
    file.topic_of[topic.readers[i].model] = {file.names.topics.size(), i};
  }
  file.names.topics.push_back(std::move(topic));
}

}  // namespace

void declare_topics(Declarations& file) {
  for (const TreeNode& entry : file.tree().entries("topics")) {
    const DeclaredArray array = declare_array(file, entry);
    const auto first = static_cast<std::uint32_t>(file.names.topics.size());
    file.names.models.emplace(array.name, ModelName{first, array.dimensions, true, {}});
    for (std::uint64_t member = 0; member < array.count(); ++member) {
      declare_topic(file, entry, array, member);
    }
  }
}

}  // namespace maide
