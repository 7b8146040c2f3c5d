// A database as the store uses it: statements with numbered parameters ($1, $2, ...), values, and
// transactions of one writer at a time.
//
// Two adapters: sqlite_database (a file) and postgres_database (a server). The SQL is the same for
// both: types TEXT, BIGINT, DOUBLE PRECISION, no generated keys, every parameter once and in order.
// Doubles come back with the same bits. Fails (bad_file) with place, reason and what to do. Belongs
// to one thread; programs that share a database wait for each other, for 10 s at most: that long a
// server may take for a statement, too, and then is not asked again (connecting: 5 s an address).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::inline records {

using DatabaseValue = std::variant<std::monostate, std::int64_t, double, std::string>;
using DatabaseRow = std::vector<DatabaseValue>;

class Database {
public:
  Database() = default;
  virtual ~Database() = default;
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // The rows of one statement; none of one that has no rows.
  [[nodiscard]] virtual Expected<std::vector<DatabaseRow>>
  execute(const std::string& statement, const std::vector<DatabaseValue>& values) = 0;
  [[nodiscard]] Expected<std::vector<DatabaseRow>> execute(const std::string& statement) {
    return execute(statement, {});
  }
  // All that `write` does, or nothing of it where it fails or the program dies. One writer at a
  // time.
  [[nodiscard]] Expected<void> transaction(const std::function<Expected<void>()>& write);
  // From now on the table refuses every change of a row and every removal. In a transaction.
  [[nodiscard]] Expected<void> make_append_only(const std::string& table);

private:
  [[nodiscard]] virtual std::vector<std::string>
  append_only_statements(const std::string& table) const = 0;
  virtual Expected<void> begin_writing() = 0;
};

// "postgresql://USER@HOST/NAME", "postgres://..." or "host=... dbname=..." is a server, everything
// else the path of a file.
[[nodiscard]] bool is_server(const std::string& place);
// The same without a password, for messages.
[[nodiscard]] std::string without_password(const std::string& place);

// Makes the file if there is none.
[[nodiscard]] Expected<std::unique_ptr<Database>> open_sqlite(const std::string& path);
// Fails (bad_argument) in a build without libpqxx.
[[nodiscard]] Expected<std::unique_ptr<Database>> open_postgres(const std::string& place);

// What a row holds; "", 0 and a quiet NaN in place of NULL.
[[nodiscard]] std::string text_of(const DatabaseValue& value);
[[nodiscard]] std::int64_t integer_of(const DatabaseValue& value);
[[nodiscard]] double number_of(const DatabaseValue& value);

} // namespace dyncal::inline records
