// `maide export MODEL|SYSTEM --to FORMAT`: a model, a whole system - its models and programs -
// or the automaton of a property, in another tool's language. A system's text may be long, so it is
// written as it comes.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/constant_settings.hpp"
#include "maide/check/build/stage_dump.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/export/step_rules.hpp"
#include "maide/check/engines/export/system_exporters.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/check/system/components.hpp"
#include "maide/check/text/tokens.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/cli/command.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/report/picture.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide::cli {

namespace {

struct ExportArguments {
  std::string source, initial;
  std::string format;
  std::string output;
  std::string component;  // a program of it; empty: the whole system
  bool lossy = false;
  std::string property;  // whose automaton is written; empty: the model, or the system
  bool negated = false;
  std::uint64_t memory_mib = 0;
  std::vector<std::string> settings;
};

// What is written, and what --json tells of it.
struct Export {
  std::function<void(std::ostream& out)> write;
  std::string summary;
  Json details;
};

std::string draw_model(const Model& model, const std::string& source, const RunControl& control) {
  const PictureSize size = size_of(model);
  if (!size.is_drawable()) {
    throw UsageError(fmt::format(
        "{} states and {} transitions are too many for a picture (at most {} and {}) ({})",
        size.states, size.transitions, most_drawn_states, most_drawn_transitions, source));
  }
  if (!can_draw()) {
    throw UsageError(
        "a picture needs Graphviz's program dot, and it is not on PATH (Debian: apt install "
        "graphviz)");
  }
  const std::string picture = draw_tikz(model_picture(model), control);
  if (picture.empty()) {
    throw UsageError("dot could not lay this out within 20 seconds (" + source + ")");
  }
  return "% \\usepackage{tikz}; then \\input this file. The styles are yours to change.\n" +
         picture;
}

Export export_model(const ExportArguments& arguments, Context& context) {
  const bool is_picture = arguments.format == tikz;
  const Exporter* exporter = is_picture ? nullptr : &find_exporter(arguments.format, {tikz});
  Model model = read_model(arguments.source, {arguments.initial, ModelReading::Labels::known});
  const auto* automaton = std::get_if<InterfaceAutomaton>(&model);
  if (automaton != nullptr && exporter != nullptr && exporter->takes_machines_alone) {
    try {
      model = to_mealy(*automaton, Translation::eager);
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("{} ({})", error.what(), arguments.source));
    }
  }
  const std::filesystem::path named =
      arguments.output.empty() ? arguments.source : arguments.output;
  std::ostringstream text;
  if (is_picture) {
    text << draw_model(model, arguments.source, context.control());
  } else {
    exporter->write(text, model,
                    {named.stem().string(), arguments.lossy ? MarkLoss::accept : MarkLoss::refuse});
  }
  const PictureSize size = size_of(model);
  return {[text = std::move(text).str()](std::ostream& out) { out << text; },
          fmt::format("{} states, {} transitions", size.states, size.transitions),
          Json{{"states", size.states}, {"transitions", size.transitions}}};
}

bool is_system(const std::string& source) {
  const std::string extension = std::filesystem::path(source).extension().string();
  return extension == ".yaml" || extension == ".yml" ||
         (extension == ".json" && is_stage_dump(read_file(source)));
}

System read_exported_system(const ExportArguments& arguments, Context& context) {
  const ModelSource models = make_learning_source(
      {{}, [](const std::string& line) { log_note(line); }, context.control()});
  return read_system(arguments.source, models, context.control(),
                     parse_settings(arguments.settings));
}

// A property's automaton: of the runs on which it holds, or of the others.
Export export_property(const ExportArguments& arguments, Context& context) {
  const System system = read_exported_system(arguments, context);
  const Property property = find_property(system, arguments.property);
  LtlAutomaton automaton;
  if (property.kind == Property::Kind::never) {
    if (!arguments.negated) {
      throw UsageError("property '" + property.name +
                       "' is an automaton of bad runs: it is written with --negated");
    }
    automaton = *property.never;
  } else if (property.kind == Property::Kind::ltl && !property.is_always_possible) {
    automaton = translate(arguments.negated
                              ? make_formula(FormulaNode::Operator::negation, property.formula)
                              : property.formula,
                          context.control());
  } else {
    throw UsageError("'" + property.name + "' is no formula and has no automaton");
  }
  std::size_t transitions = 0;
  for (const auto& state : automaton.states) transitions += state.size();
  const std::vector<ProgramInterface> interfaces = system.interfaces();
  std::ostringstream text;
  write_hoa(
      text, automaton, {system.programs, interfaces, system.expressions, &system.words},
      (arguments.negated ? "runs that violate " : "") + property.name + " of " + system.title());
  return {[text = std::move(text).str()](std::ostream& out) { out << text; },
          fmt::format("{} states, {} transitions", automaton.states.size(), transitions),
          Json{{"states", automaton.states.size()}, {"transitions", transitions}}};
}

constexpr std::size_t most_components_named = 3;  // in a message

// The component of that program; without one the whole system.
SystemPart find_part(const System& system, const SystemExporter& exporter,
                     const std::string& program) {
  const auto components = find_components(system);
  if (program.empty()) {
    if (components.size() < 2 || exporter.takes_components || !uses_second_edition(system)) {
      return SystemPart(system);
    }
    std::string first;
    for (std::size_t i = 0; i < std::min(components.size(), most_components_named); ++i) {
      first += (i == 0 ? "" : ", ") + system.programs[components[i].front()].name;
    }
    if (components.size() > most_components_named) first += ", ...";
    throw UsageError(
        fmt::format("the system has {} components, and {} takes one: --component "
                    "PROGRAM says whose, {} ({})",
                    components.size(), exporter.name, first, system.file));
  }
  std::vector<std::string> known;
  for (const auto& component : components) {
    for (const std::uint32_t index : component) {
      const Program& own = system.programs[index];
      const bool is_meant =
          own.name == program || std::ranges::find(own.nodes, program) != own.nodes.end();
      if (is_meant) return SystemPart(system, component);
      known.push_back(own.name);
    }
  }
  throw UsageError(fmt::format("there is no program or node '{}'; there is: {} ({})", program,
                               known_instead(program, known), system.file));
}

Export export_system(const ExportArguments& arguments, Context& context) {
  const SystemExporter& exporter = find_system_exporter(arguments.format);
  const auto whole = std::make_shared<const System>(read_exported_system(arguments, context));
  const auto part =
      std::make_shared<const SystemPart>(find_part(*whole, exporter, arguments.component));
  const System& system = part->system();
  const SystemExportOptions options{arguments.memory_mib << 20, context.control()};
  const Json details{{"models", system.models.size()}, {"programs", system.programs.size()}};
  const std::string summary =
      fmt::format("{} models, {} programs", system.models.size(), system.programs.size());
  return {[&exporter, whole, part, options](std::ostream& out) {
            exporter.write(out, part->system(), options);
          },
          summary, details};
}

std::string text_of(const Export& exported) {
  std::ostringstream text;
  exported.write(text);
  return std::move(text).str();
}

Export make_export(const ExportArguments& arguments, Context& context) {
  const bool is_hoa = arguments.format == "hoa";
  if (is_hoa != !arguments.property.empty()) {
    throw UsageError(
        "--to hoa writes the automaton of a system's property: it goes with "
        "--property NAME");
  }
  if (arguments.negated && !is_hoa) throw UsageError("--negated goes with --to hoa");
  if (!arguments.settings.empty() && !is_system(arguments.source)) {
    throw UsageError("--set goes with a system (" + arguments.source + ")");
  }
  if (!arguments.component.empty() && (is_hoa || !is_system(arguments.source))) {
    throw UsageError("--component goes with a system (.yaml) that is written whole");
  }
  if (is_hoa && !is_system(arguments.source)) {
    throw UsageError("a model has no properties; a system file (.yaml) has (" + arguments.source +
                     ")");
  }
  if (is_hoa) return export_property(arguments, context);
  return is_system(arguments.source) ? export_system(arguments, context)
                                     : export_model(arguments, context);
}

ExitStatus run_export(const ExportArguments& arguments, Context& context) {
  check_output("-o", arguments.output, {arguments.source});
  const Export exported = make_export(arguments, context);
  Json result{{"source", arguments.source}, {"format", arguments.format}};
  result.update(exported.details);
  if (!arguments.output.empty()) {
    write_file_atomically(arguments.output, exported.write);
    context.print(fmt::format("{}: {}\n", arguments.output, exported.summary));
    result["output"] = arguments.output;
  } else if (context.json()) {
    result["text"] = text_of(exported);
  } else {
    ChunkedStream out([&](std::string_view piece) { context.print_data(piece); });
    exported.write(out.stream());
    out.finish();
  }
  context.set_result(result);
  return ExitStatus::ok;
}

}  // namespace

RunFunction set_up_export(CommandLine& line) {
  auto arguments = std::make_shared<ExportArguments>();
  std::vector<std::string> formats = names_of(exporters());
  formats.insert(formats.end(), {std::string(tikz), "hoa"});
  line.add("SOURCE", arguments->source,
           "A model file (.dot, .gv or .aut), or a system file (.yaml)")
      .required();
  line.add("--to", arguments->format, "The format ('maide help formats'): " + join(formats))
      .offer(formats)
      .value_name("NAME")
      .required();
  line.add("--property", arguments->property,
           "With --to hoa: the automaton of the runs on which this holds")
      .value_name("NAME");
  line.add_flag("--negated", arguments->negated,
                "With --to hoa: of the runs on which it does not hold. `never:` takes it");
  line.add("--component", arguments->component,
           "Of a system: only the component of this program. That is the programs and models that "
           "it has something to do with. Formats other than aut need this if there are several "
           "components and a program has more than single inputs, outputs and choices")
      .value_name("PROGRAM");
  add_set_option(line, arguments->settings);
  line.add("--initial", arguments->initial, initial_help).value_name("STATE");
  line.add("-o,--output", arguments->output, "The file to write. Default: standard output")
      .value_name("FILE");
  line.add_flag("--lossy", arguments->lossy,
                "Write a model to aut even though aut cannot say what was never tried");
  line.add("--memory", arguments->memory_mib,
           "Most memory for a state graph (--to aut). Default: three quarters of the machine's")
      .between(1, std::uint64_t{1} << 30)
      .no_default()
      .value_name("MIB");
  return [arguments](Context& context) { return run_export(*arguments, context); };
}

}  // namespace maide::cli
