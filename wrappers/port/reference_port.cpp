#include "reference_port.hpp"

#include <utility>

namespace maide::port {

bool Port::write(Message message) {
  std::unique_lock lock(mutex_);
  Offer mine{message};
  taken_.wait(lock, [this] { return closed_ || interrupted_ || offer_ == nullptr; });
  if (closed_ || interrupted_) return false;
  offer_ = &mine;
  offered_.notify_one();
  taken_.wait(lock, [&] { return closed_ || interrupted_ || mine.taken; });
  if (!mine.taken) offer_ = nullptr;
  return mine.taken;
}

std::optional<Message> Port::take() {
  if (closed_ || offer_ == nullptr) return std::nullopt;
  Offer& offer = *std::exchange(offer_, nullptr);
  offer.taken = true;
  taken_.notify_all();
  return offer.message;
}

std::optional<Message> Port::read() {
  std::unique_lock lock(mutex_);
  offered_.wait(lock, [this] { return closed_ || offer_ != nullptr; });
  return take();
}

std::optional<Message> Port::try_read() {
  const std::scoped_lock lock(mutex_);
  return take();
}

void Port::interrupt() {
  const std::scoped_lock lock(mutex_);
  interrupted_ = true;
  taken_.notify_all();
}

void Port::resume() {
  const std::scoped_lock lock(mutex_);
  interrupted_ = false;
}

void Port::close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  offered_.notify_all();
  taken_.notify_all();
}

bool BufferedPort::write(Message message) {
  const std::scoped_lock lock(mutex_);
  if (closed_ || interrupted_) return false;
  if (!strict_) kept_.clear();
  kept_.push_back(message);
  arrived_.notify_one();
  return true;
}

std::optional<Message> BufferedPort::take() {
  if (closed_ || kept_.empty()) return std::nullopt;
  const Message message = kept_.front();
  kept_.pop_front();
  return message;
}

std::optional<Message> BufferedPort::read() {
  std::unique_lock lock(mutex_);
  arrived_.wait(lock, [this] { return closed_ || !kept_.empty(); });
  return take();
}

std::optional<Message> BufferedPort::try_read() {
  const std::scoped_lock lock(mutex_);
  return take();
}

void BufferedPort::interrupt() {
  const std::scoped_lock lock(mutex_);
  interrupted_ = true;
}

void BufferedPort::resume() {
  const std::scoped_lock lock(mutex_);
  interrupted_ = false;
}

void BufferedPort::close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  arrived_.notify_all();
}

}  // namespace maide::port
