// The state that a WrapperProxy keeps while a batch runs. For its own sources only.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "maide/wire/client/wrapper_connection.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"
#include "maide/wire/protocol/protocol.hpp"

namespace maide {

// The queries of one call of run().
struct WrapperProxy::Batch {
  // A query in which the wrapper died, to be asked alone.
  struct Suspect {
    std::size_t index = 0;
    DeathRecord record;
    std::string after;  // the word that was answered last before it
  };

  std::span<const SulQuery> queries;
  const SulAnswerSink& sink;
  std::size_t next = 0;                           // the first that was never sent
  std::size_t answered = 0;                       // how many are
  std::vector<std::size_t> again = {};            // to be sent again, last first
  std::optional<Suspect> suspect = {};            // nothing else is asked before it is answered
  std::optional<std::size_t> last_answered = {};  // by the wrapper
  std::size_t answered_since_start = 0;           // by the process that now runs
  std::chrono::steady_clock::time_point last_sign = std::chrono::steady_clock::now();  // of life
  std::optional<protocol::Leaving> leaving = {};  // it said that it will end
};

// What came of a query that was asked alone.
struct WrapperProxy::Outcome {
  std::optional<SulAnswer> answer;  // complete; without it, `death` is what happened
  Death death;
  bool is_over = false;
};

// Between looks at the stop token and the clock.
inline constexpr std::chrono::milliseconds wire_piece{50};

std::string describe_silence(std::chrono::milliseconds limit);

// What decoding needs to know of the proxy.
class WrapperProxy::Context : public protocol::AnswerContext {
 public:
  explicit Context(const WrapperProxy& proxy) : proxy_(proxy) {}
  const SulInfo& info() const override { return proxy_.info_; }
  bool open_outputs() const override { return proxy_.open_outputs_; }
  const SulQuery* find_query(std::uint64_t id) const override {
    const auto found = proxy_.pending_.find(id);
    return found == proxy_.pending_.end() ? nullptr : &found->second.query;
  }

 private:
  const WrapperProxy& proxy_;
};

}  // namespace maide
