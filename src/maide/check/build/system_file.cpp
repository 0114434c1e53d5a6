#include "maide/check/build/system_file.hpp"

#include "maide/base/file.hpp"
#include "maide/check/build/build_system.hpp"
#include "maide/check/build/constant_settings.hpp"
#include "maide/check/build/stage_dump.hpp"

namespace maide {

System parse_system(std::string_view text, const std::string& file, const ModelSource& source,
                    const RunControl& control, const std::vector<ConstantSetting>& settings,
                    Deliveries deliveries) {
  if (is_stage_dump(text)) return parse_stage_dump(text, file, source, control, settings);
  const std::string changed = with_settings(std::string(text), file, settings);
  const Declarations declared = declare(read_tree(changed, file), deliveries);
  System system = build_system(declared, find_models(declared, source, {}, control), {}, control);
  system.settings = settings;
  return system;
}

System read_system(const std::filesystem::path& path, const ModelSource& source,
                   const RunControl& control, const std::vector<ConstantSetting>& settings,
                   Deliveries deliveries) {
  const std::string text = read_file(path, control);
  return parse_system(text, path.string(), source, control, settings, deliveries);
}

}  // namespace maide
