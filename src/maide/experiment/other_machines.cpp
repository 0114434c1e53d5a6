#include "maide/experiment/other_machines.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <stop_token>
#include <string_view>
#include <thread>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/sul/sul_pool.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"
#include "maide/wire/protocol/tcp.hpp"

namespace maide {

void check_machines(const SystemSpec& spec, const SystemAccess& access) {
  const bool has_launch = !access.launch.empty(), has_hosts = !access.hosts_file.empty();
  if (has_launch != has_hosts) {
    throw UsageError(has_launch ? "--launch needs --hosts FILE" : "--hosts needs --launch COMMAND");
  }
  const bool has_accept = !access.accept.empty();
  if (access.accept_wait && !has_accept) throw UsageError("--accept-wait needs --accept HOST:PORT");
  if (has_launch && has_accept) throw UsageError("--launch and --accept exclude each other");
  if (!has_launch && !has_accept) return;
  if (spec.kind != SystemSpec::Kind::wrapper && spec.kind != SystemSpec::Kind::program) {
    throw UsageError(fmt::format("{} is for a wrapper by its name or exec:PROGRAM, not for '{}'",
                                 has_launch ? "--launch" : "--accept", spec.text));
  }
  // One is what confirms a model: any of the hosts will do.
  if (access.jobs > (has_launch ? 1 : 0)) {
    throw UsageError(has_launch ? "--jobs is of this machine: in the file of hosts a number behind "
                                  "a host says how many wrappers run there"
                                : "--jobs is of this machine: as many take part as dial in");
  }
}

std::vector<Host> read_hosts(const std::string& path) {
  std::vector<Host> hosts;
  std::map<std::string, std::size_t> lines;  // by host
  std::size_t number = 0, wrappers = 0;
  const auto fail = [&](const std::string& message) {
    throw UsageError(fmt::format("{} ({}:{})", message, path, number));
  };
  const std::string text = read_file(path);
  for (const std::string_view line : split(text, '\n')) {
    ++number;
    std::istringstream words(std::string(line.substr(0, line.find('#'))));
    Host host;
    std::string count, more;
    if (!(words >> host.name)) continue;
    if (words >> count) {
      const auto given = parse_number<std::size_t>(count);
      if (!given || *given == 0 || *given > most_jobs || words >> more) {
        fail(fmt::format("a line is HOST, or HOST and how many wrappers run there (1 to {})",
                         most_jobs));
      }
      host.wrappers = *given;
    }
    if (host.name.starts_with('-')) fail("'" + host.name + "' is no name of a host");
    const auto [before, is_new] = lines.emplace(host.name, number);
    if (!is_new)
      fail(fmt::format("host {} is there twice, first in line {}", host.name, before->second));
    wrappers += host.wrappers;
    if (wrappers > most_jobs) fail(fmt::format("more than {} wrappers", most_jobs));
    hosts.push_back(std::move(host));
  }
  if (hosts.empty()) throw UsageError("there is no host in the file (" + path + ")");
  return hosts;
}

std::vector<std::string> launch_command(const std::string& launch, const std::string& host,
                                        const std::vector<std::string>& wrapper) {
  if (launch.find("{host}") == std::string::npos) {
    throw UsageError("--launch has no {host} in it (" + launch + ")");
  }
  std::vector<std::string> quoted;
  for (const std::string& word : wrapper) quoted.push_back(quote_shell_word(word));
  std::vector<std::string> command;
  for (const std::string& word : split_shell_words(launch)) {
    if (word == "{wrapper}") {
      command.insert(command.end(), wrapper.begin(), wrapper.end());
      continue;
    }
    // In one pass: nothing is replaced in what was put in.
    std::string& made = command.emplace_back();
    for (std::size_t at = 0; at < word.size();) {
      const auto rest = std::string_view(word).substr(at);
      if (rest.starts_with("{host}")) {
        made += host;
        at += 6;
      } else if (rest.starts_with("{wrapper}")) {
        made += join(quoted, " ");
        at += 9;
      } else {
        made += word[at++];
      }
    }
  }
  return command;
}

std::vector<WrapperEndpoint> launched_endpoints(const SystemAccess& access,
                                                const std::vector<std::string>& wrapper) {
  std::vector<WrapperEndpoint> endpoints;
  for (const Host& host : read_hosts(access.hosts_file)) {
    for (std::size_t i = 1; i <= host.wrappers; ++i) {
      const std::string number = host.wrappers == 1 ? "" : fmt::format(" ({})", i);
      endpoints.push_back(WrapperEndpoint::program(
          launch_command(access.launch, host.name, wrapper), "host " + host.name + number));
    }
  }
  return endpoints;
}

namespace {

// Wrappers that dial in, as they come: each is opened in a thread of its own, so that one that is
// slow keeps no other out.
class Recruiter {
 public:
  Recruiter(const SystemSpec& spec, const std::string& host_port,
            const std::optional<std::string>& token)
      : spec_(spec),
        dial_ins_(std::make_shared<DialIns>(host_port, token, log_warning)),
        thread_([this](const std::stop_token& stop) { receive(stop); }) {}
  ~Recruiter() {
    thread_.request_stop();
    thread_.join();
  }
  Recruiter(const Recruiter&) = delete;
  Recruiter& operator=(const Recruiter&) = delete;

  const std::string& address() const { return dial_ins_->address(); }

  // The first that is open; nothing if none is within the limit. Throws UsageError for options that
  // the system does not take.
  std::optional<SulPool::Member> await_first(std::chrono::duration<double> limit,
                                             const RunControl& control) {
    std::unique_lock lock(mutex_);
    const auto until = std::chrono::steady_clock::now() +
                       std::chrono::duration_cast<std::chrono::steady_clock::duration>(limit);
    changed_.wait_until(lock, control.stop,
                        control.deadline ? std::min(until, *control.deadline) : until,
                        [this] { return error_ || !arrived_.empty(); });
    control.check("waiting for a wrapper");
    if (error_) std::rethrow_exception(error_);
    if (arrived_.empty()) return std::nullopt;
    SulPool::Member first = std::move(arrived_.front());
    arrived_.erase(arrived_.begin());
    return first;
  }

  // Those that come from here on, and those that have come, join the pool, which outlives this.
  void recruit_for(SulPool& pool) {
    const std::scoped_lock lock(mutex_);
    pool_ = &pool;
    for (SulPool::Member& member : std::exchange(arrived_, {})) join(std::move(member));
  }

 private:
  struct Attempt {
    std::jthread thread;
    std::shared_ptr<std::atomic<bool>> is_over = std::make_shared<std::atomic<bool>>(false);
  };

  void receive(const std::stop_token& stop) {
    std::list<Attempt> attempts;
    try {
      while (auto client = dial_ins_->take_newcomer(stop)) {
        attempts.remove_if([](const Attempt& one) { return one.is_over->load(); });
        Attempt& attempt = attempts.emplace_back();
        const auto connection = std::make_shared<AcceptedClient>(std::move(*client));
        attempt.thread = std::jthread([this, stop, connection, is_over = attempt.is_over] {
          open(std::move(*connection), stop);
          *is_over = true;
        });
      }
    } catch (const std::exception& error) {
      fail(std::current_exception());
      log_warning(std::string("no more wrappers are taken: ") + error.what());
    }
  }

  void open(AcceptedClient client, const std::stop_token& stop) {
    ProxySettings settings;
    if (spec_.kind == SystemSpec::Kind::wrapper) settings.name = spec_.target;
    RunControl control;
    control.stop = stop;
    const auto endpoint = WrapperEndpoint::dialled(dial_ins_, std::move(client));
    try {
      auto proxy = std::make_unique<WrapperProxy>(endpoint, spec_.options, settings, control);
      const std::scoped_lock lock(mutex_);
      join({endpoint.name(), std::move(proxy)});
    } catch (const Interrupted&) {
      // Nobody waits for it.
    } catch (const UsageError& error) {
      // Of the first one the options are wrong, and of a later one the wrapper.
      const std::scoped_lock lock(mutex_);
      if (pool_ == nullptr) {
        fail_locked(std::current_exception());
      } else {
        log_warning(endpoint.name() + " is refused: " + error.what());
      }
    } catch (const std::exception& error) {
      log_warning(endpoint.name() + " is refused: " + error.what());
    }
  }

  // The mutex is held.
  void join(SulPool::Member member) {
    if (pool_ == nullptr) {
      arrived_.push_back(std::move(member));
      changed_.notify_all();
      return;
    }
    const std::string name = member.name;
    try {
      pool_->admit(std::move(member));
      log_note(name + " has joined");
    } catch (const UsageError& error) {
      static_cast<WrapperProxy&>(*member.sul).refuse(error.what());
      log_warning(name + " is refused: " + error.what());
    }
  }

  void fail(std::exception_ptr error) {
    const std::scoped_lock lock(mutex_);
    fail_locked(std::move(error));
  }
  void fail_locked(std::exception_ptr error) {
    if (!error_) error_ = std::move(error);
    changed_.notify_all();
  }

  const SystemSpec spec_;
  const std::shared_ptr<DialIns> dial_ins_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<SulPool::Member> arrived_;  // before there is a pool
  std::exception_ptr error_;
  SulPool* pool_ = nullptr;
  std::jthread thread_;
};

// Of wrappers that dial in.
class GrowingPool : public SulPool {
 public:
  GrowingPool(Member first, std::chrono::milliseconds patience,
              std::unique_ptr<Recruiter> recruiter)
      : SulPool(one(std::move(first)), log_warning, patience), recruiter_(std::move(recruiter)) {
    recruiter_->recruit_for(*this);
  }

 private:
  static std::vector<Member> one(Member member) {
    std::vector<Member> members;
    members.push_back(std::move(member));
    return members;
  }
  std::unique_ptr<Recruiter> recruiter_;
};

// What others dial: the address of a listener on all interfaces is none.
std::string dialled_address(const std::string& address) {
  for (const std::string_view any : {"0.0.0.0", "[::]"}) {
    if (!address.starts_with(std::string(any) + ":")) continue;
    std::array<char, 256> name{};
    if (::gethostname(name.data(), name.size() - 1) != 0) break;
    return name.data() + address.substr(any.size());
  }
  return address;
}

}  // namespace

std::unique_ptr<Sul> await_wrappers(const SystemSpec& spec, const SystemAccess& access,
                                    const std::string& wrapper, const RunControl& control) {
  const double wait = access.accept_wait.value_or(default_accept_wait);
  const auto token =
      read_token(access.token_file.empty() ? std::nullopt : std::optional(access.token_file));
  auto recruiter = std::make_unique<Recruiter>(spec, access.accept, token);
  log_note(fmt::format(
      "waiting {} s for a wrapper; start some, here or elsewhere: {} --connect {}{}", wait, wrapper,
      dialled_address(recruiter->address()), token ? " --token-file FILE" : ""));
  auto first = recruiter->await_first(std::chrono::duration<double>(wait), control);
  if (!first) {
    throw Error(ExitStatus::system_failed,
                fmt::format("no wrapper has come within {} s (--accept {})", wait, access.accept));
  }
  const std::chrono::duration<double> patience(wait);
  return std::make_unique<GrowingPool>(
      std::move(*first), std::chrono::duration_cast<std::chrono::milliseconds>(patience),
      std::move(recruiter));
}

}  // namespace maide
