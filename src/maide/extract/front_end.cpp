#include "maide/extract/front_end.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/base/text.hpp"
#include "maide/extract/cppcheck_dump.hpp"
#include "maide/extract/lexer.hpp"
#include "maide/extract/read_dump.hpp"

namespace maide::extract {
namespace {

namespace fs = std::filesystem;

// Versions whose dumps tests/extract compares with what is expected of them.
const std::set<std::string> known_versions{"2.10"};

void check_version(const RunControl& control) {
  const SubprocessResult result = run_program({"cppcheck", "--version"}, {}, control);
  const std::string line = result.out.substr(0, result.out.find('\n'));
  const std::string version = line.substr(line.rfind(' ') + 1);
  if (!result.succeeded() || !known_versions.contains(version)) {
    throw UsageError("cppcheck " + version + " is of no version whose dumps are known (2.10 of " +
                     "Debian 12 is)");
  }
}

std::vector<std::string> words_of(const std::string& directive) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : directive + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
      word += c;
    } else if (!word.empty()) {
      words.push_back(std::move(word));
      word.clear();
    }
  }
  return words;
}

// Whether the first condition is the guard of a header: `#ifndef NAME`, `#define NAME`, and an
// `#endif` behind everything, with no other side.
bool has_guard(const LexedFile& lexed) {
  auto directives = lexed.directives;
  while (!directives.empty() && directives[0].second.find("pragma") < 5) {
    directives.erase(directives.begin());
  }
  if (directives.size() < 3) return false;
  const auto first = words_of(directives[0].second), second = words_of(directives[1].second);
  if (first.size() != 2 || first[0] != "ifndef" || second.size() < 2 || second[0] != "define" ||
      second[1] != first[1]) {
    return false;
  }
  int depth = 0;
  for (std::size_t i = 0; i < directives.size(); ++i) {
    const auto words = words_of(directives[i].second);
    const std::string word = words.empty() ? "" : words[0];
    if (word.starts_with("if")) ++depth;
    if (depth == 1 && word.starts_with("el")) return false;
    if (word == "endif" && --depth == 0) {
      const bool is_last = i + 1 == directives.size();
      return is_last &&
             (lexed.code_lines.empty() || (*lexed.code_lines.begin() > directives[0].first &&
                                           *lexed.code_lines.rbegin() < directives[i].first));
    }
  }
  return false;
}

// Lines of conditionals that have code in them.
std::set<int> lines_of_conditions(const LexedFile& lexed) {
  std::set<int> found;
  std::vector<int> open;
  auto code = lexed.code_lines.begin();
  const auto pass = [&](int line) {
    for (; code != lexed.code_lines.end() && *code < line; ++code) {
      if (!open.empty() && open.back() > 0) found.insert(open.back());
    }
  };
  bool is_guarded = has_guard(lexed);
  for (std::size_t i = 0; i < lexed.directives.size(); ++i) {
    const auto& [line, directive] = lexed.directives[i];
    pass(line);
    const auto words = words_of(directive);
    const std::string word = words.empty() ? "" : words[0];
    if (word.starts_with("if")) open.push_back(std::exchange(is_guarded, false) ? 0 : line);
    if (word.starts_with("el") && !open.empty()) open.back() = line;
    if (word == "endif" && !open.empty()) open.pop_back();
  }
  return found;
}

// Where the package of a file (it has a package.xml) keeps its headers.
std::vector<fs::path> folders_of_package(const fs::path& file) {
  std::error_code error;
  for (fs::path folder = fs::absolute(file).parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    if (!fs::exists(folder / "package.xml", error)) continue;
    std::vector<fs::path> found;
    for (const char* name : {"include", "src"}) {
      if (fs::is_directory(folder / name, error)) found.push_back(folder / name);
    }
    return found;
  }
  return {};
}

class FrontEnd {
 public:
  FrontEnd(const FrontEndOptions& options, const RunControl& control)
      : options_(options), control_(control) {}

  void read(const fs::path& file, Sources& sources) {
    const std::string text = read_file(file.string());
    sources.texts[file.string()] = text;
    const fs::path copy = folder_.path() / file.filename();
    write_file_atomically(copy.string(), prepare_cpp(text, sources.components));
    // Without the package's headers where these cannot be read: what they have is not known then.
    if (read_copy(file, copy, folders_of_package(file), sources)) return;
    read_copy(file, copy, {}, sources);
  }

  // Every call of the text is in some dump.
  void compare(Sources& sources) {
    for (const auto& [file, text] : sources.texts) {
      const LexedFile lexed = lex_cpp(text, file);
      sources.namespaces.insert(lexed.namespaces.begin(), lexed.namespaces.end());
      for (const int line : lines_of_conditions(lexed)) {
        sources.faults.emplace_back(Place{file, line},
                                    "code under a condition of the preprocessor");
      }
      std::set<std::string> macros(lexed.macros.begin(), lexed.macros.end());
      macros.insert(lexed.aliases.begin(), lexed.aliases.end());
      macros.insert(options_.macro_names.begin(), options_.macro_names.end());
      std::map<Mention, int> counts;
      for (const Mention& call : lexed.calls) {
        if (!macros.contains(std::get<2>(call)) &&
            std::get<2>(call) != "RCLCPP_COMPONENTS_REGISTER_NODE") {
          ++counts[call];
        }
      }
      for (const auto& [call, count] : counts) {
        const auto found = sources.mentions.find(call);
        if (found != sources.mentions.end() && found->second >= count) continue;
        sources.faults.emplace_back(Place{file, std::get<1>(call)},
                                    "'" + std::get<2>(call) + "' is in no tree of the front end");
      }
    }
  }

 private:
  bool read_copy(const fs::path& file, const fs::path& copy, const std::vector<fs::path>& folders,
                 Sources& sources) {
    const fs::path macros = folder_.path() / "macros.h";
    write_file_atomically(macros.string(), options_.macro_definitions);
    std::vector<std::string> command{"cppcheck",
                                     "--dump",
                                     "--quiet",
                                     "--force",
                                     "--std=c++17",
                                     "--language=c++",
                                     "--include=" + macros.string(),
                                     "-I" + fs::absolute(file).parent_path().string()};
    for (const std::string& include : options_.include_folders) command.push_back("-I" + include);
    for (const fs::path& include : folders) command.push_back("-I" + include.string());
    command.push_back(copy.string());
    const SubprocessResult result = run_program(command, {}, control_);
    note_messages(result.err, file, sources);
    const fs::path dump = copy.string() + ".dump";
    try {
      if (result.succeeded() && fs::exists(dump)) {
        take(read_cppcheck_dump(read_file(dump.string()), file.string()), copy, file, sources);
        fs::remove(dump);
        return true;
      }
    } catch (const ParseError&) {  // it breaks off where the front end gave up
    }
    sources.faults.emplace_back(Place{file.string(), 1}, "the front end refuses this file");
    return false;
  }

  void note_messages(const std::string& messages, const fs::path& file, Sources& sources) {
    for (const std::string_view line : split_lines(messages)) {
      // What a style checker complains of says nothing about how it was read.
      for (const std::string_view fault :
           {"[syntaxError]", "[unknownMacro]", "[internalError]", "[internalAstError]",
            "[preprocessorErrorDirective]", "[cppcheckError]"}) {
        if (!line.ends_with(fault)) continue;
        sources.faults.emplace_back(Place{file.string(), 1},
                                    "the front end says: " + one_line(line));
      }
    }
  }

  void take(Dump dump, const fs::path& copy, const fs::path& file, Sources& sources) {
    for (DumpConfiguration& configuration : dump.configurations) {
      for (DumpToken& token : configuration.tokens) {
        if (token.file == copy.string()) token.file = file.string();
        note_text(token.file, sources);
      }
      read_configuration(configuration, sources);
    }
  }

  void note_text(const std::string& file, Sources& sources) {
    if (sources.texts.contains(file)) return;
    std::error_code missing;
    sources.texts[file] = fs::exists(file, missing) ? read_file(file) : "";
  }

  const FrontEndOptions& options_;
  const RunControl& control_;
  TempDir folder_;
};

}  // namespace

std::vector<fs::path> find_sources(const std::vector<std::string>& arguments) {
  static const std::set<std::string> endings{".cpp", ".cc", ".cxx", ".C"};
  std::vector<fs::path> files;
  for (const std::string& argument : arguments) {
    if (fs::is_directory(argument)) {
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(argument)) {
        if (entry.is_regular_file() && endings.contains(entry.path().extension().string())) {
          files.push_back(entry.path());
        }
      }
    } else if (fs::is_regular_file(argument)) {
      files.emplace_back(argument);
    } else {
      throw UsageError("there is no such file or folder (" + argument + ")");
    }
  }
  std::ranges::sort(files);
  files.erase(std::unique(files.begin(), files.end()), files.end());
  if (files.empty()) throw UsageError("there is no C++ source (" + join(arguments) + ")");
  return files;
}

Sources read_sources(const std::vector<fs::path>& files, const FrontEndOptions& options,
                     const RunControl& control) {
  check_version(control);
  Sources sources;
  FrontEnd front_end(options, control);
  std::size_t done = 0;
  for (const fs::path& file : files) {
    if (options.progress) options.progress(done++, files.size(), file.string());
    front_end.read(file, sources);
  }
  front_end.compare(sources);
  return sources;
}

}  // namespace maide::extract
