// The SQLite database that a cache is kept in: how it is opened, by whom, and what its errors say.
// One process at a time writes it, and locks out all others. A process that only looks gets a copy
// of what was committed so far, and disturbs nobody.
//
// The copy is consistent without a lock. In WAL mode a page of the database file changes only by a
// checkpoint, which takes it from the log. The database is copied first, the log behind it.
// Together they make a whole, unless the log began anew in between, which its header would tell
// (SQLite, "Write-Ahead Logging" and "WAL-mode File Format").
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace maide {

// Another process has the cache open.
class CacheInUse : public UsageError {
 public:
  using UsageError::UsageError;
};

class CacheDatabase {
 public:
  enum class Access {
    create,    // to write; makes it if it is not there. Throws CacheInUse
    existing,  // to write if that may be and nobody else does, else as it is now, to read
  };
  // Throws UsageError, of one line that names the file, if it cannot be opened so or is of another
  // program.
  CacheDatabase(const std::filesystem::path& path, Access access);

  bool is_new();  // no cache yet: nothing is in it
  // Marks a new one as ours.
  void claim();
  // Throws UsageError if it was opened to read.
  void expect_writable() const;
  bool is_read_only() const { return !why_read_only_.empty(); }

  void execute(const char* sql);
  std::string pragma(const std::string& text);  // the first column of its answer
  // Whether a transaction is open; SQLite may have rolled it back after a failure.
  bool in_transaction() const;

  // SQLite's last error as a line of ours: a full disk is inconclusive, all others are UsageErrors.
  [[noreturn]] void fail(const char* doing) const;

  // A prepared statement; ends before its database does.
  class Statement {
   public:
    Statement(CacheDatabase& database, const char* sql);
    void bind(int place, std::string_view text);
    void bind_blob(int place, std::string_view bytes);
    // True while there is a row.
    bool step(const char* doing);
    void reset();  // to be stepped again
    std::string_view column(int place) const;

   private:
    struct Finalize {
      void operator()(sqlite3_stmt* statement) const;
    };
    CacheDatabase& database_;
    std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  };

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };

  void open(const std::string& name, int flags);
  void open_to_write(bool create);
  void open_to_read();
  void open_copy();
  void expect_ours();

  std::filesystem::path path_;
  std::optional<TempDir> copy_;  // where the copy is, if it is one
  std::string why_read_only_;    // "": it can be written
  std::unique_ptr<sqlite3, Close> database_;
};

}  // namespace maide
