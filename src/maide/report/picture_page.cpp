#include "maide/report/picture_page.hpp"

#include <fmt/format.h>

#include <ostream>
#include <string_view>
#include <variant>
#include <vector>

#include "maide/automata/strength.hpp"
#include "maide/base/text.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/report/html_report.hpp"
#include "maide/report/picture.hpp"

namespace maide {

void open_page(std::ostream& out, const std::string& title, const std::string& style) {
  out << fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>{0}</title>\n"
      "<style>{1}"
      "body{{font:15px/1.5 system-ui,sans-serif;max-width:75em;margin:2em auto;padding:0 1.2em;"
      "background:var(--page);color:var(--text)}}"
      "h1{{font-size:1.5em;margin-bottom:.2em}}h2{{font-size:1.15em;margin-top:2em}}"
      ".card{{background:var(--card);border:1px solid var(--rule);border-radius:8px;padding:1em;"
      "overflow-x:auto;text-align:center}}.card svg{{max-width:100%;height:auto}}"
      "p,dt{{color:var(--soft)}}table{{border-collapse:collapse}}td,th{{text-align:left;"
      "padding:.15em 1.2em .15em 0;border-bottom:1px solid var(--rule);vertical-align:top}}"
      "th{{font-weight:600;color:var(--soft)}}code,pre{{font:13px/1.5 ui-monospace,monospace}}"
      "pre{{background:var(--card);border:1px solid var(--rule);border-radius:8px;padding:1em;"
      "overflow-x:auto}}pre i{{color:var(--soft);font-style:normal}}.in{{color:var(--in)}}"
      ".out{{color:var(--out)}}{2}</style></head>\n<body>\n<h1>{0}</h1>\n",
      escape_markup(title), picture_style(), style);
}

void close_page(std::ostream& out) { out << "</body></html>\n"; }

namespace {

constexpr std::size_t most_rows = 400;  // of a table of transitions

// Every transition, as in the model's file.
struct Row {
  StateId from;
  std::string label;
  std::string to;  // or "never tried"
};

std::vector<Row> rows_of(const NondeterministicMealy& machine) {
  std::vector<Row> rows;
  for (StateId from = 0; from < machine.size(); ++from) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      for (const auto& choice : machine.choices(from, input)) {
        rows.push_back(
            {from, mealy_label(machine.inputs().name(input), machine.outputs().name(choice.output)),
             std::to_string(choice.target)});
        if (rows.size() > most_rows) return rows;
      }
    }
  }
  return rows;
}

std::vector<Row> rows_of(const InterfaceAutomaton& automaton) {
  std::vector<Row> rows;
  for (StateId from = 0; from < automaton.size() && rows.size() <= most_rows; ++from) {
    for (const auto& transition : automaton.transitions(from)) {
      rows.push_back({from, automaton.name(transition.action),
                      transition.absorbed ? "never tried" : std::to_string(transition.target)});
    }
    for (const Symbol input : automaton.unexplored(from)) {
      rows.push_back({from, automaton.name({Action::Kind::input, input}), "never tried"});
    }
  }
  return rows;
}

std::vector<Row> rows_of(const Mealy& machine) { return rows_of(NondeterministicMealy(machine)); }

void write_table(std::ostream& out, const Model& model) {
  std::vector<Row> rows = std::visit([](const auto& one) { return rows_of(one); }, model);
  const bool is_cut = rows.size() > most_rows;
  if (is_cut) rows.resize(most_rows);
  out << "<table><tr><th>state</th><th>action</th><th>next state</th></tr>\n";
  for (const Row& row : rows) {
    out << fmt::format("<tr><td>{}</td><td><code>{}</code></td><td>{}</td></tr>\n", row.from,
                       escape_markup(row.label), row.to);
  }
  out << "</table>\n";
  if (is_cut) {
    out << fmt::format("<p>The first {} of {} transitions.</p>\n", most_rows,
                       size_of(model).transitions);
  }
}

// What the colours and arrows say, as far as the model has them.
void write_legend(std::ostream& out, const InterfaceAutomaton& automaton) {
  bool has_due = false, has_untried = false;
  for (StateId state = 0; state < automaton.size(); ++state) {
    has_due = has_due || !automaton.is_quiescent(state);
    has_untried = has_untried || !automaton.unexplored(state).empty();
    for (const auto& transition : automaton.transitions(state)) {
      has_untried = has_untried || transition.absorbed;
    }
  }
  out << "<p><span class=\"in\">?input</span> that the environment gives, "
         "<span class=\"out\">!output</span> that the system emits";
  if (has_due) out << "; filled: an output is due";
  if (has_untried) {
    out << "; dashed: never tried in that state, because learning went no further - that is not "
           "\"refused\", which has no arrow";
  }
  out << ".";
  if (!automaton.hidden_returns.empty()) {
    out << " Return not seen: the call was still busy when nothing happened any more, and its "
           "return is not in the model.";
  }
  out << "</p>\n";
}

void write_facts(std::ostream& out, const Model& model) {
  const auto names = [](const Alphabet& alphabet) {
    return fmt::format("{}", fmt::join(alphabet.names(), ", "));
  };
  out << "<table>\n";
  const auto row = [&](const std::string& key, const std::string& value) {
    if (value.empty()) return;
    out << fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", escape_markup(key),
                       escape_markup(value));
  };
  std::visit(
      [&](const auto& automaton) {
        row("inputs", names(automaton.inputs()));
        row("outputs", names(automaton.outputs()));
        for (const Actor& actor : automaton.actors) {
          row("actor " + actor.name,
              fmt::format("{}; {}", fmt::join(actor.inputs, ", "), fmt::join(actor.outputs, ", ")));
        }
        for (const auto& [key, value] : automaton.origin) row(key, value);
      },
      model);
  out << "</table>\n";
}

void write_picture(std::ostream& out, const std::string& dot, const GraphPainter& paint) {
  const std::string svg = paint(dot);
  if (svg.empty()) {
    out << "<p>No picture: Graphviz's dot is not installed here, or gave up.</p>\n";
  } else {
    out << "<div class=\"card\">" << svg << "</div>\n";
  }
}

// The picture or the table, and what is known.
void write_model(std::ostream& out, const Model& model, const GraphPainter& paint) {
  const PictureSize size = size_of(model);
  if (size.is_drawable()) {
    write_picture(out, model_picture(model), paint);
    if (const auto* automaton = std::get_if<InterfaceAutomaton>(&model)) {
      write_legend(out, *automaton);
    }
  } else {
    out << fmt::format(
        "<p>Too large to be drawn (that goes up to {} states and {} transitions): "
        "its transitions as a table.</p>\n",
        most_drawn_states, most_drawn_transitions);
  }
  write_facts(out, model);
  if (!size.is_drawable()) write_table(out, model);
}

std::string describe_size(const Model& model) {
  const PictureSize size = size_of(model);
  return fmt::format("{}: {}, {}", name_of_kind(model), counted(size.states, "state"),
                     counted(size.transitions, "transition"));
}

// The text with the numbers of its lines.
void write_source(std::ostream& out, std::string_view text) {
  out << "<pre>";
  int number = 0;
  for (const std::string_view line : split_lines(text)) {
    out << fmt::format("<i>{:>4}</i>  {}\n", ++number, escape_markup(line));
  }
  out << "</pre>\n";
}

void write_program(std::ostream& out, const System& system, const Program& program,
                   const GraphPainter& paint) {
  const PictureSize size = size_of(program);
  out << fmt::format(
      "<h2>program {}</h2>\n<p>line {}; {}, {} when its repetitions are unrolled"
      "</p>\n",
      escape_markup(program.name), program.position.line, counted(size.states, "control state"),
      counted(size.transitions, "step"));
  if (size.is_drawable()) {
    write_picture(out, program_picture(system, program), paint);
  } else {
    out << "<p>Too large to be drawn: see its text below.</p>\n";
  }
}

const char* describe(WhenUnexplored when) {
  switch (when) {
    case WhenUnexplored::stop: return "stop";
    case WhenUnexplored::wait: return "wait";
    case WhenUnexplored::drop: return "drop";
  }
  return "";
}

std::string describe_strength(const ModelInstance& model) {
  const auto stated = find_strength(model.automaton.origin);
  if (!stated || !stated->is_known()) return "strength unknown";
  if (!stated->is_weak) return "not weak";
  return model.when_weak == WhenWeak::accept ? "weak (when_weak: accept)" : "weak";
}

}  // namespace

void write_model_page(std::ostream& out, const Model& model, const std::string& title,
                      const GraphPainter& paint) {
  open_page(out, title);
  out << "<p>" << describe_size(model) << "</p>\n";
  write_model(out, model, paint);
  close_page(out);
}

void write_system_page(std::ostream& out, const System& system, const std::string& text,
                       const GraphPainter& paint) {
  open_page(out, system.title());
  out << fmt::format("<p>{}, {}. Boxes are programs, ellipses are models.</p>\n",
                     counted(system.programs.size(), "program"),
                     counted(system.models.size(), "model"));
  write_picture(out, connection_picture(system), paint);
  for (const Program& program : system.programs) write_program(out, system, program, paint);
  for (const ModelInstance& model : system.models) {
    const Model automaton = model.automaton;
    out << fmt::format("<h2>model {}</h2>\n<p>{}; {}; when_unexplored: {}; {}</p>\n",
                       escape_markup(model.name), escape_markup(model.origin),
                       describe_size(automaton), describe(model.when_unexplored),
                       describe_strength(model));
    write_model(out, automaton, paint);
  }
  out << "<h2>the system file</h2>\n";
  write_source(out, text);
  close_page(out);
}

void write_chart_page(std::ostream& out, const std::string& svg, const std::string& title) {
  open_page(out, title);
  out << "<div class=\"card\">" << svg << "</div>\n";
  close_page(out);
}

std::string stand_alone(const std::string& svg) {
  const std::size_t head = svg.find('>');
  if (head == std::string::npos) return svg;
  return svg.substr(0, head + 1) + "\n<style>" + picture_style() +
         "svg{background:var(--page)}</style>" + svg.substr(head + 1);
}

}  // namespace maide
