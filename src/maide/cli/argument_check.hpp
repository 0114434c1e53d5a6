// What CLI11 leaves to be wished for: suggestions for misspelt options, and errors in our words.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace maide::cli {

// Throws UsageError for the first argument that looks like an option and is none of `app`'s, with
// the nearest name; `hint` ends the message. Looks no further than "--".
void check_option_names(const CLI::App& app, const std::vector<std::string>& arguments,
                        const std::string& hint);

// Throws UsageError for an option that was given with an empty value (a variable of a script that
// is not set), which would pass for one that was not given; `hint` ends the message.
void check_values(const CLI::App& app, const std::string& hint);

// Checks for CLI11's `check()`: empty if the text is one, else what is wrong with it. By itself
// CLI11 takes "-1" for the greatest number there is, and what does not fit for what is nearest.
std::string check_count(const std::string& text);    // a whole number from 0 to 2^64-1
std::string check_jobs(const std::string& text);     // from 1 to most_jobs
std::string check_seconds(const std::string& text);  // from 0.001 to 1e8 (three years)

// The error of CLI11 without its class names and line breaks.
std::string readable_message(const CLI::ParseError& error);

}  // namespace maide::cli
