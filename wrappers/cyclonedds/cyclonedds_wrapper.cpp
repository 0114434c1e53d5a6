#include "cyclonedds_wrapper.hpp"

#include <dds/version.h>

#include <array>
#include <thread>

#include "dds/wrapper_table.hpp"
#include "maide/base/error.hpp"

namespace maide::cyclonedds {
namespace {

// Deleting a writer or a reader waits for Cyclone's garbage collector, which looks once a
// millisecond: 1.5 ms for one connection, but 0.1 ms each for fifty of them by a few threads, whose
// waits overlap (a single thread: 0.1 to 0.8 ms, depending on the machine's load).
constexpr std::size_t most_retired = 50;
constexpr std::size_t deleting_threads = 4;
// Each writer and reader leaves some 0.4 KB behind in its domain (0.10.2, measured); a new domain
// takes 3 ms and gives that back.
constexpr std::uint64_t words_per_domain = 5000;
}  // namespace

CycloneDdsWrapper::CycloneDdsWrapper() {
  description_.name = "cyclonedds";
  description_.summary = "Eclipse Cyclone DDS: writers and readers of one topic, in one process";
  description_.versions = {{"cyclonedds", DDS_VERSION}, {"wrapper", "1"}};
  description_.options = dds::option_table();
  description_.options.push_back(
      OptionSpec::choice("transport", "none", {"none", "udp"},
                         "none: within the process, no network; udp: RTPS on the loopback device"));
}

SystemSetup CycloneDdsWrapper::configure(const OptionValues& options) {
  policies_ = dds::Policies::from(options);
  counts_ = dds::end_counts(options);
  if (options.is("transport", "udp")) transport_ = Transport::udp;
  if (transport_ == Transport::udp && policies_.pushes_back()) {
    throw UsageError(
        "option max-samples: over the network, what a full reliable reader does not take waits in "
        "buffers of the protocol, of a size that varies; say size=N instead");
  }
  // What fails says so by its return code; the log would repeat each write that finds no room.
  dds_set_log_sink([](void*, const dds_log_data_t*) {}, nullptr);
  start_domains();
  return dds::make_setup(policies_, options);
}

std::unique_ptr<SystemInstance> CycloneDdsWrapper::reset(EventSink& sink) {
  if (++words_ % words_per_domain == 0) start_domains();
  if (retired_.size() >= most_retired) delete_retired();
  retired_.push_back(std::make_shared<Endpoints>(*domains_, "maide_" + std::to_string(words_),
                                                 policies_, counts_));
  return std::make_unique<dds::DdsConnection>(retired_.back(), counts_, sink);
}

void CycloneDdsWrapper::delete_retired() {
  {
    std::array<std::jthread, deleting_threads> threads;
    for (std::size_t first = 0; first < threads.size(); ++first) {
      threads[first] = std::jthread([this, first] {
        for (std::size_t i = first; i < retired_.size(); i += deleting_threads) retired_[i].reset();
      });
    }
  }
  retired_.clear();
}

void CycloneDdsWrapper::start_domains() {
  delete_retired();
  domains_.reset();
  domains_.emplace(transport_);
}

}  // namespace maide::cyclonedds
