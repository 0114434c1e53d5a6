// Mutexes that know who holds them, and conditions: which programs use them. Who calls a procedure
// uses what its text names, and what is given to it.
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/build/declarations.hpp"
#include "maide/check/build/references.hpp"
#include "maide/check/language/code_parser.hpp"
#include "maide/check/rules/locks.hpp"

namespace maide {
namespace {

// Names of models in a program's text.
struct UsedNames {
  std::set<std::string> all, waited_at;
  std::set<std::string> procedures;
};

void add_names(const Declarations& file, const syntax::Code& code, UsedNames& used) {
  syntax::for_each_statement(code.block, [&](const syntax::Statement& statement) {
    using Kind = syntax::Statement::Kind;
    if (statement.kind == Kind::give || statement.kind == Kind::give_arms) {
      used.all.insert(statement.model.name.text);
      if (statement.event.name.text == "wait") used.waited_at.insert(statement.model.name.text);
    }
    for (const syntax::SelectArm& arm : statement.select_arms) used.all.insert(arm.model.name.text);
    if (statement.kind != Kind::call) return;
    for (const syntax::Term& argument : statement.arguments) {
      if (!argument.is_name()) continue;
      used.all.insert(argument.name.text);
      used.waited_at.insert(argument.name.text);
    }
    const auto procedure = file.names.procedures.find(statement.name.text);
    if (procedure == file.names.procedures.end()) return;
    if (used.procedures.insert(procedure->first).second) {
      add_names(file, *procedure->second.code, used);
    }
  });
}

UsedNames names_in(const Declarations& file, const ProgramDeclaration& program) {
  UsedNames used;
  if (program.code) add_names(file, *program.code, used);
  if (!program.thread) return used;
  const program_syntax::Thread& thread = *program.thread;
  const auto add = [&](const program_syntax::Callback& callback) {
    for (const syntax::Code* const code : codes_of(callback)) add_names(file, *code, used);
    if (callback.takes) used.all.insert(callback.takes->model.name.text);
  };
  std::ranges::for_each(thread.starts, add);
  std::ranges::for_each(thread.callbacks, add);
  if (thread.main) add(*thread.main);
  return used;
}

// The mutex that the condition's option names.
std::uint32_t mutex_of(Declarations& file, const TreeNode& option, const Indices& indices) {
  TreeNode named = option;
  named.reference = std::make_shared<const syntax::Reference>(syntax::parse_reference(ScalarText(
      option.text(), file.tree().document->text, file.tree().document->position(*option.yaml))));
  const auto array = file.names.models.find(named.reference->name.name.text);
  if (array == file.names.models.end() || array->second.is_topic) {
    file.tree().fail("there is no mutex '" + option.text() + "'", option);
  }
  const std::vector<std::uint32_t> members =
      References(file, indices).members(named, array->second);
  if (members.size() != 1) file.tree().fail("a condition has one mutex: say which", option);
  const ModelOrigin& origin = file.origins[members.front()];
  const bool is_mutex =
      origin.kind == ModelOrigin::Kind::recursive_mutex ||
      (origin.kind == ModelOrigin::Kind::built_in && origin.built_in->name == "mutex");
  if (!is_mutex) file.tree().fail("'" + option.text() + "' is no mutex", option);
  return members.front();
}

// A condition that belongs to one process begins anew with it.
void check_mortal_waiters(const Declarations& file, const TreeNode& entry,
                          const std::vector<std::uint32_t>& waiters,
                          const std::vector<std::uint32_t>& users) {
  for (const std::uint32_t waiter : waiters) {
    const ProgramDeclaration& program = file.programs[waiter];
    if (!program.may_die) continue;
    const bool is_its_own = std::ranges::all_of(
        users, [&](std::uint32_t user) { return file.programs[user].process == program.process; });
    if (is_its_own) continue;
    file.tree().fail_at_name(
        "who waits at a condition that is of several processes does not die yet: that is not built",
        entry);
  }
}

}  // namespace

void declare_locks(Declarations& file) {
  using Kind = ModelOrigin::Kind;
  const bool has_locks = std::ranges::any_of(file.origins, [](const ModelOrigin& origin) {
    return origin.kind == Kind::recursive_mutex || origin.kind == Kind::condition;
  });
  if (!has_locks) return;
  std::vector<UsedNames> used;
  for (const ProgramDeclaration& program : file.programs) used.push_back(names_in(file, program));
  for (const TreeNode& entry : file.tree().entries("models")) {
    const std::string& name = entry.declared->name.text;
    const ModelName& array = file.names.models.at(name);
    const auto users = [&](std::set<std::string> UsedNames::*which) {
      std::vector<std::uint32_t> programs;
      for (std::uint32_t program = 0; program < used.size(); ++program) {
        if ((used[program].*which).contains(name)) programs.push_back(program);
      }
      return programs;
    };
    DeclaredArray declared{name, {}, array.dimensions};
    for (const syntax::Index& index : entry.declared->indices) {
      declared.indices.push_back(index.name.text);
    }
    for (std::uint64_t member = 0; member < declared.count(); ++member) {
      const auto model = static_cast<std::uint32_t>(array.first + member);
      const ModelOrigin& origin = file.origins[model];
      if (origin.kind == ModelOrigin::Kind::recursive_mutex) {
        file.names.holders.emplace(model, users(&UsedNames::all));
      }
      if (origin.kind != ModelOrigin::Kind::condition) continue;
      ConditionVariable condition{0, users(&UsedNames::waited_at)};
      if (condition.waiters.size() > max_waiters) {
        file.tree().fail_at_name("at most " + std::to_string(max_waiters) +
                                     " programs wait at a condition, and at '" + name + "' " +
                                     std::to_string(condition.waiters.size()) + " may",
                                 entry);
      }
      check_mortal_waiters(file, entry, condition.waiters, users(&UsedNames::all));
      condition.mutex = mutex_of(file, *origin.of_condition, declared.indices_of(member));
      file.names.conditions.emplace(model, std::move(condition));
    }
  }
  // Who waits takes the mutex.
  for (const auto& [model, condition] : file.names.conditions) {
    const auto holders = file.names.holders.find(condition.mutex);
    if (holders == file.names.holders.end()) continue;
    std::vector<std::uint32_t> all;
    std::ranges::set_union(holders->second, condition.waiters, std::back_inserter(all));
    holders->second = std::move(all);
  }
}

}  // namespace maide
