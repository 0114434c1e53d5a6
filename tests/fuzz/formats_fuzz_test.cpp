// Readers of model files against damaged files: random edits of good ones, with fixed seeds. A
// reader either throws ParseError or gives a model that is written and read back unchanged; it
// never crashes, hangs or eats the memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/random_automata.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

std::string dot_of(const Model& model) {
  std::ostringstream out;
  write_dot(out, model);
  return out.str();
}
std::string aut_of(const Model& model) {
  std::ostringstream out;
  write_aut(out, model, MarkLoss::accept);
  return out.str();
}

constexpr std::array<std::string_view, 38> fragments{
    "digraph", "strict",   "subgraph", "node",     "edge",   "graph",  "{",          "}",
    "[",       "]",        "->",       "--",       "\"",     "\\",     "\\\"",       "/*",
    "*/",      "//",       "\n#",      ";",        ",",      "=",      ":",          "+",
    "<",       "__start0", "label",    "absorbed", "inputs", "actors", "unexplored", "type",
    " / ",     "?",        "!",        "99999999", "des (",  "\xff"};

// A few random edits: overwritten, removed, repeated and inserted pieces.
std::string damaged(std::string text, Random& random) {
  const std::uint64_t edits = random.between(1, 6);
  for (std::uint64_t edit = 0; edit < edits; ++edit) {
    const std::size_t place = random.below(text.size() + 1);
    const std::size_t length = std::min<std::size_t>(random.below(20), text.size() - place);
    switch (random.below(5)) {
      case 0:
        if (place < text.size()) text[place] = static_cast<char>(random.below(256));
        break;
      case 1: text.erase(place, length); break;
      case 2: text.insert(random.below(text.size() + 1), text.substr(place, length)); break;
      case 3: text.insert(place, fragments[random.below(fragments.size())]); break;
      default: text.replace(place, length, fragments[random.below(fragments.size())]);
    }
  }
  return text;
}

std::vector<Model> good_models(Random& random) {
  std::vector<Model> models;
  for (const char* name : {"port", "strict-2", "strict-1-absorb", "buffered-tryread"}) {
    const std::string path = std::string(MAIDE_SOURCE_DIR "/tests/models/") + name + ".dot";
    models.push_back(read_dot(read_file(path), path));
  }
  for (int round = 0; round < 4; ++round) models.push_back(random_mealy({3, 2, 2}, random));
  Mealy strange({"a / b", "\"", "\\"}, {"/", "n\nl"}, 1);
  for (Symbol input = 0; input < 3; ++input) strange.set_transition(0, input, input % 2, 0);
  strange.origin = {{"a key", "a \"value\""}};
  strange.actors = {{"a b", {"\""}, {"/"}}};
  models.push_back(strange);
  return models;
}

// A file of .aut has no alphabets: symbols are numbered as they appear, and so transitions may come
// in another order.
std::vector<std::string_view> sorted_lines(std::string_view text) {
  std::vector<std::string_view> lines = split_lines(text);
  std::ranges::sort(lines);
  return lines;
}

template <typename Read, typename Write>
void fuzz(std::uint64_t seed, int rounds, Read read, Write write) {
  Random random(seed);
  const std::vector<Model> models = good_models(random);
  int accepted = 0;
  for (int round = 0; round < rounds; ++round) {
    const std::string text = damaged(write(models[random.below(models.size())]), random);
    try {
      const Model model = read(text);
      ++accepted;
      const std::string written = write(model);
      const std::string again = write(read(written));
      ASSERT_EQ(sorted_lines(again), sorted_lines(written)) << text;
    } catch (const ParseError& error) {
      ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << text;
    } catch (const UsageError&) {
      ADD_FAILURE() << "an error without a place for " << text;
    }
  }
  EXPECT_GT(accepted, rounds / 100);  // the edits are small enough to reach the later stages
  EXPECT_LT(accepted, rounds);
}

TEST(FuzzDot, DamagedFilesAreRefusedOrUnderstood) {
  fuzz(
      21, 40000, [](const std::string& text) { return read_dot(text, "f.dot"); }, dot_of);
}

TEST(FuzzAut, DamagedFilesAreRefusedOrUnderstood) {
  fuzz(
      22, 40000, [](const std::string& text) { return read_aut(text, "f.aut"); }, aut_of);
}

TEST(FuzzBoth, NoiseIsRefused) {
  Random random(23);
  for (int round = 0; round < 20000; ++round) {
    std::string text = random.chance(0.5) ? "digraph {" : "des (0, 1, 1)\n";
    const std::uint64_t pieces = random.below(30);
    for (std::uint64_t piece = 0; piece < pieces; ++piece) {
      text += random.chance(0.8) ? std::string(fragments[random.below(fragments.size())])
                                 : std::string(1, static_cast<char>(random.below(256)));
    }
    for (const auto read : {read_dot, read_aut}) {
      try {
        read(text, "noise", {"", ModelReading::Labels::any_where_needed});
      } catch (const ParseError&) {
        continue;
      }
    }
  }
}

}  // namespace
}  // namespace maide
