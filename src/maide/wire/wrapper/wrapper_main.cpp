// run_wrapper: the main function of a wrapper's executable. Over pipes it serves the one client
// that started it. Listening, it forks for each client that has named its token and sent its
// options (Reception), so that every client has a fresh process of the middleware, several at
// once do not disturb one another, and one that crashes or hangs its system leaves the others and
// the listener alone.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/wire/protocol/tcp.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_server.hpp"

namespace maide {
namespace {

// Clients that are served at the same time; more wait, their options said, until one has gone.
constexpr std::size_t most_clients = 64;

struct Arguments {
  bool help = false, list_options = false, self_test = false;
  std::optional<std::string> listen, token_file;
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
               !take_value(arguments.token_file, "--token-file")) {
      throw UsageError(fmt::format("unknown argument '{}'; see --help", word));
    }
  }
  return arguments;
}

void print_help(const WrapperDescription& description, const char* program) {
  fmt::print(
      "{1}: {2}\n\n"
      "Usage: {0} [--listen HOST:PORT] [--token-file FILE] [--list-options] [--self-test] "
      "[--help]\n\n"
      "Speaks Maide's wire protocol over standard input and output, or over TCP:\n"
      "  --listen HOST:PORT  serve clients that connect, each in a process of its own; port 0 "
      "takes\n"
      "                      a free one; the first line printed names it\n"
      "  --token-file FILE   clients must name the token in FILE (or in MAIDE_TOKEN); needed to\n"
      "                      listen on anything but loopback\n"
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

// In the process of one client.
void serve_client(SystemWrapper& wrapper, AcceptedClient client, pid_t listener) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != listener) return;
  const int socket = client.socket.get();
  tcp::set_up(socket);
  WrapperServer(wrapper, socket, socket, std::move(client.received)).serve();
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
  tcp::Listener listener = tcp::listen(tcp::parse_address(*arguments.listen));
  if (!listener.is_loopback && !token) {
    throw UsageError("listening on " + listener.name +
                     ", which is not loopback, needs a token (--token-file or MAIDE_TOKEN)");
  }
  fmt::print("listening on {}\n", listener.name);
  std::fflush(stdout);
  const pid_t self = ::getpid();
  Reception reception(listener.socket.get(), wrapper.description(), token);
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
