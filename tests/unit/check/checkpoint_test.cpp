// Searches that are stopped and go on from their checkpoints, alone and on ranks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/check/engines/engine.hpp"
#include "mailbox_ranks.hpp"
#include "systems.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Asks for a stop at its report number `at`.
class Stopper : public ProgressObserver {
 public:
  Stopper(std::stop_source& source, int at) : source_(source), left_(at) {}
  void on_progress(const Progress& /*progress*/) override {
    if (--left_ == 0) source_.request_stop();
  }

 private:
  std::stop_source& source_;
  int left_;
};

// Of 25^4 states; levels of up to some ten thousand. `rest`: what one program does at its end.
System grid(const std::string& rest = "") {
  std::string text;
  for (const char* program : {"a", "b", "c", "d"}) {
    text += "  " + std::string(program) + ": \"repeat 24 { if * {} } " +
            (*program == 'd' ? rest : "") + "\"\n";
  }
  return test::system_of(text);
}

class CheckpointTest : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  // With a stop at that report; 0: to its end.
  PropertyResult run(const System& system, unsigned ranks, int stop_at,
                     Reduction reduction = Reduction::none) {
    std::stop_source source;
    Stopper stopper(source, stop_at);
    EngineOptions options;
    options.reduction = reduction;
    options.threads = 1 + ranks % 2;
    options.checkpoints = folder_.string();
    options.checkpoint_seconds = 0;
    options.control.stop = source.get_token();
    options.control.progress = &stopper;
    if (ranks == 1) return NativeEngine().check(system, test::deadlock_property(), options);
    test::RanksOfThreads group(ranks);
    options.ranks = group.first();
    return NativeEngine().check(system, test::deadlock_property(), options);
  }
  std::vector<std::string> files(const std::string& ending) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().string().ends_with(ending)) names.push_back(entry.path().string());
    }
    return names;
  }

  const fs::path folder_ =
      fs::path(testing::TempDir()) / ("checkpoints-" + std::to_string(::getpid()));
};

TEST_F(CheckpointTest, ASearchGoesOnWithAnotherNumberOfRanks) {
  const System system = grid();
  const PropertyResult whole = NativeEngine().check(system, test::deadlock_property(), {});
  ASSERT_EQ(whole.verdict, Verdict::holds);
  ASSERT_GT(whole.states, 100'000U);
  std::uint64_t last = 0;
  int stops = 0;
  for (const unsigned ranks : {1U, 3U, 2U, 1U}) {
    const PropertyResult part = run(system, ranks, 6);
    EXPECT_EQ(part.verdict, Verdict::inconclusive);
    EXPECT_GE(part.states, last) << "it did not begin where the last one had come to";
    last = part.states * 9 / 10;
    EXPECT_EQ(files(".json").size(), 1U);
    ++stops;
  }
  EXPECT_EQ(stops, 4);
  const PropertyResult rest = run(system, 2, 0);
  EXPECT_EQ(rest.verdict, Verdict::holds);
  EXPECT_EQ(rest.states, whole.states);
  EXPECT_EQ(rest.transitions, whole.transitions);
  EXPECT_TRUE(files(".states").empty());
  // What it found stays.
  const PropertyResult again = run(system, 1, 1);
  EXPECT_EQ(again.verdict, Verdict::holds);
  EXPECT_EQ(again.states, whole.states);
  EXPECT_EQ(again.transitions, whole.transitions);
}

TEST_F(CheckpointTest, ACounterexampleReachesBackBeyondIt) {
  const System system = grid("via.read -> message;");
  const PropertyResult whole = NativeEngine().check(system, test::deadlock_property(), {});
  ASSERT_EQ(whole.verdict, Verdict::violated);
  EXPECT_EQ(run(system, 2, 8).verdict, Verdict::inconclusive);
  const PropertyResult rest = run(system, 3, 0);
  ASSERT_EQ(rest.verdict, Verdict::violated);
  EXPECT_EQ(rest.trace->steps.size(), whole.trace->steps.size());
}

// Another system, or another reduction, has a checkpoint of its own.
TEST_F(CheckpointTest, SearchesAreKeptApart) {
  run(grid(), 1, 0);
  run(grid(), 1, 0, Reduction::order);
  const PropertyResult other = run(grid("via.write;"), 2, 0);
  EXPECT_EQ(other.verdict, Verdict::holds);
  EXPECT_GE(files(".json").size(), 2U);
}

TEST_F(CheckpointTest, ADamagedOneIsSaid) {
  const System system = grid();
  EXPECT_EQ(run(system, 1, 6).verdict, Verdict::inconclusive);
  const std::vector<std::string> parts = files(".states");
  ASSERT_EQ(parts.size(), 1U);
  const std::string content = read_file(parts[0]);
  const auto expect_damaged = [&] {
    try {
      run(system, 1, 0);
      ADD_FAILURE() << "it was believed";
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("the checkpoint is damaged"));
    }
  };
  std::string changed = content;
  changed[content.size() / 2] = static_cast<char>(changed[content.size() / 2] ^ 4);
  std::ofstream(parts[0]) << changed;
  expect_damaged();
  std::ofstream(parts[0]) << content.substr(0, content.size() / 3);
  expect_damaged();
  std::ofstream(parts[0]) << content << "more";
  expect_damaged();
  std::ofstream(parts[0]) << content;
  // A part less would be a search that found all there is.
  const std::string manifest = files(".json").at(0);
  const std::string said = read_file(manifest);
  for (const std::string name : {"parts", "depth", "transitions"}) {
    const std::size_t digit = said.find("\"" + name + "\":") + name.size() + 3;
    std::string other = said;
    other[digit] = static_cast<char>(other[digit] ^ 1);
    std::ofstream(manifest) << other;
    expect_damaged();
  }
  std::ofstream(manifest) << said;
  // A part of an earlier checkpoint is whole, and yet wrong.
  EXPECT_EQ(run(system, 1, 6).verdict, Verdict::inconclusive);
  const std::string later = files(".states").at(0);
  ASSERT_NE(later, parts[0]);
  const std::string later_content = read_file(later);
  std::ofstream(later) << content;
  expect_damaged();
  std::ofstream(later) << later_content;
  EXPECT_EQ(run(system, 1, 0).verdict, Verdict::holds);
  std::ofstream(manifest) << "{\"maide\":";
  expect_damaged();
}

// A search that is killed while it writes leaves parts that no manifest names.
TEST_F(CheckpointTest, WhatAKilledSearchLeftBehindGoes) {
  const System system = grid();
  EXPECT_EQ(run(system, 2, 6).verdict, Verdict::inconclusive);
  const std::string manifest = files(".json").at(0);
  const std::string own = manifest.substr(0, manifest.size() - 5);
  const std::string half = own + "-99-1.states.part-7-0", unnamed = own + "-99-0.states";
  const std::string others = (folder_ / "0000000000000000-1-0.states").string();
  for (const std::string& file : {half, unnamed, others}) std::ofstream(file) << "much";
  EXPECT_EQ(run(system, 3, 2).verdict, Verdict::inconclusive);
  EXPECT_FALSE(fs::exists(half));
  EXPECT_FALSE(fs::exists(unnamed));
  EXPECT_TRUE(fs::exists(others));
  EXPECT_EQ(run(system, 1, 0).verdict, Verdict::holds);
}

// An earlier checkpoint stays, and the search goes on.
TEST_F(CheckpointTest, AFolderThatVanishesCostsNoVerdict) {
  const System system = grid();
  testing::internal::CaptureStderr();
  std::stop_source source;
  class Remover : public ProgressObserver {
   public:
    explicit Remover(fs::path folder) : folder_(std::move(folder)) {}
    void on_progress(const Progress& /*progress*/) override { fs::remove_all(folder_); }

   private:
    fs::path folder_;
  } remover(folder_);
  EngineOptions options;
  options.checkpoints = folder_.string();
  options.checkpoint_seconds = 0;
  options.control.progress = &remover;
  const PropertyResult result = NativeEngine().check(system, test::deadlock_property(), options);
  EXPECT_EQ(result.verdict, Verdict::holds);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("no checkpoint was written"));
}

}  // namespace
}  // namespace maide
