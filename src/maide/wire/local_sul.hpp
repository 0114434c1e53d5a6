// A SystemWrapper as a Sul in this very process: no wire, no protection. For tests, and to measure
// what the wire costs; a system that hangs or crashes here takes the process with it.
#pragma once

#include <map>
#include <string>

#include "maide/sul/sul.hpp"
#include "maide/wire/system_wrapper.hpp"
#include "maide/wire/wrapper_session.hpp"

namespace maide {

class LocalSul : public Sul {
 public:
  // Keeps a reference to `wrapper`, which must be used once only. Throws UsageError for options
  // that the wrapper does not take.
  explicit LocalSul(SystemWrapper& wrapper, const std::map<std::string, std::string>& options = {});

  const SulInfo& info() const override { return session_.info(); }
  void add_purpose(const LearningPurpose& purpose) override { session_.add_purpose(purpose); }
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override;

 private:
  WrapperSession session_;
};

}  // namespace maide
