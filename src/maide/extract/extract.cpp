#include "maide/extract/extract.hpp"

#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/extract/api_table.hpp"
#include "maide/extract/entries.hpp"
#include "maide/extract/write_system.hpp"

namespace maide::extract {

Extracted extract_system(const std::vector<std::string>& arguments, const ExtractOptions& options,
                         const RunControl& control) {
  ApiTable table;
  for (const auto& file : own_api_tables()) table.read(file);
  for (const std::string& file : options.tables) table.read(file);
  const auto files = find_sources(arguments);
  FrontEndOptions front_end = options.front_end;
  front_end.macro_definitions = table.macro_definitions();
  front_end.macro_names = table.macro_names();
  const Sources sources = read_sources(files, front_end, control);
  const Model model = read_entries(sources, table);
  Extracted result;
  result.files = files.size();
  result.nodes = model.nodes.size();
  result.holes = model.holes;
  if (!options.assumes_ok) result.assumptions.emplace_back("ok() is true");
  if (!options.assumes_exceptions) result.assumptions.emplace_back("no exception is thrown");
  if (!options.assumes_read) {
    result.assumptions.emplace_back(
        "nothing of the sources was lost (docs/extract.md lists what is known to be)");
  }
  write_system(model, options, result);
  for (const Hole& hole : result.holes) {
    const auto text = sources.texts.find(hole.place.file);
    if (text == sources.texts.end()) continue;
    const std::vector<std::string_view> lines = split_lines(text->second);
    const auto line = static_cast<std::size_t>(hole.place.line);
    if (line > 0 && line <= lines.size()) result.lines[hole.place] = one_line(lines[line - 1]);
  }
  return result;
}

}  // namespace maide::extract
