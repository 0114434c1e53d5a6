#include "maide/base/terminal.hpp"

#include <sys/ioctl.h>

#include <cctype>
#include <cstdlib>
#include <string>

namespace maide {

std::optional<std::size_t> terminal_width(int descriptor) {
  constexpr std::size_t narrowest = 20;  // less is no answer
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col < narrowest) return std::nullopt;
  return size.ws_col;
}

bool is_utf8_locale() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    std::string locale;
    for (const char* c = value; *c != '\0'; ++c) {
      if (*c != '-') locale += static_cast<char>(std::tolower(static_cast<unsigned char>(*c)));
    }
    return locale.find("utf8") != std::string::npos;
  }
  return false;
}

}  // namespace maide
