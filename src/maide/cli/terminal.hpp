// What the terminal gets: colours, lines that fit its width, and tables of two columns. A pipe or a
// file gets plain text, and lines as long as they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace maide::cli {

// ---- Colours ----
//
// The environment variable NO_COLOR, with any value but "", means none (no-color.org), and so does
// TERM=dumb. `--color always` and `--color never` are stronger than both.

enum class ColorMode : std::uint8_t { automatic, always, never };

// What a text means to its reader.
enum class Tone : std::uint8_t {
  plain,
  good,      // green: it holds, they agree
  bad,       // red: violated, they differ, an error
  doubtful,  // yellow: inconclusive, weak
  heading,   // bold
};

// Sets when this process uses colours; at first ColorMode::automatic.
void set_color_mode(ColorMode mode);

// The text in the colour of its tone, where the stream behind the descriptor gets colours; line
// breaks at the end stay behind it. Control characters of the text itself become '?'.
std::string paint(std::string_view text, Tone tone, int descriptor);

// ---- Width ----

// The columns for help: those of the terminal behind standard output, from 40 to 80; 80 without
// one.
std::size_t help_width();

// Lines that are longer are broken at blanks. What follows stands below the line's text: behind the
// label, if the line begins with one and two blanks or more. Tables and pictures that fit stay as
// they are.
std::string wrap_lines(std::string_view text, std::size_t width);

// ---- Tables ----

// A name and what it is about.
using TextRow = std::pair<std::string, std::string>;

// The names in a column of at most `most` characters, each text beside or below its name.
std::string two_columns(const std::vector<TextRow>& rows, std::size_t width, std::size_t most);

}  // namespace maide::cli
