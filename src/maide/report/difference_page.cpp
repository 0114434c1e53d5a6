#include "maide/report/difference_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <tuple>
#include <utility>

#include "maide/base/json.hpp"
#include "maide/report/html_report.hpp"
#include "maide/report/state_names.hpp"

namespace maide {
namespace {

// ---- The page of a comparison ----

// Makes one machine of two. A state of it is a pair of partners, or a state without one.
class Joiner {
 public:
  Joiner(const BehaviourPair& pair, const Differences& differences,
         const std::vector<std::string>& left_states, const std::vector<std::string>& right_states)
      : pair_(pair),
        differences_(differences),
        left_states_(left_states),
        right_states_(right_states) {}

  DifferencePage run() {
    page_.left = "A";
    page_.right = "B";
    page_.alone = "Steps of one side alone";
    page_.legend = {{"both", "A and B"}, {"left", "A alone"}, {"right", "B alone"}};
    add_states();
    for (StateId state = 0; state < pair_.left.size; ++state) add_steps_of_left(state);
    for (StateId state = 0; state < pair_.right.size; ++state) add_steps_of_right(state);
    for (const Difference& difference : differences_.list) {
      if (page_.walks.size() == most_walks) break;
      add_walk(difference);
    }
    return std::move(page_);
  }

 private:
  enum Side { left, right };
  static constexpr const char* marks[] = {"A: ", "B: "};

  const std::string& name_of(Side side, StateId state) const {
    return side == left ? left_states_[pair_.left.origins[state]]
                        : right_states_[pair_.right.origins[state]];
  }
  const Answer& answer(Side side, StateId state, std::size_t question) const {
    return side == left ? pair_.left_answer(state, question) : pair_.right_answer(state, question);
  }

  void add_states() {
    auto& states = page_.picture.states;
    const auto untried = [&](Side side, StateId state) {
      std::string text;
      for (std::size_t question = 0; question < pair_.questions.size(); ++question) {
        if (answer(side, state, question).is_known) continue;
        text += (text.empty() ? "never tried: " : ", ") + pair_.questions[question];
      }
      return text;
    };
    for (StateId state = 0; state < pair_.left.size; ++state) {
      at_[left].push_back(states.size());
      const StateId partner = differences_.left_partners[state];
      const std::string& name = name_of(left, state);
      const std::string remark = untried(left, state);
      if (partner == Mealy::no_state) {
        states.push_back({"A: " + name, "left", remark});
        continue;
      }
      const std::string& other = name_of(right, partner);
      const std::string other_remark = untried(right, partner);
      std::string both = remark;
      if (remark != other_remark) {
        both = remark.empty() ? "" : "A " + remark;
        if (!other_remark.empty()) both += (both.empty() ? "B " : "; B ") + other_remark;
      }
      states.push_back({name == other ? name : "A: " + name + "\nB: " + other, "both", both});
    }
    for (StateId state = 0; state < pair_.right.size; ++state) {
      const StateId partner = differences_.right_partners[state];
      at_[right].push_back(partner == Mealy::no_state ? states.size() : at_[left][partner]);
      if (partner != Mealy::no_state) continue;
      states.push_back({"B: " + name_of(right, state), "right", untried(right, state)});
    }
    const std::size_t first = at_[left][pair_.left.initial],
                      other = at_[right][pair_.right.initial];
    page_.picture.starts = {first};
    page_.picture.start_kinds = {first == other ? "both" : "left"};
    if (first == other) return;
    page_.picture.starts.push_back(other);
    page_.picture.start_kinds.emplace_back("right");
  }

  std::size_t add_step(std::size_t from, std::size_t to, const char* kind,
                       const std::string& label) {
    page_.picture.steps.push_back({from, to, kind, label});
    return page_.picture.steps.size() - 1;
  }

  void add_steps_of_left(StateId state) {
    const StateId partner = differences_.left_partners[state];
    for (std::size_t question = 0; question < pair_.questions.size(); ++question) {
      for (const Answer::Way& way : answer(left, state, question).ways) {
        if (pair_.is_rest(way.label)) continue;
        const std::string& label = pair_.labels.name(way.label);
        bool is_common = false;
        if (partner != Mealy::no_state) {
          const auto& others = answer(right, partner, question).ways;
          is_common = std::ranges::any_of(others, [&](const Answer::Way& other) {
            return other.label == way.label && at_[right][other.target] == at_[left][way.target];
          });
        }
        const std::size_t step =
            add_step(at_[left][state], at_[left][way.target], is_common ? "both" : "left",
                     is_common ? label : marks[left] + label);
        steps_[left][{state, way.label}] = step;
        if (is_common) steps_[right][{partner, way.label}] = step;
      }
    }
  }

  void add_steps_of_right(StateId state) {
    for (std::size_t question = 0; question < pair_.questions.size(); ++question) {
      for (const Answer::Way& way : answer(right, state, question).ways) {
        if (pair_.is_rest(way.label) || steps_[right].contains({state, way.label})) continue;
        steps_[right][{state, way.label}] =
            add_step(at_[right][state], at_[right][way.target], "right",
                     marks[right] + pair_.labels.name(way.label));
      }
    }
  }

  // What a machine does with a label, in words: the output of a machine, "taken" for an input of an
  // automaton.
  std::string in_words(const std::string& label, std::size_t question) const {
    if (label.empty()) return rest_label;
    if (!pair_.has_outputs) return label.substr(pair_.questions[question].size() + 3);
    return label.front() == '?' ? "taken" : label.substr(1);
  }

  void move(WalkStep& step, Side side, StateId before, StateId after,
            const std::string& label) const {
    (side == left ? step.left_state : step.right_state) = name_of(side, after);
    (side == left ? step.left_at : step.right_at) = at_[side][after];
    if (label.empty()) return;
    const auto found = steps_[side].find({before, *pair_.labels.find(label)});
    if (found != steps_[side].end()) {
      (side == left ? step.left_step : step.right_step) = found->second;
    }
  }

  void add_walk(const Difference& difference) {
    Walk walk;
    const std::vector<std::string> word = describe_way(pair_, difference);
    walk.title = fmt::format("{}: {} {} {} in A, {} in B{}", describe_word(word),
                             pair_.questions[difference.question],
                             pair_.has_outputs ? "is" : "gives", difference.left, difference.right,
                             difference.is_bound ? " (no contradiction)" : "");
    StateId left_state = pair_.left.initial, right_state = pair_.right.initial;
    WalkStep start;
    move(start, left, left_state, left_state, "");
    move(start, right, right_state, right_state, "");
    walk.steps.push_back(std::move(start));
    for (const JointStep& one : difference.way) {
      WalkStep step;
      step.given = pair_.questions[one.question];
      step.left = in_words(one.left, one.question);
      step.right = in_words(one.right, one.question);
      step.differs = !one.agrees;
      move(step, left, left_state, one.left_state, one.left);
      move(step, right, right_state, one.right_state, one.right);
      left_state = one.left_state;
      right_state = one.right_state;
      walk.steps.push_back(std::move(step));
    }
    WalkStep last;
    last.given = pair_.questions[difference.question];
    last.left = difference.left;
    last.right = difference.right;
    last.differs = true;
    finish(last, left, difference.left_state, difference.question);
    finish(last, right, difference.right_state, difference.question);
    walk.steps.push_back(std::move(last));
    page_.walks.push_back(std::move(walk));
  }

  // The last step of a machine: by its own answer, if that is one way.
  void finish(WalkStep& step, Side side, StateId state, std::size_t question) const {
    const auto& ways = answer(side, state, question).ways;
    const bool goes = ways.size() == 1 && !pair_.is_rest(ways.front().label);
    move(step, side, state, goes ? ways.front().target : state,
         goes ? pair_.labels.name(ways.front().label) : "");
  }

  const BehaviourPair& pair_;
  const Differences& differences_;
  const std::vector<std::string>& left_states_;
  const std::vector<std::string>& right_states_;
  std::vector<std::size_t> at_[2];                              // by state: that of the picture
  std::map<std::pair<StateId, Symbol>, std::size_t> steps_[2];  // by state and label, likewise
  DifferencePage page_;
};

// ---- The page ----

constexpr std::size_t most_listed_steps = 400;  // of the table of steps
constexpr std::size_t states_around = 60;       // in a picture that is cut

const std::string page_style =
    ":root{--a:#0072b2;--b:#d55e00;--now:#f0e442}"
    "@media(prefers-color-scheme:dark){:root{--a:#56b4e9;--b:#e69f00;--now:#5c5500}}"
    ".stage{text-align:center;max-height:62vh;overflow:auto}.stage svg{max-width:none}"
    ".stage.fit svg{max-width:100%;max-height:58vh;height:auto}"
    ".node.left path{stroke:var(--a);stroke-width:2;stroke-dasharray:8 4}"
    ".node.right path{stroke:var(--b);stroke-width:2.2;stroke-dasharray:1 4;stroke-linecap:round}"
    ".edge.left path{stroke:var(--a);stroke-width:1.8;stroke-dasharray:8 4}"
    ".edge.right path{stroke:var(--b);stroke-width:2.2;stroke-dasharray:1 4;stroke-linecap:round}"
    ".edge.left polygon{fill:var(--a)}.edge.right polygon{fill:var(--b)}"
    ".edge.left text{fill:var(--a)}.edge.right text{fill:var(--b)}"
    ".edge.plain path{stroke:var(--rule)}.edge.plain polygon{fill:var(--rule)}"
    ".edge.plain text{fill:var(--soft)}"
    ".node.at path{fill:var(--now);stroke-width:3}.edge.at path{stroke-width:4.5}"
    ".node.at-left path{stroke:var(--a);stroke-width:4;stroke-dasharray:8 4}"
    ".node.at-right path{stroke:var(--b);stroke-width:4;stroke-dasharray:1 6;stroke-linecap:round}"
    "#controls{position:sticky;top:0;background:var(--page);padding:.5em 0;z-index:1}"
    "#controls button{font:inherit;margin-right:.3em}#controls output{margin-left:.6em}"
    "tr.differs td{font-weight:600}tr.now td{background:var(--now)}"
    "summary{cursor:pointer;padding:.2em 0}.legend svg{vertical-align:middle}"
    "li{color:var(--soft)}.a{color:var(--a)}.b{color:var(--b)}details table{margin:.3em 0 1em "
    "1.2em}";

// The page finds everything by ids. `walks` holds for each word and step the row of its table, and
// the states and steps of the picture that each side is at.
constexpr const char* script = R"js(
"use strict";
const walks = JSON.parse(document.getElementById("walks").textContent);

// The place behind a key; the same place where the key does nothing.
function move(place, key) {
  const walk = Math.min(Math.max(place.walk + (key === "n" ? 1 : key === "p" ? -1 : 0), 0),
                        walks.length - 1);
  if (walk !== place.walk) return {walk, step: 0};
  const last = walks[walk].length - 1;
  const step = {ArrowRight: place.step + 1, ArrowLeft: place.step - 1, Home: 0, End: last}[key];
  return {walk, step: step === undefined ? place.step : Math.min(Math.max(step, 0), last)};
}

// Where a link with "#2.5" leads: step 5 of difference 2; to the start if that is not there.
function asked(hash) {
  const found = /^#(\d+)\.(\d+)$/.exec(hash);
  const place = found ? {walk: Number(found[1]) - 1, step: Number(found[2])} : {walk: 0, step: 0};
  return walks[place.walk] && walks[place.walk][place.step] ? place : {walk: 0, step: 0};
}

let place = {walk: 0, step: 0};
const find = (id) => document.getElementById(id);

function mark(is_on) {
  const step = walks[place.walk][place.step];
  find(step.row).classList.toggle("now", is_on);
  for (const [side, ids, others] of [["at-left", step.left, step.right],
                                     ["at-right", step.right, step.left]]) {
    for (const id of ids) {
      find(id).classList.toggle("at", is_on);
      find(id).classList.toggle(side, is_on && others.length > 0 && !others.includes(id));
    }
  }
}

// Moves the picture in its frame, and not the page.
function look_at(id) {
  const frame = find("stage").getBoundingClientRect(), at = find(id).getBoundingClientRect();
  find("stage").scrollBy(at.left + at.width / 2 - frame.left - frame.width / 2,
                         at.top + at.height / 2 - frame.top - frame.height / 2);
}

function go(next) {
  mark(false);
  place = next;
  mark(true);
  find("w" + place.walk).open = true;
  find("where").textContent = "difference " + (place.walk + 1) + " of " + walks.length + ", step " +
      place.step + " of " + (walks[place.walk].length - 1);
  const states = walks[place.walk][place.step].left;
  if (states.length > 0) look_at(states[0]);
}

if (walks.length > 0) {
  find("controls").hidden = false;
  for (const [id, key] of [["first", "Home"], ["back", "ArrowLeft"], ["next", "ArrowRight"],
                           ["last", "End"], ["walk-back", "p"], ["walk-next", "n"]]) {
    find(id).addEventListener("click", () => go(move(place, key)));
  }
  find("fit").addEventListener("click", () => find("stage").classList.toggle("fit"));
  walks.forEach((steps, walk) => steps.forEach((step, number) =>
      find(step.row).addEventListener("click", () => go({walk, step: number}))));
  document.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const next = move(place, event.key);
    if (next.walk === place.walk && next.step === place.step) return;
    event.preventDefault();
    go(next);
  });
  go(asked(location.hash));
}
)js";

// The states that are drawn: all, or those on the words and where the machines differ, and then
// those around, up to a number.
std::vector<bool> choose_states(const DifferencePage& page) {
  const JointPicture& picture = page.picture;
  const PictureSize size{picture.states.size(), picture.steps.size()};
  if (size.is_drawable()) return std::vector<bool>(picture.states.size(), true);
  std::vector<bool> chosen(picture.states.size());
  std::deque<std::size_t> open;
  const auto choose = [&](std::optional<std::size_t> state) {
    if (!state || chosen[*state] || open.size() >= most_drawn_states) return;
    chosen[*state] = true;
    open.push_back(*state);
  };
  for (const std::size_t start : picture.starts) choose(start);
  for (const Walk& walk : page.walks) {
    for (const WalkStep& step : walk.steps) {
      choose(step.left_at);
      choose(step.right_at);
    }
  }
  for (const JointPicture::Step& step : picture.steps) {
    if (open.size() >= states_around || step.kind == "both" || step.kind == "plain") continue;
    choose(step.from);
    choose(step.to);
  }
  std::vector<std::vector<std::size_t>> next(picture.states.size());
  for (const JointPicture::Step& step : picture.steps) next[step.from].push_back(step.to);
  for (std::size_t i = 0; i < open.size() && open.size() < states_around; ++i) {
    for (const std::size_t state : next[open[i]]) {
      if (open.size() < states_around) choose(state);
    }
  }
  return chosen;
}

std::string state_name(const JointPicture::State& state) {
  std::string name = state.name;
  std::replace(name.begin(), name.end(), '\n', ';');
  return escape_markup(name);
}

void write_legend(std::ostream& out, const DifferencePage& page) {
  out << "<p class=\"legend\">";
  for (const auto& [kind, meaning] : page.legend) {
    out << fmt::format(
        "<svg width=\"54\" height=\"14\" role=\"img\" aria-hidden=\"true\"><g class=\"edge "
        "{}\"><path "
        "d=\"M2,7 L52,7\" fill=\"none\"/></g></svg> {} &nbsp; ",
        kind, escape_markup(meaning));
  }
  out << fmt::format("<br><b class=\"a\">{}</b>: {} &nbsp; <b class=\"b\">{}</b>: {}</p>\n",
                     escape_markup(page.left), escape_markup(page.left_name),
                     escape_markup(page.right), escape_markup(page.right_name));
}

void write_controls(std::ostream& out) {
  out << "<div id=\"controls\" hidden>";
  constexpr std::pair<const char*, const char*> buttons[] = {{"first", "start"},
                                                             {"back", "&larr; back"},
                                                             {"next", "next &rarr;"},
                                                             {"last", "end"},
                                                             {"walk-back", "difference before"},
                                                             {"walk-next", "next difference"},
                                                             {"fit", "whole picture"}};
  for (const auto& [id, text] : buttons) {
    out << fmt::format("<button type=\"button\" id=\"{}\">{}</button>", id, text);
  }
  out << "<output id=\"where\"></output><br><small>Keys: left and right, Home and End step through "
         "the word; n and p go to the next difference and the one before. Yellow is where the word "
         "is; "
         "where the sides are apart, dashed and dotted as the lines above.</small></div>\n";
}

void write_walk(std::ostream& out, const DifferencePage& page, std::size_t number) {
  const Walk& walk = page.walks[number];
  // Nobody knows the states of a running system.
  const bool has_right = std::ranges::any_of(
      walk.steps, [](const WalkStep& step) { return step.right_at.has_value(); });
  out << fmt::format(
      "<details id=\"w{0}\"{1}><summary>{2}. {3}</summary>\n<table><tr><th>step</th><th>given</th>"
      "<th class=\"a\">{4} answers</th><th class=\"b\">{5} answers</th><th>{4} is "
      "then</th>{6}</tr>\n",
      number, number == 0 ? " open" : "", number + 1, escape_markup(walk.title),
      escape_markup(page.left), escape_markup(page.right),
      has_right ? fmt::format("<th>{} is then</th>", escape_markup(page.right)) : "");
  for (std::size_t i = 0; i < walk.steps.size(); ++i) {
    const WalkStep& step = walk.steps[i];
    out << fmt::format(
        "<tr id=\"w{}s{}\"{}><td>{}</td><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td>"
        "{}</tr>\n",
        number, i, step.differs ? " class=\"differs\"" : "", i,
        escape_markup(i == 0 ? "(start)" : step.given), escape_markup(step.left),
        escape_markup(step.right), escape_markup(step.left_state),
        has_right ? fmt::format("<td>{}</td>", escape_markup(step.right_state)) : "");
  }
  out << "</table></details>\n";
}

// What the script needs, where there is a picture: ids of what is drawn.
std::string walks_json(const DifferencePage& page, const std::vector<bool>& is_drawn,
                       const std::vector<std::size_t>& edges) {
  Json walks = Json::array();
  for (std::size_t number = 0; number < page.walks.size(); ++number) {
    Json steps = Json::array();
    for (std::size_t i = 0; i < page.walks[number].steps.size(); ++i) {
      const WalkStep& step = page.walks[number].steps[i];
      const auto ids = [&](std::optional<std::size_t> state, std::optional<std::size_t> one) {
        std::vector<std::string> found;
        if (state && !is_drawn.empty() && is_drawn[*state])
          found.push_back(fmt::format("n{}", *state));
        if (one && *one < edges.size() && edges[*one] < page.picture.steps.size()) {
          found.push_back(fmt::format("e{}", edges[*one]));
        }
        return found;
      };
      steps.push_back({{"row", fmt::format("w{}s{}", number, i)},
                       {"left", ids(step.left_at, step.left_step)},
                       {"right", ids(step.right_at, step.right_step)}});
    }
    walks.push_back(std::move(steps));
  }
  return to_json_line(walks);
}

// All steps that are not common, for those who cannot see the picture.
void write_steps(std::ostream& out, const DifferencePage& page) {
  std::size_t rows = 0, all = 0;
  for (const JointPicture::Step& step : page.picture.steps) {
    if (step.kind == "both" || step.kind == "plain") continue;
    if (++all > most_listed_steps) continue;
    if (rows++ == 0) {
      out << fmt::format(
          "<h2>{}</h2>\n<table><tr><th>in state</th><th>step</th><th>goes to</th></tr>\n",
          escape_markup(page.alone));
    }
    out << fmt::format("<tr><td>{}</td><td class=\"{}\"><code>{}</code></td><td>{}</td></tr>\n",
                       state_name(page.picture.states[step.from]), step.kind == "right" ? "b" : "a",
                       escape_markup(step.label), state_name(page.picture.states[step.to]));
  }
  if (rows > 0) out << "</table>\n";
  if (all > most_listed_steps)
    out << fmt::format("<p>The first {} of {}.</p>\n", most_listed_steps, all);
}

}  // namespace

DifferencePage make_comparison_page(const BehaviourPair& pair, const Differences& differences,
                                    const std::vector<std::string>& left_states,
                                    const std::vector<std::string>& right_states) {
  return Joiner(pair, differences, left_states, right_states).run();
}

DifferencePage make_conformance_page(const ConformanceResult& result,
                                     const std::vector<std::string>& states,
                                     const std::vector<std::string>& titles) {
  const Mealy& model = result.model;
  const std::size_t inputs = model.inputs().size();
  DifferencePage page;
  page.left = "model";
  page.right = "system";
  page.alone = "Transitions that fail";
  page.legend = {{"both", "a test came here, and they agreed"},
                 {"plain", "no test came here"},
                 {"right", "the system answers otherwise"}};
  std::map<std::pair<StateId, Symbol>, const ConformanceFailure*> failures;
  for (const ConformanceFailure& one : result.failures) failures[{one.state, one.input}] = &one;
  std::vector<std::size_t> steps(model.size() * inputs);
  page.picture.starts = {model.initial()};
  page.picture.start_kinds = {"both"};
  for (StateId state = 0; state < model.size(); ++state) {
    std::string untried;
    for (Symbol input = 0; input < inputs; ++input) {
      const std::size_t place = std::size_t{state} * inputs + input;
      const std::string& name = model.inputs().name(input);
      if (result.never_tried[place]) {
        untried += (untried.empty() ? "never tried: " : ", ") + name;
        continue;
      }
      const std::string& output = model.outputs().name(model.output(state, input));
      const auto failure = failures.find({state, input});
      const bool fails = failure != failures.end();
      steps[place] = page.picture.steps.size();
      page.picture.steps.push_back({state, model.target(state, input),
                                    fails                   ? "right"
                                    : result.covered[place] ? "both"
                                                            : "plain",
                                    fails ? fmt::format("{} / model: {}, system: {}", name, output,
                                                        failure->second->observed)
                                          : fmt::format("{} / {}", name, output)});
    }
    page.picture.states.push_back({states[state], "both", untried});
  }
  for (const ConformanceFailure& failure : result.failures) {
    Walk walk;
    StateId state = model.initial();
    walk.steps.push_back({"", "", "", states[state], "", state, {}, {}, {}, false});
    for (std::size_t i = 0; i < failure.word.size(); ++i) {
      const std::size_t place = std::size_t{state} * inputs + failure.word[i];
      const bool is_last = i + 1 == failure.word.size();
      const std::string& output = model.outputs().name(model.output(state, failure.word[i]));
      state = model.target(state, failure.word[i]);
      WalkStep step;
      step.given = model.inputs().name(failure.word[i]);
      step.left = result.never_tried[place] ? "never tried" : output;
      step.right = is_last ? failure.observed : result.never_tried[place] ? "not asked" : output;
      step.left_state = states[state];
      step.left_at = state;
      if (!result.never_tried[place]) step.left_step = steps[place];
      step.differs = is_last;
      walk.steps.push_back(std::move(step));
    }
    walk.title = titles[page.walks.size()];
    page.walks.push_back(std::move(walk));
  }
  return page;
}

void write_difference_page(std::ostream& out, const DifferencePage& page,
                           const GraphPainter& paint) {
  open_page(out, page.title, page_style);
  out << fmt::format("<p>{}</p>\n", escape_markup(page.verdict));
  if (!page.notes.empty()) {
    out << "<ul>\n";
    for (const std::string& note : page.notes) out << "<li>" << escape_markup(note) << "</li>\n";
    out << "</ul>\n";
  }
  write_legend(out, page);
  std::vector<bool> is_drawn = choose_states(page);
  std::vector<std::size_t> edges;
  const std::string svg = paint(joint_picture(page.picture, is_drawn, edges));
  write_controls(out);
  if (svg.empty()) {
    is_drawn.clear();
    edges.clear();
    out << "<p>No picture: Graphviz's dot is not installed here, or gave up.</p>\n";
  } else {
    const auto drawn = static_cast<std::size_t>(std::ranges::count(is_drawn, true));
    if (drawn < is_drawn.size()) {
      out << fmt::format(
          "<p>{} of {} states are drawn: those on the words below, those where the two differ, and "
          "some around them.</p>\n",
          drawn, is_drawn.size());
    }
    out << "<div class=\"card stage\" id=\"stage\">" << svg << "</div>\n";
  }
  if (!page.walks.empty()) out << "<h2>Differences</h2>\n";
  for (std::size_t i = 0; i < page.walks.size(); ++i) write_walk(out, page, i);
  write_steps(out, page);
  out << "<script type=\"application/json\" id=\"walks\">" << walks_json(page, is_drawn, edges)
      << "</script>\n<script>" << script << "</script>\n";
  close_page(out);
}

}  // namespace maide
