// The pages of `maide help PAGE`. They are made from the tables that the program reads: learners,
// test methods and their options, wrappers, formats.
#include <algorithm>
#include <array>
#include <own_wrappers.hpp>  // made by the build
#include <string>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/export/system_exporters.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/terminal.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/learn/learner.hpp"
#include "maide/report/sequence_chart.hpp"
#include "maide/workflow/open_system.hpp"

namespace maide::cli {
namespace {

constexpr std::size_t widest_name = 26;

template <typename Table>
std::vector<TextRow> rows_of(const Table& table, auto&& text_of) {
  std::vector<TextRow> rows;
  for (const auto& row : table) rows.emplace_back(std::string(row.name), text_of(row));
  return rows;
}

std::string algorithms_page(std::size_t width) {
  const auto describe = [](const LearnerEntry& entry) { return std::string(entry.description); };
  return "Learning algorithms (--algorithm); the first is the default\n\n" +
         two_columns(rows_of(learners(), describe), width, widest_name);
}

std::string tests_page(std::size_t width) {
  const auto describe = [](const TestMethodEntry& entry) { return std::string(entry.description); };
  std::vector<TextRow> options;
  for (const TestOption& option : test_options()) {
    options.emplace_back(
        "--" + std::string(option.key) + " " + std::string(option.value),
        std::string(option.help) + (option.is_of_run ? "" : " (" + methods_with(option.key) + ")"));
  }
  return "How hypotheses are tested (--eq); the first is the default\n\n" +
         two_columns(rows_of(test_methods(), describe), width, widest_name) + "\n" +
         wrap(
             "Several with commas between are asked in turn, each with options of its own: "
             "--eq w:extra-states=1,random-hads:max-tests=5000",
             width, 0) +
         "\nOptions of tests, and the methods that look at them\n\n" +
         two_columns(options, width, widest_name);
}

std::string systems_page(std::size_t width) {
  std::vector<TextRow> wrappers;
  for (const OwnWrapper& wrapper : own_wrappers) {
    wrappers.emplace_back(
        std::string(wrapper.name),
        std::string(wrapper.title) + (find_wrapper(wrapper.name) ? "" : " (not on this machine)"));
  }
  return "Systems (SUL), with options behind them: KEY=VALUE ...\n\n" +
         two_columns({{"NAME",
                       "The program maide-wrap-NAME, found beside maide, in "
                       "../libexec/maide or on PATH"},
                      {"sim:FILE", "A model, simulated"},
                      {"exec:PROGRAM ARGS", "Any program that speaks the wire protocol"},
                      {"tcp://HOST:PORT,...",
                       "Wrappers that listen; the token comes from "
                       "--token-file or MAIDE_TOKEN"}},
                     width, widest_name) +
         "\nWrappers that come with Maide\n\n" + two_columns(wrappers, width, widest_name) + "\n" +
         wrap(
             "'maide learn NAME --list-options' lists the options of a system, 'maide doctor' "
             "tells what is usable on this machine. In keys - and _ are the same.",
             width, 0);
}

std::string formats_page(std::size_t width) {
  const auto describe = [](const auto& entry) { return std::string(entry.summary); };
  std::vector<TextRow> of_models = rows_of(exporters(), describe);
  of_models.emplace_back(tikz, tikz_summary);
  return "Formats of a model (maide export MODEL --to NAME)\n\n" +
         two_columns(of_models, width, widest_name) +
         "\nFormats of a system (maide export SYSTEM.yaml --to NAME)\n\n" +
         two_columns(rows_of(system_exporters(), describe), width, widest_name) +
         "\nFormat of a property of a system (--property NAME --to hoa)\n\n" +
         two_columns({{"hoa", "its automaton, for Spot and other tools of temporal logic"}}, width,
                     widest_name);
}

}  // namespace

std::span<const HelpPage> help_pages() {
  static constexpr std::array pages{
      HelpPage{"systems", "what can be learned and tested, and how it is named", systems_page},
      HelpPage{"algorithms", "the learning algorithms", algorithms_page},
      HelpPage{"tests", "how hypotheses and systems are tested", tests_page},
      HelpPage{"formats", "what models and systems can be written as", formats_page},
      HelpPage{"language", "how system files are written",
               [](std::size_t) { return std::string(language_help()); }},
  };
  return pages;
}

const HelpPage* find_help_page(std::string_view name) {
  for (const HelpPage& page : help_pages()) {
    if (page.name == name) return &page;
  }
  return nullptr;
}

std::string describe_help_pages() {
  std::vector<TextRow> rows;
  for (const HelpPage& page : help_pages()) {
    rows.emplace_back("maide help " + std::string(page.name), std::string(page.summary));
  }
  return two_columns(rows, help_width(), widest_name);
}

}  // namespace maide::cli
