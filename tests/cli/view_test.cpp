// `maide view` with the real program: pages and pictures of models, systems and traces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "maide/automata/random_automata.hpp"
#include "maide/base/file.hpp"
#include "maide/formats/model_file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string model(const std::string& name) {
  return MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot";
}

class View : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    write_file_atomically(path(name), text);
    return path(name);
  }
  // What is in the file that `maide view source -o name` makes.
  std::string view(const std::string& source, const std::string& name) const {
    const SubprocessResult result = run_maide({"view", source, "-o", path(name)});
    EXPECT_EQ(result.exit_status, 0) << result.err;
    EXPECT_EQ(result.out, path(name) + "\n");
    return read_file(path(name));
  }

 private:
  TempDir folder_;
};

TEST_F(View, AModelWithItsMarksInWords) {
  const std::string page = view(model("strict-2"), "page.html");
  EXPECT_THAT(page, AllOf(HasSubstr("<svg"), HasSubstr("?write"), HasSubstr("!message"),
                          HasSubstr("never tried"), HasSubstr("prefers-color-scheme:dark")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(view(model("strict-1-absorb"), "page.html"), HasSubstr("never tried"));
  const std::string picture = view(model("strict-2"), "picture.svg");
  EXPECT_THAT(picture, testing::StartsWith("<svg"));
  EXPECT_THAT(picture, HasSubstr("<style>"));
}

TEST_F(View, WritesNothingOverItsSource) {
  const std::string text = "programs: {a: skip}\n";
  const std::string system = write("s.yaml", text);
  expect_error(run_maide({"view", "--stage", "names", system, "-o", system}), 2,
               "-o would write over a file that is used (" + system + ")");
  const std::string beside = path("./s.yaml");
  expect_error(run_maide({"view", "--stage", "tree", system, "-o", beside}), 2, "write over");
  expect_error(run_maide({"export", system, "--to", "promela", "-o", beside}), 2, "write over");
  EXPECT_EQ(read_file(system), text);
}

TEST_F(View, ModelsTooLargeToDrawAreTables) {
  Random random(5);
  std::ostringstream text;
  write_dot(text, random_mealy({3000, 4, 3}, random));
  const std::string large = write("large.dot", text.str());
  const std::string page = view(large, "large.html");
  EXPECT_THAT(page, AllOf(HasSubstr("3000 states"), HasSubstr("Too large to be drawn"),
                          HasSubstr("The first 400 of 12000 transitions")));
  EXPECT_THAT(page, Not(HasSubstr("<svg")));
  expect_error(run_maide({"view", large, "-o", path("large.svg")}), 2, "too many for a picture");
}

TEST_F(View, ASystemWithItsPrograms) {
  const std::string system =
      write("system.yaml", "models:\n  via: {file: " + model("strict-2") +
                               "}\nprograms:\n  planner: |\n    repeat 2 { via.write; }\n"
                               "    @done skip;\n  tracker: |\n    loop { via.read -> message; }\n"
                               "  long: |\n    repeat 1000 { via.write; }\n");
  const std::string page = view(system, "system.html");
  EXPECT_THAT(page,
              AllOf(HasSubstr("program planner"), HasSubstr("@done"), HasSubstr("program tracker"),
                    HasSubstr("1001 control states"), HasSubstr("see its text below"),
                    HasSubstr("model via"), HasSubstr("repeat 2 { via.write; }")));
  EXPECT_THAT(view(system, "system.svg"), AllOf(HasSubstr("planner"), HasSubstr("via")));
}

TEST_F(View, ATraceIsAChart) {
  const std::string trace =
      write("trace.json",
            R"({"system": "s.yaml", "property": "deadlock", "loop_start": 1, "steps": [
          {"program": "planner", "line": 4, "model": "via", "event": "?write"},
          {"program": "tracker", "line": 7, "model": "via", "event": "!message"},
          {"program": "tracker", "line": 8, "model": null, "event": "else"}]})");
  EXPECT_THAT(view(trace, "trace.svg"),
              AllOf(HasSubstr("planner"), HasSubstr("tracker"), HasSubstr("message"),
                    HasSubstr("line 7"), HasSubstr("deadlock of s.yaml")));
  EXPECT_THAT(view(trace, "trace.html"), HasSubstr("<h1>deadlock of s.yaml</h1>"));
}

TEST_F(View, WithoutANameThePageIsTemporary) {
  const Json json = json_of(run_maide({"view", model("port"), "--json"}));
  const std::filesystem::path page = json.at("output").get<std::string>();
  EXPECT_EQ(json.at("kind"), "model");
  EXPECT_EQ(page.filename(), "port.html");
  EXPECT_THAT(read_file(page), HasSubstr("?write"));
  std::filesystem::remove_all(page.parent_path());
}

TEST_F(View, WithoutDotItSaysSo) {
  const SubprocessResult page =
      run_with_maide("PATH=/nowhere \"$maide\" view " + model("port") + " -o " + path("p.html"));
  EXPECT_EQ(page.exit_status, 0) << page.err;
  EXPECT_THAT(page.err, HasSubstr("dot is not on PATH"));
  EXPECT_THAT(read_file(path("p.html")), HasSubstr("No picture"));
  expect_error(
      run_with_maide("PATH=/nowhere \"$maide\" view " + model("port") + " -o " + path("p.svg")), 2,
      "dot");
}

TEST_F(View, ErrorsAreOneLine) {
  expect_error(run_maide({"view", model("port"), "-o", path("x.png")}), 2, "ends in .html or .svg");
  expect_error(run_maide({"view", "x.txt"}), 2, "(x.txt)");
  expect_error(run_maide({"view", write("a.json", "[]"), "-o", path("x.svg")}), 2, "no trace");
  expect_error(run_maide({"view", write("b.json", "{"), "-o", path("x.svg")}), 2, "no JSON");
  expect_error(run_maide({"view", write("c.json", R"({"steps": [{}]})"), "-o", path("x.svg")}), 2,
               "step 1 has no `program`");
}

}  // namespace
}  // namespace maide::test
