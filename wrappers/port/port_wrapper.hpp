// The wrapper of the reference port: `maide learn port kind=strict size=3`.
#pragma once

#include <cstddef>
#include <memory>

#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide::port {

class PortWrapper : public SystemWrapper {
 public:
  PortWrapper();
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues& options) override;
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override;

 private:
  enum class Kind { port, buffered, strict };
  WrapperDescription description_;
  Kind kind_ = Kind::port;
  std::size_t readers_ = 1;
};

}  // namespace maide::port
