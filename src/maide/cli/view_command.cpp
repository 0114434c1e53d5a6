// `maide view MODEL|SYSTEM|TRACE`: pictures, as one page or one SVG file, and stages of reading a
// system. What the source is, its extension says.
#include <fmt/format.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/check/build/constant_settings.hpp"
#include "maide/check/build/stage_dump.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/cli/command.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/report/picture.hpp"
#include "maide/report/picture_page.hpp"
#include "maide/report/sequence_chart.hpp"
#include "maide/report/trace_text.hpp"

namespace maide::cli {

namespace {

namespace fs = std::filesystem;

struct ViewArguments {
  std::string source, initial;
  std::string output;
  std::string stage;
  std::vector<std::string> settings;
};

std::string extension_of(const std::string& path) { return fs::path(path).extension().string(); }

// A place for a page that nobody named: in a folder of its own, so that no other user's file of
// that name is in the way.
std::string temporary_page(const std::string& source) {
  std::error_code ignored;
  fs::path folder = fs::temp_directory_path(ignored);
  if (ignored) folder = "/tmp";
  std::string made = (folder / "maide-view-XXXXXX").string();
  if (::mkdtemp(made.data()) == nullptr) {
    throw UsageError("there is no folder for the page; -o FILE.html says where (" + made + ")");
  }
  return (fs::path(made) / (fs::path(source).stem().string() + ".html")).string();
}

// One picture of its own must be drawn; on a page a missing one is said there.
std::string drawn(const std::string& dot, const std::string& source, const RunControl& control) {
  if (!can_draw()) {
    throw UsageError(
        "a picture needs Graphviz's program dot, and it is not on PATH (Debian: apt "
        "install graphviz)");
  }
  const std::string svg = draw_svg(dot, control);
  if (svg.empty()) throw UsageError("dot could not draw this within 20 seconds (" + source + ")");
  return stand_alone(svg);
}

std::string view_model(const ViewArguments& arguments, bool is_svg, const RunControl& control) {
  const Model model =
      read_model(arguments.source, {arguments.initial, ModelReading::Labels::any_where_needed});
  if (is_svg) {
    const PictureSize size = size_of(model);
    if (!size.is_drawable()) {
      throw UsageError(fmt::format(
          "{} states and {} transitions are too many for a picture (at most {} and {}): -o "
          "FILE.html makes a table ({})",
          size.states, size.transitions, most_drawn_states, most_drawn_transitions,
          arguments.source));
    }
    return drawn(model_picture(model), arguments.source, control);
  }
  std::ostringstream page;
  write_model_page(page, model, arguments.source,
                   [&](const std::string& dot) { return draw_svg(dot, control); });
  return std::move(page).str();
}

ModelSource models_for(const RunControl& control) {
  return make_learning_source({{}, [](const std::string& line) { log_note(line); }, control});
}

std::string view_system(const ViewArguments& arguments, bool is_svg, const RunControl& control) {
  const System system = read_system(arguments.source, models_for(control), control,
                                    parse_settings(arguments.settings));
  if (is_svg) return drawn(connection_picture(system), arguments.source, control);
  std::ostringstream page;
  write_system_page(page, system, system.sources.at(system.file),
                    [&](const std::string& dot) { return draw_svg(dot, control); });
  return std::move(page).str();
}

std::string view_trace(const ViewArguments& arguments, bool is_svg, const RunControl& control) {
  SequenceChart chart = chart_of_trace(read_file(arguments.source, control), arguments.source);
  std::string title = chart.title.empty() ? arguments.source : chart.title;
  if (!is_svg) chart.title.clear();
  std::ostringstream svg;
  write_sequence_chart_svg(svg, chart);
  if (is_svg) return std::move(svg).str();
  std::ostringstream page;
  write_chart_page(page, svg.str(), title);
  return std::move(page).str();
}

ExitStatus view_stage(const ViewArguments& arguments, Context& context) {
  const std::string text =
      dump_stage(*find_stage(arguments.stage), read_file(arguments.source, context.control()),
                 arguments.source, models_for(context.control()), context.control(),
                 parse_settings(arguments.settings));
  Json result{{"source", arguments.source}, {"kind", "stage"}, {"stage", arguments.stage}};
  // A dump may be so long that it takes a while to hand it on.
  constexpr std::size_t piece = std::size_t{1} << 20;
  const auto hand_on = [&](const std::function<void(std::string_view)>& take) {
    for (std::size_t at = 0; at < text.size(); at += piece) {
      context.control().check("writing the dump");
      take(std::string_view(text).substr(at, piece));
    }
  };
  if (arguments.output.empty()) {
    if (context.json()) {
      result["text"] = text;
    } else {
      hand_on([&](std::string_view part) { context.print_data(part); });
    }
  } else {
    write_file_atomically(arguments.output, [&](std::ostream& out) {
      hand_on([&](std::string_view part) { out << part; });
    });
    context.print(arguments.output + "\n");
    result["output"] = arguments.output;
  }
  context.set_result(result);
  return ExitStatus::ok;
}

ExitStatus run_view(const ViewArguments& arguments, Context& context) {
  check_output("-o", arguments.output, {arguments.source});
  if (!arguments.stage.empty()) return view_stage(arguments, context);
  const std::string source = extension_of(arguments.source);
  const bool is_system =
      source == ".yaml" || source == ".yml" ||
      (source == ".json" && is_stage_dump(read_file(arguments.source, context.control())));
  if (!is_system && !arguments.settings.empty()) {
    throw UsageError("--set goes with a system (" + arguments.source + ")");
  }
  const bool is_svg = extension_of(arguments.output) == ".svg";
  if (!arguments.output.empty() && !is_svg && extension_of(arguments.output) != ".html") {
    throw UsageError("a picture's name ends in .html or .svg (" + arguments.output + ")");
  }
  std::string text;
  const char* kind = "model";
  if (is_system) {
    kind = "system";
    text = view_system(arguments, is_svg, context.control());
  } else if (source == ".json") {
    kind = "trace";
    text = view_trace(arguments, is_svg, context.control());
  } else if (source == ".dot" || source == ".gv" || source == ".aut") {
    text = view_model(arguments, is_svg, context.control());
  } else {
    throw UsageError(
        "what is viewed is a model (.dot, .gv, .aut), a system (.yaml) or a trace "
        "(.json), and this is none (" +
        arguments.source + ")");
  }
  if (!is_svg && std::string_view(kind) != "trace" && !can_draw()) {
    log_note("no pictures: Graphviz's program dot is not on PATH (Debian: apt install graphviz)");
  }
  const std::string output =
      arguments.output.empty() ? temporary_page(arguments.source) : arguments.output;
  write_file_atomically(output, text);
  context.print(output + "\n");
  context.set_result(Json{{"source", arguments.source}, {"kind", kind}, {"output", output}});
  return ExitStatus::ok;
}

}  // namespace

RunFunction set_up_view(CommandLine& line) {
  auto arguments = std::make_shared<ViewArguments>();
  line.add("SOURCE", arguments->source,
           "A model (.dot, .gv, .aut), a system (.yaml), or a trace (.json). `maide check --trace` "
           "writes one")
      .required();
  line.add(
          "--stage", arguments->stage,
          "Of a system: in place of pictures, what this stage of reading made of it. `tree` is the "
          "file in one style, `names` what its names are, `models` the automata, too, `system` "
          "what "
          "is searched. `check` and all that read a system take the result in its place")
      .one_of({"tree", "names", "models", "system"})
      .value_name("STAGE");
  add_set_option(line, arguments->settings);
  line.add("--initial", arguments->initial, initial_help).value_name("STATE");
  line.add("-o,--output", arguments->output,
           "The page (.html), or one picture (.svg). The picture is of the model, the system's "
           "connections, or the trace. Default: a page in a temporary folder, whose path is "
           "printed")
      .value_name("FILE");
  return [arguments](Context& context) { return run_view(*arguments, context); };
}

}  // namespace maide::cli
