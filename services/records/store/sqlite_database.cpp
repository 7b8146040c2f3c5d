#include <filesystem>
#include <utility>

#include <fmt/core.h>
#include <sqlite3.h>

#include "services/records/store/database.hpp"

namespace dyncal::inline records {
namespace {

constexpr int patience_ms = 10'000; // with another program that writes

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinishStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Handle = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;

int bind(sqlite3_stmt* statement, int place, const DatabaseValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return sqlite3_bind_int64(statement, place, *integer);
  }
  if (const auto* number = std::get_if<double>(&value)) {
    return sqlite3_bind_double(statement, place, *number);
  }
  if (const auto* text = std::get_if<std::string>(&value)) {
    return sqlite3_bind_text64(statement, place, text->data(), text->size(), SQLITE_TRANSIENT,
                               SQLITE_UTF8);
  }
  return sqlite3_bind_null(statement, place);
}

DatabaseValue column(sqlite3_stmt* statement, int place) {
  switch (sqlite3_column_type(statement, place)) {
  case SQLITE_INTEGER:
    return std::int64_t{sqlite3_column_int64(statement, place)};
  case SQLITE_FLOAT:
    return sqlite3_column_double(statement, place);
  case SQLITE_NULL:
    return std::monostate{};
  default: {
    const void* text = sqlite3_column_blob(statement, place);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, place));
    return text == nullptr ? std::string() : std::string(static_cast<const char*>(text), size);
  }
  }
}

class SqliteDatabase : public Database {
public:
  SqliteDatabase(Handle handle, std::string path)
      : handle_(std::move(handle)), path_(std::move(path)) {}

  using Database::execute;
  Expected<std::vector<DatabaseRow>> execute(const std::string& text,
                                             const std::vector<DatabaseValue>& values) override {
    sqlite3_stmt* raw = nullptr;
    if (sqlite3_prepare_v2(handle_.get(), text.c_str(), -1, &raw, nullptr) != SQLITE_OK) {
      return fail(error());
    }
    const Statement statement(raw);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (bind(statement.get(), static_cast<int>(i) + 1, values[i]) != SQLITE_OK) {
        return fail(error());
      }
    }
    std::vector<DatabaseRow> rows;
    int state = sqlite3_step(statement.get());
    for (; state == SQLITE_ROW; state = sqlite3_step(statement.get())) {
      DatabaseRow& row = rows.emplace_back();
      for (int i = 0; i < sqlite3_column_count(statement.get()); ++i) {
        row.push_back(column(statement.get(), i));
      }
    }
    return state == SQLITE_DONE ? Expected<std::vector<DatabaseRow>>(std::move(rows))
                                : fail(error());
  }

private:
  Expected<void> begin_writing() override {
    const auto begun = execute("BEGIN IMMEDIATE");
    return begun ? Expected<void>{} : fail(begun.error());
  }
  [[nodiscard]] std::vector<std::string>
  append_only_statements(const std::string& table) const override {
    std::vector<std::string> statements;
    for (const char* change : {"UPDATE", "DELETE"}) {
      statements.push_back(fmt::format("CREATE TRIGGER {}_refuses_{} BEFORE {} ON {} BEGIN SELECT "
                                       "RAISE(ABORT, '{} is append-only'); END",
                                       table, change, change, table, table));
    }
    return statements;
  }
  [[nodiscard]] Error error() const {
    return {ErrorCode::bad_file,
            fmt::format("{}: the store cannot be used ({})", path_, sqlite3_errmsg(handle_.get()))};
  }

  Handle handle_;
  std::string path_;
};

} // namespace

Expected<std::unique_ptr<Database>> open_sqlite(const std::string& path) {
  std::error_code ignored; // the file then cannot be opened
  std::filesystem::create_directories(
      std::filesystem::absolute(std::filesystem::path(path)).parent_path(), ignored);
  sqlite3* raw = nullptr;
  const int state =
      sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  Handle handle(raw);
  if (state != SQLITE_OK) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the store cannot be opened ({}); choose another with --store",
                            path, raw == nullptr ? sqlite3_errstr(state) : sqlite3_errmsg(raw)));
  }
  sqlite3_extended_result_codes(raw, 1);
  sqlite3_busy_timeout(raw, patience_ms);
  auto database = std::make_unique<SqliteDatabase>(std::move(handle), path);
  DYNCAL_TRY(database->execute("PRAGMA foreign_keys = ON", {}));
  return database;
}

} // namespace dyncal::inline records
