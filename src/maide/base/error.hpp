// The errors of Maide. Every error carries the exit status with which the command line ends, so a
// library's failure and a command's exit status cannot drift apart. Every message is one line:
// "what is wrong (where)".
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace maide {

// Exit statuses of every `maide` command.
enum class ExitStatus : int {
  ok = 0,             // it holds, they agree, done
  violated = 1,       // violated, they differ
  usage = 2,          // unusable arguments or input
  inconclusive = 3,   // a bound, a limit, an interruption, a system that stays nondeterministic
  system_failed = 4,  // the system under learning failed: not found, died, nonsense
  internal = 5,       // an error of Maide's own
};

// Base of all errors that Maide throws on purpose.
class Error : public std::runtime_error {
 public:
  Error(ExitStatus status, const std::string& message)
      : std::runtime_error(message), status_(status) {}
  ExitStatus status() const noexcept { return status_; }

 private:
  ExitStatus status_;
};

// Arguments or input that cannot be used (exit status 2).
class UsageError : public Error {
 public:
  explicit UsageError(const std::string& message) : Error(ExitStatus::usage, message) {}
};

// A place in a text. Lines and columns count from 1; 0 means "unknown". A column is a byte, and a
// byte order mark is none.
struct TextPlace {
  int line = 0;
  int column = 0;
};

// A place in a file.
struct SourcePosition {
  std::string file;
  int line = 0;
  int column = 0;
};

// "file:line:column", without the parts that are unknown.
std::string to_string(const SourcePosition& position);

// Text that does not parse (exit status 2); what() is "message (file:line:column)".
class ParseError : public Error {
 public:
  ParseError(const std::string& message, SourcePosition position);
  const SourcePosition& position() const noexcept { return position_; }

 private:
  SourcePosition position_;
};

// The system under learning or its wrapper failed (exit status 4); what() ends with "(endpoint)".
class WrapperError : public Error {
 public:
  WrapperError(const std::string& message, const std::string& endpoint);
  const std::string& endpoint() const noexcept { return endpoint_; }

 private:
  std::string endpoint_;
};

// The same word was answered in several ways (exit status 3). The word and its answers are rendered
// with their symbols' names, separated by spaces. what() ends with what can be done about it.
class NondeterminismError : public Error {
 public:
  NondeterminismError(std::string word, std::string first_answer, std::string second_answer);
  // The word was asked again and again; `answers` says how often each answer came, the most
  // frequent two first. There are at least two.
  NondeterminismError(std::string word,
                      const std::vector<std::pair<std::string, std::uint64_t>>& answers);
  const std::string& word() const noexcept { return word_; }
  const std::string& first_answer() const noexcept { return first_; }
  const std::string& second_answer() const noexcept { return second_; }

 private:
  std::string word_, first_, second_;
};

// A long call was stopped: its stop token was set or its deadline passed (exit status 3).
class Interrupted : public Error {
 public:
  explicit Interrupted(const std::string& message) : Error(ExitStatus::inconclusive, message) {}
};

// The line about an exception that nobody meant to throw (exit status 5). `what` may be empty.
std::string describe_internal_error(std::string_view what);

}  // namespace maide
