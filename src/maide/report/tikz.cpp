// A picture as a tikzpicture for LaTeX. Graphviz lays it out (`dot -Tjson`), and TikZ draws nodes
// and edges where it put them. Core TikZ is enough, so that any LaTeX can compile it. The classes
// of nodes and edges are styles, which a paper may define anew. One length of the layout is one
// point (bp) in the picture.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/base/text.hpp"
#include "maide/formats/names.hpp"
#include "maide/report/picture.hpp"

namespace maide {
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
