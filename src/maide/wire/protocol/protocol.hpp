// The protocol between Maide and a wrapper, version 1: one JSON object a line, in both directions,
// pipelined. docs/protocol.md describes it. Here are its messages as values, and their text. A
// decoded message was checked: it is well-formed and speaks only of inputs, actors and outputs that
// exist.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "maide/sul/learning_purpose.hpp"
#include "maide/sul/sul.hpp"
#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide::protocol {

inline constexpr int version = 1;
// A longer line is nonsense: the connection ends.
inline constexpr std::size_t max_line = std::size_t{4} << 20;
// A step with more events is nonsense, too: nobody reads such a model.
inline constexpr std::size_t max_events = 1000;
// How Delta, the extra input of the av translation, is called in queries.
inline constexpr const char* delta = "Delta";

// What is wrong with a line, in a few words, without its endpoint.
class ProtocolError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// ---- From the wrapper ----

// The first line of all.
struct Hello {
  std::string name;
  std::map<std::string, std::string> versions;
  bool speaks_trees = false, speaks_purposes = false, speaks_av = false;
  bool announces_steps = false;     // can say at once that a step is over, where a Run asks for it
  bool needs_token = false;         // the next line must be a Token
  bool dials_again = false;         // dialling in, in place of a process that has ended
  std::vector<OptionSpec> options;  // may be empty: then it takes whatever it takes
};
// The answer to Configure. Name, versions and features are those of the hello.
struct Info {
  SulInfo info;
  bool open_outputs = false;  // events may have names that are not listed
  // Further versions, which the wrapper knows once it has met the system.
  std::map<std::string, std::string> versions = {};
};
struct Ok {};  // the answer to Purpose
struct Answer {
  std::uint64_t id = 0;
  SulAnswer answer;
};
// A Run may ask for these messages before its answer: the reset is done; a step is over. After a
// crash they tell how far the word had come.
struct Ready {
  std::uint64_t id = 0;
};
struct Step {
  std::uint64_t id = 0;
  SulStep step;
};
enum class ErrorCode : std::uint8_t {
  option,    // an option or a purpose that it does not take: the user's mistake
  token,     // the token is missing or wrong
  protocol,  // it did not understand a line
  system,    // the system under learning failed
};
struct ErrorReport {
  ErrorCode code = ErrorCode::protocol;
  std::string message;
  std::optional<std::uint64_t> id;  // the query that it answers
};
// The wrapper ends in good order and wants to be started anew (a call could not be unblocked, the
// broker is gone).
struct Leaving {
  std::string reason;
  std::optional<std::uint64_t> id =
      {};  // the query in which that happened, unanswered; none: between
};
using FromWrapper = std::variant<Hello, Info, Ok, Answer, Ready, Step, ErrorReport, Leaving>;

// ---- To the wrapper ----

struct Token {
  std::string token;
};
struct Configure {
  std::map<std::string, std::string> options;
};
struct Purpose {
  LearningPurpose purpose;
};
struct Run {
  std::uint64_t id = 0;
  SulQuery query;
  bool announce = false;  // wants Ready and Step
};
// Every query that is not answered yet is answered as aborted, or with what it has.
struct Cancel {};
struct Bye {};
// An ErrorReport goes this way only to a wrapper that dialled in and is of no use.
using ToWrapper = std::variant<Token, Configure, Purpose, Run, Cancel, Bye, ErrorReport>;

// One line each, without its newline.
std::string encode(const Hello& hello);
std::string encode(const Info& info);
std::string encode(const Ok& ok);
// `query` is the one that it answers: a tree's answer carries the path that was taken.
std::string encode(const Answer& answer, const SulInfo& info, const SulQuery& query);
std::string encode(const Ready& ready);
std::string encode(const Step& step, const SulInfo& info);
std::string encode(const ErrorReport& error);
std::string encode(const Leaving& leaving);
std::string encode(const Token& token);
std::string encode(const Configure& configure);
std::string encode(const LearningPurpose& purpose);
std::string encode(const Run& run, const SulInfo& info);
std::string encode(const Cancel& cancel);
std::string encode(const Bye& bye);

// What decoding an answer needs to know.
class AnswerContext {
 public:
  virtual ~AnswerContext() = default;
  virtual const SulInfo& info() const = 0;
  virtual bool open_outputs() const = 0;
  // The query of this id that was asked and not answered; null: there is none (an error).
  virtual const SulQuery* find_query(std::uint64_t id) const = 0;
};

// All throw ProtocolError.
// Without a context: before there are queries.
FromWrapper decode_from_wrapper(std::string_view line);
FromWrapper decode_from_wrapper(std::string_view line, const AnswerContext& context);
ToWrapper decode_to_wrapper(std::string_view line, const SulInfo& info);

}  // namespace maide::protocol
