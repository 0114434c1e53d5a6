// Two machines on one page. A picture shows both: what only one of them does has a colour and a
// line style of its own. Every difference is a word that is stepped through on both. The page is
// one file that needs nothing else. Without JavaScript all words stand there as tables.
//
// The colours are Okabe & Ito's, which colour-blind people tell apart ("Color universal design",
// 2008).
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/behaviour.hpp"
#include "maide/automata/differences.hpp"
#include "maide/experiment/conformance_run.hpp"
#include "maide/report/picture.hpp"
#include "maide/report/picture_page.hpp"

namespace maide {

// One step of a word on both sides.
struct WalkStep {
  std::string given;                                 // "write"; "" for the start
  std::string left, right;                           // the answers
  std::string left_state, right_state;               // names of the states behind the step; or ""
  std::optional<std::size_t> left_at, right_at;      // the same as states of the picture
  std::optional<std::size_t> left_step, right_step;  // steps of the picture
  bool differs = false;
};

struct Walk {
  std::string title;            // "after write, write: read gives message in A, nothing in B"
  std::vector<WalkStep> steps;  // the start first
};

struct DifferencePage {
  std::string title;
  std::string verdict;                // a sentence
  std::string left, right;            // how columns and labels name the sides: "A", "model"
  std::string left_name, right_name;  // what they are: "old.dot"
  std::vector<std::string> notes;     // sentences
  std::vector<std::pair<std::string, std::string>> legend;  // kinds of steps, and what they mean
  std::string alone;  // heading of the steps that are not of both
  JointPicture picture;
  std::vector<Walk> walks;
};

inline constexpr std::size_t most_walks = 100;  // words on a page; the rest is counted

// The page of `maide compare`. `left_states` and `right_states` name the states of the two models.
DifferencePage make_comparison_page(const BehaviourPair& pair, const Differences& differences,
                                    const std::vector<std::string>& left_states,
                                    const std::vector<std::string>& right_states);

// The page of `maide test`: the model, with the transitions that tests passed and those that fail.
// `states` names the states of `result.model`, `titles` the failures.
DifferencePage make_conformance_page(const ConformanceResult& result,
                                     const std::vector<std::string>& states,
                                     const std::vector<std::string>& titles);

// Writes the page. A picture that is too large
// (report/picture.hpp) is cut to the states on the words, those where something differs, and some
// around.
void write_difference_page(std::ostream& out, const DifferencePage& page,
                           const GraphPainter& paint);

}  // namespace maide
