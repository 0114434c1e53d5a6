#include "maide/learn/cache/cache_file.hpp"

#include <fmt/format.h>

#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/base/log.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

using Statement = CacheDatabase::Statement;

constexpr const char* format_version = "1";

// Symbols as LEB128 numbers, one after the other.
std::string encode(const Word& word) {
  std::string bytes;
  for (Symbol symbol : word) {
    for (; symbol >= 0x80; symbol >>= 7) bytes.push_back(static_cast<char>(symbol | 0x80));
    bytes.push_back(static_cast<char>(symbol));
  }
  return bytes;
}

// False if the bytes are no symbols below `limit`.
bool decode(std::string_view bytes, std::size_t limit, Word& word) {
  word.clear();
  std::uint64_t symbol = 0;
  unsigned shift = 0;
  for (const char byte : bytes) {
    symbol |= std::uint64_t{static_cast<unsigned char>(byte) & 0x7fu} << shift;
    if ((static_cast<unsigned char>(byte) & 0x80) != 0) {
      shift += 7;
      if (shift > 28) return false;
      continue;
    }
    if (symbol >= limit) return false;
    word.push_back(static_cast<Symbol>(symbol));
    symbol = 0;
    shift = 0;
  }
  return shift == 0;
}

// For checks: symbols come back out of their bytes.
[[maybe_unused]] bool comes_back(const Word& word) {
  Word again;
  return decode(encode(word), ~std::size_t{0}, again) && again == word;
}

// What is not the same "there" (in the file) and "here"; "" if nothing.
std::string describe_differences(const Fingerprint& there, const Fingerprint& here) {
  std::vector<std::string> differences;
  for (const auto& [name, value] : there) {
    const auto found = here.find(name);
    if (found == here.end()) {
      differences.push_back(fmt::format("{} is '{}' there, not set here", name, value));
    } else if (found->second != value) {
      differences.push_back(fmt::format("{} is '{}' there, '{}' here", name, value, found->second));
    }
  }
  for (const auto& [name, value] : here) {
    if (there.contains(name)) continue;
    differences.push_back(fmt::format("{} is not set there, '{}' here", name, value));
  }
  return join(differences, "; ");
}

}  // namespace

CacheFile::CacheFile(const std::filesystem::path& path, const Alphabet& inputs,
                     const Fingerprint& fingerprint, const RunControl* wait)
    : path_(path) {
  for (bool is_waiting = false;; is_waiting = true) {
    try {
      database_.emplace(path, CacheDatabase::Access::create);
      break;
    } catch (const CacheInUse&) {
      if (wait == nullptr) throw;
      if (!is_waiting) log_note("waiting for another process to close " + path.string());
    }
    Progress progress;
    progress.phase = "waiting for the cache";
    wait->report(progress);
    wait->check(progress.phase);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  if (database_->is_new()) initialise(inputs, fingerprint);
  read_system();
  expect_system(inputs, fingerprint);
}

CacheFile::CacheFile(const std::filesystem::path& path) : path_(path) {
  database_.emplace(path, CacheDatabase::Access::existing);
  if (database_->is_new())
    throw UsageError(fmt::format("not a cache of Maide ({})", path.string()));
  read_system();
}

CacheFile::~CacheFile() {
  try {
    commit();
  } catch (const Error&) {  // what was not committed before is not promised
  }
}

void CacheFile::initialise(const Alphabet& inputs, const Fingerprint& fingerprint) {
  database_->execute("BEGIN IMMEDIATE");
  database_->claim();
  database_->execute(fmt::format("PRAGMA user_version = {}", format_version).c_str());
  database_->execute("CREATE TABLE fingerprint(name TEXT PRIMARY KEY, value TEXT NOT NULL)");
  database_->execute("CREATE TABLE inputs(id INTEGER PRIMARY KEY, name TEXT NOT NULL)");
  database_->execute("CREATE TABLE outputs(id INTEGER PRIMARY KEY, name TEXT NOT NULL)");
  database_->execute(
      "CREATE TABLE words(id INTEGER PRIMARY KEY, inputs BLOB NOT NULL, outputs BLOB NOT NULL)");
  for (const auto& [name, value] : fingerprint) {
    Statement insert(*database_, "INSERT INTO fingerprint VALUES (?, ?)");
    insert.bind(1, name);
    insert.bind(2, value);
    insert.step("write");
  }
  for (const std::string& name : inputs.names()) {
    Statement insert(*database_, "INSERT INTO inputs(name) VALUES (?)");
    insert.bind(1, name);
    insert.step("write");
  }
  database_->execute("COMMIT");
}

void CacheFile::read_system() {
  const std::string version = database_->pragma("user_version");
  if (version != format_version) {
    throw UsageError(fmt::format("the cache has format {}, this Maide reads format {} ({})",
                                 version, format_version, path_.string()));
  }
  Statement read_fingerprint(*database_, "SELECT name, value FROM fingerprint");
  while (read_fingerprint.step("read")) {
    fingerprint_.emplace(read_fingerprint.column(0), read_fingerprint.column(1));
  }
  Statement read_inputs(*database_, "SELECT name FROM inputs ORDER BY id");
  while (read_inputs.step("read")) inputs_.intern(read_inputs.column(0));
  Statement read_outputs(*database_, "SELECT name FROM outputs ORDER BY id");
  while (read_outputs.step("read")) outputs_.intern(read_outputs.column(0));
}

void CacheFile::expect_system(const Alphabet& inputs, const Fingerprint& fingerprint) const {
  const std::string differences = describe_differences(*this, inputs, fingerprint);
  if (differences.empty()) return;
  throw UsageError(fmt::format("the cache was recorded for another system: {} ({})", differences,
                               path_.string()));
}

std::string describe_differences(const CacheFile& cache, const Alphabet& inputs,
                                 const Fingerprint& fingerprint) {
  Fingerprint there = cache.fingerprint(), here = fingerprint;
  there["the inputs"] = join(cache.inputs().names(), ",");
  here["the inputs"] = join(inputs.names(), ",");
  return describe_differences(there, here);
}

std::string CacheFile::find_damage() {
  Statement statement(*database_, "PRAGMA integrity_check(1)");
  const std::string found(statement.step("read") ? statement.column(0) : "nothing to read");
  return found == "ok" ? "" : found;
}

void CacheFile::for_each(const std::function<void(const Word&, const Word&)>& visit) {
  for_each_row(
      [&](std::string_view, const Word& inputs, const Word& outputs) { visit(inputs, outputs); });
}

template <typename Visit>
void CacheFile::for_each_row(const Visit& visit) {
  Statement statement(*database_, "SELECT id, inputs, outputs FROM words ORDER BY id");
  Word inputs, outputs;
  while (statement.step("read")) {
    if (!decode(statement.column(1), inputs_.size(), inputs) ||
        !decode(statement.column(2), outputs_.size(), outputs) || outputs.size() > inputs.size()) {
      throw UsageError(fmt::format("the cache is damaged ({})", path_.string()));
    }
    visit(statement.column(0), inputs, outputs);
  }
}

void CacheFile::begin() {
  database_->expect_writable();
  if (!in_transaction_) database_->execute("BEGIN IMMEDIATE");
  in_transaction_ = true;
}

void CacheFile::add(const Word& inputs, const Word& answer, const Alphabet& names) {
  begin();
  while (outputs_.size() < names.size()) {
    const std::string& name = names.name(static_cast<Symbol>(outputs_.size()));
    Statement insert(*database_, "INSERT INTO outputs(name) VALUES (?)");
    insert.bind(1, name);
    insert.step("write");
    outputs_.intern(name);
  }
  MAIDE_CHECK(outputs_.size() == 0 ||
              outputs_.names().back() == names.name(static_cast<Symbol>(outputs_.size() - 1)));
  MAIDE_CHECK(answer.size() <= inputs.size() && comes_back(inputs) && comes_back(answer));
  if (!insert_word_) {
    insert_word_.emplace(*database_, "INSERT INTO words(inputs, outputs) VALUES (?, ?)");
  }
  insert_word_->bind_blob(1, encode(inputs));
  insert_word_->bind_blob(2, encode(answer));
  insert_word_->step("write");
  insert_word_->reset();
}

void CacheFile::remove_if(const std::function<bool(const Word&, const Word&)>& is_wrong) {
  begin();
  std::vector<std::string> wrong;
  for_each_row([&](std::string_view id, const Word& inputs, const Word& outputs) {
    if (is_wrong(inputs, outputs)) wrong.emplace_back(id);
  });
  Statement remove(*database_, "DELETE FROM words WHERE id = ?");
  for (const std::string& id : wrong) {
    remove.bind(1, id);
    remove.step("write");
    remove.reset();
  }
}

// The table is made when it is needed first: caches without it are of the same format.
std::optional<std::uint64_t> CacheFile::find_confirmed(const std::string& name) {
  Statement find_table(*database_, "SELECT name FROM sqlite_master WHERE name = 'confirmed'");
  if (!find_table.step("read")) return std::nullopt;
  Statement find_row(*database_, "SELECT words FROM confirmed WHERE name = ?");
  find_row.bind(1, name);
  if (!find_row.step("read")) return std::nullopt;
  return parse_number<std::uint64_t>(find_row.column(0));
}

void CacheFile::add_confirmed(const std::string& name, std::uint64_t words) {
  begin();
  database_->execute(
      "CREATE TABLE IF NOT EXISTS confirmed(name TEXT PRIMARY KEY, words TEXT NOT NULL)");
  Statement insert(*database_, "INSERT OR REPLACE INTO confirmed VALUES (?, ?)");
  insert.bind(1, name);
  insert.bind(2, std::to_string(words));
  insert.step("write");
}

void CacheFile::commit() {
  // After a failure, which was thrown, SQLite may have rolled back by itself.
  if (!database_->in_transaction()) in_transaction_ = false;
  if (!in_transaction_) return;
  database_->execute("COMMIT");
  in_transaction_ = false;
}

}  // namespace maide
