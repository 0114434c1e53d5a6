// `maide export` with the real program; what the formats look like is approved in tests/golden.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "maide/automata/compare.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/ia_translation.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string model(const std::string& name) {
  return MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot";
}
std::string approved(const std::string& file) {
  return read_file(MAIDE_SOURCE_DIR "/tests/golden/approved/" + file + ".approved");
}

TEST(Export, WritesToStandardOutput) {
  const SubprocessResult result = run_maide({"export", model("strict-2"), "--to", "promela"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(result.out, approved("strict-2.pml"));
}

TEST(Export, WritesToAFile) {
  const TempDir folder;
  const std::string file = (folder.path() / "strict-2.smv").string();
  const SubprocessResult result =
      run_maide({"export", model("strict-2"), "--to", "smv", "-o", file, "--json"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(read_file(file), approved("strict-2.smv"));
  const Json json = json_of(result);
  EXPECT_EQ(json.at("output"), file);
  EXPECT_EQ(json.at("states"), 6);
  EXPECT_EQ(json.at("transitions"), 8);
}

TEST(Export, JsonWithoutAFileHoldsTheText) {
  const Json json =
      json_of(run_maide({"export", model("buffered-tryread"), "--to", "aut", "--json"}));
  EXPECT_EQ(json.at("text"), approved("buffered-tryread.aut"));
}

TEST(Export, TheClassIsNamedAfterTheFile) {
  EXPECT_THAT(run_maide({"export", model("strict-2"), "--to", "cpp"}).out,
              HasSubstr("class strict_2 {"));
}

TEST(Export, MarksAreLostOnlyWhenAsked) {
  expect_error(run_maide({"export", model("strict-2"), "--to", "aut"}), 2, "--lossy");
  const SubprocessResult result =
      run_maide({"export", model("strict-2"), "--to", "aut", "--lossy"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.out, StartsWith("des (0, 8, 6)"));
}

// An interface automaton as other learning tools read one: states and transitions alone.
TEST(Export, TheMealyMachineOfAnAutomaton) {
  const TempDir folder;
  const std::string file = (folder.path() / "strict-2.dot").string();
  const SubprocessResult result =
      run_maide({"export", model("strict-2"), "--to", "mealy", "-o", file, "--json"});
  ASSERT_EQ(result.exit_status, 0) << result.err;
  const Mealy expected = to_mealy(read_interface_automaton(model("strict-2")), Translation::eager);
  EXPECT_EQ(json_of(result).at("states"), expected.size());
  const Mealy written = read_mealy(file);
  EXPECT_FALSE(find_difference(written, expected));
  EXPECT_TRUE(written.origin.empty());
  const std::string text = read_file(file);
  for (const std::string_view line : split_lines(text)) {
    EXPECT_TRUE(line.find("label=") != std::string_view::npos || line == "digraph g {" ||
                line.starts_with("  __start0 -> s") || line == "}")
        << line;
  }
}

// Compiled, where there is a LaTeX; else looked at.
void expect_picture(const std::string& source, const TempDir& folder, std::size_t states) {
  const std::string file = (folder.path() / "picture.tex").string();
  const SubprocessResult result = run_maide({"export", source, "--to", "tikz", "-o", file});
  ASSERT_EQ(result.exit_status, 0) << result.err;
  const std::string text = read_file(file);
  std::size_t nodes = 0;
  for (const std::string_view line : split_lines(text)) {
    if (line.starts_with("  \\node[state") || line.starts_with("  \\node[due")) ++nodes;
  }
  EXPECT_EQ(nodes, states);
  EXPECT_THAT(text, HasSubstr("\\draw[transition"));
  EXPECT_THAT(text, testing::EndsWith("\\end{tikzpicture}\n"));
  if (!find_on_path("pdflatex")) return;
  write_file_atomically((folder.path() / "paper.tex").string(),
                        "\\documentclass{article}\\usepackage{tikz}\\begin{document}\n"
                        "\\input{picture}\n\\end{document}\n");
  SubprocessOptions options;
  options.folder = folder.path();
  const SubprocessResult compiled =
      run_program({"pdflatex", "-interaction=batchmode", "-halt-on-error", "paper.tex"}, options);
  EXPECT_TRUE(compiled.succeeded()) << read_file(folder.path() / "paper.log");
}

TEST(Export, PicturesForLatex) {
  const TempDir folder;
  expect_picture(model("strict-2"), folder, 6);
  const std::string strange = (folder.path() / "strange.dot").string();
  write_file_atomically(strange, R"(digraph g { a -> b [label="in_put{}%#\\~^ / <>|$&"];
    a -> a [label="zwölf / 中"]; b -> a [label="in_put{}%#\\~^ / 0"];
    b -> b [label="zwölf / \"x\""]; })");
  expect_picture(strange, folder, 2);
}

TEST(Export, PicturesForLatexNeedGraphviz) {
  expect_error(
      run_with_maide("PATH=/nonexistent; \"$maide\" export " + model("port") + " --to tikz"), 2,
      "graphviz");
}

// Two programs over the port: a file of the folder.
std::string small_system(const TempDir& folder) {
  const std::string system = (folder.path() / "system.yaml").string();
  write_file_atomically(system, "models:\n  via: {file: " + model("port") +
                                    "}\nprograms:\n  planner: |\n    loop { via.write; }\n  "
                                    "tracker: |\n    loop { via.read -> message; }\n");
  return system;
}

TEST(Export, SystemsAsPromela) {
  const TempDir folder;
  const std::string system = small_system(folder);
  const std::string file = (folder.path() / "system.pml").string();
  const SubprocessResult result =
      run_maide({"export", system, "--to", "promela", "-o", file, "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_EQ(json_of(result).at("programs"), 2);
  SubprocessOptions options;
  options.folder = folder.path();
  const SubprocessResult generated = run_program({"spin", "-a", file}, options);
  EXPECT_TRUE(generated.succeeded()) << generated.out << generated.err;
}

// What they mean is compared in tests/differential; here, that a person gets them.
TEST(Export, SystemsAsOtherLanguages) {
  const TempDir folder;
  const std::string system = small_system(folder);
  const SubprocessResult aut = run_maide({"export", system, "--to", "aut"});
  EXPECT_EQ(aut.exit_status, 0) << aut.err;
  EXPECT_THAT(aut.out, StartsWith("des (0, "));
  EXPECT_THAT(aut.out, HasSubstr("\"planner via?write\""));
  EXPECT_THAT(aut.out, HasSubstr("\"tracker via!message\""));
  const std::string file = (folder.path() / "system.aut").string();
  EXPECT_EQ(run_maide({"export", system, "--to", "aut", "-o", file}).exit_status, 0);
  EXPECT_EQ(read_file(file), aut.out);
  EXPECT_EQ(json_of(run_maide({"export", system, "--to", "aut", "--json"})).at("text"), aut.out);
  EXPECT_THAT(run_maide({"export", system, "--to", "smv"}).out, HasSubstr("INVARSPEC !deadlock;"));
  EXPECT_THAT(run_maide({"export", system, "--to", "mcrl2"}).out,
              HasSubstr("p_in_via_write | m_in_via_write -> in_via_write"));
  EXPECT_THAT(run_maide({"export", system, "--to", "pins"}).out,
              HasSubstr("void pins_model_init(grey_box_model *model) {"));
  expect_error(run_maide({"export", system, "--to", "cpp"}), 2,
               "unknown format of systems 'cpp'; known are: promela, aut, smv, mcrl2, pins");
}

// SPIN decides one component at a time.
TEST(Export, OneComponentOfSeveral) {
  const TempDir folder;
  const std::string system = (folder.path() / "system.yaml").string();
  const auto promela = [&](const std::string& component) {
    return run_maide({"export", system, "--to", "promela", "--component", component});
  };
  write_file_atomically(system, R"(
models:
  lock[i in 0..4]: {use: mutex}
programs:
  robot[i in 0..4]: "loop { idle lock[i].lock; lock[i].unlock; }"
)");
  expect_error(run_maide({"export", system, "--to", "smv"}), 2,
               "the system has 5 components, and smv takes one: --component PROGRAM says whose, "
               "robot[0], robot[1], robot[2], ... (");
  const SubprocessResult one = promela("robot[3]");
  EXPECT_EQ(one.exit_status, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("byte model_lock_3_ = 0;"));
  EXPECT_EQ(one.out.find("lock_2_"), std::string::npos);
  EXPECT_EQ(run_maide({"export", system, "--to", "aut"}).exit_status, 0);
  EXPECT_THAT(run_maide({"export", system, "--to", "aut", "--component", "robot[0]"}).out,
              StartsWith("des (0, 2, 2)"));
  expect_error(promela("robot[5]"), 2,
               "there is no program or node 'robot[5]'; there is: robot[0]");
  expect_error(run_maide({"export", model("port"), "--to", "smv", "--component", "x"}), 2,
               "--component goes with a system");
}

TEST(Export, PropertiesAsAutomata) {
  const TempDir folder;
  const std::string system = small_system(folder);
  write_file_atomically(system, read_file(system) + "properties:\n  live: \"G F via!message\"\n");
  const SubprocessResult live = run_maide({"export", system, "--property", "live", "--to", "hoa"});
  EXPECT_EQ(live.exit_status, 0) << live.err;
  EXPECT_THAT(live.out, StartsWith("HOA: v1\nname: \"live of "));
  const std::string file = (folder.path() / "bad.hoa").string();
  EXPECT_EQ(
      run_maide({"export", system, "--property", "live", "--negated", "--to", "hoa", "-o", file})
          .exit_status,
      0);
  write_file_atomically(system, read_file(system) + "  same: {never: bad.hoa}\n");
  const auto verdict = [&](const std::string& property) {
    const SubprocessResult result =
        run_maide({"check", system, "--engine", "native", "--property", property, "--json"});
    return json_of(result).at("properties").at(0).at("verdict");
  };
  EXPECT_EQ(verdict("live"), verdict("same"));
  EXPECT_EQ(
      run_maide({"export", system, "--property", "same", "--negated", "--to", "hoa"}).exit_status,
      0);
  expect_error(run_maide({"export", system, "--property", "same", "--to", "hoa"}), 2, "--negated");
  expect_error(run_maide({"export", system, "--property", "deadlock", "--to", "hoa"}), 2,
               "is no formula");
  expect_error(run_maide({"export", system, "--to", "hoa"}), 2, "--property");
  expect_error(run_maide({"export", model("port"), "--property", "x", "--to", "hoa"}), 2,
               "a model has no properties");
}

TEST(Export, UnknownFormatsAreErrors) {
  expect_error(run_maide({"export", model("port"), "--to", "png"}), 2,
               "unknown format 'png'; known are: dot, mealy, aut, promela, smv, mcrl2, cpp, tikz");
  expect_error(run_maide({"export", model("port")}), 2, "--to");
  expect_error(run_maide({"export", model("port"), "--to", "dot", "-o", "/no/such/folder/x.dot"}),
               2, "(/no/such/folder/x.dot)");
}

}  // namespace
}  // namespace maide::test
