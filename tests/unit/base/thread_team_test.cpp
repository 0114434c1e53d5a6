// All members work at once, one piece of work after another; an exception of any comes out.
#include "maide/base/thread_team.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace maide {
namespace {

TEST(ThreadTeam, EachMemberDoesEachPieceOnce) {
  for (const unsigned size : {1U, 2U, 5U}) {
    ThreadTeam team(size);
    ASSERT_EQ(team.size(), size);
    std::vector<int> done(size);  // not atomic: what one piece wrote the next one sees
    for (int piece = 0; piece < 1000; ++piece) {
      team.run([&](unsigned member) {
        EXPECT_EQ(done[member], piece);
        ++done[member];
      });
      for (const int count : done) EXPECT_EQ(count, piece + 1);
    }
  }
}

TEST(ThreadTeam, MembersWorkAtTheSameTime) {
  ThreadTeam team(3);
  std::atomic<unsigned> there = 0;
  team.run([&](unsigned) {  // returns only if all are in it
    there.fetch_add(1);
    there.notify_all();
    for (unsigned seen = there.load(); seen < 3; seen = there.load()) there.wait(seen);
  });
  EXPECT_EQ(there.load(), 3U);
}

TEST(ThreadTeam, AnExceptionOfTheFirstMemberThatThrewComesOut) {
  ThreadTeam team(4);
  for (int piece = 0; piece < 10; ++piece) {
    try {
      team.run([](unsigned member) {
        if (member >= 2) throw std::runtime_error(std::to_string(member));
      });
      FAIL() << "nothing came out";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "2");
    }
    std::atomic<int> sum = 0;
    team.run([&](unsigned member) { sum += static_cast<int>(member); });
    EXPECT_EQ(sum, 6);
  }
}

TEST(ThreadTeam, NoThreadIsStartedForNoWork) {
  const ThreadTeam team(1000);
  EXPECT_EQ(team.size(), 1000U);
  EXPECT_GE(processor_count(), 1U);
}

}  // namespace
}  // namespace maide
