// The wrapper for Eclipse Cyclone DDS: `maide learn cyclonedds history=keep_last depth=10`. Writers
// and readers of one topic, in one process, with the QoS that the user names. The actor `writer`
// calls dds_write; `reader` waits for data on a waitset and takes one sample (read), or
// takes one if there is one (tryread).
//
// transport=none: the domain has no network at all; within a process Cyclone hands a sample to the
// readers of its own domain from within dds_write, no protocol timer runs, and no socket is open.
// transport=udp: two domains with the same number on the network, one for the writers and one
// for the readers, which meet over RTPS on the loopback device alone. Wrappers side by side never
// meet, and CYCLONEDDS_URI is not looked at.
//
// A reset keeps process, domain and participant; topic, writers and readers are fresh for each
// word.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "dds/policies.hpp"
#include "domains.hpp"
#include "endpoints.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide::cyclonedds {

class CycloneDdsWrapper : public SystemWrapper {
 public:
  CycloneDdsWrapper();
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues& options) override;
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override;

 private:
  void start_domains();
  void delete_retired();

  WrapperDescription description_;
  dds::Policies policies_;
  dds::EndCounts counts_;
  std::uint64_t words_ = 0;
  Transport transport_ = Transport::none;
  std::optional<Domains> domains_;
  // Of past words, to be deleted, and of the present one.
  std::vector<std::shared_ptr<Endpoints>> retired_;
};

}  // namespace maide::cyclonedds
