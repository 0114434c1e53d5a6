// maide under the real mpirun: what it finds, says and exits with, and what becomes of the others
// if one of its processes dies.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "check_systems.hpp"
#include "maide/base/file.hpp"
#include "maide/base/random.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/experiment/open_system.hpp"
#include "processes.hpp"
#include "run_maide.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class Mpirun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    // As root, with more ranks than processors, and by nothing but this machine's memory.
    for (const char* setting : {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM",
                                "OMPI_MCA_rmaps_base_oversubscribe"}) {
      ::setenv(setting, "1", 1);
    }
    ::setenv("OMPI_MCA_btl", "self,vader", 1);
    ::setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 1);
    ::setenv("OMPI_MCA_oob_tcp_if_include", "lo", 1);
    ::setenv("OMPI_MCA_plm_rsh_agent", "", 1);
  }
  void SetUp() override {
    if (!find_on_path("mpirun") ||
        !fs::exists(fs::path(MAIDE_PROGRAM).parent_path() / "maide-mpi.so")) {
      GTEST_SKIP() << "skipped: no MPI";
    }
  }

  static std::vector<std::string> command(int ranks, const std::vector<std::string>& rest) {
    std::vector<std::string> all{"mpirun", "-n", std::to_string(ranks)};
    all.insert(all.end(), rest.begin(), rest.end());
    return all;
  }
  static SubprocessResult run(int ranks, const std::vector<std::string>& rest) {
    SubprocessOptions options;
    options.time_limit = std::chrono::minutes(4);
    SubprocessResult result = run_program(command(ranks, rest), options);
    EXPECT_FALSE(result.timed_out);
    return result;
  }
  static fs::path write(const bench::SystemText& system) {
    return bench::write_system(system, fs::path(testing::TempDir()) / ("mpi-" + system.name));
  }
};

TEST_F(Mpirun, FiftyRandomSystemsAreSearchedAsByOneProcess) {
  const SubprocessResult result = run(3, {MAIDE_MPI_SYSTEMS, "71", "50"});
  EXPECT_EQ(result.exit_status, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("50 systems agree on 3 ranks"));
  EXPECT_THAT(result.out, Not(HasSubstr(" 0 violated")));
}

TEST_F(Mpirun, TheFirstRankSaysWhatOneProcessSays) {
  const std::string file = write(bench::philosophers(6)).string();
  const auto alone = test::run_maide({"check", file, "--property", "deadlock", "--json"});
  const SubprocessResult result =
      run(2, {MAIDE_PROGRAM, "check", file, "--property", "deadlock", "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  const Json one = test::json_of(alone), both = test::json_of(result);
  EXPECT_EQ(both["verdict"], one["verdict"]);
  EXPECT_EQ(both["properties"][0]["states"], one["properties"][0]["states"]);
  EXPECT_EQ(both["properties"][0]["transitions"], one["properties"][0]["transitions"]);
  EXPECT_THAT(result.err, HasSubstr("2 ranks search together"));
}

TEST_F(Mpirun, ACounterexampleIsReadAcrossRanks) {
  const std::string file = MAIDE_SOURCE_DIR "/examples/architectures/cell.yaml";
  const auto alone = test::run_maide({"check", file, "--property", "deadlock", "--json"});
  const SubprocessResult result =
      run(3, {MAIDE_PROGRAM, "check", file, "--property", "deadlock", "--json"});
  EXPECT_EQ(alone.exit_status, 1);
  EXPECT_EQ(result.exit_status, 1);
  const Json both = test::json_of(result);
  EXPECT_EQ(both["properties"][0]["trace"].size(),
            test::json_of(alone)["properties"][0]["trace"].size());
}

TEST_F(Mpirun, AWrongLineIsSaidOnce) {
  const SubprocessResult result = run(3, {MAIDE_PROGRAM, "check", "--nonsense"});
  EXPECT_EQ(result.exit_status, 2);
  const auto first = result.err.find("unknown option '--nonsense'");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(result.err.find("unknown option", first + 1), std::string::npos);
  const SubprocessResult engine = run(2, {MAIDE_PROGRAM, "check", "none.yaml", "--engine", "spin"});
  EXPECT_EQ(engine.exit_status, 2);
  EXPECT_THAT(engine.err, HasSubstr("mpirun is for the engine native, not for spin"));
}

// Neither hangs the others nor looks like a verdict.
TEST_F(Mpirun, ADeadRankEndsAll) {
  const std::string file = write(bench::philosophers(16)).string();
  for (const std::size_t victim : {std::size_t{0}, std::size_t{2}}) {
    const test::ProcessMark mark;
    const fs::path out = fs::path(testing::TempDir()) / "mpi-killed.txt";
    const int output = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ASSERT_GE(output, 0);
    const std::vector<std::string> line =
        command(3, {MAIDE_PROGRAM, "check", file, "--property", "deadlock"});
    const pid_t mpirun = start_program({line, {0, output, output}, {}, {}});
    std::vector<pid_t> ranks;
    for (int look = 0; look < 300 && ranks.size() < 3; ++look) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      ranks = test::children_of(mpirun, "maide");
    }
    ASSERT_EQ(ranks.size(), 3U);
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    ::kill(ranks[victim], SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(mpirun, &status, 0), mpirun);
    ::close(output);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 128 + SIGKILL);
    const std::string said = read_file(out);
    EXPECT_THAT(said, HasSubstr("signal 9"));
    EXPECT_THAT(said, Not(HasSubstr("verdict")));
    EXPECT_TRUE(mark.find().empty());
  }
}

// kill -9 of a rank at random moments, each run with another number of them, until one comes to its
// end.
TEST_F(Mpirun, AKilledSearchGoesOn) {
  const std::string file = write(bench::philosophers(13)).string();
  const fs::path folder = fs::path(testing::TempDir()) / "mpi-checkpoints";
  fs::remove_all(folder);
  Random random(5);
  int kills = 0;
  SubprocessResult last;
  for (int run = 0; run < 40; ++run) {
    const fs::path out = fs::path(testing::TempDir()) / "mpi-resumed.txt";
    const int output = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ASSERT_GE(output, 0);
    const std::vector<std::string> line =
        command(1 + run % 3, {MAIDE_PROGRAM, "check", file, "--property", "deadlock", "--json",
                              "--checkpoint", folder.string(), "--checkpoint-interval", "0"});
    const pid_t mpirun = start_program({line, {0, output, output}, {}, {}});
    ::close(output);
    int status = 0;
    if (run < 6) {
      std::this_thread::sleep_for(std::chrono::milliseconds(300 + random.below(600)));
      const std::vector<pid_t> ranks = test::children_of(mpirun, "maide");
      if (!ranks.empty() && ::kill(ranks[random.below(ranks.size())], SIGKILL) == 0) ++kills;
    }
    ASSERT_EQ(::waitpid(mpirun, &status, 0), mpirun);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) continue;
    last.out = read_file(out);
    break;
  }
  EXPECT_GE(kills, 2);
  const auto begin = last.out.find("{\"schema\"");
  ASSERT_NE(begin, std::string::npos) << last.out;
  const Json resumed = Json::parse(last.out.substr(begin, last.out.find('\n', begin) - begin));
  const Json alone =
      test::json_of(test::run_maide({"check", file, "--property", "deadlock", "--json"}));
  EXPECT_EQ(resumed["properties"][0]["states"], alone["properties"][0]["states"]);
  EXPECT_EQ(resumed["properties"][0]["transitions"], alone["properties"][0]["transitions"]);
}

// One line for all, and no hang.
TEST_F(Mpirun, AFailureOfTheSearchEndsAll) {
  const std::string file = write(bench::philosophers(6)).string();
  const SubprocessResult result = run(3, {MAIDE_PROGRAM, "check", file, "--property", "deadlock",
                                          "--checkpoint", "/proc/no/such/folder"});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("cannot make the folder for checkpoints"));
}

// A rank without the module says what is missing, instead of searching alone.
TEST(WithoutMpi, ARankSaysWhatIsMissing) {
  const fs::path folder = fs::path(testing::TempDir()) / "maide-alone";
  fs::create_directories(folder);
  fs::copy_file(MAIDE_PROGRAM, folder / "maide", fs::copy_options::overwrite_existing);
  ::setenv("PMI_RANK", "0", 1);
  const SubprocessResult result = run_program({(folder / "maide").string(), "check", "none.yaml"});
  ::unsetenv("PMI_RANK");
  test::expect_error(result, 2, "this is a rank of mpirun (PMI_RANK is set)");
}

}  // namespace
}  // namespace maide
