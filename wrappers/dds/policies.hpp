// The options of a DDS wrapper that are QoS policies, and what they mean for a write. Names and
// defaults as in the OMG's "Data Distribution Service", version 1.4 (2015), section 2.2.3; a vendor
// turns them into QoS of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide::dds {

// Of the writers, or of the readers.
struct EndPolicies {
  bool keep_all = false;  // else keep_last
  std::int32_t depth = 1;
  bool reliable = true;
  bool transient_local = false;
};

// What a vendor sets where the user names nothing.
struct VendorDefaults {
  bool writer_is_transient_local = false;
};

struct Policies {
  EndPolicies writer, reader;
  std::int32_t max_samples = 0;  // of keep_all; 0: no limit
  bool write_waits = true;       // without limit for room; else it fails at once

  // The rows of the wrapper's table that these come from.
  static std::vector<OptionSpec> options();
  // Throws UsageError for combinations that make no sense.
  static Policies from(const OptionValues& options, const VendorDefaults& defaults = {});

  // Writers offer what readers ask for; others never match (DDS 1.4, section 2.2.3).
  bool match() const {
    return (writer.reliable || !reader.reliable) &&
           (writer.transient_local || !reader.transient_local);
  }
  // A late reader gets what the writer keeps.
  bool keeps_for_late_readers() const { return writer.transient_local && reader.transient_local; }
  // A reader that is full holds the writer up; otherwise it drops what comes.
  bool pushes_back() const { return match() && reader.reliable && max_samples > 0; }
  bool write_may_block() const { return pushes_back() && write_waits; }
  // How many messages can be in flight, one in a blocked write included; 0: no limit.
  std::size_t capacity() const;
};

// Is there an input that takes the reader away?
bool disconnects(const OptionValues& options);

}  // namespace maide::dds
