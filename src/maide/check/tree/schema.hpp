// The keys of a system file, in one table: what may stand where, its values, what holds without it,
// and a line of help. The reader checks files with it, messages name keys from it, and the tables
// of docs/systems.md are made from it.
//
//   "models/*/when_weak"   word   inconclusive|accept   fits `models: {via: {when_weak: accept}}`,
//                                                       and `models: {when_weak: accept}` does not
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace maide {

// What stands behind a key.
enum class FieldKind : std::uint8_t {
  entries,    // a map, whose keys are names that the file gives
  map,        // a map with the keys that the table has
  word,       // one of `values`
  text,       // any text
  texts,      // one, or a list of them
  number,     // an expression over constants, or one of `values`
  timer,      // such an expression, perhaps behind `once`
  options,    // a map of any keys and texts
  name,       // of a program, a node, a service, an executor
  names,      // one of these, or a list of them
  program,    // statements
  procedure,  // statements, perhaps none
  callback,   // statements
  variables,  // declarations
  taken,      // "image.read -> message"
  formula,
};

// How the keys of a map of entries are read.
enum class NameKind : std::uint8_t {
  plain,      // as it stands
  declared,   // "fork[i in 0..4]"
  head,       // "send(m, n)"
  reference,  // "image", "fork[2]": what stands elsewhere in the file
  output,     // "message(var x)"
};

struct Key {
  std::string_view path;    // `*` is the name of an entry
  std::string_view what;    // in messages, before its name: "model"; "" of a key with a fixed name
  std::string_view values;  // of a word: "stop|wait|drop"; of a number what may stand in its place
  std::string_view standard;  // what holds without it; "" if nothing does, or it must be there
  std::string_view help;
  FieldKind kind;
  NameKind names = NameKind::plain;  // of a map of entries
};

std::span<const Key> system_keys();

// What may stand there, in the order of the table: some keys take a text or a map. Empty: there is
// no such key. O(keys).
std::vector<const Key*> keys_at(std::string_view path);
// The names of the keys below that path, in the order of the table.
std::vector<std::string> keys_below(std::string_view path);
// "stop", "wait", "drop".
std::vector<std::string> values_of(const Key& key);

// A table of Markdown with the keys below that path: key, what stands there, without it, help.
std::string write_key_table(std::string_view path);

}  // namespace maide
