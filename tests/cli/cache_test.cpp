// `maide cache` with the real program, on caches that `maide learn` has written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string model = MAIDE_SOURCE_DIR "/tests/models/strict-6.dot";
const std::string simulated = "sim:" + model;

class CacheCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }

  // Learns into the cache; the words run on the system.
  std::uint64_t learn(const std::string& cache, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"learn",  simulated, "--cache",        cache,
                                       "--json", "-o",      path("model.dot")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const SubprocessResult result = run_maide(arguments);
    EXPECT_EQ(result.exit_status, 0) << result.err;
    return json_of(result).at("experiments");
  }
  // Adds a word that was answered with `outputs` over `names`.
  void add_word(const std::string& cache, const Word& inputs, const Word& outputs,
                const Alphabet& names) {
    CacheFile file(cache);
    Alphabet all = file.outputs();
    Word renumbered;
    for (const Symbol output : outputs) renumbered.push_back(all.intern(names.name(output)));
    file.add(inputs, renumbered, all);
    file.commit();
  }

  TempDir folder;
};

// Words that begin so, and were not answered so.
void remove_contradicting(CacheFile& file, const Word& word, const Word& answer) {
  file.remove_if([&](const Word& inputs, const Word& outputs) {
    return is_prefix(word, inputs) && !is_prefix(answer, outputs);
  });
}

TEST_F(CacheCommand, ShowSaysWhatIsInIt) {
  const std::string cache = path("a.cache");
  const std::uint64_t experiments = learn(cache);
  const SubprocessResult text = run_maide({"cache", "show", cache});
  EXPECT_EQ(text.exit_status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("system        " + simulated));
  EXPECT_THAT(text.out, HasSubstr("translation   eager"));
  EXPECT_THAT(text.out, HasSubstr("inputs        2: write, read"));
  const Json found = json_of(run_maide({"cache", "show", cache, "--json"})).at("caches").at(0);
  EXPECT_LE(found.at("words"), experiments);  // what says nothing new is not kept
  EXPECT_GT(found.at("observations"), 0);
  EXPECT_GE(found.at("symbols"), found.at("observations"));
  EXPECT_EQ(found.at("bytes"), fs::file_size(cache));
  EXPECT_EQ(found.at("conflicts"), 0);
}

// What two runs have asked is asked no more by a third one on the merged cache.
TEST_F(CacheCommand, MergedCachesAnswerWhatEachOfThemAnswers) {
  const std::string one = path("one.cache"), two = path("two.cache"), all = path("all.cache");
  const std::vector<std::string> words{"--eq", "random-words", "--seed", "7"};
  const std::uint64_t first = learn(one), second = learn(two, words);
  const SubprocessResult result = run_maide({"cache", "merge", one, two, "-o", all, "--json"});
  ASSERT_EQ(result.exit_status, 0) << result.err;
  EXPECT_GE(json_of(result).at("words"), std::max(first, second));
  EXPECT_LT(json_of(result).at("words"), first + second);
  EXPECT_EQ(learn(all), 0U);
  EXPECT_EQ(learn(all, words), 0U);
  EXPECT_EQ(run_maide({"cache", "check", all}).exit_status, 0);
  expect_error(run_maide({"cache", "merge", one, two, "-o", all}), 2, "is there already");
  expect_error(run_maide({"cache", "merge", one, two}), 2, "-o FILE");
  write_file_atomically(path("new.cache.part"), "somebody's");
  expect_error(run_maide({"cache", "merge", one, two, "-o", path("new.cache")}), 2,
               "this one is there already (" + path("new.cache.part"));
  EXPECT_EQ(read_file(path("new.cache.part")), "somebody's");
}

TEST_F(CacheCommand, CachesThatContradictEachOtherAreNotMerged) {
  const std::string one = path("one.cache"), two = path("two.cache"), all = path("all.cache");
  learn(one);
  fs::copy_file(one, two);
  add_word(two, {0, 1, 1}, {0, 1, 0}, {"quiet", "lie"});
  const SubprocessResult result = run_maide({"cache", "merge", one, two, "-o", all});
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(
      result.out,
      HasSubstr("\"write read\" is answered \"quiet message\" and \"quiet lie\" by " + two));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 3)
      << "the model and two caches";
}

TEST_F(CacheCommand, CachesOfOtherSystemsAreNotMerged) {
  const std::string one = path("one.cache"), two = path("two.cache");
  learn(one);
  CacheFile(two, Alphabet{"write", "read"}, {{"the system", "another"}}).commit();
  expect_error(run_maide({"cache", "merge", one, two, "-o", path("all.cache")}), 2,
               "the caches are of different systems: the system is 'another' there");
  EXPECT_FALSE(fs::exists(path("all.cache")));
}

TEST_F(CacheCommand, CheckFindsContradictionsAndDamage) {
  const std::string sound = path("sound.cache"), torn = path("torn.cache");
  learn(sound);
  EXPECT_THAT(run_maide({"cache", "check", sound}).out, HasSubstr("sound.cache: sound, "));

  const std::string wrong = path("wrong.cache");
  fs::copy_file(sound, wrong);
  add_word(wrong, {0, 1, 1}, {0, 1, 0}, {"quiet", "lie"});
  const SubprocessResult contradiction = run_maide({"cache", "check", sound, wrong});
  EXPECT_EQ(contradiction.exit_status, 1);
  EXPECT_THAT(contradiction.out, HasSubstr("1 of "));
  EXPECT_THAT(contradiction.out, HasSubstr("\"write read\" is answered"));

  fs::copy_file(sound, torn);
  fs::resize_file(torn, fs::file_size(torn) - 4096);
  const SubprocessResult damage = run_maide({"cache", "check", torn, sound});
  EXPECT_EQ(damage.exit_status, 2);
  EXPECT_THAT(damage.err, HasSubstr("torn.cache)"));
  EXPECT_THAT(damage.out, HasSubstr("sound.cache: sound, ")) << "the others are checked, too";

  expect_error(run_maide({"cache", "check", path("nothing")}), 2, "cannot open the cache");
  expect_error(run_maide({"cache", "check", model}), 2, "not a cache of Maide");
  expect_error(run_maide({"cache", "look", sound}), 2, "'look' is none of show, merge, check");
}

TEST_F(CacheCommand, CheckAsksTheSystemAgain) {
  const std::string cache = path("a.cache");
  learn(cache);
  const Json shown = json_of(run_maide({"cache", "show", cache, "--json"}));
  const auto words = shown.at("caches").at(0).at("words").get<std::uint64_t>();
  const auto check = [&](const std::string& system) {
    return run_maide({"cache", "check", cache, "--system", system, "--words", "1000000"});
  };
  const SubprocessResult same = check("'" + simulated + "'");
  EXPECT_EQ(same.exit_status, 0) << same.err;
  EXPECT_THAT(same.out, HasSubstr(std::to_string(words) + " of them asked again: all"));

  add_word(cache, {1, 1, 1}, {0, 1, 0}, {"quiet", "lie"});  // another system, so to speak
  {
    CacheFile file(cache);
    const Alphabet& names = file.outputs();
    remove_contradicting(file, {1, 1}, {names.at("quiet"), names.at("lie")});
    file.commit();
  }
  const SubprocessResult other = check(simulated);
  EXPECT_EQ(other.exit_status, 1) << other.out << other.err;
  EXPECT_THAT(other.out,
              HasSubstr("\"read read\" is answered \"quiet lie\" and \"quiet refused\""));
  expect_error(run_maide({"cache", "check", cache, "--system", simulated, "--words", "0"}), 2,
               "'0' is not a whole number from 1");
  expect_error(run_maide({"cache", "check", cache, "--system",
                          "sim:" MAIDE_SOURCE_DIR "/tests/models/port.dot"}),
               2, "recorded for another system");
}

// A simulated model's version is its text.
TEST_F(CacheCommand, CheckTakesAnotherVersion) {
  const std::string system = "sim:" + path("machine.dot");
  const auto write = [&](const std::string& output) {
    write_file_atomically(path("machine.dot"),
                          "digraph { a -> b [label=\"x / 0\"]; "
                          "b -> a [label=\"x / " +
                              output + "\"] }");
  };
  write("1");
  const std::string cache = path("a.cache");
  ASSERT_EQ(run_maide({"learn", system, "--cache", cache, "-o", path("m.dot")}).exit_status, 0);
  const std::vector<std::string> check{"cache", "check", cache, "--system", system};
  EXPECT_THAT(run_maide(check).out, testing::Not(HasSubstr("another version")));
  write("2");
  const SubprocessResult other = run_maide(check);
  EXPECT_EQ(other.exit_status, 1) << other.out << other.err;
  EXPECT_THAT(other.out, HasSubstr("another version: model "));
  EXPECT_THAT(other.out, HasSubstr("\"x x\" is answered \"0 1\" and \"0 2\""));
}

// The cache says "lie" to each of eleven inputs, twice to the first one; to the twelfth only the
// second time.
TEST_F(CacheCommand, CheckShowsEachChangedAnswerOnceShortestFirst) {
  std::string machine = "digraph {";
  for (char input = 'a'; input <= 'l'; ++input) {
    machine += std::string(" s -> s [label=\"") + input + " / no\"];";
  }
  write_file_atomically(path("deaf.dot"), machine + " }");
  const std::string cache = path("a.cache"), system = "sim:" + path("deaf.dot");
  ASSERT_EQ(run_maide({"learn", system, "--cache", cache, "-o", path("m.dot")}).exit_status, 0);
  {
    CacheFile file(cache);
    Alphabet names = file.outputs();
    const Symbol no = names.at("no"), lie = names.intern("lie");
    for (Symbol input = 0; input < 11; ++input) file.add({input, input}, {lie, no}, names);
    file.add({0, 1}, {lie, no}, names);
    file.add({11, 11, 0}, {no, lie, no}, names);
    for (Symbol input = 0; input < 11; ++input) remove_contradicting(file, {input}, {lie});
    remove_contradicting(file, {11, 11}, {no, lie});
    file.commit();
  }
  const SubprocessResult text =
      run_maide({"cache", "check", cache, "--system", system, "--words", "1000"});
  EXPECT_EQ(text.exit_status, 1) << text.out << text.err;
  EXPECT_THAT(text.out, HasSubstr("13 answered otherwise\n  \"a\" is answered \"lie\" and \"no\", "
                                  "in 2 words\n  \"b\" is"));
  EXPECT_THAT(text.out, HasSubstr("\"j\" is answered \"lie\" and \"no\"\n  and 2 more"));
  const Json found =
      json_of(run_maide({"cache", "check", cache, "--system", system, "--words", "1000", "--json"}))
          .at("caches")
          .at(0);
  EXPECT_EQ(found.at("different"), 13);
  ASSERT_EQ(found.at("answered_otherwise").size(), 12U);
  EXPECT_EQ(found.at("answered_otherwise").back(),
            (Json{{"word", {"l", "l"}}, {"known", "no lie"}, {"other", "no no"}, {"words", 1}}));
}

TEST_F(CacheCommand, OptionsOfAnotherVerbAreRefused) {
  const std::string cache = path("a.cache");
  learn(cache);
  expect_error(run_maide({"cache", "check", cache, "--words", "5"}), 2,
               "--words needs a system that is asked again");
  expect_error(run_maide({"cache", "show", cache, "--system", simulated}), 2,
               "--system is an option of 'maide cache check', not of 'maide cache show'");
  expect_error(run_maide({"cache", "check", cache, "-o", path("b.cache")}), 2,
               "--output is an option of 'maide cache merge', not of 'maide cache check'");
}

// What is there is shown while somebody else has the cache open, and a run goes on undisturbed.
TEST_F(CacheCommand, ShowNeedsNoLock) {
  const std::string cache = path("a.cache");
  const std::uint64_t words = learn(cache);
  const auto holder = std::make_unique<CacheFile>(cache);
  const SubprocessResult result = run_maide({"cache", "show", cache, "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("another process uses this cache; what it held just now is "
                                    "read (" +
                                    cache + ")"));
  EXPECT_LE(json_of(result).at("caches").at(0).at("words"), words);
  EXPECT_TRUE(fs::exists(cache + "-wal")) << "the holder's log was taken away";
}

// Somebody else has the cache open; the run waits for them, and then asks only what they did not.
TEST_F(CacheCommand, ARunWaitsForAnotherOneToCloseTheCache) {
  const std::string cache = path("a.cache");
  learn(cache);
  const std::string script = "\"$maide\" learn " + simulated + " --cache " + cache + " --json -o " +
                             path("again.dot") + " 2> " + path("note") +
                             " & run=$!; until grep -q waiting " + path("note") +
                             "; do sleep 0.01; done; touch " + path("waits") + "; wait $run";
  auto holder = std::make_unique<CacheFile>(cache);
  const std::jthread release([&] {
    while (!fs::exists(path("waits"))) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    holder.reset();
  });
  const SubprocessResult result = run_with_maide(script);
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_EQ(json_of(result).at("experiments"), 0);
  EXPECT_THAT(read_file(path("note")), HasSubstr("waiting for another process to close " + cache));
}

}  // namespace
}  // namespace maide::test
