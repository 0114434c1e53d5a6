// docs/reference/learning.md is made from the tables that the program reads: learners, equivalence
// methods, options of tests. After a change of one of them:
//   MAIDE_APPROVE=1 build/dev/bin/test_reference_page    and look at what git says.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/tree/schema.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/learn/learner.hpp"

namespace maide {
namespace {

std::string code(std::string_view text) { return "`" + std::string(text) + "`"; }

// A table's cell: a bar would end it.
std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

std::string codes(std::string_view words) {
  if (words.empty()) return "none";
  std::vector<std::string> list;
  for (const std::string_view word : split(words, ' ')) list.push_back(code(word));
  return join(list);
}

std::string make_page() {
  std::string page =
      "# Learners, equivalence methods and their options\n\n"
      "This page is made from the tables that the program reads; a test compares. `maide learn` "
      "and\n"
      "`maide bench` take each option as `--KEY VALUE`. A method in `--eq` takes it behind a "
      "colon\n"
      "(`--eq w:extra-states=1,random-hads:max-tests=5000`). A system file takes it under "
      "`learning:`.\n"
      "An option that neither the learner nor a method looks at is refused.\n\n"
      "## Learners (`--algorithm`)\n\n| name | what it is |\n|---|---|\n";
  for (const LearnerEntry& learner : learners()) {
    page += "| " + code(learner.name) + " | " + cell(learner.description) + " |\n";
  }
  page +=
      "\n`nstar` has tests of its own, with the options " + codes(learners().back().test_options) +
      ".\n\n## Equivalence methods (`--eq`)\n\n| name | what it tests | options |\n|---|---|---|\n";
  for (const TestMethodEntry& method : test_methods()) {
    page += "| " + code(method.name) + " | " + cell(method.description) + " | " +
            codes(method.options) + " |\n";
  }
  page += "\n## Options of tests\n\n| option | value | meaning |\n|---|---|---|\n";
  for (const TestOption& option : test_options()) {
    page += "| " + code(option.key) + " | " + std::string(option.value) + " | " +
            cell(option.help) + (option.is_of_run ? " (whatever the method)" : "") + " |\n";
  }
  return page;
}

std::string make_key_page() {
  std::string page =
      "# The keys of a system file\n\n"
      "This page is made from the table with which the program reads a system file; a test "
      "compares.\n"
      "[systems.md](../systems.md) says what they mean. `NAME` is a name that the file gives.\n";
  for (const Key& key : system_keys()) {
    if (key.kind != FieldKind::map) continue;
    std::string title = key.path.empty() ? "The file" : "";
    for (const std::string_view part : split(key.path, '/')) {
      if (part.empty()) continue;
      title += (title.empty() ? "" : ": ") + (part == "*" ? "`NAME`" : code(part));
    }
    page += "\n## " + title + "\n\n" + write_key_table(key.path);
  }
  return page;
}

void expect_page(const std::string& name, const std::string& page) {
  const std::filesystem::path file =
      std::filesystem::path(MAIDE_SOURCE_DIR) / "docs/reference" / name;
  if (std::getenv("MAIDE_APPROVE") != nullptr) {
    std::filesystem::create_directories(file.parent_path());
    write_file_atomically(file, page);
  }
  EXPECT_EQ(read_file(file), page) << "if that is meant: run this once with MAIDE_APPROVE=1";
}

TEST(ReferencePage, SaysWhatTheTablesSay) {
  expect_page("learning.md", make_page());
  expect_page("system-file.md", make_key_page());
}

// Every option is looked at by some method, and methods look at no option that there is not.
TEST(ReferencePage, MethodsAndOptionsFitTogether) {
  for (const TestOption& option : test_options()) {
    EXPECT_NE(methods_with(option.key), "") << option.key;
  }
  for (const TestMethodEntry& method : test_methods()) {
    if (method.options.empty()) continue;
    for (const std::string_view key : split(method.options, ' ')) {
      EXPECT_EQ(find_test_option(key).key, key) << method.name;
    }
  }
}

}  // namespace
}  // namespace maide
