// Options of commands that read C++ sources, and what they say of what was not understood.
#pragma once

#include <string>
#include <vector>

#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/extract/extract.hpp"

namespace maide::cli {

struct SourceArguments {
  std::string executor, assume;
  std::vector<std::string> includes, tables;
  bool is_closed = false;
  std::size_t most_holes = 0;  // kinds of holes that the file names; 0: all
};

// What is taken for granted, and what runs nodes of which nothing tells.
void add_source_options(CommandLine& line, SourceArguments& arguments);
// Folders of headers, and tables.
void add_reading_options(CommandLine& line, SourceArguments& arguments);

// Reads the sources; says how far it has come where that takes long. Throws UsageError.
extract::Extracted extract_sources(const std::vector<std::string>& sources,
                                   const SourceArguments& arguments, Context& context);

// Whether this names C++ sources, or a folder of them, and no system file.
bool names_sources(const std::string& argument);

// A line for each kind of hole, the most frequent first; "" if there is none.
std::string describe_holes(const extract::Extracted& found);
// What is taken for granted, a line each.
std::string describe_assumptions(const extract::Extracted& found);
Json holes_to_json(const extract::Extracted& found);

}  // namespace maide::cli
