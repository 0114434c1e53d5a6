#include "maide/check/build/references.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "maide/base/text.hpp"
#include "maide/check/build/name_resolver.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {
namespace {

const syntax::Reference& reference_of(const TreeNode& field) {
  return field.reference ? *field.reference : *field.named;
}
const YamlNode& place_of(const TreeNode& field) {
  return field.reference ? *field.yaml : *field.name;
}

bool is_list(const TreeNode& field) { return !field.reference && !field.named; }

// The indices behind the name, which are known at once.
std::vector<Value> indices_behind(Declarations& file, const syntax::Term& name,
                                  const Dimensions& dimensions, const Indices& indices) {
  const program_syntax::Context context = file.context(indices);
  program_syntax::Work work(context, {file.tree().file(), 0, 0});
  const program_syntax::NameResolver resolver(work);
  std::vector<Value> values;
  for (const Expression& index : resolver.indices(name, dimensions)) {
    if (!index.is_constant()) resolver.fail("an index is known here", name.place);
    values.push_back(index.value);
  }
  return values;
}

}  // namespace

std::vector<std::uint32_t> References::members(const TreeNode& field,
                                               const ModelName& array) const {
  return members(field, reference_of(field), array);
}

std::vector<std::uint32_t> References::members(const TreeNode& field,
                                               const syntax::Reference& reference,
                                               const ModelName& array) const {
  std::vector<std::uint32_t> all;
  if (!reference.name.has_indices) {
    const auto count = static_cast<std::uint32_t>(member_count(array.dimensions));
    for (std::uint32_t i = 0; i < count; ++i) all.push_back(array.first + i);
    return all;
  }
  Expression leaf;
  leaf.name = reference.name.name.text;
  leaf.dimensions = array.dimensions;
  try {
    return {array.first +
            element_of(leaf, indices_behind(file_, reference.name, array.dimensions, indices_))};
  } catch (const EvaluationError& error) {
    file_.tree().fail(error.text, place_of(field));
  }
}

std::vector<std::uint32_t> References::programs(const TreeNode& field) const {
  std::vector<std::uint32_t> all;
  if (is_list(field)) {
    for (const TreeNode& one : field.children) {
      for (const std::uint32_t program : programs(one)) {
        if (std::find(all.begin(), all.end(), program) != all.end()) {
          file_.tree().fail("program " + file_.programs[program].name + " is there twice", one);
        }
        all.push_back(program);
      }
    }
    return all;
  }
  const std::string& name = reference_of(field).name.name.text;
  if (is_anybody(file_, field)) return {};
  if (const auto array = file_.node_arrays.find(name); array != file_.node_arrays.end()) {
    for (const std::uint32_t member : members(field, array->second)) {
      const auto& run_by = file_.nodes[member].programs;
      all.insert(all.end(), run_by.begin(), run_by.end());
    }
    return all;
  }
  const auto array = file_.program_arrays.find(name);
  if (array == file_.program_arrays.end()) {
    std::vector<std::string> known;
    for (const auto& [other, programs] : file_.program_arrays) known.push_back(other);
    for (const auto& [other, nodes] : file_.node_arrays) known.push_back(other);
    file_.tree().fail("unknown program '" + name + "'; there is: " + known_instead(name, known),
                      place_of(field));
  }
  return members(field, array->second);
}

bool is_anybody(const Declarations& file, const TreeNode& field) {
  return field.is(anybody) && !file.program_arrays.contains(anybody) &&
         !file.node_arrays.contains(anybody);
}

bool names_anybody(const Declarations& file, const TreeNode& field) {
  if (!is_list(field)) return is_anybody(file, field);
  return std::ranges::any_of(field.children,
                             [&](const TreeNode& one) { return is_anybody(file, one); });
}

std::vector<std::uint32_t> References::writers(const TreeNode& field) const {
  if (!is_list(field)) return programs(field);
  std::set<std::uint32_t> all;
  std::set<std::string> names;
  for (const TreeNode& one : field.children) {
    if (!names.insert(one.text()).second) {
      file_.tree().fail("program " + one.text() + " is there twice", one);
    }
    for (const std::uint32_t program : programs(one)) all.insert(program);
  }
  return {all.begin(), all.end()};
}

std::vector<End> References::ends(const TreeNode& field) const {
  std::vector<End> all;
  if (is_list(field)) {
    for (const TreeNode& one : field.children) {
      for (End& end : ends(one)) {
        for (const End& other : all) {
          if (!other.is_of(end.node, end.program)) continue;
          file_.tree().fail(
              (end.node.empty() ? file_.programs[end.program].name : end.node) + " is there twice",
              one);
        }
        all.push_back(std::move(end));
      }
    }
    return all;
  }
  const auto array = file_.node_arrays.find(reference_of(field).name.name.text);
  if (array == file_.node_arrays.end()) {
    for (const std::uint32_t program : programs(field)) all.push_back({program, ""});
    return all;
  }
  for (const std::uint32_t member : members(field, array->second)) {
    all.push_back({0, file_.nodes[member].name});
  }
  return all;
}

std::vector<std::uint32_t> References::services(const TreeNode& field) const {
  const std::string& name = reference_of(field).name.name.text;
  const auto array = file_.service_arrays.find(name);
  if (array == file_.service_arrays.end()) {
    std::vector<std::string> known;
    for (const auto& [other, services] : file_.service_arrays) known.push_back(other);
    file_.tree().fail("unknown service '" + name + "'" + did_you_mean(name, known),
                      place_of(field));
  }
  return members(field, array->second);
}

// ---- Readers of topics --------------------------------------------------------------------------

std::vector<ReaderEnd> References::readers(const TreeNode& field, const std::string& topic) const {
  std::vector<ReaderEnd> all;
  if (is_list(field)) {
    for (const TreeNode& one : field.children) {
      for (ReaderEnd& end : readers(one, topic)) {
        for (const ReaderEnd& other : all) {
          if (other.program != end.program || other.callback != end.callback) continue;
          file_.tree().fail("program " + end.name + " is there twice", one);
        }
        all.push_back(std::move(end));
      }
    }
    return all;
  }
  // "detector", "detector[1]", "detector.on_image", "detector[1].on_image".
  syntax::Reference reference = reference_of(field);
  std::string& name = reference.name.name.text;
  if (!file_.program_arrays.contains(name) && !reference.name.has_indices) {
    const std::size_t dot = name.find('.');
    if (dot != std::string::npos) {
      reference.part = name.substr(dot + 1);
      name.resize(dot);
    }
  }
  const auto array = file_.node_arrays.find(name);
  if (array == file_.node_arrays.end()) {
    for (const std::uint32_t program : programs(field)) {
      all.push_back({program, "", file_.programs[program].name});
    }
    return all;
  }
  const bool is_array_alone = !array->second.dimensions.empty() && !reference.name.has_indices;
  if (!reference.part.empty() && is_array_alone) {
    file_.tree().fail("unknown node '" + reference.text + "'", place_of(field));
  }
  for (const std::uint32_t member : members(field, reference, array->second)) {
    for (ReaderEnd& end : readers_of_node(field, file_.nodes[member], reference.part, topic)) {
      all.push_back(std::move(end));
    }
  }
  return all;
}

std::vector<ReaderEnd> References::readers_of_node(const TreeNode& field,
                                                   const NodeDeclaration& node,
                                                   const std::string& only,
                                                   const std::string& topic) const {
  std::vector<ReaderEnd> all;
  const std::vector<std::string> callbacks = takers(node, only, topic);
  if (callbacks.empty()) {
    file_.tree().fail("no callback of " + node.name + " takes from '" + topic + "'",
                      place_of(field));
  }
  for (const std::string& callback : callbacks) {
    const std::string whole = node.name + "." + callback;
    for (const std::uint32_t program : node.programs) {
      const auto& run = file_.programs[program].thread->callbacks;
      const bool has = std::any_of(run.begin(), run.end(),
                                   [&](const auto& other) { return other.whole_name() == whole; });
      if (!has) continue;
      all.push_back({program, whole, callbacks.size() == 1 && only.empty() ? node.name : whole});
      break;  // the runs of a callback are one reader
    }
  }
  return all;
}

std::vector<std::string> References::takers(const NodeDeclaration& node,
                                            const std::string& callback,
                                            const std::string& topic) const {
  std::vector<std::string> takers;
  const auto array = file_.names.models.find(topic.substr(0, topic.find('[')));
  for (const program_syntax::Callback& other : node.callbacks) {
    if (!other.takes || other.takes->model.name.text != array->first) continue;
    if (!callback.empty() && other.name != callback) continue;
    if (!array->second.dimensions.empty()) {
      std::string suffix;
      for (const Value index :
           indices_behind(file_, other.takes->model, array->second.dimensions, node.indices)) {
        suffix += (suffix.empty() ? "[" : ",") + std::to_string(index);
      }
      if (topic != array->first + suffix + "]") continue;
    }
    takers.push_back(other.name);
  }
  return takers;
}

}  // namespace maide
