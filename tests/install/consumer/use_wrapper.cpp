// A program against what a wrapper needs.
#include <iostream>
#include <maide/automata/alphabet.hpp>
#include <maide/base/version.hpp>

int main() {
  std::cout << maide::version() << '\n';
  return 0;
}
