#include "maide/join/check_system_file.hpp"

#include "maide/base/file.hpp"
#include "maide/ros2/executor_runs.hpp"

namespace maide {

CheckedSystem check_system_text(std::string_view text, const std::string& file, Engine& engine,
                                const CheckRequest& request, const ModelSource& models,
                                const std::vector<ConstantSetting>& settings) {
  const RunControl& control = request.options.control;
  CheckedSystem checked;
  checked.system = parse_system(text, file, models, control, settings);
  checked.report = check_system(checked.system, engine, request);
  prefer_runs_of_executors(checked.system, checked.report, control);
  return checked;
}

CheckedSystem check_system_file(const std::filesystem::path& path, Engine& engine,
                                const CheckRequest& request, const LearnedModelsOptions& models,
                                const std::vector<ConstantSetting>& settings) {
  require_fitting(engine, request.options);
  return check_system_text(read_file(path, request.options.control), path.string(), engine, request,
                           make_learning_source(models), settings);
}

}  // namespace maide
