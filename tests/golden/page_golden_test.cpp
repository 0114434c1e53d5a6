// Pages of models, systems and differences, byte for byte, against approved files. What is given to
// be drawn stands in them as it is, in DOT, so that no program that draws matters. After a change
// that is meant: MAIDE_APPROVE=1 build/dev/bin/test_golden.
#include <gtest/gtest.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "approved.hpp"
#include "maide/automata/behaviour.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/differences.hpp"
#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/experiment/conformance_run.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/report/difference_page.hpp"
#include "maide/report/html_report.hpp"
#include "maide/report/line_plot.hpp"
#include "maide/report/picture.hpp"
#include "maide/report/picture_page.hpp"
#include "maide/report/state_names.hpp"

namespace maide {
namespace {

using test::expect_approved;
using test::source_root;

// The page shows what there is to draw.
std::string show(const std::string& dot) { return "<pre>" + escape_markup(dot) + "</pre>\n"; }

// A page that cannot draw.
std::string show_nothing(const std::string&) { return ""; }

InterfaceAutomaton automaton_of(const std::string& name) {
  return read_interface_automaton(source_root + "/tests/models/" + name + ".dot");
}

// Two ends of a queue with all that a model may say of itself.
Model marked_automaton() {
  InterfaceAutomaton automaton({"write", "read", "close"}, {"message", "<crash>"}, 4);
  automaton.add_transition(0, {Action::Kind::input, 0}, 1);
  automaton.add_transition(1, {Action::Kind::input, 0}, 1, true);
  automaton.add_transition(1, {Action::Kind::input, 1}, 2);
  automaton.add_transition(2, {Action::Kind::output, 0}, 0);
  automaton.add_transition(2, {Action::Kind::output, 1}, 3);
  automaton.add_transition(3, {Action::Kind::input, 0}, 3);
  automaton.add_transition(3, {Action::Kind::input, 1}, 3);
  automaton.mark_unexplored(1, 2);
  automaton.mark_unexplored(3, 2);
  automaton.actors = {{"writer", {"write", "close"}, {}}, {"reader", {"read"}, {"message"}}};
  automaton.hidden_returns = {"close"};
  automaton.origin = {{"sul", "port size=1"}, {"bound", "1 & no more"}, {"strength", "weak: x"}};
  return automaton;
}

Model small_machine() {
  Mealy machine({"coin", "button"}, {"quiet", "coffee"}, 3);
  for (StateId state = 0; state < 3; ++state) {
    machine.set_transition(state, 0, 0, state == 2 ? 2 : state + 1);
    machine.set_transition(state, 1, state == 2 ? 1 : 0, 0);
  }
  machine.origin = {{"algorithm", "lsharp"}};
  return machine;
}

// Too large to draw by one transition, or by one state.
Model large_machine(std::size_t states, std::size_t inputs) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < inputs; ++i) names.push_back("i" + std::to_string(i));
  Mealy machine(Alphabet(std::span<const std::string>(names)), {"quiet"}, states);
  for (StateId state = 0; state < states; ++state) {
    for (Symbol input = 0; input < inputs; ++input) {
      machine.set_transition(state, input, 0,
                             input == 0 ? static_cast<StateId>((state + 1) % states) : state);
    }
  }
  return machine;
}

TEST(PageGolden, OfModels) {
  std::ostringstream out;
  write_model_page(out, marked_automaton(), "a <queue>", show);
  write_model_page(out, small_machine(), "coffee", show);
  write_model_page(out, small_machine(), "coffee, not drawn", show_nothing);
  write_model_page(out, automaton_of("buffered-tryread"), "buffered", show);
  write_model_page(out, automaton_of("strict-1-absorb"), "strict", show);
  expect_approved("models.html", out.str());
}

TEST(PageGolden, OfModelsAtTheLimitOfPictures) {
  const auto is_drawn = [](const Model& model) {
    EXPECT_EQ(size_of(model).is_drawable(), true);
    std::ostringstream out;
    write_model_page(out, model, "large", [](const std::string&) { return "<i>drawn</i>"; });
    return out.str().find("<i>drawn</i>") != std::string::npos;
  };
  EXPECT_TRUE(is_drawn(large_machine(150, 4)));
  EXPECT_FALSE(size_of(large_machine(151, 1)).is_drawable());
  EXPECT_FALSE(size_of(large_machine(1, 601)).is_drawable());
  EXPECT_TRUE(size_of(large_machine(1, 600)).is_drawable());
  std::ostringstream out;
  write_model_page(out, large_machine(151, 2), "large", show);
  expect_approved("large-model.html", out.str());
}

TEST(PageGolden, OfSystems) {
  std::ostringstream out;
  for (const std::string file : {"ros2/nested/nested-mended.yaml", "architectures/map-server.yaml",
                                 "architectures/token.yaml"}) {
    const std::string path = source_root + "/examples/" + file;
    write_system_page(out, read_system(path), read_file(path), show);
  }
  expect_approved("systems.html", out.str());
}

TEST(PageGolden, OfSystemsThatCannotBeDrawn) {
  const std::string path = source_root + "/examples/architectures/two-by-two.yaml";
  std::ostringstream out;
  write_system_page(out, read_system(path), read_file(path), show_nothing);
  write_chart_page(out, "<svg><title>t</title></svg>", "a <title>");
  out << stand_alone("<svg viewBox=\"0 0 1 1\"><g/></svg>\n");
  expect_approved("system-without-pictures.html", out.str());
}

template <typename Left, typename Right>
void write_comparison(std::ostream& out, const Left& left, const Right& right,
                      const GraphPainter& paint) {
  const BehaviourPair pair = read_behaviours(left, right, {});
  DifferencePage page =
      make_comparison_page(pair, find_differences(pair, {}), name_states(left), name_states(right));
  page.title = "one and <other>";
  page.verdict = "They may differ.";
  page.left_name = "one.dot";
  page.right_name = "other.dot";
  page.notes = {"a note", "another <note>"};
  write_difference_page(out, page, paint);
}

TEST(PageGolden, OfDifferences) {
  std::ostringstream out;
  write_comparison(out, automaton_of("strict-1"), automaton_of("strict-2"), show);
  write_comparison(out, automaton_of("strict-1"), automaton_of("strict-1-absorb"), show);
  write_comparison(out, automaton_of("buffered-tryread"), automaton_of("buffered-tryread"), show);
  write_comparison(out, std::get<InterfaceAutomaton>(marked_automaton()), automaton_of("port"),
                   show_nothing);
  expect_approved("differences.html", out.str());
}

TEST(PageGolden, OfATest) {
  ConformanceResult result;
  result.model = std::get<Mealy>(small_machine());
  result.access = {{}, {0}, {0, 0}};
  result.never_tried = {false, false, false, true, false, false};
  result.covered = {true, true, true, false, false, false};
  result.failures = {{2, 1, {0, 0, 1}, "coffee", "quiet"}, {2, 0, {0, 0, 0}, "quiet", "tea"}};
  result.states = {3, 3};
  result.transitions = {3, 5};
  result.pairs = {4, 9};
  result.other_inputs = {"shake"};
  DifferencePage page =
      make_conformance_page(result, {"start", "paid", "full"}, {"no coffee", "tea in its place"});
  page.title = "coffee and a machine";
  page.verdict = "It does not conform.";
  page.left_name = "coffee.dot";
  page.right_name = "machine";
  std::ostringstream out;
  write_difference_page(out, page, show);
  expect_approved("test.html", out.str());
}

TEST(PageGolden, OfPlots) {
  const std::vector<std::pair<double, double>> points{{1, 1}, {3, 20}, {16, 700}, {900, 31}};
  std::ostringstream out;
  for (const PlotScale x :
       {PlotScale::powers_of_two, PlotScale::powers_of_ten, PlotScale::linear}) {
    for (const PlotScale y :
         {PlotScale::powers_of_two, PlotScale::powers_of_ten, PlotScale::linear}) {
      out << draw_plot({{"left", {{"one", points, true}, {"two", {{2, 5}, {8, 5}}}}},
                        {"right", {{"one", {}}, {"two", {{7, 7}}}}}},
                       {"below", x, y})
          << '\n';
    }
  }
  out << draw_plot({}, {"below"}) << '\n';
  expect_approved("plots.svg.txt", out.str());
}

TEST(PageGolden, NamesOfStates) {
  std::ostringstream out;
  for (const char* name :
       {"buffered-tryread", "port", "strict-3", "strict-1-absorb", "strict-3-tryread"}) {
    for (const std::string& state : name_states(automaton_of(name))) out << state << '\n';
    out << '\n';
  }
  for (const std::string& state : name_states(std::get<InterfaceAutomaton>(marked_automaton()))) {
    out << state << '\n';
  }
  expect_approved("states.txt", out.str());
  EXPECT_EQ(describe_word({}), "at the start");
  EXPECT_EQ(describe_word({"write"}), "after write");
  EXPECT_EQ(describe_word({"write", "write", "read"}), "after write twice, read");
  EXPECT_EQ(describe_word({"a", "b", "b", "b"}), "after a, b 3 times");
}

}  // namespace
}  // namespace maide
