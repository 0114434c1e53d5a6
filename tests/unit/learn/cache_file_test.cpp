#include "maide/learn/cache/cache_file.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <utility>

#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "oracles.hpp"

namespace maide {
namespace {

const Alphabet inputs{"write", "read"};
const Fingerprint fingerprint{{"depth", "3"}, {"kind", "strict"}};

class CacheFileTest : public testing::Test {
 protected:
  // The message of opening it.
  std::string failure(const Alphabet& its_inputs = inputs, const Fingerprint& its = fingerprint) {
    try {
      CacheFile file(path, its_inputs, its);
      file.for_each([](const Word&, const Word&) {});
    } catch (const UsageError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(path.string()), std::string::npos) << "does not name the file";
      EXPECT_EQ(message.find('\n'), std::string::npos);
      return message;
    }
    return "";
  }
  void expect_failure(const std::string& part) {
    EXPECT_NE(failure().find(part), std::string::npos) << failure();
  }
  void execute(const char* sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }
  void make() {
    CacheFile file(path, inputs, fingerprint);
    file.add({0, 1}, {0, 1}, {"quiet", "message"});
    file.commit();
  }

  TempDir directory;
  std::filesystem::path path = directory.path() / "cache";
};

TEST_F(CacheFileTest, GivesBackWhatWasAdded) {
  std::vector<std::pair<Word, Word>> words{
      {{}, {}}, {{0, 1, 0}, {0, 1, 200}}, {{1}, {16000}}, {{1, 1}, {16000, 127}}};
  Alphabet names;
  for (int i = 0; i <= 16000; ++i) names.intern("o" + std::to_string(i));
  {
    CacheFile file(path, inputs, fingerprint);
    for (const auto& [word, answer] : words) file.add(word, answer, names);
    file.commit();
  }
  CacheFile file(path, inputs, fingerprint);
  EXPECT_EQ(file.outputs(), names);
  std::vector<std::pair<Word, Word>> read;
  file.for_each([&](const Word& word, const Word& answer) { read.emplace_back(word, answer); });
  EXPECT_EQ(read, words);
}

TEST_F(CacheFileTest, NamesEverythingThatDiffers) {
  make();
  EXPECT_EQ(failure(), "");
  const std::string message = failure({"write", "tryread"}, {{"depth", "4"}, {"size", "1"}});
  for (const char* part :
       {"recorded for another system", "depth is '3' there, '4' here",
        "kind is 'strict' there, not set here", "size is not set there, '1' here",
        "the inputs is 'write,read' there, 'write,tryread' here"}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST_F(CacheFileTest, OtherFilesAreRefusedAndStayAsTheyAre) {
  {
    std::ofstream out(path);
    out << "digraph g { this is no database, and long enough not to be taken for one; }";
  }
  const auto size = std::filesystem::file_size(path);
  expect_failure("not a cache of Maide");
  EXPECT_EQ(std::filesystem::file_size(path), size);
  std::filesystem::remove(path);
  execute("CREATE TABLE songs(title TEXT)");
  expect_failure("a database, but not a cache of Maide");
  execute("INSERT INTO songs VALUES ('still here')");
}

TEST_F(CacheFileTest, DamageIsFound) {
  make();
  execute("UPDATE words SET inputs = x'00ff'");
  expect_failure("damaged");
  execute("UPDATE words SET inputs = x'0009'");
  expect_failure("damaged");
  execute("UPDATE words SET inputs = x'00'");
  expect_failure("damaged");
  std::filesystem::resize_file(path, 6000);
  expect_failure("damaged");
}

TEST_F(CacheFileTest, AContradictionInTheFileIsFound) {
  const Alphabet names{"quiet", "message"};
  {
    CacheFile file(path, inputs, fingerprint);
    file.add({0, 1}, {0, 1}, names);
    file.add({0}, {1}, names);
    file.commit();
  }
  ScriptedOracle system(inputs, {});
  CacheFile file(path, inputs, fingerprint);
  EXPECT_THROW(Cache(system, file), UsageError);
}

TEST_F(CacheFileTest, AnotherFormatIsRefused) {
  make();
  execute("PRAGMA user_version = 7");
  expect_failure("format 7");
}

TEST_F(CacheFileTest, IsOpenOnce) {
  CacheFile file(path, inputs, fingerprint);
  expect_failure("in use by another process");
}

TEST_F(CacheFileTest, PlacesThatCannotBeWritten) {
  path = directory.path() / "nowhere" / "cache";
  expect_failure("cannot open the cache");
  path = directory.path();
  expect_failure("cannot open the cache");
}

// Runs `body` in a process of its own, which ends with its result.
template <typename Body>
int run_in_child(Body body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

// As another user, because root may write everything.
TEST_F(CacheFileTest, AReadOnlyFileIsOneClearLine) {
  make();
  using std::filesystem::perms;
  std::filesystem::permissions(path, perms::owner_read | perms::group_read | perms::others_read);
  std::filesystem::permissions(directory.path(), perms::all);
  const std::string message = "cannot write the cache: no permission";
  EXPECT_EQ(run_in_child([&] {
              if (geteuid() == 0 && seteuid(65534) != 0) return 1;
              return failure().find(message) != std::string::npos ? 0 : 2;
            }),
            0);
}

// Neither file nor folder can be written, as with somebody else's cache.
TEST_F(CacheFileTest, AReadOnlyFileIsReadWithoutWriting) {
  make();
  using std::filesystem::perms;
  const perms all_read = perms::owner_read | perms::group_read | perms::others_read;
  const perms all_enter = perms::owner_exec | perms::group_exec | perms::others_exec;
  std::filesystem::permissions(path, all_read);
  std::filesystem::permissions(directory.path(), all_read | all_enter);
  const auto read = [&] {
    if (geteuid() == 0 && seteuid(65534) != 0) return 1;
    try {
      CacheFile file(path);
      std::vector<Word> words;
      file.for_each([&](const Word& word, const Word&) { words.push_back(word); });
      if (words != std::vector<Word>{{0, 1}} || !file.find_damage().empty()) return 2;
      file.add({1}, {0}, file.outputs());
    } catch (const UsageError& error) {
      return std::string(error.what()).find("no permission") != std::string::npos ? 0 : 3;
    }
    return 4;
  };
  EXPECT_EQ(run_in_child(read), 0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1);
  // The word is in the log of a run that was killed.
  std::filesystem::permissions(directory.path(), perms::owner_all | all_read | all_enter);
  std::filesystem::remove(path);
  EXPECT_EQ(run_in_child([&] {
              CacheFile file(path, inputs, fingerprint);
              file.add({0, 1}, {0, 1}, {"quiet", "message"});
              file.commit();
              _exit(0);
              return 1;
            }),
            0);
  const std::string log = path.string() + "-wal";
  ASSERT_GT(std::filesystem::file_size(log), 0U);
  std::filesystem::permissions(path, all_read);
  std::filesystem::permissions(log, all_read);
  std::filesystem::permissions(directory.path(), all_read | all_enter);
  EXPECT_EQ(run_in_child(read), 0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 2);
  std::filesystem::permissions(directory.path(), perms::owner_all);
}

// A process writes words, the numbers from 0 on as 30 bits, through several checkpoints; whoever
// looks meanwhile sees a sound beginning of them, and more each time.
TEST_F(CacheFileTest, IsReadWhileAnotherProcessWritesIt) {
  int ready[2], stop[2];
  ASSERT_EQ(pipe(ready), 0);
  ASSERT_EQ(pipe(stop), 0);
  constexpr std::uint32_t batch = 50;
  const auto word_of = [](std::uint32_t number) {
    Word word;
    for (int bit = 0; bit < 30; ++bit) word.push_back((number >> bit) & 1);
    return word;
  };
  const pid_t writer = fork();
  ASSERT_GE(writer, 0);
  if (writer == 0) {
    ::close(stop[1]);
    CacheFile file(path, inputs, fingerprint);
    for (std::uint32_t number = 0;; ++number) {
      file.add(word_of(number), Word(30, 0), {"quiet"});
      if (number % batch != batch - 1) continue;
      file.commit();
      if (number < batch && write(ready[1], "x", 1) != 1) _exit(1);
      pollfd end{stop[0], POLLIN, 0};
      if (poll(&end, 1, 1) != 0) _exit(0);  // whoever looks is done
    }
  }
  ::close(stop[0]);
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  std::uint32_t before = 0;
  std::uintmax_t size = 0;
  for (int checkpoints = 0; checkpoints < 4;) {
    const std::uintmax_t now = std::filesystem::file_size(path);
    if (now != std::exchange(size, now)) ++checkpoints;
    CacheFile file(path);
    ASSERT_EQ(file.find_damage(), "");
    std::uint32_t count = 0;
    file.for_each([&](const Word& word, const Word&) { ASSERT_EQ(word, word_of(count++)); });
    EXPECT_EQ(count % batch, 0U);
    EXPECT_GE(count, std::max(before, batch));
    before = count;
    try {
      file.add({0}, {0}, file.outputs());
      ADD_FAILURE() << "it was written";
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("another process uses it"), std::string::npos);
    }
  }
  EXPECT_GT(before, batch);
  ::close(stop[1]);
  int status = 0;
  EXPECT_EQ(waitpid(writer, &status, 0), writer);
  EXPECT_EQ(status, 0);
  ::close(ready[0]);
  ::close(ready[1]);
  CacheFile(path, inputs, fingerprint);  // and nothing is left behind that disturbs a run
}

TEST_F(CacheFileTest, NamesThatAreSpecialToSqliteAreFiles) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(directory.path());
  for (const char* name : {":memory:", "file:a?mode=memory"}) {
    path = name;
    make();
    EXPECT_TRUE(std::filesystem::exists(directory.path() / name)) << name;
  }
  std::filesystem::current_path(before);
}

// A limit on the size of files stands for a full disk.
TEST_F(CacheFileTest, AFullDiskIsOneClearLine) {
  const int result = run_in_child([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100'000, 100'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    Random random(1);
    const Mealy machine = random_mealy({.states = 5, .inputs = 2, .outputs = 2}, random);
    MealyOracle system(machine);
    try {
      CacheFile file(path, machine.inputs(), fingerprint);
      Cache cache(system, file);
      Word word(1000);
      for (int i = 0; i < 1000; ++i) {
        for (Symbol& input : word) input = static_cast<Symbol>(random.below(2));
        cache.ask(word);
      }
      return 1;
    } catch (const Error& error) {
      if (error.status() != ExitStatus::inconclusive) return 4;
      return std::string(error.what()).find("cannot write the cache") != std::string::npos ? 0 : 2;
    } catch (...) {
      return 3;
    }
  });
  EXPECT_EQ(result, 0);
}

TEST_F(CacheFileTest, ACacheStartsWithItsWordsAndNumbersThemAnew) {
  Random random(3);
  const Mealy machine = random_mealy({.states = 9, .inputs = 2, .outputs = 4}, random);
  std::vector<Query> words;
  for (int i = 0; i < 200; ++i) {
    Word word(random.below(8));
    for (Symbol& input : word) input = static_cast<Symbol>(random.below(2));
    words.emplace_back(word);
  }
  {
    MealyOracle system(machine);
    CacheFile file(path, machine.inputs(), fingerprint);
    Cache cache(system, file);
    cache.ask(words);
  }
  ScriptedOracle system(machine.inputs(), {});  // fails if asked: it has no script
  CacheFile file(path, machine.inputs(), fingerprint);
  Cache cache(system, file);
  EXPECT_EQ(cache.outputs().size(), 0U);
  const auto answers = cache.ask(words);
  for (std::size_t i = 0; i < words.size(); ++i) {
    EXPECT_EQ(to_string(answers[i].outputs, cache.outputs()),
              to_string(machine.output_word(std::get<Word>(words[i])), machine.outputs()));
  }
  // A tree with a branch for an output that only the file has named so far.
  DecisionTree tree;
  const Word first{0};
  const Symbol output = cache.ask(first).front();
  tree.nodes = {{0, {{output, 1}}}, {1, {}}};
  const Query query = tree;
  EXPECT_EQ(cache.ask(std::span(&query, 1)).front().inputs, (Word{0, 1}));
}

}  // namespace
}  // namespace maide
