#include "maide/learn/cache_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <chrono>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "maide/base/join.hpp"
#include "maide/base/log.hpp"

namespace maide {
namespace {

constexpr const char* application_id = "1298229604";  // the letters "Maid"
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

// From the root on, because SQLite takes names such as ":memory:" for something else than files;
// without symbolic links, because its log stands beside the file itself.
std::string absolute_name(const std::filesystem::path& path) {
  std::error_code failure;
  const std::filesystem::path absolute = std::filesystem::absolute(path, failure);
  if (failure) return path.string();
  const std::filesystem::path canonical = std::filesystem::weakly_canonical(absolute, failure);
  return failure ? absolute.string() : canonical.string();
}

bool may_write(const std::filesystem::path& path) {
  return ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) == 0;
}

// The file, and the folder in which SQLite keeps its log beside it.
bool can_be_written(const std::string& name) {
  return may_write(name) && may_write(std::filesystem::path(name).parent_path());
}

bool has_log(const std::string& name) {
  std::error_code ignored;
  return std::filesystem::exists(name + "-wal", ignored);
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

}  // namespace

// A prepared statement, reset and finalised in time.
class CacheFile::Statement {
 public:
  Statement(const CacheFile& file, const char* sql) : file_(file) {
    if (sqlite3_prepare_v2(file.database_, sql, -1, &statement_, nullptr) != SQLITE_OK) {
      file.fail("read");
    }
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  void bind(int place, std::string_view text) {
    sqlite3_bind_text(statement_, place, text.data(), static_cast<int>(text.size()),
                      SQLITE_TRANSIENT);
  }
  void bind_blob(int place, std::string_view bytes) {
    sqlite3_bind_blob(statement_, place, bytes.data(), static_cast<int>(bytes.size()),
                      SQLITE_TRANSIENT);
  }
  // True while there is a row.
  bool step(const char* doing) {
    const int result = sqlite3_step(statement_);
    if (result == SQLITE_ROW) return true;
    if (result != SQLITE_DONE) file_.fail(doing);
    return false;
  }
  std::string_view column(int place) const {
    const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_, place));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, place));
    return bytes == nullptr ? std::string_view() : std::string_view(bytes, size);
  }

 private:
  const CacheFile& file_;
  sqlite3_stmt* statement_ = nullptr;
};

CacheFile::CacheFile(const std::filesystem::path& path, const Alphabet& inputs,
                     const Fingerprint& fingerprint, const RunControl* wait)
    : path_(path) {
  for (bool is_waiting = false;; is_waiting = true) {
    try {
      open_to_write(true);
      if (is_new()) initialise(inputs, fingerprint);
      read_system();
      expect_system(inputs, fingerprint);
      prepare();
      return;
    } catch (const CacheInUse&) {
      close();
      if (wait == nullptr) throw;
      if (!is_waiting) log_note("waiting for another process to close " + path.string());
    } catch (...) {
      close();
      throw;
    }
    Progress progress;
    progress.phase = "waiting for the cache";
    wait->report(progress);
    wait->check(progress.phase);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

CacheFile::CacheFile(const std::filesystem::path& path) : path_(path) {
  try {
    is_read_only_ = !can_be_written(absolute_name(path));
    if (is_read_only_) {
      open_to_read();
    } else {
      open_to_write(false);
    }
    if (is_new()) throw UsageError(fmt::format("not a cache of Maide ({})", path.string()));
    read_system();
    if (!is_read_only_) prepare();
  } catch (...) {
    close();
    throw;
  }
}

CacheFile::~CacheFile() {
  if (in_transaction_) sqlite3_exec(database_, "COMMIT", nullptr, nullptr, nullptr);
  close();
}

void CacheFile::close() noexcept {
  sqlite3_finalize(insert_word_);
  sqlite3_close(database_);
  insert_word_ = nullptr;
  database_ = nullptr;
}

// SQLite's last error as a line of ours.
void CacheFile::fail(const char* doing) const {
  const int code = sqlite3_errcode(database_) & 0xff;
  const std::string name = path_.string();
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED) {
    throw CacheInUse(fmt::format("the cache is in use by another process ({})", name));
  }
  if (code == SQLITE_NOTADB) throw UsageError(fmt::format("not a cache of Maide ({})", name));
  if (code == SQLITE_CORRUPT) throw UsageError(fmt::format("the cache is damaged ({})", name));
  if (is_read_only_ && code == SQLITE_CANTOPEN && has_log(absolute_name(path_))) {
    throw UsageError(fmt::format(
        "cannot {} the cache: its last run did not close it, and to do so needs permission to "
        "write ({})",
        doing, name));
  }
  const std::string message =
      fmt::format("cannot {} the cache: {} ({})", doing, sqlite3_errmsg(database_), name);
  // The disk is full, or fails: no fault of the arguments.
  if (code == SQLITE_FULL || code == SQLITE_IOERR) throw Error(ExitStatus::inconclusive, message);
  throw UsageError(message);
}

void CacheFile::execute(const char* sql) {
  if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail("write");
}

std::string CacheFile::pragma(const char* name) {
  Statement statement(*this, fmt::format("PRAGMA {}", name).c_str());
  return statement.step("read") ? std::string(statement.column(0)) : std::string();
}

void CacheFile::open_to_write(bool create) {
  const int flags = SQLITE_OPEN_READWRITE | (create ? SQLITE_OPEN_CREATE : 0);
  const std::string name = absolute_name(path_);
  if (sqlite3_open_v2(name.c_str(), &database_, flags, nullptr) != SQLITE_OK) fail("open");
  if (sqlite3_db_readonly(database_, "main") == 1) {
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

// Without locks and shared memory, which need a file that can be written: nobody has the cache open
// if no log stands beside it. With one SQLite may find a way, and else says why not.
void CacheFile::open_to_read() {
  const std::string name = absolute_name(path_);
  const std::string opened = has_log(name) ? name : immutable_uri(name);
  const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
  if (sqlite3_open_v2(opened.c_str(), &database_, flags, nullptr) != SQLITE_OK) fail("open");
  expect_ours();
}

void CacheFile::expect_ours() {
  const std::string id = pragma("application_id");
  if (id != application_id && !(id == "0" && pragma("schema_version") == "0")) {
    throw UsageError(fmt::format("a database, but not a cache of Maide ({})", path_.string()));
  }
}

bool CacheFile::is_new() {
  return pragma("application_id") == "0" && pragma("schema_version") == "0";
}

// Makes what add() needs.
void CacheFile::prepare() {
  if (sqlite3_prepare_v2(database_, "INSERT INTO words(inputs, outputs) VALUES (?, ?)", -1,
                         &insert_word_, nullptr) != SQLITE_OK) {
    fail("read");
  }
}

void CacheFile::initialise(const Alphabet& inputs, const Fingerprint& fingerprint) {
  execute("BEGIN IMMEDIATE");
  execute(fmt::format("PRAGMA application_id = {}", application_id).c_str());
  execute(fmt::format("PRAGMA user_version = {}", format_version).c_str());
  execute("CREATE TABLE fingerprint(name TEXT PRIMARY KEY, value TEXT NOT NULL)");
  execute("CREATE TABLE inputs(id INTEGER PRIMARY KEY, name TEXT NOT NULL)");
  execute("CREATE TABLE outputs(id INTEGER PRIMARY KEY, name TEXT NOT NULL)");
  execute(
      "CREATE TABLE words(id INTEGER PRIMARY KEY, inputs BLOB NOT NULL, outputs BLOB NOT NULL)");
  for (const auto& [name, value] : fingerprint) {
    Statement insert(*this, "INSERT INTO fingerprint VALUES (?, ?)");
    insert.bind(1, name);
    insert.bind(2, value);
    insert.step("write");
  }
  for (const std::string& name : inputs.names()) {
    Statement insert(*this, "INSERT INTO inputs(name) VALUES (?)");
    insert.bind(1, name);
    insert.step("write");
  }
  execute("COMMIT");
}

void CacheFile::read_system() {
  const std::string version = pragma("user_version");
  if (version != format_version) {
    throw UsageError(fmt::format("the cache has format {}, this Maide reads format {} ({})",
                                 version, format_version, path_.string()));
  }
  Statement read_fingerprint(*this, "SELECT name, value FROM fingerprint");
  while (read_fingerprint.step("read")) {
    fingerprint_.emplace(read_fingerprint.column(0), read_fingerprint.column(1));
  }
  Statement read_inputs(*this, "SELECT name FROM inputs ORDER BY id");
  while (read_inputs.step("read")) inputs_.intern(read_inputs.column(0));
  Statement read_outputs(*this, "SELECT name FROM outputs ORDER BY id");
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
  Statement statement(*this, "PRAGMA integrity_check(1)");
  const std::string found(statement.step("read") ? statement.column(0) : "nothing to read");
  return found == "ok" ? "" : found;
}

void CacheFile::for_each(const std::function<void(const Word&, const Word&)>& visit) {
  Statement statement(*this, "SELECT inputs, outputs FROM words ORDER BY id");
  Word inputs, outputs;
  while (statement.step("read")) {
    if (!decode(statement.column(0), inputs_.size(), inputs) ||
        !decode(statement.column(1), outputs_.size(), outputs) || outputs.size() > inputs.size()) {
      throw UsageError(fmt::format("the cache is damaged ({})", path_.string()));
    }
    visit(inputs, outputs);
  }
}

void CacheFile::begin() {
  if (is_read_only_) {
    throw UsageError(fmt::format("cannot write the cache: no permission ({})", path_.string()));
  }
  if (!in_transaction_) execute("BEGIN IMMEDIATE");
  in_transaction_ = true;
}

void CacheFile::add(const Word& inputs, const Word& answer, const Alphabet& names) {
  begin();
  while (outputs_.size() < names.size()) {
    const std::string& name = names.name(static_cast<Symbol>(outputs_.size()));
    Statement insert(*this, "INSERT INTO outputs(name) VALUES (?)");
    insert.bind(1, name);
    insert.step("write");
    outputs_.intern(name);
  }
  const std::string input_bytes = encode(inputs), output_bytes = encode(answer);
  sqlite3_bind_blob(insert_word_, 1, input_bytes.data(), static_cast<int>(input_bytes.size()),
                    SQLITE_STATIC);
  sqlite3_bind_blob(insert_word_, 2, output_bytes.data(), static_cast<int>(output_bytes.size()),
                    SQLITE_STATIC);
  if (sqlite3_step(insert_word_) != SQLITE_DONE) fail("write");
  sqlite3_reset(insert_word_);
}

// No encoded symbol is the beginning of another one, so prefixes of words are those of their bytes.
void CacheFile::remove_contradicting(const Word& inputs, const Word& answer) {
  begin();
  Statement remove(*this,
                   "DELETE FROM words WHERE substr(inputs, 1, length(?1)) = ?1 "
                   "AND substr(outputs, 1, length(?2)) <> ?2");
  remove.bind_blob(1, encode(inputs));
  remove.bind_blob(2, encode(answer));
  remove.step("write");
}

void CacheFile::commit() {
  // After a failure, which was thrown, SQLite may have rolled back by itself.
  if (sqlite3_get_autocommit(database_) != 0) in_transaction_ = false;
  if (!in_transaction_) return;
  execute("COMMIT");
  in_transaction_ = false;
}

}  // namespace maide
