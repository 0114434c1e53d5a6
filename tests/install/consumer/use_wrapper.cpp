// A program against what a wrapper needs.
#include <iostream>
#include <maide/base/version.hpp>
#include <maide/wrapper.hpp>

int main() {
  std::cout << maide::version() << '\n';
  return 0;
}
