// run_wrapper: the main function of a wrapper's executable. Over pipes it serves the one client
// that started it. Listening, it forks for each client that has named its token and sent its
// options (Reception), so that every client has a fresh process of the middleware, several at
// once do not disturb one another, and one that crashes or hangs its system leaves the others and
// the listener alone. Dialling in to Maide, it forks for each connection over which Maide has sent
// its options, and dials again when that process has ended: a crash costs the process, not the
// wrapper.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "maide/wire/protocol/tcp.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_server.hpp"

namespace maide {
namespace {

// Clients that are served at the same time; more wait, their options said, until one has gone.
constexpr std::size_t most_clients = 64;

struct Arguments {
  bool help = false, list_options = false, self_test = false;
  std::optional<std::string> listen, connect, token_file;
};

Arguments parse_arguments(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    // True if `word` is this argument; its value is behind '=', or the next word.
    const auto take_value = [&](std::optional<std::string>& value, const std::string& name) {
      if (word != name && !word.starts_with(name + "=")) return false;
      if (word == name && i + 1 == argc) throw UsageError(name + " needs a value");
      value = word == name ? argv[++i] : word.substr(name.size() + 1);
      return true;
    };
    if (word == "--help" || word == "-h") {
      arguments.help = true;
    } else if (word == "--list-options") {
      arguments.list_options = true;
    } else if (word == "--self-test") {
      arguments.self_test = true;
    } else if (!take_value(arguments.listen, "--listen") &&
               !take_value(arguments.connect, "--connect") &&
               !take_value(arguments.token_file, "--token-file")) {
      throw UsageError(fmt::format("unknown argument '{}'; see --help", word));
    }
  }
  if (arguments.listen && arguments.connect) {
    throw UsageError("--listen and --connect exclude each other");
  }
  return arguments;
}

void print_help(const WrapperDescription& description, const char* program) {
  fmt::print(
      "{1}: {2}\n\n"
      "Usage: {0} [--listen HOST:PORT | --connect HOST:PORT] [--token-file FILE]\n"
      "       {0} --list-options | --self-test | --help\n\n"
      "Speaks Maide's wire protocol over standard input and output, or over TCP:\n"
      "  --listen HOST:PORT  serve clients that connect, each in a process of its own; port 0 "
      "takes\n"
      "                      a free one; the first line printed names it\n"
      "  --connect HOST:PORT dial in to 'maide learn {1} --accept HOST:PORT', again for each "
      "new\n"
      "                      process, until nobody listens there any more\n"
      "  --token-file FILE   whoever connects must name the token in FILE (or in MAIDE_TOKEN); "
      "needed\n"
      "                      to listen on anything but loopback\n"
      "  --list-options      the options of the system\n"
      "  --self-test         try the system once: one line, and status 0 if it is usable\n\n"
      "Example: maide learn {1}\n\n"
      "Options of the system (maide learn {1} KEY=VALUE ...):\n{3}",
      program, description.name, description.summary, to_string(full_option_table(description)));
}

// What the middleware prints must not get between the protocol's lines, nor may it read them.
void serve_pipes(SystemWrapper& wrapper) {
  const Descriptor in(::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3));
  const Descriptor out(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3));
  const Descriptor nothing(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  ::dup2(nothing.get(), STDIN_FILENO);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  WrapperServer(wrapper, in.get(), out.get()).serve();
}

// In the process of one client. Returns as WrapperServer::serve().
std::string serve_client(SystemWrapper& wrapper, AcceptedClient client, pid_t parent,
                         std::function<void()> on_configured = {}) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) return "";
  const int socket = client.socket.get();
  tcp::set_up(socket);
  tcp::set_blocking(socket, true);
  return WrapperServer(wrapper, socket, socket, std::move(client.received),
                       std::move(on_configured))
      .serve();
}

// Clears away the processes of clients that have gone.
void reap(std::size_t& clients) {
  while (clients > 0) {
    const pid_t ended = ::waitpid(-1, nullptr, WNOHANG);
    if (ended < 0 && errno == EINTR) continue;
    if (ended <= 0) return;
    --clients;
  }
}

int listen_for_clients(SystemWrapper& wrapper, const Arguments& arguments) {
  const std::optional<std::string> token = read_token(arguments.token_file);
  tcp::Listener listener = listen_guarded(*arguments.listen, token);
  fmt::print("listening on {}\n", listener.name);
  std::fflush(stdout);
  const pid_t self = ::getpid();
  Reception reception(listener.socket.get(), rules_for_clients(wrapper.description(), token));
  constexpr std::chrono::milliseconds piece{50};  // between looks for a place that is free again
  for (std::size_t clients = 0;;) {
    reception.wait(clients >= most_clients ? std::optional(piece) : std::nullopt);
    reap(clients);
    while (clients < most_clients) {
      std::optional<AcceptedClient> client = reception.take_ready();
      if (!client) break;
      const pid_t child = ::fork();
      if (child > 0) ++clients;
      if (child != 0) continue;
      listener.socket.reset();
      reception.clear();
      serve_client(wrapper, std::move(*client), self);
      return 0;
    }
  }
}

// ---- Dialling in ----

// What the process of a connection tells the one that forked it, a byte each.
constexpr std::string_view is_configured = "c", is_refused = "r";

// Where it dials in, and what it says there first.
struct Caller {
  const std::string& address;
  std::string greeting;  // the token, if there is one, and the hello
};

// A connection on which it has said that. Throws std::runtime_error if nobody listens there.
Descriptor reach(const Caller& caller) {
  constexpr std::chrono::seconds limit{10};
  Descriptor socket = tcp::connect(tcp::parse_address(caller.address), limit, [] { return false; });
  tcp::set_blocking(socket.get(), true);
  write_all(socket.get(), caller.greeting);  // if Maide does not read it, it says why
  return socket;
}

// The same for the first time: Maide may be started a little later than the wrapper.
Descriptor reach_first(const Caller& caller) {
  constexpr std::chrono::seconds patience{10};
  constexpr std::chrono::milliseconds pause{200};
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (true) {
    try {
      return reach(caller);
    } catch (const UsageError&) {
      throw;
    } catch (const std::runtime_error& error) {
      if (std::chrono::steady_clock::now() >= deadline) {
        throw Error(ExitStatus::system_failed,
                    fmt::format("nobody listens at {} within {} s: {}", caller.address,
                                patience.count(), error.what()));
      }
    }
    std::this_thread::sleep_for(pause);
  }
}

// Waits until Maide says something, which is then `received`. Nothing: Maide has hung up. Throws
// UsageError if Maide refuses the wrapper.
std::optional<AcceptedClient> await_word(Descriptor socket) {
  AcceptedClient client;
  client.socket = std::move(socket);
  LineSplitter lines;
  std::string bytes;
  try {
    while (read_some(client.socket.get(), bytes) == ReadResult::some) {
      client.received += bytes;
      lines.append(bytes);
      const std::optional<std::string> line = lines.take_line();
      if (!line) continue;
      const auto message = protocol::decode_to_wrapper(*line, {});
      if (const auto* error = std::get_if<protocol::ErrorReport>(&message)) {
        throw UsageError("refused: " + error->message);
      }
      if (std::holds_alternative<protocol::Bye>(message)) return std::nullopt;
      return client;
    }
  } catch (const protocol::ProtocolError& error) {
    throw UsageError(std::string("it is not Maide that listens: ") + error.what());
  }
  return std::nullopt;
}

// Waits for the end of the process of a connection. If Maide hangs up, the process has a short
// grace. Returns what it told over the pipe.
std::string await_end(pid_t process, int socket, int pipe) {
  constexpr std::chrono::milliseconds grace{500};
  constexpr int piece_ms = 50, long_piece_ms = 1000;  // its end wakes, mostly: the pipe closes
  std::string told, bytes;
  std::optional<std::chrono::steady_clock::time_point> deadline;
  while (true) {
    pollfd waiting[] = {{pipe, POLLIN, 0}, {deadline ? -1 : socket, POLLRDHUP, 0}};
    ::poll(waiting, 2, deadline || pipe < 0 ? piece_ms : long_piece_ms);
    if (waiting[0].revents != 0) {
      if (read_some(pipe, bytes) == ReadResult::some) {
        told += bytes;
      } else {
        pipe = -1;
      }
    }
    if (waiting[1].revents != 0) deadline = std::chrono::steady_clock::now() + grace;
    if (deadline && std::chrono::steady_clock::now() >= *deadline) ::kill(process, SIGKILL);
    const pid_t ended = ::waitpid(process, nullptr, WNOHANG);
    if (ended == process || (ended < 0 && errno != EINTR)) return told;
  }
}

int dial_in(SystemWrapper& wrapper, const Arguments& arguments) {
  const std::optional<std::string> token = read_token(arguments.token_file);
  const std::string named =
      token ? protocol::encode(protocol::Token{*token}) + '\n' : std::string();
  protocol::Hello hello = hello_of(wrapper.description(), false);
  Caller caller{*arguments.connect, named + protocol::encode(hello) + '\n'};
  const pid_t self = ::getpid();
  constexpr int most_failures = 4;
  Descriptor socket = reach_first(caller);
  hello.dials_again = true;
  caller.greeting = named + protocol::encode(hello) + '\n';
  for (int failures = 0; failures < most_failures;) {
    std::optional<AcceptedClient> client = await_word(std::move(socket));
    std::string told;
    if (client) {
      Pipe pipe;
      const pid_t child = ::fork();
      if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
      if (child == 0) {
        pipe.read_end.reset();
        const auto tell = [&](std::string_view what) { write_all(pipe.write_end.get(), what); };
        const std::string refusal =
            serve_client(wrapper, std::move(*client), self, [&] { tell(is_configured); });
        if (refusal.empty()) return static_cast<int>(ExitStatus::ok);
        tell(is_refused);
        throw UsageError(refusal);
      }
      pipe.write_end.reset();
      told = await_end(child, client->socket.get(), pipe.read_end.get());
      if (told.ends_with(is_refused)) return static_cast<int>(ExitStatus::usage);
    }
    failures = told.starts_with(is_configured) ? 0 : failures + 1;
    // The old connection is still open here: when Maide sees its end, the next one is there.
    try {
      socket = reach(caller);
    } catch (const std::runtime_error&) {
      return static_cast<int>(ExitStatus::ok);  // nobody listens any more: the run is over
    }
  }
  throw Error(
      ExitStatus::system_failed,
      fmt::format("{} connections in a row ended before the system was set up", most_failures));
}

}  // namespace

int run_wrapper(SystemWrapper& wrapper, int argc, char** argv) {
  const WrapperDescription& description = wrapper.description();
  try {
    const Arguments arguments = parse_arguments(argc, argv);
    if (arguments.help) {
      print_help(description, argv[0]);
    } else if (arguments.list_options) {
      fmt::print("{}", to_string(full_option_table(description)));
    } else if (arguments.self_test) {
      fmt::print("{}\n", one_line(run_self_test(wrapper)));
    } else if (arguments.listen) {
      return listen_for_clients(wrapper, arguments);
    } else if (arguments.connect) {
      return dial_in(wrapper, arguments);
    } else {
      serve_pipes(wrapper);
    }
    return static_cast<int>(ExitStatus::ok);
  } catch (const Error& error) {
    fmt::print(stderr, "maide-wrap-{}: {}\n", description.name, one_line(error.what()));
    return static_cast<int>(error.status());
  } catch (const std::exception& error) {
    fmt::print(stderr, "maide-wrap-{}: {}\n", description.name, one_line(error.what()));
    return static_cast<int>(ExitStatus::system_failed);
  }
}

}  // namespace maide
