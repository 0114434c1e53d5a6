// Where the writer and the reader of all words live: one participant without any network, or two
// that can only meet over it.
#pragma once

#include "dds_entity.hpp"

namespace maide::cyclonedds {

enum class Transport { none, udp };

class Domains {
 public:
  // Throws std::runtime_error.
  explicit Domains(Transport transport);

  dds_entity_t of_writer() const { return writing_.get(); }
  dds_entity_t of_reader() const { return reading_.get() > 0 ? reading_.get() : writing_.get(); }

 private:
  // Deleted in the opposite order.
  Entity writing_domain_, reading_domain_;
  Entity writing_, reading_;  // participants
};

}  // namespace maide::cyclonedds
