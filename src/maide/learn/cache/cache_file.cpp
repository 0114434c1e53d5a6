#include "maide/learn/cache/cache_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/log.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;

constexpr const char* application_id = "1298229604";  // the letters "Maid"
// A log begins anew with each 4 MB or so; who writes faster than a file is copied is rare.
constexpr int most_copies = 20;

// From the root on, because SQLite takes names such as ":memory:" for something else than files;
// without symbolic links, because its log stands beside the file itself.
std::string absolute_name(const fs::path& path) {
  std::error_code failure;
  const fs::path absolute = fs::absolute(path, failure);
  if (failure) return path.string();
  const fs::path canonical = fs::weakly_canonical(absolute, failure);
  return failure ? absolute.string() : canonical.string();
}

bool may_write(const fs::path& path) {
  return ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) == 0;
}

// The file, and the folder in which SQLite keeps its log beside it.
bool can_be_written(const std::string& name) {
  return may_write(name) && may_write(fs::path(name).parent_path());
}

std::string log_of(const std::string& name) { return name + "-wal"; }

bool has_log(const std::string& name) {
  std::error_code ignored;
  return fs::exists(log_of(name), ignored);
}

// Another one from each beginning of the log on; "" if there is none.
std::string log_header(const std::string& name) {
  std::string header(32, '\0');
  std::ifstream log(log_of(name), std::ios::binary);
  log.read(header.data(), std::ssize(header));
  header.resize(static_cast<std::size_t>(log.gcount()));
  return header;
}

// A file that nobody changes, as SQLite writes that.
std::string immutable_uri(const std::string& name) {
  std::string uri = "file://";
  for (const char c : name) {
    if (c == '%' || c == '?' || c == '#') {
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

// To a file that can be written, whatever the other's permissions are.
void copy_file(const std::string& from, const std::string& to) {
  std::error_code failure;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, failure);
  if (!failure) fs::permissions(to, fs::perms::owner_read | fs::perms::owner_write, failure);
  if (!failure) return;
  throw_write_failure(
      fmt::format("cannot copy the cache to read it: {} ({})", failure.message(), from),
      failure.value());
}

// The database and, if there is one, its log; that may go away meanwhile, if the writer ends.
void copy_with_log(const std::string& from, const std::string& to) {
  std::error_code ignored;
  copy_file(from, to);
  fs::remove(log_of(to), ignored);
  try {
    if (has_log(from)) copy_file(log_of(from), log_of(to));
  } catch (const Error&) {
    if (has_log(from)) throw;
  }
}

}  // namespace

void CacheDatabase::Close::operator()(sqlite3* database) const { sqlite3_close(database); }

CacheDatabase::CacheDatabase(const fs::path& path, Access access) : path_(path) {
  if (access == Access::create) {
    open_to_write(true);
  } else if (!can_be_written(absolute_name(path))) {
    open_to_read();
  } else {
    try {
      open_to_write(false);
    } catch (const CacheInUse&) {
      log_note(fmt::format("another process uses this cache; what it held just now is read ({})",
                           path.string()));
      why_read_only_ = "another process uses it";
      open_copy();
    }
  }
}

void CacheDatabase::fail(const char* doing) const {
  const int code = sqlite3_errcode(database_.get()) & 0xff;
  const std::string name = path_.string();
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED) {
    throw CacheInUse(fmt::format("the cache is in use by another process ({})", name));
  }
  if (code == SQLITE_NOTADB) throw UsageError(fmt::format("not a cache of Maide ({})", name));
  if (code == SQLITE_CORRUPT) throw UsageError(fmt::format("the cache is damaged ({})", name));
  const std::string message =
      fmt::format("cannot {} the cache: {} ({})", doing, sqlite3_errmsg(database_.get()), name);
  // The disk is full, or fails: no fault of the arguments.
  if (code == SQLITE_FULL || code == SQLITE_IOERR) throw Error(ExitStatus::inconclusive, message);
  throw UsageError(message);
}

void CacheDatabase::open(const std::string& name, int flags) {
  sqlite3* database = nullptr;
  const int result = sqlite3_open_v2(name.c_str(), &database, flags, nullptr);
  database_.reset(database);  // it says what failed, too
  if (result != SQLITE_OK) fail("open");
}

void CacheDatabase::open_to_write(bool create) {
  open(absolute_name(path_), SQLITE_OPEN_READWRITE | (create ? SQLITE_OPEN_CREATE : 0));
  if (sqlite3_db_readonly(database_.get(), "main") == 1) {
    throw UsageError(fmt::format("cannot write the cache: no permission ({})", path_.string()));
  }
  // An exclusive lock from the first access on: two runs must not write one cache. With it, WAL
  // needs no shared memory and works on network file systems.
  execute("PRAGMA locking_mode = EXCLUSIVE");
  // Asked before anything is written, so a file that is not ours stays as it is.
  expect_ours();
  execute("PRAGMA journal_mode = WAL");
  execute("PRAGMA synchronous = NORMAL");
  execute("BEGIN EXCLUSIVE");
  execute("COMMIT");
}

// Nobody has it open, or what does is not to be disturbed: without locks and shared memory, which
// need a file that can be written. A log beside it holds words, too.
void CacheDatabase::open_to_read() {
  why_read_only_ = "no permission";
  const std::string name = absolute_name(path_);
  if (has_log(name)) return open_copy();
  open(immutable_uri(name), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
  expect_ours();
}

void CacheDatabase::open_copy() {
  database_.reset();
  copy_.emplace("maide-cache-");
  const std::string name = absolute_name(path_), copy = (copy_->path() / "cache").string();
  for (int attempt = 0; attempt < most_copies; ++attempt) {
    const std::string header = log_header(name);
    copy_with_log(name, copy);
    if (log_header(name) != header) continue;
    open(copy, SQLITE_OPEN_READWRITE);
    expect_ours();
    return;
  }
  throw CacheInUse(
      fmt::format("the cache is in use by another process, which writes faster than it can be "
                  "copied ({})",
                  path_.string()));
}

bool CacheDatabase::is_new() {
  return pragma("application_id") == "0" && pragma("schema_version") == "0";
}

void CacheDatabase::expect_ours() {
  if (pragma("application_id") == application_id || is_new()) return;
  throw UsageError(fmt::format("a database, but not a cache of Maide ({})", path_.string()));
}

void CacheDatabase::claim() {
  execute(fmt::format("PRAGMA application_id = {}", application_id).c_str());
}

void CacheDatabase::expect_writable() const {
  if (!is_read_only()) return;
  throw UsageError(fmt::format("cannot write the cache: {} ({})", why_read_only_, path_.string()));
}

void CacheDatabase::execute(const char* sql) {
  if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail("write");
}

std::string CacheDatabase::pragma(const std::string& text) {
  Statement statement(*this, ("PRAGMA " + text).c_str());
  return statement.step("read") ? std::string(statement.column(0)) : std::string();
}

bool CacheDatabase::in_transaction() const { return sqlite3_get_autocommit(database_.get()) == 0; }

void CacheDatabase::Statement::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

CacheDatabase::Statement::Statement(CacheDatabase& database, const char* sql)
    : database_(database) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database.database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) {
    database.fail("read");
  }
  statement_.reset(statement);
}

void CacheDatabase::Statement::bind(int place, std::string_view text) {
  sqlite3_bind_text(statement_.get(), place, text.data(), static_cast<int>(text.size()),
                    SQLITE_TRANSIENT);
}

void CacheDatabase::Statement::bind_blob(int place, std::string_view bytes) {
  sqlite3_bind_blob(statement_.get(), place, bytes.data(), static_cast<int>(bytes.size()),
                    SQLITE_TRANSIENT);
}

bool CacheDatabase::Statement::step(const char* doing) {
  const int result = sqlite3_step(statement_.get());
  if (result == SQLITE_ROW) return true;
  if (result != SQLITE_DONE) database_.fail(doing);
  return false;
}

void CacheDatabase::Statement::reset() { sqlite3_reset(statement_.get()); }

std::string_view CacheDatabase::Statement::column(int place) const {
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_.get(), place));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), place));
  return bytes == nullptr ? std::string_view() : std::string_view(bytes, size);
}

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
