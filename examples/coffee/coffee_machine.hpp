// A coffee machine: it wants water and a pod, in any order, then the button gives a coffee; after
// that it has to be cleaned. Anything else breaks it for good. From Steffen, Howar & Merten,
// "Introduction to active automata learning from a practical perspective", SFM 2011.
#pragma once

#include <maide/automata/alphabet.hpp>
#include <string>

class CoffeeMachine {
 public:
  maide::Alphabet inputs() const { return {"water", "pod", "button", "clean"}; }

  void reset() { *this = {}; }

  std::string step(const std::string& input) {
    if (is_broken_) return "error";
    if (input == "clean") {
      reset();
      return "ok";
    }
    if (input == "water" && !has_made_coffee_) {
      has_water_ = true;
      return "ok";
    }
    if (input == "pod" && !has_made_coffee_) {
      has_pod_ = true;
      return "ok";
    }
    if (input == "button" && has_water_ && has_pod_ && !has_made_coffee_) {
      has_made_coffee_ = true;
      return "coffee";
    }
    is_broken_ = true;
    return "error";
  }

 private:
  bool has_water_ = false, has_pod_ = false, has_made_coffee_ = false, is_broken_ = false;
};
