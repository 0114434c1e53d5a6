#include "maide/extract/extract.hpp"

#include <string>
#include <vector>

#include "maide/base/error.hpp"
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
  const Sources sources = read_sources(files, options.front_end, control);
  const Model model = read_entries(sources, table);
  Extracted result;
  result.files = files.size();
  result.nodes = model.nodes.size();
  result.holes = model.holes;
  if (!options.assumes_ok) result.assumptions.emplace_back("ok() is true");
  if (!options.assumes_exceptions) result.assumptions.emplace_back("no exception is thrown");
  write_system(model, options, result);
  return result;
}

}  // namespace maide::extract
