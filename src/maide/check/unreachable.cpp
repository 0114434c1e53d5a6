// Statements that control never reaches, by structure alone: those behind a `loop`, a `stop`, or a
// statement of which every branch ends in such. What a model never does is not looked at.
#include <algorithm>

#include "maide/check/program_syntax.hpp"

namespace maide::program_syntax {
namespace {

class Finder {
 public:
  explicit Finder(const std::string& file) : file_(file) {}

  // Whether control can come to the end of the block.
  bool can_end(const Block& block) {
    bool is_reached = true;
    for (const Statement& statement : block) {
      if (!is_reached) {
        found_.push_back({file_, statement.line, statement.column});
        return false;
      }
      is_reached = can_end(statement);
    }
    return is_reached;
  }

  std::vector<SourcePosition> take() { return std::move(found_); }

 private:
  bool can_end(const Statement& statement) {
    switch (statement.kind) {
      case Statement::Kind::stop: return false;
      case Statement::Kind::loop: can_end(*statement.body); return false;
      case Statement::Kind::repeat: return can_end(*statement.body) || statement.count == 0;
      case Statement::Kind::choice: {
        const bool first = can_end(*statement.body);
        return can_end(*statement.otherwise) || first;
      }
      default: break;
    }
    bool any = statement.arms.empty();
    for (const Arm& arm : statement.arms) any = can_end(*arm.body) || any;
    return any;
  }

  std::string file_;
  std::vector<SourcePosition> found_;
};

}  // namespace

std::vector<SourcePosition> find_unreachable(const Tree& tree, const std::string& file) {
  Finder finder(file);
  finder.can_end(tree.statements);
  std::vector<SourcePosition> found = finder.take();
  std::sort(found.begin(), found.end(), [](const SourcePosition& a, const SourcePosition& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  return found;
}

}  // namespace maide::program_syntax
