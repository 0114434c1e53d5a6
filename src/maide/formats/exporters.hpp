// The formats that models are exported to, in one table: `maide export --to NAME`.
#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <string_view>

#include "maide/formats/aut.hpp"
#include "maide/formats/labelled_graph.hpp"

namespace maide {

struct ExportOptions {
  std::string name = "Model";  // of the class, where the format has one
  MarkLoss marks = MarkLoss::refuse;
};

struct Exporter {
  std::string_view name;       // as in --to
  std::string_view extension;  // of its files, with the dot
  std::string_view summary;
  void (*write)(std::ostream& out, const Model& model, const ExportOptions& options);
};

std::span<const Exporter> exporters();
// Throws UsageError "unknown format 'x'; known are: ...".
const Exporter& find_exporter(std::string_view name);

}  // namespace maide
