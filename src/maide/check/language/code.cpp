#include "maide/check/language/code.hpp"

namespace maide::syntax {

// Here a Statement is complete.
Block::Block() = default;
Block::Block(Block&&) noexcept = default;
Block& Block::operator=(Block&&) noexcept = default;
Block::Block(const Block&) = default;
Block& Block::operator=(const Block&) = default;
Block::~Block() = default;

void for_each_statement(const Block& block, const std::function<void(const Statement&)>& visit) {
  for (const Statement& statement : block.statements) {
    visit(statement);
    for_each_statement(statement.body, visit);
    for_each_statement(statement.otherwise, visit);
    for (const Arm& arm : statement.arms) for_each_statement(arm.body, visit);
    for (const SelectArm& choice : statement.select_arms) {
      for_each_statement(choice.body, visit);
      for (const Arm& arm : choice.arms) for_each_statement(arm.body, visit);
    }
  }
}

}  // namespace maide::syntax
