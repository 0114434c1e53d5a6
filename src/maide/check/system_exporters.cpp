#include "maide/check/system_exporters.hpp"

#include <unistd.h>

#include <array>
#include <ostream>

#include "maide/base/named_table.hpp"
#include "maide/check/aut_system.hpp"
#include "maide/check/mcrl2_system.hpp"
#include "maide/check/promela_system.hpp"
#include "maide/check/smv_system.hpp"

namespace maide {

namespace {

std::uint64_t default_bytes() {
  return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE)) / 4 * 3;
}

constexpr std::array<SystemExporter, 4> table{{
    {"promela", "Promela, SPIN's language",
     [](std::ostream& out, const System& system, const SystemExportOptions&) {
       out << write_promela(system).text;
     }},
    {"aut", "the graph of its states, for CADP, mCRL2 and LTSmin",
     [](std::ostream& out, const System& system, const SystemExportOptions& options) {
       write_aut(out, system, options.bytes != 0 ? options.bytes : default_bytes(),
                 options.control);
     }},
    {"smv", "the language of NuSMV and nuXmv",
     [](std::ostream& out, const System& system, const SystemExportOptions&) {
       write_smv(out, system);
     }},
    {"mcrl2", "mCRL2, the process algebra",
     [](std::ostream& out, const System& system, const SystemExportOptions&) {
       write_mcrl2(out, system);
     }},
}};

}  // namespace

std::span<const SystemExporter> system_exporters() { return table; }

const SystemExporter& find_system_exporter(std::string_view name) {
  return find_row(system_exporters(), "format of systems", name);
}

}  // namespace maide
