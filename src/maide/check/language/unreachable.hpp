// Statements that control never reaches, from the text alone: a walk over the syntax tree finds for
// each block whether control comes to its end, leaves its loop or returns from its procedure. Both
// branches of a condition count. A loop ends, unless a constant says that it goes round for ever.
#pragma once

#include <string>
#include <vector>

#include "maide/check/language/program_tree.hpp"
#include "maide/check/text/scalar_text.hpp"

namespace maide::program_syntax {

// The first statement of each block that control never reaches.
std::vector<SourcePosition> find_unreachable(const Tree& tree, const std::string& file);

}  // namespace maide::program_syntax
