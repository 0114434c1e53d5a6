// What the kernel shows is tried: on this machine, and where a filter as of a container takes a
// system call away.
#include "maide/wire/observe/kernel_support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

namespace maide {
namespace {

KernelFeature feature(std::string_view name) {
  const std::vector<KernelFeature> all = examine_kernel();
  const auto found = std::ranges::find(all, name, &KernelFeature::name);
  if (found == all.end()) std::abort();
  return *found;
}

// From now on this process may not make that call.
void forbid(unsigned call) {
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const sock_fprog filter{std::size(program), program};
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) != 0) {
    std::abort();
  }
}

TEST(KernelSupport, EverythingHasANameAPurposeAndAnAnswer) {
  for (const KernelFeature& each : examine_kernel()) {
    EXPECT_NE(each.name, "");
    EXPECT_NE(each.purpose, "");
    EXPECT_NE(each.without, "");
    EXPECT_NE(each.detail, "") << each.name;
  }
}

// All other tests of this folder need it.
TEST(KernelSupport, RunCountsAreShownHere) { EXPECT_TRUE(feature("schedstat").is_usable); }

TEST(KernelSupport, AForbiddenCallIsNoticed) {
  for (const unsigned call : {unsigned{SYS_pidfd_open}, unsigned{SYS_pidfd_getfd}}) {
    EXPECT_EXIT(
        {
          forbid(call);
          const KernelFeature pidfd = feature("pidfd");
          std::fputs(pidfd.detail.c_str(), stderr);
          std::_Exit(pidfd.is_usable ? 1 : 0);
        },
        testing::ExitedWithCode(0), "not permitted");
  }
}

}  // namespace
}  // namespace maide
