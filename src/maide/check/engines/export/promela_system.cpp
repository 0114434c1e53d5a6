#include "maide/check/engines/export/promela_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text_cursor.hpp"
#include "maide/check/engines/export/promela_text.hpp"

namespace maide {
namespace {

constexpr std::size_t longest_name = 40;  // of a name's bytes in its identifier

// What the text itself uses, what the translator of formulas reads, and what C makes of it.
std::vector<std::string_view> reserved_words() {
  const auto promela = promela_reserved();
  std::vector<std::string_view> words(promela.begin(), promela.end());
  words.insert(words.end(), {"InChannel", "OutChannel", "quiet", "event", "cut", "idling"});
  words.insert(words.end(), {"none", "is_halted", "no_more_deaths", "survival", "nobody"});
  words.insert(words.end(), {"and", "or", "not", "next", "strong", "cond_expr", "R"});
  words.insert(words.end(), {"const", "define", "ifdef", "include"});
  return words;
}

// Labels with a meaning for SPIN, and the names of labels and macros of the text: s0, p0, is_cut.
// Identifiers leave out some bytes that are not ASCII, so a name with such bytes may become one of
// these.
bool may_have_a_meaning(std::string_view word) {
  for (const std::string_view prefix : {"end", "accept", "progress", "T0", "is_cut", "never"}) {
    if (word.starts_with(prefix)) return true;
  }
  if (word.size() > 1 && (word[0] == 's' || word[0] == 'p') &&
      std::all_of(word.begin() + 1, word.end(), is_digit)) {
    return true;
  }
  return std::ranges::any_of(word, [](char c) { return static_cast<unsigned char>(c) >= 0x80; });
}

}  // namespace

PromelaNames::PromelaNames() : identifiers_(reserved_words()) {}

const std::string& PromelaNames::of(std::string_view prefix, std::string_view name) {
  const auto [entry, is_new] =
      known_.try_emplace({std::string(prefix), std::string(name)}, std::string());
  if (is_new) entry->second = another(prefix, name);
  return entry->second;
}

std::string PromelaNames::another(std::string_view prefix, std::string_view name) {
  std::string word = std::string(prefix) + std::string(name.substr(0, longest_name));
  if (may_have_a_meaning(word)) word.insert(0, "n_");
  return identifiers_.unique(word);
}

std::string promela_comment(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 32 || c == '/' || c == '\\') c = c == '/' ? '|' : ' ';
  }
  return text;
}

void PromelaText::line(const std::string& text, const PromelaLine& meaning) {
  result_.text += text;
  result_.text += '\n';
  result_.lines.push_back(meaning);
}

void PromelaText::heading(const System& system, PromelaOptions::Purpose purpose) {
  const auto describe = [&] {
    switch (purpose) {
      case PromelaOptions::Purpose::deadlock: return "deadlocks are its invalid end states";
      case PromelaOptions::Purpose::error: return "an assertion fails at an error";
      case PromelaOptions::Purpose::cut:
        return "an assertion fails where a run leaves what was learned";
      case PromelaOptions::Purpose::ltl: return "for a never claim";
    }
    return "";
  };
  line(fmt::format("/* {}: {} */", promela_comment(system.title()), describe()));
}

void PromelaText::idling(std::string_view head, bool has_events) {
  line("");
  line(fmt::format("{} idling() {{", head));
  line(fmt::format("end_idle: do :: atomic {{ timeout -> {} }} od",
                   has_events ? "event = 0" : "skip"));
  line("}");
}

namespace {

// In SPIN's words, over p0, p1, ...; each literal holds in a cut run.
std::string claim_text(const Formula& formula, const std::vector<Atom>& atoms, bool has_cuts) {
  using Operator = FormulaNode::Operator;
  const auto literal = [&](const Atom& atom, const char* sign) {
    const auto number = std::ranges::lower_bound(atoms, atom) - atoms.begin();
    return fmt::format("({}p{}{})", sign, number, has_cuts ? " || is_cut" : "");
  };
  const auto part = [&](const Formula& operand) { return claim_text(operand, atoms, has_cuts); };
  const auto binary = [&](const char* op) {
    return fmt::format("({} {} {})", part(formula->left), op, part(formula->right));
  };
  switch (formula->op) {
    case Operator::truth: return "true";
    case Operator::falsity: return has_cuts ? "is_cut" : "false";
    case Operator::atom: return literal(formula->atom, "");
    case Operator::negation: return literal(formula->left->atom, "!");
    case Operator::conjunction: return binary("&&");
    case Operator::disjunction: return binary("||");
    case Operator::until:
      return formula->left->op == Operator::truth ? fmt::format("(<> {})", part(formula->right))
                                                  : binary("U");
    case Operator::release:
      return formula->left->op == Operator::falsity ? fmt::format("([] {})", part(formula->right))
                                                    : binary("V");
    default: throw UsageError("SPIN checks no formula with X");
  }
}

}  // namespace

void PromelaText::claim(const Formula& formula, const std::vector<std::string>& expressions,
                        bool has_cuts) {
  line("");
  for (std::size_t number = 0; number < expressions.size(); ++number) {
    line(fmt::format("#define p{} ({})", number, expressions[number]));
  }
  if (has_cuts) line("#define is_cut (cut)");
  result_.claim =
      "!(" + claim_text(negation_normal_form(formula), atoms_of(formula), has_cuts) + ")";
}

PromelaSystem write_promela(const System& system, const PromelaOptions& options) {
  bool has_steps = uses_second_edition(system);
  for (const Atom& atom : options.formula ? atoms_of(options.formula) : std::vector<Atom>{}) {
    has_steps =
        has_steps || atom.kind == Atom::Kind::expression || atom.program != Atom::any_program;
  }
  return has_steps ? write_promela_steps(system, options)
                   : write_promela_rendezvous(system, options);
}

// Systems in Promela whose models are processes. A model meets the programs on two rendezvous
// channels, its InChannel and its OutChannel, as in the paper. `quiet` is an output that a
// quiescent model offers again and again. An input beyond the bound is a message of its own,
// `beyond_write`; the purpose of the text chooses what it does.
//
// Invariant: one transition of the Promela is one step of the system. Every transition is a single
// rendezvous or expression followed by gotos, which cost nothing, so it is atomic by itself.
// (`atomic` could stand only where a rendezvous is received: a sender inside `atomic` takes its
// goto as a step of its own.)

namespace {

// What the programs of a system use of each of its models: that much of a model is written.
struct ModelUsage {
  struct Instance {
    std::set<Symbol> inputs;   // that are given
    std::set<Symbol> cutting;  // those of them that may be beyond what was learned, while the model
                               // says `stop`, as far as its automaton alone tells
    bool quiet = false;        // some program has an arm for it
  };

  explicit ModelUsage(const System& system);

  std::vector<Instance> instances;  // by model
  bool any_cut = false;             // else no run can be cut
};

bool cuts(const ModelInstance& model, Symbol input) {
  if (model.when_unexplored != WhenUnexplored::stop) return false;
  for (StateId state = 0; state < model.automaton.size(); ++state) {
    if (model.automaton.is_quiescent(state) && is_beyond_learned(model.automaton, state, input)) {
      return true;
    }
  }
  return false;
}

ModelUsage::ModelUsage(const System& system) : instances(system.models.size()) {
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      if (edge.kind == ProgramEdge::Kind::quiet) instances[edge.model].quiet = true;
      if (edge.kind != ProgramEdge::Kind::give) continue;
      if (!instances[edge.model].inputs.insert(edge.index).second) continue;
      if (!cuts(system.models[edge.model], edge.index)) continue;
      instances[edge.model].cutting.insert(edge.index);
      any_cut = true;
    }
  }
}

using Purpose = PromelaOptions::Purpose;

class PromelaWriter {
 public:
  PromelaWriter(const System& system, const PromelaOptions& options)
      : system_(system), options_(options), usage_(system) {
    if (is_ltl()) {
      for (const Atom& atom : atoms_of(options.formula)) {
        if (atom.is_event()) event_codes_.emplace(atom, event_codes_.size() + 1);
      }
    }
  }

  PromelaSystem run() {
    const std::size_t processes = system_.models.size() + system_.programs.size() + 3;
    if (processes > most_promela_names) {
      throw UsageError(
          fmt::format("SPIN takes at most {} models and programs", most_promela_names - 3));
    }
    if (2 * system_.models.size() > most_promela_names) {
      throw UsageError(fmt::format("SPIN takes at most {} models, each of two channels",
                                   most_promela_names / 2));
    }
    text_.result().processes = processes;
    text_.result().has_start = true;
    write_head();
    for (std::uint32_t index = 0; index < system_.models.size(); ++index) write_model(index);
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) write_program(index);
    if (is_ltl()) text_.idling("proctype", has_events());
    write_init();
    if (is_ltl()) write_claim();
    return std::move(text_.result());
  }

 private:
  bool is_ltl() const { return options_.purpose == Purpose::ltl; }
  bool has_events() const { return !event_codes_.empty(); }
  // LTL messages carry one value, received into `event`, or into `cut`.
  bool has_value() const { return has_events() || (is_ltl() && usage_.any_cut); }

  void line(const std::string& text, const PromelaLine& meaning = {}) { text_.line(text, meaning); }

  const std::string& symbol(std::string_view name) { return names_.of("", name); }
  const std::string& beyond(std::string_view name) { return names_.of("beyond_", name); }
  std::string in_channel(std::uint32_t model) {
    return names_.of("in_", system_.models[model].name);
  }
  std::string out_channel(std::uint32_t model) {
    return names_.of("out_", system_.models[model].name);
  }
  const std::string& proctype(std::uint32_t program) {
    return names_.of("program_", system_.programs[program].name);
  }
  std::string control_label(const Program& program, ControlState state) const {
    return (program.is_end(state) ? "end_s" : "s") + std::to_string(state);
  }

  void write_head() {
    std::set<std::string> names;
    for (const ModelInstance& model : system_.models) {
      for (const std::string& name : model.automaton.inputs().names()) names.insert(symbol(name));
      for (const std::string& name : model.automaton.outputs().names()) names.insert(symbol(name));
    }
    for (std::uint32_t model = 0; model < system_.models.size(); ++model) {
      for (const Symbol input : usage_.instances[model].cutting) {
        names.insert(beyond(system_.models[model].automaton.inputs().name(input)));
      }
    }
    names.insert("quiet");
    if (names.size() > most_promela_names) {
      throw UsageError(
          fmt::format("SPIN takes at most {} names of inputs and outputs, and there "
                      "are {}",
                      most_promela_names, names.size()));
    }
    text_.heading(system_, options_.purpose);
    line(fmt::format("mtype = {{ {} }};", fmt::join(names, ", ")));
    if (has_events()) line("short event;  /* of the step that reached this state; 0: none */");
    if (is_ltl() && usage_.any_cut) line("bit cut;  /* the run left what was learned */");
    for (std::uint32_t model = 0; model < system_.models.size(); ++model) {
      const char* type = has_value() ? "[0] of { mtype, short }" : "[0] of { mtype }";
      line(fmt::format("chan {} = {};", in_channel(model), type));
      line(fmt::format("chan {} = {};", out_channel(model), type));
    }
  }

  // What a message carries beside its name: sent, and received into a variable.
  std::string sent(Atom::Kind kind, std::uint32_t model, Symbol code) const {
    if (!has_value()) return "";
    const auto place = event_codes_.find({kind, model, code});
    return fmt::format(",{}", place == event_codes_.end() ? 0 : place->second);
  }
  std::string received() const {
    if (!has_value()) return "";
    return has_events() ? ",event" : ",_";
  }

  // The two sides of an output. Under a claim its message goes the other way round, from the
  // program to the model: pan's weak fairness is owed to processes that can send, never to those
  // that could receive, and it is programs that fairness is about. A rendezvous is the same both
  // ways.
  std::string emission(const std::string& name) const {
    return is_ltl() ? "?" + name + received() : "!" + name;
  }
  std::string acceptance(const std::string& name, const std::string& value) const {
    return is_ltl() ? "!" + name + value : "?" + name;
  }

  // One way on from a state.
  struct Option {
    std::string statement;
    std::string target;   // a label
    std::string comment;  // may be empty
    PromelaLine meaning;
  };

  // A state: its label, and the ways on. What compiles fast counts here (programs are unrolled, and
  // a C compiler has to read what comes of it): one way needs no `if`, going on in the next line
  // no goto.
  void write_state(const std::string& label, const std::vector<Option>& options,
                   const std::string& next_label) {
    const auto text = [&](const Option& option, bool needs_goto) {
      return option.statement + (needs_goto ? " -> goto " + option.target : "") +
             (option.comment.empty() ? "" : "  /* " + option.comment + " */");
    };
    if (options.empty()) {
      line(label + ": false;");
    } else if (options.size() == 1) {
      const Option& only = options[0];
      line(label + ": " + text({only.statement, only.target, "", {}}, only.target != next_label) +
               ";" + (only.comment.empty() ? "" : "  /* " + only.comment + " */"),
           only.meaning);
    } else {
      line(label + ": if");
      for (const Option& option : options) line("  :: " + text(option, true), option.meaning);
      line("  fi;");
    }
  }

  void write_model(std::uint32_t index) {
    const ModelInstance& model = system_.models[index];
    line("");
    line(fmt::format("/* model {}: {} */", promela_comment(model.name),
                     promela_comment(model.origin)));
    line(fmt::format("proctype {}(chan InChannel; chan OutChannel) {{",
                     names_.of("model_", model.name)));
    if (model.automaton.initial() != 0) {
      line(fmt::format("  goto {};", model_label(model.automaton.initial())));
    }
    for (StateId state = 0; state < model.automaton.size(); ++state) {
      write_state(model_label(state), model_options(index, state), model_label(state + 1));
    }
    line("}");
  }

  static std::string model_label(StateId state) { return "end_q" + std::to_string(state); }

  std::vector<Option> model_options(std::uint32_t index, StateId state) {
    std::vector<Option> options;
    const ModelInstance& model = system_.models[index];
    const InterfaceAutomaton& automaton = model.automaton;
    const auto option = [&](const std::string& message, StateId target, bool is_beyond) {
      options.push_back({message,
                         model_label(target),
                         "",
                         {PromelaLine::Kind::model_transition, index, 0, target, is_beyond}});
    };
    const bool is_quiescent = automaton.is_quiescent(state);
    for (const auto& transition : automaton.transitions(state)) {
      const Symbol code = transition.action.symbol;
      if (!transition.action.is_input()) {
        option("OutChannel" + emission(symbol(automaton.outputs().name(code))), transition.target,
               false);
      } else if (is_quiescent && !transition.absorbed &&
                 usage_.instances[index].inputs.contains(code)) {
        option(fmt::format("InChannel?{}{}", symbol(automaton.inputs().name(code)), received()),
               transition.target, false);
      }
    }
    if (!is_quiescent) return options;
    for (const Symbol code : usage_.instances[index].inputs) {
      if (!is_beyond_learned(automaton, state, code)) continue;
      const std::string& name = automaton.inputs().name(code);
      if (model.when_unexplored == WhenUnexplored::drop) {
        option(fmt::format("InChannel?{}{}", symbol(name), received()), state, true);
      } else if (model.when_unexplored == WhenUnexplored::stop) {
        option(beyond_reception(name), state, true);
      }
    }
    if (usage_.instances[index].quiet) {
      option("OutChannel" + emission("quiet"), state, false);
    }
    return options;
  }

  std::string beyond_reception(const std::string& name) {
    switch (options_.purpose) {
      case Purpose::deadlock:
      case Purpose::error: return fmt::format("InChannel?{}", beyond(name));
      case Purpose::cut: return fmt::format("InChannel?{} -> assert(false)", beyond(name));
      case Purpose::ltl: return fmt::format("InChannel?{},cut", beyond(name));
    }
    return "";
  }

  void write_program(std::uint32_t index) {
    const Program& program = system_.programs[index];
    line("");
    line(fmt::format("/* program {}, line {} */", promela_comment(program.name),
                     program.position.line));
    line(fmt::format("proctype {}() {{", proctype(index)));
    for (ControlState state = 0; state < program.states.size(); ++state) {
      std::vector<Option> options;
      const Program::State& control = program.states[state];
      for (std::uint32_t offset = 0; offset < control.edge_count; ++offset) {
        add_edge_options(index, state, control.first_edge + offset, options);
      }
      const bool is_last = state + 1 == program.states.size();
      write_state(control_label(program, state), options,
                  is_last ? "" : control_label(program, state + 1));
    }
    line("}");
  }

  void add_edge_options(std::uint32_t index, ControlState state, std::uint32_t number,
                        std::vector<Option>& options) {
    const Program& program = system_.programs[index];
    const ProgramEdge& edge = program.edges[number];
    const std::string place = "line " + std::to_string(edge.line);
    const auto option = [&](const std::string& statement, bool is_beyond = false) {
      options.push_back({statement,
                         control_label(program, is_beyond ? state : edge.target),
                         place,
                         {PromelaLine::Kind::program_edge, index, number, 0, is_beyond}});
    };
    switch (edge.kind) {
      case ProgramEdge::Kind::choice:
        // Not `true`: SPIN refuses a loop of that.
        option(has_events() ? "event = 0" : "(_pid >= 0)");
        break;
      case ProgramEdge::Kind::quiet:
        option(out_channel(edge.model) + acceptance("quiet", has_value() ? ",0" : ""));
        break;
      case ProgramEdge::Kind::take: {
        const std::string& name = system_.models[edge.model].automaton.outputs().name(edge.index);
        option(out_channel(edge.model) +
               acceptance(symbol(name), sent(Atom::Kind::output, edge.model, edge.index)));
        break;
      }
      case ProgramEdge::Kind::give: {
        const std::string& name = system_.models[edge.model].automaton.inputs().name(edge.index);
        option(fmt::format("{}!{}{}", in_channel(edge.model), symbol(name),
                           sent(Atom::Kind::input, edge.model, edge.index)));
        if (usage_.instances[edge.model].cutting.contains(edge.index)) {
          option(fmt::format("{}!{}{}", in_channel(edge.model), beyond(name), is_ltl() ? ",1" : ""),
                 true);
        }
        break;
      }
      case ProgramEdge::Kind::act:
      case ProgramEdge::Kind::combined: break;  // not in this form
    }
  }

  void write_init() {
    line("");
    line("init {");
    line("  atomic {");
    for (std::uint32_t index = 0; index < system_.models.size(); ++index) {
      line(fmt::format("    run {}({}, {});", names_.of("model_", system_.models[index].name),
                       in_channel(index), out_channel(index)));
    }
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) {
      line(fmt::format("    run {}();", proctype(index)));
    }
    if (is_ltl()) line("    run idling();");
    line("  }");
    line("}");
  }

  void write_claim() {
    std::vector<std::string> expressions;
    for (const Atom& atom : atoms_of(options_.formula)) expressions.push_back(expression(atom));
    text_.claim(options_.formula, expressions, usage_.any_cut);
  }

  std::string expression(const Atom& atom) {
    if (atom.is_event()) return fmt::format("event == {}", event_codes_.at(atom));
    const Program& program = system_.programs[atom.owner];
    std::string text;
    for (ControlState state = 0; state < program.states.size(); ++state) {
      const bool holds = atom.kind == Atom::Kind::end ? program.is_end(state)
                                                      : program.has_label(state, atom.symbol);
      if (!holds) continue;
      text += fmt::format("{}{}@{}", text.empty() ? "" : " || ", proctype(atom.owner),
                          control_label(program, state));
    }
    return text.empty() ? "false" : text;
  }

  const System& system_;
  const PromelaOptions& options_;
  ModelUsage usage_;
  PromelaNames names_;
  std::map<Atom, std::size_t> event_codes_;
  PromelaText text_;
};

}  // namespace

PromelaSystem write_promela_rendezvous(const System& system, const PromelaOptions& options) {
  return PromelaWriter(system, options).run();
}

}  // namespace maide
