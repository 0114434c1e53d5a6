#include "maide/formats/exporters.hpp"

#include <array>

#include "maide/base/named_table.hpp"
#include "maide/formats/cpp_source.hpp"
#include "maide/formats/dot.hpp"
#include "maide/formats/mcrl2.hpp"
#include "maide/formats/promela.hpp"
#include "maide/formats/smv.hpp"

namespace maide {

namespace {

constexpr std::array<Exporter, 6> table{{
    {"dot", ".dot", "Graphviz, the format in which models are kept",
     [](std::ostream& out, const Model& model, const ExportOptions&) { write_dot(out, model); }},
    {"aut", ".aut", "Aldebaran, read by CADP, mCRL2 and LTSmin",
     [](std::ostream& out, const Model& model, const ExportOptions& options) {
       write_aut(out, model, options.marks);
     }},
    {"promela", ".pml", "Promela, SPIN's language",
     [](std::ostream& out, const Model& model, const ExportOptions&) {
       write_promela(out, model);
     }},
    {"smv", ".smv", "the language of NuSMV and nuXmv",
     [](std::ostream& out, const Model& model, const ExportOptions&) { write_smv(out, model); }},
    {"mcrl2", ".mcrl2", "mCRL2, the process algebra",
     [](std::ostream& out, const Model& model, const ExportOptions&) { write_mcrl2(out, model); }},
    {"cpp", ".hpp", "a C++ class, in one header",
     [](std::ostream& out, const Model& model, const ExportOptions& options) {
       write_cpp(out, model, options.name);
     }},
}};

}  // namespace

std::span<const Exporter> exporters() { return table; }

const Exporter& find_exporter(std::string_view name) {
  return find_row(exporters(), "format", name);
}

}  // namespace maide
