// Texts that are held against approved files.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <string>

#include "maide/base/file.hpp"

namespace maide::test {

inline const std::string source_root = MAIDE_SOURCE_DIR;

// The text, without where the tree lies, is that of approved/NAME.approved. With MAIDE_APPROVE it
// is written there before.
inline void expect_approved(const std::string& name, std::string text) {
  for (std::size_t at; (at = text.find(source_root + "/")) != std::string::npos;) {
    text.erase(at, source_root.size() + 1);
  }
  const std::string path = source_root + "/tests/golden/approved/" + name + ".approved";
  if (std::getenv("MAIDE_APPROVE") != nullptr) write_file_atomically(path, text);
  EXPECT_EQ(text, read_file(path)) << path;
}

}  // namespace maide::test
