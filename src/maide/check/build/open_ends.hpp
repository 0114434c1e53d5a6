// Anybody at an end of a topic or service: programs of his that the file does not write.
//
// Where he is the only one at his end, what he does has no states: what he may write is there at
// any time (rules/open_topic.hpp), and so is a request of his. There he is a program that does
// nothing. Beside others he is a further writer or client: a program that goes round for ever.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/build/declarations.hpp"

namespace maide {

// The program that stands for him where he does nothing that has a step. One a file.
std::uint32_t silent_anybody(Declarations& file, const SourcePosition& position);
// One that goes round for ever, and gives the input to that member of the topic or service, with
// each of the values: "image.anybody". No values: without one.
std::uint32_t busy_anybody(Declarations& file, const DeclaredArray& array, std::uint64_t member,
                           const std::string& input, const std::vector<std::string>& values,
                           const SourcePosition& position);
// What stands under `values:`, each as in "message(go)"; a range has all of its numbers. Throws
// ParseError.
std::vector<std::string> values_of_anybody(Declarations& file, const TreeNode& entry);
// The entry says `true` behind that key.
bool says(const TreeNode& entry, std::string_view key);

}  // namespace maide
