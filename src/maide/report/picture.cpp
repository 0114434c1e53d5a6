#include "maide/report/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/base/text.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/dot_syntax.hpp"
#include "maide/formats/names.hpp"
#include "maide/report/sequence_chart.hpp"
#include "maide/report/state_names.hpp"

namespace maide {

bool can_draw() { return find_on_path("dot").has_value(); }

std::string draw_svg(const std::string& dot, const RunControl& control) {
  if (!can_draw()) return "";
  SubprocessOptions options;
  options.input = dot;
  options.time_limit = std::chrono::seconds(20);
  const SubprocessResult drawn = run_program({"dot", "-Tsvg"}, options, control);
  const std::size_t begin = drawn.out.find("<svg");
  return drawn.succeeded() && begin != std::string::npos ? drawn.out.substr(begin) : "";
}

namespace {

constexpr std::size_t most_lines = 8;  // of a label

// The edges of a picture: those between the same nodes and of the same class become one.
class Edges {
 public:
  // Returns the edge's number.
  std::size_t add(const std::string& from, const std::string& to, const std::string& kind,
                  const std::string& line) {
    const auto [place, is_new] = lines_.try_emplace({from, to, kind});
    if (is_new) order_.push_back(place->first);
    if (is_new) place->second.number = order_.size() - 1;
    place->second.lines.push_back(line);
    return place->second.number;
  }

  // With ids the edge number i has the id "e<i>".
  std::string text(bool has_ids = false) const {
    std::string text;
    for (const Key& key : order_) {
      const auto& [from, to, kind] = key;
      const Edge& edge = lines_.at(key);
      text += fmt::format("  {} -> {} [class=\"{}\"{} label={}];\n", from, to, kind,
                          has_ids ? fmt::format(" id=\"e{}\"", edge.number) : "",
                          quote_dot_label(label(edge.lines)));
    }
    return text;
  }

 private:
  using Key = std::tuple<std::string, std::string, std::string>;
  struct Edge {
    std::size_t number = 0;
    std::vector<std::string> lines;
  };

  static std::string label(const std::vector<std::string>& lines) {
    std::string text;
    const bool is_cut = lines.size() > most_lines;
    const std::size_t shown = is_cut ? most_lines - 1 : lines.size();
    for (std::size_t i = 0; i < shown; ++i) text += (i == 0 ? " " : "\n ") + lines[i] + " ";
    if (is_cut) text += fmt::format("\n and {} more ", lines.size() - shown);
    return text;
  }

  std::map<Key, Edge> lines_;
  std::vector<Key> order_;
};

std::string node(std::size_t number) { return "n" + std::to_string(number); }

std::string head(const char* direction) {
  return fmt::format(
      "digraph picture {{\n  bgcolor=transparent; rankdir={}; nodesep=0.35; ranksep=0.45;\n"
      "  node [fontname=\"Helvetica,Arial,sans-serif\" fontsize=12 width=0.4 height=0.4 "
      "margin=\"0.08,0.04\"];\n  edge [fontname=\"Helvetica,Arial,sans-serif\" fontsize=11 "
      "arrowsize=0.7];\n",
      direction);
}

std::string start_at(std::size_t initial) {
  return fmt::format(
      "  start [shape=point width=0.08 class=\"start\"];\n  start -> {} "
      "[class=\"start\"];\n",
      node(initial));
}

std::string state(std::size_t number, const char* kind, const std::string& label,
                  const char* shape = "circle") {
  return fmt::format("  {} [shape={} class=\"{}\" label={}];\n", node(number), shape, kind,
                     quote_dot_label(label));
}

// A name takes room: in a larger picture a state has its number alone.
constexpr std::size_t most_named_states = 60;

template <typename Automaton>
std::vector<std::string> names_of(const Automaton& automaton) {
  return automaton.size() <= most_named_states ? name_states(automaton)
                                               : std::vector<std::string>();
}

const char* shape_of(std::size_t states) {
  return states <= most_named_states ? "box style=rounded" : "circle";
}

// In lines of some words.
std::string folded(const std::string& name) {
  constexpr std::size_t widest = 20;
  std::string lines;
  for (const auto line : split(name, '\n')) lines += wrap(line, widest, 0);
  lines.pop_back();  // the line break at the end
  return lines;
}

// The number, and below it the name.
std::string state_label(StateId state, const std::vector<std::string>& names) {
  return std::to_string(state) + (names.empty() ? "" : "\n" + folded(names[state]));
}

std::string picture_of(const NondeterministicMealy& machine) {
  std::string text = head("TB") + start_at(machine.initial());
  const std::vector<std::string> names = names_of(machine);
  Edges edges;
  for (StateId from = 0; from < machine.size(); ++from) {
    text += state(from, "state", state_label(from, names), shape_of(machine.size()));
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      for (const auto& choice : machine.choices(from, input)) {
        edges.add(node(from), node(choice.target), "both",
                  mealy_label(machine.inputs().name(input), machine.outputs().name(choice.output)));
      }
    }
  }
  return text + edges.text() + "}\n";
}

std::string picture_of(const InterfaceAutomaton& automaton) {
  std::string text = head("TB") + start_at(automaton.initial());
  const std::vector<std::string> names = names_of(automaton);
  const std::set<std::string> hidden(automaton.hidden_returns.begin(),
                                     automaton.hidden_returns.end());
  Edges edges;
  for (StateId from = 0; from < automaton.size(); ++from) {
    text += state(from, automaton.is_quiescent(from) ? "state" : "due", state_label(from, names),
                  shape_of(automaton.size()));
    std::vector<std::string> untried;
    for (const auto& transition : automaton.transitions(from)) {
      const std::string name = automaton.name(transition.action);
      if (transition.absorbed) {
        untried.push_back(name);
      } else if (transition.action.is_input()) {
        const bool is_hidden = hidden.contains(name.substr(1));
        edges.add(node(from), node(transition.target), "input",
                  is_hidden ? name + " (return not seen)" : name);
      } else {
        edges.add(node(from), node(transition.target), "output", name);
      }
    }
    for (const Symbol input : automaton.unexplored(from)) {
      untried.push_back(automaton.name({Action::Kind::input, input}));
    }
    if (untried.empty()) continue;
    const std::string beyond = "u" + std::to_string(from);
    text +=
        fmt::format("  {} [shape=plaintext class=\"untried\" label=\"never tried\"];\n", beyond);
    for (const std::string& name : untried) edges.add(node(from), beyond, "untried", name);
  }
  return text + edges.text() + "}\n";
}

}  // namespace

PictureSize size_of(const Model& model) {
  if (const auto* machine = std::get_if<Mealy>(&model)) {
    return {machine->size(), machine->size() * machine->inputs().size()};
  }
  return std::visit(
      [](const auto& automaton) -> PictureSize {
        if constexpr (std::is_same_v<std::decay_t<decltype(automaton)>, Mealy>) {
          return {};
        } else {
          return {automaton.size(), automaton.transition_count()};
        }
      },
      model);
}

PictureSize size_of(const Program& program) {
  return {program.states.size(), program.edges.size()};
}

std::string model_picture(const Model& model) {
  if (const auto* machine = std::get_if<Mealy>(&model)) {
    return picture_of(NondeterministicMealy(*machine));
  }
  if (const auto* machine = std::get_if<NondeterministicMealy>(&model)) {
    return picture_of(*machine);
  }
  return picture_of(std::get<InterfaceAutomaton>(model));
}

std::string program_picture(const System& system, const Program& program) {
  std::string text = head("TB") + start_at(0);
  Edges edges;
  for (ControlState at = 0; at < program.states.size(); ++at) {
    std::string label;
    for (const std::uint32_t index : program.label_sets[program.states[at].label_set]) {
      label += (label.empty() ? "@" : "\n@") + program.labels[index];
    }
    if (program.is_end(at)) label += label.empty() ? "end" : "\nend";
    if (program.is_error(at)) {
      label +=
          (label.empty() ? "error: " : "\nerror: ") + program.errors[program.states[at].error].text;
    }
    text += state(at, program.is_end(at) ? "end" : "state", label,
                  label.empty() ? "circle" : "box style=rounded");
    for (const ProgramEdge& edge : program.edges_of(at)) {
      const char* kind = edge.kind == ProgramEdge::Kind::give   ? "input"
                         : edge.kind == ProgramEdge::Kind::take ? "output"
                                                                : "both";
      edges.add(node(at), node(edge.target), kind,
                fmt::format("{}:  {}", edge.line, describe_edge(system, program, edge)));
    }
  }
  return text + edges.text() + "}\n";
}

std::string connection_picture(const System& system) {
  std::string text = head("LR");
  for (std::size_t i = 0; i < system.programs.size(); ++i) {
    text += state(i, "program", system.programs[i].name, "box");
  }
  const auto model_node = [](std::size_t model) { return "m" + std::to_string(model); };
  for (std::size_t i = 0; i < system.models.size(); ++i) {
    text += fmt::format("  {} [shape=ellipse class=\"model\" label={}];\n", model_node(i),
                        quote_dot_label(system.models[i].name));
  }
  Edges edges;
  for (std::size_t i = 0; i < system.programs.size(); ++i) {
    std::set<ModelUse> seen;
    const auto add = [&](const ModelUse& use) {
      if (!seen.insert(use).second) return;
      const ModelInstance& model = system.models[use.model];
      switch (use.kind) {
        case ModelUse::Kind::give:
          edges.add(node(i), model_node(use.model), "input",
                    model.automaton.inputs().name(use.index));
          break;
        case ModelUse::Kind::take:
          edges.add(model_node(use.model), node(i), "output",
                    model.automaton.outputs().name(use.index));
          break;
        case ModelUse::Kind::act:
          edges.add(node(i), model_node(use.model), "both", model.actions[use.index].name);
          break;
        default: break;
      }
    };
    const Program& program = system.programs[i];
    for (const ProgramEdge& edge : program.edges) {
      const auto events = program.events_of(edge);
      for (const ModelUse& event : events) add(event);
      for (const ModelUse& use : program.uses_of(edge)) {
        const bool is_shown = std::ranges::any_of(
            events, [&](const ModelUse& event) { return event.model == use.model; });
        if (!is_shown) add(use);
      }
    }
  }
  return text + edges.text() + "}\n";
}

std::string joint_picture(const JointPicture& picture, const std::vector<bool>& is_shown,
                          std::vector<std::size_t>& edges) {
  std::string text = head("TB");
  for (std::size_t i = 0; i < picture.states.size(); ++i) {
    if (!is_shown[i]) continue;
    const JointPicture::State& one = picture.states[i];
    const std::string label =
        folded(one.name) + (one.remark.empty() ? "" : "\n" + folded(one.remark));
    text += fmt::format("  {0} [id=\"{0}\" shape=box style=rounded class=\"{1}\" label={2}];\n",
                        node(i), one.kind, quote_dot_label(label));
  }
  for (std::size_t i = 0; i < picture.starts.size(); ++i) {
    if (!is_shown[picture.starts[i]]) continue;
    text += fmt::format(
        "  start{0} [shape=point width=0.08 class=\"start\"];\n  start{0} -> {1} "
        "[class=\"{2}\"];\n",
        i, node(picture.starts[i]), picture.start_kinds[i]);
  }
  Edges drawn;
  edges.assign(picture.steps.size(), picture.steps.size());
  for (std::size_t i = 0; i < picture.steps.size(); ++i) {
    const JointPicture::Step& step = picture.steps[i];
    if (!is_shown[step.from] || !is_shown[step.to]) continue;
    edges[i] = drawn.add(node(step.from), node(step.to), step.kind, step.label);
  }
  return text + drawn.text(true) + "}\n";
}

std::string picture_style() {
  return ":root{--page:#fff;--text:#1d2330;--soft:#667085;--rule:#d7dce5;--card:#f7f8fa;"
         "--state:#fff;--due:#fde8c8;--program:#eef1f5;--model:#e3eefb;--in:#1f5fa8;--out:#a8501f;"
         "--both:#4a5568}"
         "@media(prefers-color-scheme:dark){:root{--page:#14171c;--text:#e4e7ec;--soft:#98a2b3;"
         "--rule:#343b47;--card:#1b1f26;--state:#1f242c;--due:#4d3a1c;--program:#262c36;"
         "--model:#1d3048;--in:#7fb4f0;--out:#f0a878;--both:#b6c0cf}}"
         ".node ellipse,.node path,.node polygon{stroke:var(--soft);fill:var(--state)}"
         ".node text{fill:var(--text)}"
         ".due ellipse,.due path{fill:var(--due)}"
         ".program polygon{fill:var(--program)}.model ellipse{fill:var(--model)}"
         ".end path{fill:var(--program)}.start ellipse{fill:var(--soft)}"
         ".untried polygon{stroke:none;fill:none}.node.untried text{fill:var(--soft);"
         "font-style:italic}"
         ".edge path{stroke:var(--soft)}.edge polygon{stroke:none;fill:var(--soft)}"
         ".input text{fill:var(--in)}.input path{stroke:var(--in)}.input polygon{fill:var(--in)}"
         ".output text{fill:var(--out)}.output path{stroke:var(--out)}"
         ".output polygon{fill:var(--out)}.both text{fill:var(--both)}"
         ".edge.untried text{fill:var(--soft)}.edge.untried path{stroke-dasharray:4 3}"
         ".edge.untried polygon{fill:var(--soft)}";
}

// A picture as a tikzpicture for LaTeX. Graphviz lays it out (`dot -Tjson`), and TikZ draws nodes
// and edges where it put them. Core TikZ is enough, so that any LaTeX can compile it. The classes
// of nodes and edges are styles, which a paper may define anew. One length of the layout is one
// point (bp) in the picture.

namespace {

constexpr double points_per_inch = 72;

constexpr std::string_view styles =
    "  every node/.style={inner sep=1pt, font=\\footnotesize},\n"
    "  state/.style={draw, rounded corners, align=center, inner sep=3pt},\n"
    "  due/.style={state, fill=black!12},\n"
    "  start/.style={fill, circle, inner sep=1pt}, untried/.style={black!50},\n"
    "  action/.style={align=center}, transition/.style={->, >=stealth},\n"
    "  input/.style={}, output/.style={}, both/.style={}, beyond/.style={dashed, black!50}]\n";

// Letters that LaTeX's fonts have without any package: those of Western Europe, but eth and thorn.
bool has_glyph(char32_t letter) {
  return letter >= 0xC0 && letter <= 0xFF && letter != 0xD0 && letter != 0xF0 && letter != 0xDE &&
         letter != 0xFE;
}

// As TeX shows it; what it has no letter for is named by its number, "U+4E2D".
std::string escape_tex(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::string_view before = text;
    const std::optional<char32_t> letter = take_character(text);
    if (letter && *letter >= 0x80) {
      result += has_glyph(*letter) ? std::string(before.substr(0, before.size() - text.size()))
                                   : fmt::format("U+{:04X}", static_cast<std::uint32_t>(*letter));
      continue;
    }
    if (!letter) text = before.substr(1);  // no character of UTF-8
    switch (letter.value_or('?')) {
      case '\\': result += "\\textbackslash{}"; break;
      case '^': result += "\\textasciicircum{}"; break;
      case '~': result += "\\textasciitilde{}"; break;
      case '<': result += "\\textless{}"; break;
      case '>': result += "\\textgreater{}"; break;
      case '|': result += "\\textbar{}"; break;
      case '"': result += "{''}"; break;
      case '{':
      case '}':
      case '$':
      case '&':
      case '#':
      case '_':
      case '%': result += std::string("\\") + static_cast<char>(*letter); break;
      default: result += letter && *letter >= 0x20 ? static_cast<char>(*letter) : '?';
    }
  }
  return result;
}

// The lines of a label that Graphviz was given, one below the other.
std::string label_text(const std::string& label) {
  std::string text;
  std::string line;
  const auto finish = [&] {
    if (!text.empty()) text += "\\\\ ";
    text += escape_tex(std::string(trim(line)));
    line.clear();
  };
  for (std::size_t i = 0; i < label.size(); ++i) {
    const bool is_escape = label[i] == '\\' && i + 1 < label.size();
    if (label[i] == '\n' ||
        (is_escape && std::string_view("nlr").find(label[i + 1]) != std::string_view::npos)) {
      finish();
      i += is_escape ? 1 : 0;
    } else {
      i += is_escape ? 1 : 0;
      line += label[i];
    }
  }
  finish();
  return text;
}

struct Point {
  double x = 0, y = 0;
};

std::string to_string(Point point) { return fmt::format("({:.1f},{:.1f})", point.x, point.y); }

// "12.5,40".
Point read_point(std::string_view text) {
  Point point;
  const std::size_t comma = std::min(text.find(','), text.size());
  const char* end = text.data() + text.size();
  const auto x = std::from_chars(text.data(), text.data() + comma, point.x);
  const auto y = std::from_chars(text.data() + std::min(comma + 1, text.size()), end, point.y);
  if (x.ec != std::errc() || y.ec != std::errc()) {
    throw Error(ExitStatus::internal,
                "dot laid out a place that cannot be read: " + one_line(text));
  }
  return point;
}

// A spline of Graphviz, "e,END START C C POINT C C POINT ...", as a path of TikZ.
std::string path_of(const std::string& spline) {
  std::optional<Point> end;
  std::vector<Point> points;
  for (std::string_view part : split(spline, ' ')) {
    if (part.empty()) continue;
    if (part.starts_with("e,")) {
      end = read_point(part.substr(2));
    } else {
      points.push_back(read_point(part));
    }
  }
  if (points.empty()) return "";
  std::string path = to_string(points.front());
  for (std::size_t i = 1; i + 2 < points.size(); i += 3) {
    path += fmt::format(" .. controls {} and {} .. {}", to_string(points[i]),
                        to_string(points[i + 1]), to_string(points[i + 2]));
  }
  return end ? path + " -- " + to_string(*end) : path;
}

std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string node_text(const Json& node) {
  const std::string kind = text_of(node, "class");
  const std::string shape = text_of(node, "shape");
  const auto points = [&](const char* key) {
    double inches = 0;
    const std::string length = text_of(node, key);
    std::from_chars(length.data(), length.data() + length.size(), inches);
    return inches * points_per_inch;
  };
  // As large as Graphviz took it for, or edges would end before it.
  const std::string size =
      shape == "circle" ? fmt::format(", circle, minimum size={:.1f}bp", points("width"))
      : shape == "box"  ? fmt::format(", minimum width={:.1f}bp, minimum height={:.1f}bp",
                                      points("width"), points("height"))
                        : "";
  return fmt::format("  \\node[{}{}] at {} {{{}}};\n", kind, size,
                     to_string(read_point(text_of(node, "pos"))),
                     kind == "start" ? "" : label_text(text_of(node, "label")));
}

std::string edge_text(const Json& edge) {
  const std::string kind = text_of(edge, "class");
  const std::string style = kind == "start" ? "" : kind == "untried" ? ", beyond" : ", " + kind;
  std::string text =
      fmt::format("  \\draw[transition{}] {};\n", style, path_of(text_of(edge, "pos")));
  const std::string place = text_of(edge, "lp");
  if (place.empty()) return text;
  return text + fmt::format("  \\node[action{}] at {} {{{}}};\n", style,
                            to_string(read_point(place)), label_text(text_of(edge, "label")));
}

}  // namespace

std::string draw_tikz(const std::string& dot, const RunControl& control) {
  if (!can_draw()) return "";
  SubprocessOptions options;
  options.input = dot;
  options.time_limit = std::chrono::seconds(20);
  const SubprocessResult drawn = run_program({"dot", "-Tjson"}, options, control);
  if (!drawn.succeeded()) return "";
  const Json graph = parse_json(drawn.out, "dot -Tjson");
  std::string text = "\\begin{tikzpicture}[x=1bp, y=1bp,\n" + std::string(styles);
  for (const Json& node : graph.value("objects", Json::array())) text += node_text(node);
  for (const Json& edge : graph.value("edges", Json::array())) text += edge_text(edge);
  return text + "\\end{tikzpicture}\n";
}

}  // namespace maide
