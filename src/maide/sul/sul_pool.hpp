// Several equal systems, asked at once. The queries of a batch lie in one queue. For each system a
// thread takes small portions of the queue and runs them. Portions shrink as the queue does (guided
// self-scheduling: Polychronopoulos & Kuck, IEEE Transactions on Computers 36, 1987), so that no
// system is left with a long one at the end. Systems may come while a batch runs, and take part in
// it from there.
//
// Invariant: which queries are asked does not depend on the number of systems, nor on when they
// come and go. Only the order in
// which answers arrive does; whoever numbers outputs does it in the order of the queries.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/sul/learning_purpose.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

class SulPool : public Sul {
 public:
  struct Member {
    std::string name;  // for messages: "tcp://b:7000"
    std::unique_ptr<Sul> sul;
  };
  // Told when a system is given up, from the thread that called.
  using Warn = std::function<void(std::string_view message)>;

  // `patience`: how long to wait for another system when none is left. Throws UsageError if there
  // is no system, or if two do not say the same of themselves.
  explicit SulPool(std::vector<Member> members, Warn warn = {},
                   std::chrono::milliseconds patience = {});
  ~SulPool() override;

  // One more; from any thread, also while a batch runs. Throws UsageError if it does not say the
  // same of itself as the first one; `member` stays what it was.
  void admit(Member&& member);

  const SulInfo& info() const override { return info_; }
  void add_purpose(const LearningPurpose& purpose) override;
  // Of all of them, also of those that were given up.
  SulIncidents incidents() const override;

  // Runs every query on one of the systems. A system that throws WrapperError is given up for good,
  // and the others are asked the rest of its queries. If none is left and none comes within the
  // patience, the error of the last system is thrown. Any other exception, the sink's too, stops
  // all of them. All are idle when the call ends.
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override;

  // Systems that were not given up; those that have come since the last call are not counted.
  std::size_t size() const { return members_.size(); }
  // The largest size() so far.
  std::size_t most() const { return most_; }

 private:
  class Batch;
  class Listening;
  struct Place {  // of a member
    Member member;
    std::size_t purposes = 0;  // how many of `purposes_` it has been given
  };
  std::vector<Place*> take_newcomers();
  void await_newcomer(const RunControl& control);
  void give_purposes(Place& place) const;
  void run_once(std::span<const SulQuery> batch, std::span<const std::size_t> open,
                const SulAnswerSink& sink, const RunControl& control);
  void give_up(const Sul& sul, const std::exception_ptr& error);

  SulInfo info_;
  std::list<Place> members_;
  std::size_t most_ = 0;
  std::vector<LearningPurpose> purposes_;
  Warn warn_;
  std::chrono::milliseconds patience_;
  std::exception_ptr last_error_;   // of the system that was given up last
  SulIncidents earlier_incidents_;  // of those that were given up

  std::mutex mutex_;  // of what follows
  std::condition_variable_any changed_;
  std::list<Place> newcomers_;
  Batch* running_ = nullptr;  // to be told of newcomers
};

}  // namespace maide
