// What a beginner starts from: `maide new wrapper` writes a wrapper that runs at once, `maide init`
// a system file for what is installed. The wrappers are those of examples/, which are tested, with
// the user's server and lines in the place of theirs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <own_wrappers.hpp>  // made by the build
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>
#include <wrapper_templates.hpp>  // made by the build

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/base/text.hpp"
#include "maide/check/tree/print.hpp"
#include "maide/cli/command.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/names.hpp"

namespace maide::cli {
namespace {

// A file that is there is somebody's work.
void refuse_to_replace(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) {
    throw UsageError("there is such a file already (" + path + ")");
  }
  check_can_write(path);
}

// ---- maide new wrapper ----

struct NewArguments {
  std::string what;
  std::string tcp, udp, tls;
  std::string line_end = "crlf";
  bool is_lines = false, is_python = false, is_cpp = false;
  std::vector<std::string> inputs, resets;
  std::string output;
};

struct LineInput {
  std::string name, line;
};

// Where the server listens, and what carries its lines.
struct Server {
  std::string transport, address;
};

// In both languages the same.
std::string quoted(const std::string& text) { return Json(text).dump(); }

std::string check_line(const std::string& text) {
  const bool has_control = std::ranges::any_of(
      text, [](unsigned char letter) { return letter < 0x20 || letter == 0x7F; });
  return has_control ? "has a control character" : "";
}

// What is sent: in the text "\n" begins a further line, "\t" is a tab, and "\\" a backslash. Any
// other backslash is one.
std::string read_line(const std::string& text, const char* newline = "\n") {
  std::string line;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char next = text[i] == '\\' && i + 1 < text.size() ? text[i + 1] : ' ';
    if (next == 'n') line += newline;
    if (next == 't') line += '\t';
    if (next == '\\') line += '\\';
    if (next == 'n' || next == 't' || next == '\\') {
      ++i;
    } else {
      line += text[i];
    }
  }
  return line;
}

// "login=USER anonymous", or a line that is its own name.
LineInput read_input(const std::string& text) {
  const std::size_t place = text.find('=');
  LineInput input{text.substr(0, place),
                  read_line(place == std::string::npos ? text : text.substr(place + 1))};
  input.name = trim(place == std::string::npos ? read_line(text, " ") : input.name);
  if (input.name.empty()) throw UsageError("an input without a name (--input '" + text + "')");
  return input;
}

std::vector<LineInput> read_inputs(const std::vector<std::string>& texts) {
  if (texts.empty()) return {{"HELP", "HELP"}, {"NOOP", "NOOP"}, {"QUIT", "QUIT"}};
  std::vector<LineInput> inputs;
  for (const std::string& text : texts) {
    inputs.push_back(read_input(text));
    const std::string& name = inputs.back().name;
    if (name == "Delta") throw UsageError("'Delta' cannot be the name of an input (--input)");
    for (std::size_t i = 0; i + 1 < inputs.size(); ++i) {
      if (inputs[i].name == name) throw UsageError("two inputs have the name '" + name + "'");
    }
  }
  return inputs;
}

// "HOST:PORT", as both wrappers read it.
void check_address(const Server& server) {
  const std::string& address = server.address;
  const std::size_t colon = address.rfind(':');
  const std::string port = colon == std::string::npos ? "" : address.substr(colon + 1);
  const bool is_number = !port.empty() && port.size() <= 5 &&
                         port.find_first_not_of("0123456789") == std::string::npos &&
                         std::stoi(port) >= 1 && std::stoi(port) <= 65535;
  if (colon == 0 || !is_number || !check_line(address).empty()) {
    throw UsageError("an address is HOST:PORT (--" + server.transport + " " + address + ")");
  }
}

Server read_server(const NewArguments& arguments) {
  std::vector<Server> given;
  for (const auto& [transport, address] :
       {std::pair("tcp", &arguments.tcp), {"udp", &arguments.udp}, {"tls", &arguments.tls}}) {
    if (!address->empty()) given.push_back({transport, *address});
  }
  if (given.empty()) {
    throw UsageError(
        "--tcp HOST:PORT is required: where the server listens (or --udp, --tls HOST:PORT)");
  }
  if (given.size() > 1) throw UsageError("--tcp, --udp and --tls exclude each other");
  if (arguments.is_cpp && given.front().transport != "tcp") {
    throw UsageError("--cpp is for --tcp alone; the wrapper in Python takes --" +
                     given.front().transport);
  }
  check_address(given.front());
  return given.front();
}

std::string quoted_line_end(const NewArguments& arguments) {
  return arguments.line_end == "lf" ? R"("\n")" : R"("\r\n")";
}

// Puts `value` in the place of what stands between `begin` and the next `end`.
void put_in(std::string& text, std::string_view begin, std::string_view end,
            const std::string& value) {
  const std::size_t start = text.find(begin);
  const std::size_t stop =
      start == std::string::npos ? start : text.find(end, start + begin.size());
  if (stop == std::string::npos) {
    throw std::logic_error("the wrapper has no line " + std::string(begin));
  }
  text.replace(start + begin.size(), stop - start - begin.size(), value);
}

std::string listed(const std::vector<std::string>& texts, const char* open, const char* close) {
  std::vector<std::string> words;
  for (const std::string& text : texts) words.push_back(quoted(read_line(text)));
  return open + join(words) + close;
}

std::string python_wrapper(const NewArguments& arguments, const Server& server,
                           const std::vector<LineInput>& inputs) {
  std::string text(python_lines_wrapper);
  std::vector<std::string> pairs;
  for (const LineInput& input : inputs) {
    pairs.push_back(quoted(input.name) + ": " + quoted(input.line));
  }
  put_in(text, "\nSERVER = ", "\n", quoted(server.address));
  put_in(text, "\nTRANSPORT = ", "  #", quoted(server.transport));
  put_in(text, "\nLINE_END = ", "\n", quoted_line_end(arguments));
  put_in(text, "\nINPUTS = ", "\n", "{" + join(pairs, ",\n          ") + "}");
  put_in(text, "\nRESET = ", "\n", listed(arguments.resets, "[", "]"));
  return text;
}

std::string cpp_wrapper(const NewArguments& arguments, const std::vector<LineInput>& inputs) {
  std::string text(cpp_lines_wrapper);
  std::vector<std::string> pairs;
  for (const LineInput& input : inputs) {
    pairs.push_back("{" + quoted(input.name) + ", " + quoted(input.line) + "}");
  }
  put_in(text, " server = ", ";\n", quoted(arguments.tcp));
  put_in(text, " line_end = ", ";\n", quoted_line_end(arguments));
  put_in(text, " lines_of_inputs = ", ";\n", "{\n    " + join(pairs, ",\n    ") + "}");
  put_in(text, " lines_of_reset = ", ";\n", listed(arguments.resets, "{", "}"));
  return text;
}

// How the wrapper is run, and built before; for people, who paste it.
std::string next_steps(const NewArguments& arguments) {
  const std::filesystem::path file = arguments.output;
  const std::string stem = file.stem().string();
  const std::string model = quote_shell_word(stem + ".dot");
  if (!arguments.is_cpp) {
    return fmt::format("  learn it    maide learn {} -o {}\n",
                       quote_shell_word("exec:python3 " + quote_shell_word(arguments.output)),
                       model);
  }
  const std::string program =
      (file.parent_path() / std::filesystem::path("maide-wrap-" + stem)).string();
  const bool has_folder = program.find('/') != std::string::npos;
  return fmt::format(
      "  build it    g++ -std=c++20 {} -o {} $(pkg-config --cflags --libs maide)\n"
      "  learn it    maide learn {} -o {}\n",
      quote_shell_word(arguments.output), quote_shell_word(program),
      quote_shell_word("exec:" + quote_shell_word((has_folder ? "" : "./") + program)), model);
}

ExitStatus run_new(const NewArguments& arguments, Context& context) {
  if (arguments.is_python && arguments.is_cpp)
    throw UsageError("--python and --cpp exclude each other");
  const Server server = read_server(arguments);
  const std::vector<LineInput> inputs = read_inputs(arguments.inputs);
  const std::string text =
      arguments.is_cpp ? cpp_wrapper(arguments, inputs) : python_wrapper(arguments, server, inputs);
  const char* language = arguments.is_cpp ? "cpp" : "python";
  Json result{{"language", language}, {"server", server.address}, {"inputs", Json::array()}};
  for (const LineInput& input : inputs) result["inputs"].push_back(input.name);
  if (arguments.output.empty()) {
    context.print_data(text);
    if (context.json()) result["text"] = text;
  } else {
    refuse_to_replace(arguments.output);
    write_file_atomically(arguments.output, text);
    const std::string head = fmt::format("{}: a wrapper in {} for {}\n", arguments.output,
                                         arguments.is_cpp ? "C++" : "Python", server.address);
    context.print(context.quiet() ? head : head + next_steps(arguments));
    result["output"] = arguments.output;
  }
  context.set_result(result);
  return ExitStatus::ok;
}

// ---- maide init ----

// The options that make of each system a connection that is small and loses what is too much.
struct FirstSystem {
  std::string_view name, options;
};

constexpr auto first_systems = std::to_array<FirstSystem>({
    {"cyclonedds", "{history: keep_last, depth: 1}"},
    {"fastdds", "{history: keep_last, depth: 1}"},
    {"ros2", "{kind: topic, depth: 1}"},
    {"ros1", "{queue_size: 1}"},
    {"zeromq", "{conflate: yes}"},
    {"mqtt", "{qos: 1, max-inflight: 1, max-queued: 1, size: 0}"},
    {"yarp", "{kind: buffered}"},
    {"port", "{kind: buffered}"},
});

std::string title_of(std::string_view name) {
  for (const OwnWrapper& wrapper : own_wrappers) {
    if (wrapper.name == name) return std::string(wrapper.title);
  }
  return std::string(name);
}

bool is_usable(std::string_view name, const RunControl& control) {
  const auto path = find_wrapper(name);
  if (!path) return false;
  SubprocessOptions options;
  options.time_limit = std::chrono::seconds(30);
  return run_program({path->string(), "--self-test"}, options, control).succeeded();
}

const FirstSystem& find_first_system(const std::string& wanted, const RunControl& control) {
  if (!wanted.empty()) {
    const FirstSystem& system =
        find_row(std::span<const FirstSystem>(first_systems), "system", wanted);
    if (find_wrapper(wanted)) return system;
    throw UsageError("the wrapper of " + wanted +
                     " is not here; 'maide doctor' tells what to install");
  }
  for (const FirstSystem& system : first_systems) {
    control.check("the examination");
    if (is_usable(system.name, control)) return system;
  }
  throw UsageError("no wrapper is usable here; 'maide doctor' tells what to install");
}

std::string first_file(const FirstSystem& system, const std::string& file) {
  return fmt::format(
      R"yaml(# A first system file: two programs, and the connections of {title} between them. A planner sends
# three points, then waits until the controller has had them. Both connections keep few messages and lose
# what is too much, so a point may be lost, and then both wait for ever. Make it yours: the options of
# your connections, and what your programs send and wait for.
#
#   maide check {file}               learns the connections, tells whether the programs hang, and where
#   maide check {file} --suggest     and which other options mend that
#   maide learn {name} --list-options
#   maide help language
models:
  points: {{learn: {name}, with: {options}}}
  done: {{learn: {name}, with: {options}}}
programs:
  planner: |
    loop {{
      repeat 3 {{ points.write; }}
      @sent done.read -> message;
    }}
  controller: |
    loop {{
      repeat 3 {{ points.read -> message; }}
      @finished done.write;
    }}
properties:
  acknowledged: "G (planner@sent -> F controller@finished)"
)yaml",
      fmt::arg("title", title_of(system.name)), fmt::arg("file", file),
      fmt::arg("name", system.name), fmt::arg("options", system.options));
}

struct InitArguments {
  std::string file = "system.yaml";
  std::string system;
};

ExitStatus run_init(const InitArguments& arguments, Context& context) {
  const std::string extension = std::filesystem::path(arguments.file).extension().string();
  if (extension != ".yaml" && extension != ".yml") {
    throw UsageError("a system file ends in .yaml (" + arguments.file + ")");
  }
  refuse_to_replace(arguments.file);
  const FirstSystem& system = find_first_system(arguments.system, context.control());
  const std::string shown = quote_shell_word(arguments.file);
  write_file_atomically(arguments.file, format_system(first_file(system, shown), arguments.file));
  context.print(fmt::format("{}: two programs over {}\n", arguments.file, title_of(system.name)) +
                (context.quiet() ? "" : fmt::format("  check it    maide check {}\n", shown)));
  context.set_result({{"file", arguments.file}, {"system", std::string(system.name)}});
  return ExitStatus::ok;
}

}  // namespace

RunFunction set_up_new(CommandLine& line) {
  auto arguments = std::make_shared<NewArguments>();
  line.add("WHAT", arguments->what, "What to write: wrapper").required().one_of({"wrapper"});
  line.add("--tcp", arguments->tcp, "Where the server listens").value_name("HOST:PORT");
  line.add("--udp", arguments->udp, "The same for a server of datagrams (not with --cpp)")
      .value_name("HOST:PORT");
  line.add("--tls", arguments->tls,
           "The same for a server over TLS, whoever signed its certificate (not with --cpp)")
      .value_name("HOST:PORT");
  line.add_flag("--lines", arguments->is_lines,
                "The server takes lines of text and answers with lines (the only kind so far)");
  line.add_flag("--python", arguments->is_python,
                "Write it in Python (the default): it runs as it is");
  line.add_flag("--cpp", arguments->is_cpp, "Write it in C++, with Maide's library for wrappers");
  line.add("--input", arguments->inputs,
           "An input and the line that it sends, or a line that is its own name; '\\n' in it "
           "begins a "
           "further line; may be given several times (default: HELP, NOOP and QUIT)")
      .one_each()
      .no_default()
      .check(check_line)
      .value_name("NAME=LINE");
  line.add("--reset", arguments->resets,
           "A line to send when a word begins, so that the server forgets the last one; may be "
           "given several times")
      .one_each()
      .no_default()
      .check(check_line)
      .value_name("LINE");
  line.add("--line-end", arguments->line_end, "What ends a line: crlf (\\r\\n) or lf (\\n)")
      .one_of({"crlf", "lf"});
  line.add("-o,--output", arguments->output,
           "The file to write, which must not be there; standard output if not given");
  return [arguments](Context& context) { return run_new(*arguments, context); };
}

RunFunction set_up_init(CommandLine& line) {
  auto arguments = std::make_shared<InitArguments>();
  line.add("FILE", arguments->file, "The system file to write, which must not be there");
  std::string names;
  for (const FirstSystem& system : first_systems) {
    names += (names.empty() ? "" : ", ") + std::string(system.name);
  }
  line.add("--system", arguments->system,
           "Over which system (" + names + "); default: the first of these that is usable here")
      .no_default()
      .value_name("NAME");
  return [arguments](Context& context) { return run_init(*arguments, context); };
}

}  // namespace maide::cli
