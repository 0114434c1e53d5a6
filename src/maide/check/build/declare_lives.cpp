// Processes that may die: by themselves, because some code kills them, or because their own code
// ends them; and whether they begin anew.
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/build/declarations.hpp"
#include "maide/check/build/open_ends.hpp"
#include "maide/check/rules/life.hpp"

namespace maide {
namespace {

constexpr std::uint32_t most_restarts = 100;

// What the file says of a process.
struct ProcessWish {
  std::string shown;  // "driver"
  std::vector<std::uint32_t> programs;
  bool may_die = false;
  bool is_ended = false;  // by its own code, or killed
  bool is_told = false;   // to begin anew
  std::uint32_t restarts = 0;
  const TreeNode* may_restart = nullptr;
};

class LifeMaker {
 public:
  explicit LifeMaker(Declarations& file) : file_(file) {}

  void make() {
    find_processes();
    find_statements();
    for (auto& [process, wish] : wishes_) {
      const bool dies = wish.may_die || wish.is_ended;
      if (wish.programs.empty()) continue;  // an executor without nodes
      if (wish.may_restart != nullptr && !dies) {
        file_.tree().fail("'may_restart' goes with 'may_die: true', or with a 'kill'",
                          *wish.may_restart);
      }
      if (!dies) continue;
      for (const std::uint32_t program : wish.programs) file_.programs[program].may_die = true;
      const bool ends_alone = wish.programs.size() == 1 && !wish.is_ended && wish.restarts == 0;
      if (!ends_alone) add_life(wish);
    }
    for (const auto& [name, process] : names_) {
      const auto program = wishes_.at(process).programs;
      if (program.empty()) continue;
      const auto life = file_.names.life_of_program.find(program.front());
      if (life == file_.names.life_of_program.end()) continue;
      file_.names.life_of_name.emplace(name, life->second);
    }
  }

 private:
  void find_processes() {
    for (std::uint32_t number = 0; number < file_.programs.size(); ++number) {
      const ProgramDeclaration& program = file_.programs[number];
      ProcessWish& wish = wishes_[program.process];
      wish.shown = program.name;
      wish.programs.push_back(number);
      if (program.code && !program.thread) names_.emplace(program.name, program.process);
    }
    for (const TreeNode& entry : file_.tree().entries("programs")) {
      if (!entry.is_map()) continue;
      const ModelName& array = file_.program_arrays.at(entry.declared->name.text);
      for (std::uint32_t member = 0; member < member_count(array.dimensions); ++member) {
        read(entry, file_.programs[array.first + member].process);
      }
    }
    for (const ExecutorDeclaration& executor : file_.executors) {
      const std::string process = process_of(*executor.entry, "executor " + executor.name);
      names_.insert_or_assign(executor.name, process);
      wishes_[process].shown = executor.name;
      if (executor.entry->key->path == "executors/*") read(*executor.entry, process);
    }
    constexpr std::string_view shared = "process ";
    for (auto& [process, wish] : wishes_) {
      if (!process.starts_with(shared)) continue;
      wish.shown = process.substr(shared.size());
      names_.emplace(wish.shown, process);
    }
  }

  void read(const TreeNode& entry, const std::string& process) {
    ProcessWish& wish = wishes_[process];
    wish.may_die = wish.may_die || says(entry, "may_die");
    const TreeNode* const may_restart = entry.find("may_restart");
    if (may_restart == nullptr || may_restart->is("false")) return;
    wish.may_restart = may_restart;
    if (may_restart->is("true")) {
      wish.restarts = std::max(wish.restarts, 1U);
      return;
    }
    const std::uint32_t count = count_of(constant_of(file_, *may_restart->number), most_restarts);
    if (count == 0) {
      file_.tree().fail(
          "'may_restart' is true, or a number from 1 to " + std::to_string(most_restarts),
          *may_restart);
    }
    wish.restarts = std::max(wish.restarts, count);
  }

  // Those of `kill`, `restart` and `end`.
  void find_statements() {
    for_each_code(file_.tree().root, [&](const syntax::Code& code) {
      syntax::for_each_statement(code.block, [&](const syntax::Statement& statement) {
        using Kind = syntax::Statement::Kind;
        if (statement.kind != Kind::kill && statement.kind != Kind::restart) return;
        ProcessWish& wish = wishes_.at(process_named(code, statement.name));
        wish.is_ended = true;
        wish.is_told = wish.is_told || statement.kind == Kind::restart;
      });
    });
    const auto procedures = file_.tree().entries("procedures");
    const bool all_end = std::ranges::any_of(
        procedures, [](const TreeNode& procedure) { return says_end(*procedure.code); });
    for (const ProgramDeclaration& program : file_.programs) {
      if (all_end || ends_itself(program)) wishes_.at(program.process).is_ended = true;
    }
  }

  const std::string& process_named(const syntax::Code& code, const syntax::Name& name) const {
    const SourcePosition position{code.file, name.place.line, name.place.column};
    const auto place = names_.find(name.text);
    if (place != names_.end()) {
      if (!wishes_.at(place->second).programs.empty()) return place->second;
      throw ParseError("nothing runs on executor '" + name.text + "'", position);
    }
    std::vector<std::string> known;
    for (const auto& [other, process] : names_) known.push_back(other);
    throw ParseError("no executor, program or process is called '" + name.text +
                         "'; there is: " + known_instead(name.text, known),
                     position);
  }

  static bool says_end(const syntax::Code& code) {
    bool found = false;
    syntax::for_each_statement(code.block, [&](const syntax::Statement& statement) {
      found = found || statement.kind == syntax::Statement::Kind::end;
    });
    return found;
  }

  static bool ends_itself(const ProgramDeclaration& program) {
    if (!program.thread) return says_end(*program.code);
    const auto says = [](const program_syntax::Callback& callback) {
      return std::ranges::any_of(codes_of(callback),
                                 [](const syntax::Code* code) { return says_end(*code); });
    };
    const program_syntax::Thread& thread = *program.thread;
    return std::ranges::any_of(thread.starts, says) ||
           std::ranges::any_of(thread.callbacks, says) || (thread.main && says(*thread.main));
  }

  void add_life(const ProcessWish& wish) {
    Life life;
    life.process = wish.shown;
    life.programs = wish.programs;
    life.may_die = wish.may_die;
    life.is_told = wish.is_told;
    life.may_begin_anew = wish.is_told || wish.restarts > 0;
    life.group = static_cast<std::uint32_t>(file_.names.lives.size() + 1);
    life.rules = std::make_shared<LifeRules>(static_cast<std::uint32_t>(wish.programs.size()),
                                             wish.restarts);
    const ProgramDeclaration& first = file_.programs[wish.programs.front()];
    life.model =
        add_hidden_model(file_, wish.shown + ".life", life.rules->automaton(), first.position);
    for (const std::uint32_t program : wish.programs) {
      for (const std::string& node : file_.programs[program].nodes) {
        if (std::ranges::find(life.nodes, node) == life.nodes.end()) life.nodes.push_back(node);
      }
      file_.names.life_of_program.emplace(program, file_.names.lives.size());
    }
    file_.names.lives.push_back(std::move(life));
  }

  Declarations& file_;
  std::map<std::string, ProcessWish> wishes_;  // by process
  std::map<std::string, std::string> names_;   // of what `kill` takes: the process
};

}  // namespace

void declare_lives(Declarations& file) { LifeMaker(file).make(); }

}  // namespace maide
