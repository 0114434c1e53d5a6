// Several equal systems, asked at once. The queries of a batch lie in one queue. For each system a
// thread takes small portions of the queue and runs them. Portions shrink as the queue does (guided
// self-scheduling: Polychronopoulos & Kuck, IEEE Transactions on Computers 36, 1987), so that no
// system is left with a long one at the end.
//
// Invariant: which queries are asked does not depend on the number of systems. Only the order in
// which answers arrive does; whoever numbers outputs does it in the order of the queries.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

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

  // Throws UsageError if there is no system, or if two do not say the same of themselves.
  explicit SulPool(std::vector<Member> members, Warn warn = {});

  const SulInfo& info() const override { return info_; }
  void add_purpose(const LearningPurpose& purpose) override;
  // Of all of them, also of those that were given up.
  SulIncidents incidents() const override;

  // Runs every query on one of the systems. A system that throws WrapperError is given up for good,
  // and the others are asked the rest of its queries. The error of the last system is thrown. Any
  // other exception, the sink's too, stops all of them. All are idle when the call ends.
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override;

  // Systems that were not given up.
  std::size_t size() const { return members_.size(); }

 private:
  class Batch;

  void run_once(std::span<const SulQuery> batch, std::span<const std::size_t> open,
                const SulAnswerSink& sink, const RunControl& control);
  void give_up(const Sul& sul, const std::exception_ptr& error);

  SulInfo info_;
  std::vector<Member> members_;
  Warn warn_;
  std::exception_ptr last_error_;   // of the system that was given up last
  SulIncidents earlier_incidents_;  // of those that were given up
};

}  // namespace maide
