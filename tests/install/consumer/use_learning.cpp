// A program that learns, against the library for learning alone.
#include <iostream>
#include <maide/learn.hpp>
#include <string>
#include <variant>

// A counter to three. With two and with three it answers alike: three states.
class Counter {
 public:
  maide::Alphabet inputs() const { return {"count", "clear"}; }
  void reset() { count_ = 0; }
  std::string step(const std::string& input) {
    if (input == "clear") count_ = 0;
    if (input == "count" && count_ < 3) ++count_;
    return std::to_string(count_);
  }

 private:
  int count_ = 0;
};

int main() {
  Counter counter;
  const maide::Learned learned = maide::learn_machine(counter);
  const auto& model = std::get<maide::Mealy>(learned.model.value());
  std::cout << model.size() << " states, " << learned.strength << '\n';
  return model.size() == 3 ? 0 : 1;
}
