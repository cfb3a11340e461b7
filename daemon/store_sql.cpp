#include "daemon/store_sql.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace povslam {
namespace {

constexpr int kBusy_ms = 500;                // how long another program's lock is waited for
constexpr int kMaxRowBytes = 8 << 20;        // longer ones are damage: the most features there can be take 1.2 MB
constexpr int kWalPages = 1000;              // of the log before they are brought into the file
constexpr std::int64_t kWalBytes = 8 << 20;  // what the log is cut back to

// file: address with what SQLite would understand otherwise escaped.
std::string address(const std::filesystem::path& file, const char* parameters) {
  std::string text = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    switch (c) {
      case '%':
        text += "%25";
        break;
      case '?':
        text += "%3f";
        break;
      case '#':
        text += "%23";
        break;
      default:
        text += c;
    }
  }
  return text + parameters;
}

bool is_damage(int code) {
  switch (code & 0xFF) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_FORMAT:
    case SQLITE_ERROR:  // tables or columns that are not there
    case SQLITE_SCHEMA:
    case SQLITE_MISMATCH:
    case SQLITE_TOOBIG:
      return true;
    default:
      return false;
  }
}

const char* remedy(int code) {
  switch (code & 0xFF) {
    case SQLITE_FULL:
      return "free some space on its disk";
    case SQLITE_IOERR:
      return "look at the disk (dmesg), is it full or failing?";
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return "file and folder must be writable by this user";
    case SQLITE_CANTOPEN:
      return "file and folder must be there and belong to this user";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another program holds it";
    default:
      return "try again";
  }
}

int flags_of(SqlMode mode) {
  constexpr int kAlways = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI | SQLITE_OPEN_EXRESCODE;
  switch (mode) {
    case SqlMode::create:
      return kAlways | SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    case SqlMode::read_write:
      return kAlways | SQLITE_OPEN_READWRITE;
    default:
      return kAlways | SQLITE_OPEN_READONLY;
  }
}

}  // namespace

void Database::Close::operator()(sqlite3* handle) const {
  sqlite3_close_v2(handle);
}

Database::Database(const std::filesystem::path& file, SqlMode mode) : file_(file) {
  sqlite3* handle = nullptr;
  const std::string name = address(file, mode == SqlMode::snapshot ? "?immutable=1" : "");
  const int code = sqlite3_open_v2(name.c_str(), &handle, flags_of(mode), nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) fail(code);
  sqlite3_busy_timeout(handle, kBusy_ms);
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kMaxRowBytes);
  // Nothing that stands in a file may make SQLite run code or trust a structure unchecked.
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  fold_log_on_close(false);
  sqlite3_wal_autocheckpoint(handle, kWalPages);
  run("PRAGMA cell_size_check = ON");
  run("PRAGMA synchronous = FULL");
  run("PRAGMA journal_size_limit = " + std::to_string(kWalBytes));
}

Database::~Database() = default;

void Database::fail(int code) const {
  const std::string said = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code);
  const std::string what = file_.string() + ": " + said + " (SQLite " + std::to_string(code) + ")";
  if (is_damage(code)) throw StoreFault{true, what};
  throw StoreFault{false, what + "; " + remedy(code)};
}

void Database::fail_damaged(const std::string& what) const {
  throw StoreFault{true, file_.string() + ": " + what};
}

void Database::run(const std::string& sql) {
  Statement statement(*this, sql);
  while (statement.step()) {
  }
}

std::int64_t Database::number(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.number(0) : 0;
}

std::string Database::text(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.text(0) : "";
}

bool Database::moved() const {
  int gone = 0;
  const int code = sqlite3_file_control(handle(), "main", SQLITE_FCNTL_HAS_MOVED, &gone);
  return code == SQLITE_OK && gone != 0;
}

bool Database::read_only() const {
  return sqlite3_db_readonly(handle(), "main") == 1;
}

namespace {

struct RawFile {
  RawFile(const std::filesystem::path& file, sqlite3_vfs* vfs)
      : name(sqlite3_create_filename(file.c_str(), "", "", 0, nullptr)),
        memory(static_cast<std::size_t>(vfs->szOsFile)) {
    code = vfs->xOpen(vfs, name, get(), SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB, nullptr);
  }
  ~RawFile() {
    if (get()->pMethods != nullptr) get()->pMethods->xClose(get());
    sqlite3_free_filename(name);
  }
  RawFile(const RawFile&) = delete;
  RawFile& operator=(const RawFile&) = delete;
  sqlite3_file* get() { return reinterpret_cast<sqlite3_file*>(memory.data()); }

  sqlite3_filename name;
  std::vector<std::max_align_t> memory;
  int code = SQLITE_OK;
};

}  // namespace

void expect_readable(const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::exists(file, none)) return;
  RawFile raw(file, sqlite3_vfs_find(nullptr));
  sqlite3_int64 size = 0;
  int code = raw.code;
  if (code == SQLITE_OK) code = raw.get()->pMethods->xFileSize(raw.get(), &size);
  std::vector<char> block(1 << 16);
  for (sqlite3_int64 at = 0; code == SQLITE_OK && at < size; at += static_cast<sqlite3_int64>(block.size())) {
    const auto wanted = std::min<sqlite3_int64>(size - at, static_cast<sqlite3_int64>(block.size()));
    code = raw.get()->pMethods->xRead(raw.get(), block.data(), static_cast<int>(wanted), at);
  }
  if (code == SQLITE_OK || code == SQLITE_IOERR_SHORT_READ) return;
  throw StoreFault{false, file.string() + ": cannot be read (SQLite " + std::to_string(code) + "); " + remedy(code)};
}

void Database::fold_log_on_close(bool fold) {
  sqlite3_db_config(handle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, fold ? 0 : 1, nullptr);
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Statement::Statement(const Database& database, const std::string& sql) : database_(database) {
  sqlite3_stmt* statement = nullptr;
  const int code =
      sqlite3_prepare_v2(database.handle(), sql.c_str(), static_cast<int>(sql.size()) + 1, &statement, nullptr);
  statement_.reset(statement);
  if (code != SQLITE_OK) database.fail(code);
}

Statement& Statement::bind(int parameter, std::int64_t value) {
  const int code = sqlite3_bind_int64(statement_.get(), parameter + 1, value);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

Statement& Statement::bind(int parameter, std::span<const std::uint8_t> bytes) {
  const int code =
      sqlite3_bind_blob(statement_.get(), parameter + 1, bytes.data(), static_cast<int>(bytes.size()), nullptr);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  try {
    database_.fail(code);
  } catch (...) {
    reset();  // a statement left half-way would hold its transaction open
    throw;
  }
}

void Statement::run() {
  step();
  reset();
}

void Statement::reset() {
  sqlite3_reset(statement_.get());
}

bool Statement::is_number(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_INTEGER;
}

std::int64_t Statement::number(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

bool Statement::is_bytes(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_BLOB;
}

std::span<const std::uint8_t> Statement::bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  if (data == nullptr && size > 0) database_.fail(SQLITE_NOMEM);
  return {static_cast<const std::uint8_t*>(data), static_cast<std::size_t>(size)};
}

std::string Statement::text(int column) const {
  const auto* data = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return data == nullptr ? "" : data;
}

Transaction::Transaction(Database& database, Kind kind) : database_(database) {
  database_.run(kind == Kind::write ? "BEGIN IMMEDIATE" : "BEGIN");
}

Transaction::~Transaction() {
  // SQLite itself has rolled back after some failures.
  if (open_ && sqlite3_get_autocommit(database_.handle()) == 0) {
    sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  open_ = false;
}

}  // namespace povslam
