// The cache on disk: a SQLite database of the words that were run and their answers. It is written
// as the run goes, so that a killed run resumes where it was. It belongs to one system: it can be
// opened again only with the same inputs and the same fingerprint (options, versions, translation),
// which the caller gives. One process at a time may write it. Others can wait for it, or look at
// it.
//
// Transactions end with each batch. In WAL mode a kill loses at most the words of the batch in
// flight. All errors are UsageErrors of one line that name the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/run_control.hpp"

struct sqlite3;
struct sqlite3_stmt;
namespace maide {

// The SQLite database that a cache is kept in: how it is opened, by whom, and what its errors say.
// One process at a time writes it, and locks out all others. A process that only looks gets a copy
// of what was committed so far, and disturbs nobody.
//
// The copy is consistent without a lock. In WAL mode a page of the database file changes only by a
// checkpoint, which takes it from the log. The database is copied first, the log behind it.
// Together they make a whole, unless the log began anew in between, which its header would tell
// (SQLite, "Write-Ahead Logging" and "WAL-mode File Format").

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

// What identifies a system: names and values, say {"depth", "3"}.
using Fingerprint = std::map<std::string, std::string>;

class CacheFile {
 public:
  // Opens the file, or makes it. Throws UsageError if it cannot be written, is no cache, or was
  // recorded for another system, naming what differs. While another process has it open: waits as
  // long as `wait` allows, with a note in the log (throws Interrupted); without it throws
  // CacheInUse.
  CacheFile(const std::filesystem::path& path, const Alphabet& inputs,
            const Fingerprint& fingerprint, const RunControl* wait = nullptr);
  // Opens a cache that is there, of whatever system. One that cannot be written, or that another
  // process has open, is only read, as it is now; then add() and remove_if() throw
  // UsageError. Throws as above.
  explicit CacheFile(const std::filesystem::path& path);
  ~CacheFile();
  CacheFile(const CacheFile&) = delete;
  CacheFile& operator=(const CacheFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const Alphabet& inputs() const { return inputs_; }
  // The outputs of the words in the file, as those number them.
  const Alphabet& outputs() const { return outputs_; }
  const Fingerprint& fingerprint() const { return fingerprint_; }

  // Hands over every word and its answer, in the order in which they were added.
  void for_each(const std::function<void(const Word& inputs, const Word& outputs)>& visit);

  // What SQLite finds wrong with the file, in its words; "" for nothing. Reads all of it.
  std::string find_damage();

  // Adds a word and its answer; it is safe after the next commit(). `names` names the outputs; it
  // begins with outputs().
  void add(const Word& inputs, const Word& answer, const Alphabet& names);
  // Removes the words that `is_wrong` accepts, with their answers. Safe after the next commit().
  // O(words in the file).
  void remove_if(const std::function<bool(const Word& inputs, const Word& outputs)>& is_wrong);
  // What was confirmed of the system beside the words, under a name that the caller chooses: in how
  // many words; nothing if it was not. What is added is safe after the next commit().
  std::optional<std::uint64_t> find_confirmed(const std::string& name);
  void add_confirmed(const std::string& name, std::uint64_t words);
  // Ends the transaction that the first add() began; nothing to do is fine.
  void commit();

 private:
  template <typename Visit>
  void for_each_row(const Visit& visit);
  void begin();
  void initialise(const Alphabet& inputs, const Fingerprint& fingerprint);
  void read_system();
  void expect_system(const Alphabet& inputs, const Fingerprint& fingerprint) const;

  std::filesystem::path path_;
  std::optional<CacheDatabase> database_;  // always there behind the constructor
  std::optional<CacheDatabase::Statement> insert_word_;
  Alphabet inputs_, outputs_;
  Fingerprint fingerprint_;
  bool in_transaction_ = false;
};

// What differs between the system of a cache and another one: "depth is '3' there, '4' here; ...";
// "" if they are the same.
std::string describe_differences(const CacheFile& cache, const Alphabet& inputs,
                                 const Fingerprint& fingerprint);

}  // namespace maide
