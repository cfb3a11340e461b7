// SQLite in the few forms the store needs. SQLite's door, with store*. Failures are thrown as StoreFault and caught by
// MapStore's public functions, nowhere else.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace povslam {

struct StoreFault {
  bool damage = false;  // the content cannot be what was written; else the world: disk, permissions, other programs
  std::string message;  // names the file and the remedy
};

enum class SqlMode {
  read_write,  // the file must exist
  create,      // and must not
  read_only,   // beside a writer
  snapshot,    // a file that nobody writes, in a folder that may be read-only
};

class Database {
 public:
  Database(const std::filesystem::path& file, SqlMode mode);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const std::string& sql);  // any rows are ignored
  std::int64_t number(const std::string& sql);
  std::string text(const std::string& sql);
  bool moved() const;  // the file was removed or renamed since it was opened
  bool read_only() const;
  // Whether closing brings the log into the file. Not unless told: a file that turns out damaged stays as it was found.
  void fold_log_on_close(bool fold);

  const std::filesystem::path& file() const { return file_; }
  sqlite3* handle() const { return handle_.get(); }
  [[noreturn]] void fail(int code) const;                         // code: SQLite's
  [[noreturn]] void fail_damaged(const std::string& what) const;  // the content is not what was written

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> handle_;
};

// Reads every byte of a file the way SQLite does. Throws (never as damage) when the disk does not give them: what
// SQLite says about the content of such a file means nothing.
void expect_readable(const std::filesystem::path& file);

// Prepared once, run often. Columns and parameters count from 0.
class Statement {
 public:
  Statement(const Database& database, const std::string& sql);

  Statement& bind(int parameter, std::int64_t value);
  Statement& bind(int parameter, std::span<const std::uint8_t> bytes);  // must live until the statement has run
  bool step();                                                          // true: a row is there
  void run();                                                           // no row is expected; ready to run again
  void reset();

  bool is_number(int column) const;
  std::int64_t number(int column) const;
  bool is_bytes(int column) const;
  std::span<const std::uint8_t> bytes(int column) const;  // until the next step
  std::string text(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  const Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

// Everything or nothing: rolled back unless committed.
class Transaction {
 public:
  enum class Kind { read, write };
  Transaction(Database& database, Kind kind);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace povslam
