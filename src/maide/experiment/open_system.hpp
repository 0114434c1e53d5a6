// From what a person types to a system that can be asked. A model is simulated, a wrapper's
// processes are started, or listening wrappers are connected to. Several are asked at once, as a
// pool.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/base/text.hpp"
#include "maide/sul/sul.hpp"
#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide {

// ---- What a person types ----
//
// A system under learning is typed as `SUL [KEY=VALUE ...]`. SUL is `sim:FILE` (a model,
// simulated), the name of a wrapper ("port", "cyclonedds"), `tcp://HOST:PORT,...` (wrappers that
// listen), or `exec:PROGRAM ARGS` (any program that speaks the protocol).
struct SystemSpec {
  enum class Kind { simulated, wrapper, tcp, program, embedded };
  Kind kind = Kind::wrapper;
  std::string text;                            // as typed: "sim:coffee.dot"
  std::string target;                          // the file, the wrapper's name, "HOST:PORT,..."
  std::vector<std::string> command;            // of `exec:`: the program and its arguments
  std::map<std::string, std::string> options;  // KEY=VALUE, keys with '-' for '_'
};

// A program around Maide may have systems of its own, too: EmbeddedSystem.

// Throws UsageError: an unknown scheme, an empty target, a word without '=', a key given twice.
SystemSpec parse_system_spec(const std::string& sul, std::span<const std::string> key_values);

// The system and its options in one line, as a model keeps them; split_shell_words() undoes it.
std::string origin_of(const SystemSpec& spec, const std::map<std::string, std::string>& options);

// ---- Where wrappers are found ----
//
// The programs `maide-wrap-<middleware>` are looked for beside the running program, then in
// ../libexec/maide from there, then on PATH. Where the running program is not Maide's (Python), it
// says where they are: that folder comes before all others.
void look_for_wrappers_in(const std::filesystem::path& folder);

// The program of the wrapper called `name` ("cyclonedds"), or nothing if it is nowhere. A name that
// is not made of letters, digits, '_' and '-' is nowhere.
std::optional<std::filesystem::path> find_wrapper(std::string_view name);

// The file of that name beside the running program or in ../libexec/maide, or nothing.
std::optional<std::filesystem::path> find_own_file(std::string_view name);

// The program of that name where wrappers are, but not on PATH; or nothing.
std::optional<std::filesystem::path> find_own_program(std::string_view name);

// The program called `name`, as a shell would find it on PATH (`name` has no '/').
std::optional<std::filesystem::path> find_on_path(std::string_view name);

// The names of all wrappers that can be found, in alphabetical order.
std::vector<std::string> list_wrappers();

// For error messages: the wrappers that could be found, and where they were looked for.
std::string describe_wrapper_search();

// ---- Opening ----
//
// More systems at once than this are a mistake.
inline constexpr std::size_t most_jobs = 256;

inline constexpr double default_accept_wait = 300;  // seconds

struct SystemAccess {
  // Of wrappers that listen or dial in; empty: MAIDE_TOKEN, if it is set.
  std::string token_file;
  // The translation asked for; a simulated plain Mealy machine is only taken for an interface
  // automaton (outputs joined by ',', "quiet" for none) if one is.
  std::optional<Translation> translation;
  std::size_t jobs = 0;  // systems that are asked at once; 0: default_jobs()

  // Wrappers on other machines, in place of those of this one. Either a command that starts one,
  // and a file of hosts; or HOST:PORT, where wrappers dial in.
  std::string launch, hosts_file;
  std::string accept;
  std::optional<double> accept_wait;  // seconds to wait for a wrapper when there is none
};

// A wrapper of ours: one for each processor. A program: one, since nobody knows whether a second
// one can run beside it. Hosts: one connection to each. A simulation: one, for it never waits.
std::size_t default_jobs(const SystemSpec& spec);

struct OpenedSystem {
  std::unique_ptr<Sul> sul;
  std::optional<Mealy> reference;  // the machine to be learned, where the system is a simulation
};

// Systems that are asked at once; the most there were, if they come and go.
std::size_t count_systems(const Sul& sul);

// Throws UsageError for a system or an option that does not exist, for too many jobs, for fewer
// jobs than hosts, and for systems that differ. Throws WrapperError if a system cannot be reached
// or says nothing sensible within 10 s; where a command launches them on hosts, only if none can be
// started, and a host that cannot is a warning. A system that fails later is given up with a
// warning in the log. Where wrappers dial in, this waits for the first one; later ones join in.
OpenedSystem open_system(const SystemSpec& spec, const SystemAccess& access = {},
                         const RunControl& control = {});

// A system that the running program has itself, as an object. As long as this lives, text() names
// it wherever the name of a system is read. Any thread may use it.
class EmbeddedSystem {
 public:
  // `open` is called for each open_system(); what it opens may outlive neither.
  explicit EmbeddedSystem(std::function<OpenedSystem()> open);
  ~EmbeddedSystem();
  EmbeddedSystem(const EmbeddedSystem&) = delete;
  EmbeddedSystem& operator=(const EmbeddedSystem&) = delete;

  const std::string& text() const { return text_; }  // "object:1"

 private:
  std::string text_;
};

// The options of the system; a simulated model has none. Options given in `spec` are not looked at.
// Throws as open_system does.
std::vector<OptionSpec> list_system_options(const SystemSpec& spec, const SystemAccess& access = {},
                                            const RunControl& control = {});

}  // namespace maide
