// A file descriptor that is closed with its owner, and a pipe of two.
#pragma once

namespace maide {

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() { reset(); }
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;

  int get() const { return value_; }
  bool is_open() const { return value_ >= 0; }
  void reset();
  // Closes, and returns 0 or the error number: some file systems report a full disk only then.
  int close();

 private:
  int value_ = -1;
};

// Both ends are closed on exec. Throws std::system_error.
struct Pipe {
  Pipe();
  Descriptor read_end, write_end;
};

}  // namespace maide
