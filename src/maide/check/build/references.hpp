// Who a reference of a system file means: programs, nodes, callbacks, services. An array's name
// means all its members, and a name with indices one of them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "maide/check/build/declarations.hpp"

namespace maide {

// A reader of a topic: a program, or a callback of a node.
struct ReaderEnd {
  std::uint32_t program = 0;
  std::string callback, name;  // "detector.on_image" and "detector", where that says it
};

// Who stands at ends in place of programs and nodes of the file, which are not named so.
inline constexpr const char* anybody = "anybody";
bool is_anybody(const Declarations& file, const TreeNode& field);
// The field, or one of its list, is he.
bool names_anybody(const Declarations& file, const TreeNode& field);

// He is left out of all that is named here, but for names_anybody().
class References {
 public:
  // Keeps a reference to the file. `indices`: those of the array's member that refers.
  References(Declarations& file, const Indices& indices) : file_(file), indices_(indices) {}

  // Members of the array, by their numbers.
  std::vector<std::uint32_t> members(const TreeNode& field, const ModelName& array) const;
  // A program's number for each that the field names; of a node those that run its callbacks.
  std::vector<std::uint32_t> programs(const TreeNode& field) const;
  // Nodes that share an executor are run by one program, which is there once.
  std::vector<std::uint32_t> writers(const TreeNode& field) const;
  std::vector<End> ends(const TreeNode& field) const;
  std::vector<ReaderEnd> readers(const TreeNode& field, const std::string& topic) const;
  std::vector<std::uint32_t> services(const TreeNode& field) const;

 private:
  std::vector<std::uint32_t> members(const TreeNode& field, const syntax::Reference& reference,
                                     const ModelName& array) const;
  std::vector<ReaderEnd> readers_of_node(const TreeNode& field, const NodeDeclaration& node,
                                         const std::string& only, const std::string& topic) const;
  // The node's callbacks that take from that topic; only the one of that name, unless it is empty.
  std::vector<std::string> takers(const NodeDeclaration& node, const std::string& callback,
                                  const std::string& topic) const;

  Declarations& file_;
  const Indices& indices_;
};

}  // namespace maide
