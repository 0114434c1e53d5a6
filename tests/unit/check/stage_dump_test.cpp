// Dumps of the stages of reading: what is read from one leads on as the file does.
#include "maide/check/build/stage_dump.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <stop_token>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/system/system_json.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

using testing::HasSubstr;

// A model that was never learned stands for one that is.
InterfaceAutomaton find_model(const ModelRequest& request) {
  if (request.known) return *request.known;
  if (request.learn.empty()) return read_requested_model(request);
  return std::get<InterfaceAutomaton>(read_model(MAIDE_SOURCE_DIR "/examples/models/strict-6.dot"));
}
InterfaceAutomaton ask_nobody(const ModelRequest& request) {
  if (request.known) return *request.known;
  ADD_FAILURE() << "asked for " << request.instance;
  return find_model(request);
}

std::string json_text(const System& system) { return json_of(system).dump(); }

RunControl stopped() {
  std::stop_source source;
  source.request_stop();
  RunControl control;
  control.stop = source.get_token();
  return control;
}

std::vector<std::string> examples() {
  std::vector<std::string> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(MAIDE_SOURCE_DIR "/examples")) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().string());
  }
  return files;
}

constexpr const char* small_system =
    "constants: {n: 2, m: n}\nprograms: {a: 'repeat n { skip; } @d skip;'}\n";

TEST(StageDump, IsReadWithAMarkBlankLinesAndAnotherOrder) {
  const std::string dump = dump_stage(Stage::system, small_system, "s.yaml", ask_nobody);
  const std::string expected = json_text(parse_system(small_system, "s.yaml", ask_nobody));
  const std::string sorted = nlohmann::json::parse(dump).dump(1);
  EXPECT_FALSE(sorted.starts_with("{\n \"maide_stage\""));
  for (const std::string& text : {"\xEF\xBB\xBF" + dump, "\r\n \n" + dump, sorted}) {
    EXPECT_TRUE(is_stage_dump(text));
    EXPECT_EQ(json_text(parse_system(text, "s.json", ask_nobody)), expected);
  }
  for (const char* other :
       {"", "{}", "{\"a\": {\"maide_stage\": 1}}", "{\"a\": \"{\\\"maide_stage\"}",
        "[\"maide_stage\"]", "{\"maide_stages\": 1}", "{\"a"}) {
    EXPECT_FALSE(is_stage_dump(other)) << other;
  }
}

TEST(StageDump, WhatWritesOrReadsOneHearsThatItIsToStop) {
  const std::string dump = dump_stage(Stage::names, small_system, "s.yaml", ask_nobody);
  EXPECT_THROW(dump_stage(Stage::names, small_system, "s.yaml", ask_nobody, stopped()),
               Interrupted);
  EXPECT_THROW(parse_system(dump, "s.json", ask_nobody, stopped()), Interrupted);
  // In the middle.
  InterfaceAutomaton large(Alphabet({"a"}), Alphabet(std::vector<std::string>{}), 5000);
  EXPECT_THROW(json_of(large, stopped()), Interrupted);
  const nlohmann::json whole = json_of(large);
  EXPECT_THROW(automaton_of(whole, stopped()), Interrupted);
  EXPECT_EQ(automaton_of(whole).size(), 5000u);
}

TEST(StageDump, KeepsTheValuesOfConstantsThatWereSet) {
  const std::vector<ConstantSetting> three{{"n", "3"}};
  const System system = parse_system(small_system, "s.yaml", ask_nobody, {}, three);
  EXPECT_EQ(system.settings, three);
  for (const Stage stage : {Stage::names, Stage::models, Stage::system}) {
    const std::string dump = dump_stage(stage, small_system, "s.yaml", ask_nobody, {}, three);
    EXPECT_EQ(json_text(parse_system(dump, "d", ask_nobody)), json_text(system));
    EXPECT_EQ(json_text(parse_system(dump, "d", ask_nobody, {}, three)), json_text(system));
    EXPECT_THROW(parse_system(dump, "d", ask_nobody, {}, {{"n", "2"}}), UsageError);
  }
  EXPECT_THAT(dump_stage(Stage::tree, small_system, "s.yaml", ask_nobody, {}, three),
              HasSubstr("{n: 3, m: n}"));
}

TEST(StageDump, KeepsWhichProcessesDieAndWhoseProgramsAreOver) {
  const std::string text =
      "programs:\n  a: {do: 'skip;', may_die: true, may_restart: 2, process: x}\n"
      "  b: {do: 'skip;', process: x}\n  k: 'kill a; restart x;'\n";
  const System system = parse_system(text, "s.yaml", ask_nobody);
  for (const Stage stage : {Stage::names, Stage::models, Stage::system}) {
    const std::string dump = dump_stage(stage, text, "s.yaml", ask_nobody);
    const System read = parse_system(dump, "d", ask_nobody);
    EXPECT_EQ(json_text(read), json_text(system));
    for (std::size_t number = 0; number < system.programs.size(); ++number) {
      const Program &one = system.programs[number], &other = read.programs[number];
      EXPECT_EQ(one.may_die(), other.may_die()) << one.name;
      ASSERT_EQ(one.states.size(), other.states.size());
      for (ControlState at = 0; at < one.states.size(); ++at) {
        EXPECT_EQ(one.is_end(at), other.is_end(at)) << one.name << " at " << at;
      }
    }
  }
}

TEST(StageDump, OfEachStageOfEachExampleLeadsToTheSameSystem) {
  int compared = 0;
  for (const std::string& file : examples()) {
    SCOPED_TRACE(file);
    const std::string text = read_file(file);
    System system;
    try {
      system = parse_system(text, file, find_model);
    } catch (const ParseError&) {
      continue;  // the model that stands for a learned one has other inputs
    }
    std::size_t states = 0;
    for (const Program& program : system.programs) states += program.states.size();
    if (states > 300) continue;
    const std::string names = dump_stage(Stage::names, text, file, ask_nobody);
    const std::string models = dump_stage(Stage::models, names, "names", find_model);
    const std::string whole = dump_stage(Stage::system, models, "models", ask_nobody);
    EXPECT_EQ(whole, dump_stage(Stage::system, text, file, find_model));
    EXPECT_EQ(models, dump_stage(Stage::models, models, "models", ask_nobody));
    EXPECT_EQ(whole, dump_stage(Stage::system, whole, "whole", ask_nobody));
    const std::string expected = json_text(system);
    EXPECT_EQ(expected, json_text(parse_system(names, "names", find_model)));
    EXPECT_EQ(expected, json_text(parse_system(models, "models", ask_nobody)));
    EXPECT_EQ(expected, json_text(parse_system(whole, "whole", ask_nobody)));
    const std::string tree = dump_stage(Stage::tree, names, "names", ask_nobody);
    EXPECT_EQ(tree, dump_stage(Stage::tree, text, file, ask_nobody));
    if (tree == text) {
      EXPECT_EQ(expected, json_text(parse_system(tree, file, find_model)));
    }
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

constexpr const char* small =
    "constants: {n: 2}\n"
    "models: {q: {use: queue, with: {size: n}}, via: {learn: port}, \"m[i in 0..1]\": {use: "
    "mutex}}\n"
    "variables: \"var v[i in 0..2]: 0..3;\"\n"
    "procedures: {\"both(x)\": \"v[0] = x; v[1] = x;\"}\n"
    "programs: {p: via.write; call both(1);, \"r[i in 0..1]\": \"m[i].lock; q.write; "
    "m[i].unlock;\"}\n"
    "properties: {done: F p@end}\n";

TEST(StageDump, NamesAreToldWithoutAnyModel) {
  const auto dump =
      nlohmann::json::parse(dump_stage(Stage::names, small, "small.yaml", ask_nobody));
  const auto& names = dump.at("names");
  EXPECT_EQ(names.at("constants").dump(), R"({"n":"2"})");
  EXPECT_EQ(names.at("procedures").at("both").at("parameters").dump(), R"(["x"])");
  EXPECT_EQ(names.at("variables").at(0).at("members"), 3);
  EXPECT_EQ(names.at("variables").at(0).at("type"), "0..3");
  EXPECT_EQ(names.at("models").size(), 4U);
  EXPECT_EQ(names.at("models").at(0).at("from").dump(), R"({"size":2,"use":"queue"})");
  EXPECT_EQ(names.at("models").at(1).at("from").at("learn"), "port");
  EXPECT_EQ(names.at("models").at(3).at("name"), "m[1]");
  EXPECT_EQ(names.at("programs").at(2).at("name"), "r[1]");
}

std::string error_of(const std::string& text) {
  try {
    parse_system(text, "dump.json", find_model);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(StageDump, AChangedOneIsRefused) {
  for (const Stage stage : {Stage::names, Stage::models, Stage::system}) {
    const std::string dump = dump_stage(stage, small, "small.yaml", find_model);
    EXPECT_EQ(error_of(dump), "");
    EXPECT_THAT(error_of(std::regex_replace(dump, std::regex("done"), "gone")),
                HasSubstr("the dump was changed"));
    EXPECT_THAT(error_of(std::regex_replace(dump, std::regex("\"version\": \"[^\"]*\""),
                                            "\"version\": \"0.0.1\"")),
                HasSubstr("the dump is of maide 0.0.1"));
    EXPECT_THAT(error_of(dump.substr(0, dump.size() / 2)), HasSubstr("not valid JSON"));
  }
  EXPECT_THAT(error_of(R"({"maide_stage": 3})"), HasSubstr("no dump of a stage"));
  EXPECT_THAT(error_of(R"({"maide_stage": "packed", "sum": "", "version": ""})"),
              HasSubstr("the dump is of maide "));
  EXPECT_THAT(error_of("{}"), HasSubstr("programs"));
  const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
  EXPECT_THAT(error_of(R"({"maide_stage": "names", "x": )" + deep + "}"),
              HasSubstr("brackets are nested too deeply (dump.json:1:"));
}

TEST(StageDump, OfBytesThatAreNoUtf8IsRefused) {
  const std::string text = "programs: {p: \"skip;\"}\n";
  EXPECT_THROW(dump_stage(Stage::names, text, "\xe9.yaml", ask_nobody), UsageError);
  EXPECT_THROW(dump_stage(Stage::system, text, "\xe9.yaml", ask_nobody), UsageError);
}

TEST(StageDump, OfALaterStageHasTheFile) {
  const std::string dump = dump_stage(Stage::system, small, "small.yaml", find_model);
  EXPECT_EQ(dump_stage(Stage::names, dump, "dump.json", ask_nobody),
            dump_stage(Stage::names, small, "small.yaml", ask_nobody));
  EXPECT_FALSE(find_stage("packed"));
}

}  // namespace
}  // namespace maide
