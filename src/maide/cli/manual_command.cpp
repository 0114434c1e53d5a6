// `maide completion SHELL` and `maide manual [COMMAND]`: what shells and man need to know, made
// from the table of commands and their options.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/json.hpp"
#include "maide/base/text.hpp"
#include "maide/base/version.hpp"
#include "maide/cli/command.hpp"

namespace maide::cli {
namespace {

// ---- What there is to complete ----

std::string replace_each(std::string text,
                         const std::vector<std::pair<std::string, std::string>>& pairs) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const auto pair = std::ranges::find_if(
        pairs, [&](const auto& one) { return text.compare(at, one.first.size(), one.first) == 0; });
    if (pair == pairs.end()) {
      result += text[at++];
    } else {
      result += pair->second;
      at += pair->first.size();
    }
  }
  return result;
}

// "-o", "--output".
std::vector<std::string> spellings(const Argument& argument) {
  std::vector<std::string> names;
  for (const std::string& name : argument.short_names()) names.push_back("-" + name);
  for (const std::string& name : argument.long_names()) names.push_back("--" + name);
  return names;
}

// In single quotes: all shells read it as it is, but fish's backslash.
std::string quoted(const std::string& text) {
  return "'" + replace_each(text, {{"'", "'\\''"}}) + "'";
}

// What stands in the place of arguments: names that are known, beside files.
std::vector<std::string> offered_arguments(const CommandLine& line) {
  std::vector<std::string> names;
  for (const Argument& argument : line.all()) {
    if (!argument.is_positional()) continue;
    const std::vector<std::string> more = argument.choices();
    names.insert(names.end(), more.begin(), more.end());
  }
  return names;
}

std::vector<std::string> words_after_maide() {
  std::vector<std::string> words = names_of(command_table());
  words.insert(words.end(), {"help", "--help", "--version"});
  return words;
}

std::vector<std::string> words_after_help() {
  std::vector<std::string> words = names_of(command_table());
  const std::vector<std::string> pages = names_of(help_pages());
  words.insert(words.end(), pages.begin(), pages.end());
  return words;
}

// ---- bash ----

std::string bash_completion() {
  std::string values, options;
  for (const Command& command : command_table()) {
    const DeclaredCommand declared(command);
    std::vector<std::string> names;
    for (const Argument& argument : declared.line.all()) {
      if (argument.is_positional()) continue;
      const std::vector<std::string> ways = spellings(argument);
      names.insert(names.end(), ways.begin(), ways.end());
      if (!argument.takes_value()) continue;
      std::vector<std::string> patterns;
      for (const std::string& way : ways) {
        patterns.push_back(fmt::format("'{} {}'", command.name, way));
      }
      values += fmt::format("    {}) words={} ;;\n", join(patterns, "|"),
                            quoted(join(argument.choices(), " ")));
    }
    options +=
        fmt::format("    {})\n      options={}\n      arguments={} ;;\n", command.name,
                    quoted(join(names, " ")), quoted(join(offered_arguments(declared.line), " ")));
  }
  return fmt::format(R"bash(# Completion of maide for bash; made by `maide completion bash`.
# Where it offers nothing, bash offers files.
_maide() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} words= options= arguments=
  local command=${{COMP_WORDS[1]-}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}
  case $command in
{}    help) arguments={} ;;
  esac
  if [ "$COMP_CWORD" -eq 1 ]; then
    words={}
  else
    case "$command $previous" in
{}    *) if [ "${{current#-}}" != "$current" ]; then words=$options; else words=$arguments; fi ;;
    esac
  fi
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F _maide maide
)bash",
                     options, quoted(join(words_after_help(), " ")),
                     quoted(join(words_after_maide(), " ")), values);
}

// ---- zsh ----

// Behind an option or an argument: what it is, and what is offered.
std::string zsh_value(const std::string& name, const std::vector<std::string>& choices) {
  const std::string message = replace_each(name, {{":", "\\:"}});
  return ":" + message + ":" + (choices.empty() ? "_files" : "(" + join(choices, " ") + ")");
}

std::string zsh_completion() {
  std::string commands, cases;
  for (const Command& command : command_table()) {
    commands +=
        fmt::format("    {}\n", quoted(fmt::format("{}:{}", command.name, command.summary)));
    const DeclaredCommand declared(command);
    cases += fmt::format("    {})\n      _arguments -S", command.name);
    for (const Argument& argument : declared.line.all()) {
      if (argument.is_positional()) continue;
      const std::string help =
          replace_each(first_sentence(argument.help()),
                       {{"\\", "\\\\"}, {"[", "\\["}, {"]", "\\]"}, {":", "\\:"}});
      const std::string value =
          argument.takes_value() ? zsh_value(argument.value_name(), argument.choices()) : "";
      for (const std::string& way : spellings(argument)) {
        const std::string joined = way.starts_with("--") && argument.takes_value() ? "=" : "";
        cases += " \\\n        " + quoted("*" + way + joined + "[" + help + "]" + value);
      }
    }
    const std::vector<std::string> names = offered_arguments(declared.line);
    cases += " \\\n        '*: :_files'";
    if (!names.empty()) cases += " \\\n        " + quoted("1" + zsh_value("NAME", names));
    cases += " ;;\n";
  }
  return fmt::format(R"zsh(#compdef maide
# Completion of maide for zsh; made by `maide completion zsh`.
_maide() {{
  local -a commands
  commands=(
{}    'help:Tell more about a command or a topic'
  )
  if (( CURRENT == 2 )); then
    _describe -t commands command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{}    help) _arguments {} ;;
  esac
}}
if [ "$funcstack[1]" = _maide ]; then _maide "$@"; else compdef _maide maide; fi
)zsh",
                     commands, cases, quoted("1" + zsh_value("TOPIC", words_after_help())));
}

// ---- fish ----

std::string fish_quoted(const std::string& text) {
  return "'" + replace_each(text, {{"\\", "\\\\"}, {"'", "\\'"}}) + "'";
}

std::string fish_completion() {
  std::string text =
      "# Completion of maide for fish; made by `maide completion fish`.\n"
      "complete -c maide -n __fish_use_subcommand -f -l version -d 'Print the version'\n"
      "complete -c maide -n __fish_use_subcommand -f -a help -d 'Tell more about a topic'\n";
  for (const Command& command : command_table()) {
    text += fmt::format("complete -c maide -n __fish_use_subcommand -f -a {} -d {}\n", command.name,
                        fish_quoted(std::string(command.summary)));
    const DeclaredCommand declared(command);
    const std::string here =
        fmt::format("complete -c maide -n '__fish_seen_subcommand_from {}'", command.name);
    for (const Argument& argument : declared.line.all()) {
      if (argument.is_positional()) continue;
      text += here;
      for (const std::string& name : argument.short_names()) text += " -s " + name;
      for (const std::string& name : argument.long_names()) text += " -l " + name;
      const std::vector<std::string> choices = argument.choices();
      if (!argument.takes_value()) {
        text += " -f";
      } else if (choices.empty()) {
        text += " -r";
      } else {
        text += " -x -a " + fish_quoted(join(choices, " "));
      }
      text += " -d " + fish_quoted(first_sentence(argument.help())) + "\n";
    }
    const std::vector<std::string> names = offered_arguments(declared.line);
    if (!names.empty()) text += here + " -a " + fish_quoted(join(names, " ")) + "\n";
  }
  return text + "complete -c maide -n '__fish_seen_subcommand_from help' -f -a " +
         fish_quoted(join(words_after_help(), " ")) + "\n";
}

ExitStatus run_completion(const std::string& shell, Context& context) {
  const std::string text = shell == "bash"  ? bash_completion()
                           : shell == "zsh" ? zsh_completion()
                                            : fish_completion();
  context.print_data(text);
  context.set_result({{"shell", shell}, {"text", text}});
  return ExitStatus::ok;
}

// ---- Manual pages ----
//
// In man's macros, as groff and mandoc read them.

// Text within a line: no hyphen is broken at, and nothing is a command.
std::string roff(const std::string& text) {
  const std::string escaped = replace_each(text, {{"\\", "\\e"}, {"-", "\\-"}, {"'", "\\(aq"}});
  return escaped.starts_with(".") ? "\\&" + escaped : escaped;
}

std::string roff_lines(std::string_view text) {
  std::string result = ".nf\n";
  for (const std::string_view line : split_lines(text)) result += roff(std::string(line)) + "\n";
  return result + ".fi\n";
}

std::string page_head(const std::string& name, const std::string& summary) {
  return fmt::format(".TH {} 1 \"\" \"maide {}\" \"Maide\"\n.SH NAME\n{} \\- {}\n", roff(name),
                     version(), roff(name), roff(summary));
}

std::string page_of(const Command& command) {
  const DeclaredCommand declared(command);
  const std::string name = "maide-" + std::string(command.name);
  std::string text =
      page_head(name, std::string(command.summary)) +
      fmt::format(".SH SYNOPSIS\n.B maide {}\n[OPTIONS]", roff(std::string(command.name)));
  std::string arguments, options;
  for (const Argument& argument : declared.line.all()) {
    const std::string item =
        fmt::format(".TP\n.B {}\n{}\n", roff(argument.synopsis()), roff(argument.help()) + ".");
    if (!argument.is_positional()) {
      options += item;
      continue;
    }
    arguments += item;
    text += argument.is_required() ? " " + roff(argument.synopsis())
                                   : " [" + roff(argument.synopsis()) + "]";
  }
  text += "\n";
  if (!arguments.empty()) text += ".SH ARGUMENTS\n" + arguments;
  return text + ".SH OPTIONS\n" + options + ".SH EXAMPLES\n" + roff_lines(command.examples) +
         ".SH EXIT STATUS\n" + roff_lines(describe_exit_statuses()) +
         ".SH SEE ALSO\n.BR maide (1)\n";
}

std::string page_of_maide() {
  std::string text =
      page_head("maide", "learn models of robot middleware and check programs against them") +
      ".SH SYNOPSIS\n.B maide\nCOMMAND [OPTIONS] ...\n.SH COMMANDS\n";
  std::vector<std::string> pages;
  for (const Command& command : command_table()) {
    text += fmt::format(".TP\n.B {}\n{}.\n", roff(std::string(command.name)),
                        roff(std::string(command.summary)));
    pages.push_back(fmt::format(".BR maide\\-{} (1)", roff(std::string(command.name))));
  }
  text += ".SH TOPICS\n.B maide help\nTOPIC tells of these.\n";
  for (const HelpPage& page : help_pages()) {
    text += fmt::format(".TP\n.B {}\n{}.\n", roff(std::string(page.name)),
                        roff(std::string(page.summary)));
  }
  return text + ".SH EXIT STATUS\n" + roff_lines(describe_exit_statuses()) + ".SH SEE ALSO\n" +
         join(pages, ",\n") + "\n";
}

struct ManualArguments {
  std::string command;
  bool all = false;
  std::string folder;
};

ExitStatus run_manual(const ManualArguments& arguments, Context& context) {
  if (arguments.all == arguments.folder.empty()) {
    throw UsageError("--all and -o FOLDER go together");
  }
  if (!arguments.all) {
    const std::string text =
        arguments.command.empty()
            ? page_of_maide()
            : page_of(find_row(command_table(), "command", std::string_view(arguments.command)));
    context.print_data(text);
    context.set_result({{"text", text}});
    return ExitStatus::ok;
  }
  if (!arguments.command.empty()) throw UsageError("--all writes the pages of all commands");
  const std::filesystem::path folder = arguments.folder;
  std::vector<std::string> files{(folder / "maide.1").string()};
  write_file_atomically(files.front(), page_of_maide());
  for (const Command& command : command_table()) {
    files.push_back((folder / fmt::format("maide-{}.1", command.name)).string());
    write_file_atomically(files.back(), page_of(command));
  }
  context.print(fmt::format("{}: {} pages\n", arguments.folder, files.size()));
  context.set_result({{"files", files}});
  return ExitStatus::ok;
}

}  // namespace

RunFunction set_up_completion(CommandLine& line) {
  auto shell = std::make_shared<std::string>();
  line.add("SHELL", *shell, "For which shell: bash, zsh or fish")
      .required()
      .one_of({"bash", "zsh", "fish"});
  return [shell](Context& context) { return run_completion(*shell, context); };
}

RunFunction set_up_manual(CommandLine& line) {
  auto arguments = std::make_shared<ManualArguments>();
  line.add("COMMAND", arguments->command, "The page of this command. Default: that of maide")
      .offer(names_of(command_table()));
  line.add_flag("--all", arguments->all, "Write the pages of all commands into a folder");
  line.add("-o,--output", arguments->folder, "With --all: the folder, which must be there")
      .value_name("FOLDER");
  return [arguments](Context& context) { return run_manual(*arguments, context); };
}

}  // namespace maide::cli
