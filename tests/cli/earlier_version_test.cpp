// Files that version 0.1.0 wrote (tests/models/version-0.1) are read, and are of the system that
// they were of: a model, the model that it kept for a system file, and a cache, here as SQL.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <string>

#include "maide/automata/interface_automaton.hpp"
#include "maide/base/file.hpp"
#include "maide/formats/model_file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string folder_of_0_1 = MAIDE_SOURCE_DIR "/tests/models/version-0.1/";
const std::string model_of_0_1 = folder_of_0_1 + "strict-2.dot";

// Two programs at the connection that the files are of.
std::string system_with(const std::string& model) {
  return "models:\n  via: {" + model +
         "}\n"
         "programs:\n"
         "  planner: \"repeat 2 { via.write; }\"\n"
         "  controller: \"repeat 2 { via.read -> message; }\"\n";
}

TEST(EarlierVersion, AModelIsReadAndItsStrengthUnknown) {
  EXPECT_EQ(read_interface_automaton(model_of_0_1).origin.at("versions"), "port 1");
  const SubprocessResult compared =
      run_maide({"compare", model_of_0_1, MAIDE_SOURCE_DIR "/tests/models/strict-2.dot"});
  EXPECT_EQ(compared.exit_status, 0) << compared.out << compared.err;

  const TempDir folder;
  const std::string system = (folder.path() / "system.yaml").string();
  write_file_atomically(system, system_with("file: " + model_of_0_1));
  const SubprocessResult checked = run_maide({"check", system});
  EXPECT_EQ(checked.exit_status, 0) << checked.out << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("strength"));
}

TEST(EarlierVersion, AKeptModelIsNotLearnedAgain) {
  const TempDir folder;
  const std::string system = (folder.path() / "system.yaml").string();
  write_file_atomically(
      system, system_with("learn: port, with: {kind: strict, size: 2}, learning: {algorithm: rs, "
                          "eq: w, extra-states: 1}"));
  // The name that 0.1.0 gave it.
  const fs::path kept =
      folder.path() / "maide-models" /
      "port_kind=strict_size=2__learning_algorithm=rs_eq=w_extra-states=1_-57c0e16469e64b69.dot";
  fs::create_directory(kept.parent_path());
  fs::copy_file(model_of_0_1, kept);
  const SubprocessResult checked = run_maide({"check", system});
  EXPECT_EQ(checked.exit_status, 0) << checked.out << checked.err;
  EXPECT_THAT(checked.err, HasSubstr("via: learned before ("));
}

TEST(EarlierVersion, ACacheAnswersWhatItAnsweredThen) {
  const TempDir folder;
  const std::string cache = (folder.path() / "strict-2.cache").string();
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(cache.c_str(), &database), SQLITE_OK);
  const std::string sql = read_file(folder_of_0_1 + "strict-2.cache.sql");
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);

  const SubprocessResult learned = run_maide(
      {"learn", "port", "kind=strict", "size=2", "--algorithm", "rs", "--eq", "w:extra-states=1",
       "--confirm", "no", "--cache", cache, "--json", "-o", (folder.path() / "new.dot").string()});
  EXPECT_EQ(learned.exit_status, 0) << learned.err;
  EXPECT_EQ(json_of(learned).at("experiments"), 0);
  EXPECT_EQ(run_maide({"compare", model_of_0_1, (folder.path() / "new.dot").string()}).exit_status,
            0);
}

}  // namespace
}  // namespace maide::test
