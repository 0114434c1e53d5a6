#include "maide/report/junit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <ostream>

#include "maide/base/text.hpp"

namespace maide {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";  // U+FFFD

void append_escaped(std::string& text, std::string_view character, std::optional<char32_t> code) {
  if (!code) {
    text += replacement;
    return;
  }
  switch (*code) {
    case U'&': text += "&amp;"; return;
    case U'<': text += "&lt;"; return;
    case U'>': text += "&gt;"; return;
    case U'"': text += "&quot;"; return;
    case U'\'': text += "&apos;"; return;
    case U'\t': text += "&#9;"; return;
    case U'\n': text += "&#10;"; return;
    case U'\r': text += "&#13;"; return;
    default: break;
  }
  const bool is_allowed = !is_control(*code) && *code != U'\uFFFE' && *code != U'\uFFFF';
  text += is_allowed ? character : replacement;
}

void write_case(std::ostream& out, const JUnitCase& one, std::string_view suite) {
  out << fmt::format("    <testcase classname=\"{}\" name=\"{}\"", suite, escape_xml(one.name));
  if (one.seconds) out << fmt::format(" time=\"{:.3f}\"", *one.seconds);
  if (!one.failure.empty()) {
    out << fmt::format(">\n      <failure message=\"{}\">{}</failure>\n    </testcase>\n",
                       escape_xml(one.failure), escape_xml(one.details));
  } else if (!one.error.empty()) {
    out << fmt::format(">\n      <error message=\"{}\"/>\n    </testcase>\n",
                       escape_xml(one.error));
  } else if (!one.skipped.empty()) {
    out << fmt::format(">\n      <skipped message=\"{}\"/>\n    </testcase>\n",
                       escape_xml(one.skipped));
  } else {
    out << "/>\n";
  }
}

}  // namespace

std::string escape_xml(std::string_view text) {
  std::string escaped;
  while (!text.empty()) {
    const std::string_view before = text;
    const std::optional<char32_t> code = take_character(text);
    append_escaped(escaped, before.substr(0, before.size() - text.size()), code);
  }
  return escaped;
}

void write_junit(std::ostream& out, const JUnitSuite& suite) {
  const auto count = [&](const std::string JUnitCase::*member) {
    return std::ranges::count_if(suite.cases,
                                 [&](const JUnitCase& one) { return !(one.*member).empty(); });
  };
  const std::size_t whole = suite.error.empty() ? 0 : 1;
  const std::string name = escape_xml(suite.name);
  const std::string counts =
      fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{:.3f}\"",
                  suite.cases.size() + whole, count(&JUnitCase::failure),
                  whole + static_cast<std::size_t>(count(&JUnitCase::error)),
                  count(&JUnitCase::skipped), suite.seconds);
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  out << fmt::format("<testsuites {}>\n  <testsuite name=\"{}\" {}>\n", counts, name, counts);
  out << "    <properties>\n";
  for (const auto& [key, value] : suite.properties) {
    out << fmt::format("      <property name=\"{}\" value=\"{}\"/>\n", escape_xml(key),
                       escape_xml(value));
  }
  out << "    </properties>\n";
  for (const JUnitCase& one : suite.cases) write_case(out, one, name);
  if (whole != 0) {
    out << fmt::format(
        "    <testcase classname=\"{}\" name=\"(the whole suite)\">\n      <error "
        "message=\"{}\"/>\n    </testcase>\n",
        name, escape_xml(suite.error));
  }
  out << "  </testsuite>\n</testsuites>\n";
}

}  // namespace maide
