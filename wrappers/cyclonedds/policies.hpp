// The options of the wrapper that are QoS policies of DDS, and what they mean for a write. Names
// and defaults as in the OMG's "Data Distribution Service", version 1.4 (2015), section 2.2.3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dds_entity.hpp"
#include "maide/wire/wrapper_options.hpp"

namespace maide::cyclonedds {

struct Policies {
  dds_history_kind_t history = DDS_HISTORY_KEEP_LAST;
  std::int32_t depth = 1;
  bool reliable_writer = true, reliable_reader = false;
  std::int32_t max_samples = DDS_LENGTH_UNLIMITED;  // of the reader
  dds_duration_t max_blocking_time = DDS_INFINITY;  // of the writer

  // The rows of the wrapper's table that these come from.
  static std::vector<OptionSpec> options();
  // Throws UsageError for combinations that make no sense.
  static Policies from(const OptionValues& options);

  Qos reader_qos() const;
  Qos writer_qos() const;
  // A reader that is full holds the writer up; otherwise it drops what comes.
  bool pushes_back() const { return reliable_reader && max_samples != DDS_LENGTH_UNLIMITED; }
  bool write_may_block() const { return pushes_back() && max_blocking_time != 0; }
  // How many messages can be in flight, one in a blocked write included; 0: no limit.
  std::size_t capacity() const;
};

}  // namespace maide::cyclonedds
