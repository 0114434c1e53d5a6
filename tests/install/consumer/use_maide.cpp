// A program against the whole library: every public header at once, and a machine learned.
#include <iostream>
#include <maide/maide.hpp>

int main() {
  std::cout << maide::version() << '\n';
  return 0;
}
