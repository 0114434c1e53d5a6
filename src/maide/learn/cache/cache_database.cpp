#include "maide/learn/cache/cache_database.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <fstream>
#include <system_error>

#include "maide/base/file.hpp"
#include "maide/base/log.hpp"

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

}  // namespace maide
