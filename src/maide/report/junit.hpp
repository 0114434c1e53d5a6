// JUnit XML, which continuous integration servers read: one suite of cases, each passed, failed,
// in error or skipped, with properties of the suite. The form is that of Ant's JUnit task, as
// Jenkins, GitLab and GitHub's actions take it.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace maide {

struct JUnitCase {
  std::string name;     // unique in its suite
  std::string failure;  // one line; "": not failed
  std::string details;  // of the failure; may have several lines
  std::string skipped;  // why it was not tried; "": it was
  std::string error{};  // why it could not be judged; "": it could
  std::optional<double> seconds{};
};

struct JUnitSuite {
  std::string name;  // of the suite, and the class of its cases
  std::vector<std::pair<std::string, std::string>> properties;
  std::vector<JUnitCase> cases;
  std::string error;   // why the suite did not come to its end; "": it did
  double seconds = 0;  // of the whole suite
};

// Text for an attribute or an element: escaped, and what XML 1.0 does not allow (control
// characters, U+FFFE and U+FFFF, bytes that are not UTF-8) is U+FFFD. Line breaks and tabs are
// character references, because an attribute would lose them.
std::string escape_xml(std::string_view text);

// An error of the suite is a case of its own, "(the whole suite)", so that no server takes a part
// for the whole. O(size).
void write_junit(std::ostream& out, const JUnitSuite& suite);

}  // namespace maide
