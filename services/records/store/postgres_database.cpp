#include "services/records/store/database.hpp"

#include <fmt/core.h>

#ifdef DYNCAL_HAVE_PQXX
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <thread>

#include <pqxx/pqxx>
#include <sys/socket.h>
#endif

namespace dyncal::inline records {

#ifdef DYNCAL_HAVE_PQXX
namespace {

// Of the programs that write: any number that no other application of the server uses.
constexpr const char* lock_statement = "SELECT pg_advisory_xact_lock(6079466151)";

// A server that is stopped, or whose host has lost its cable, says nothing, and libpq waits for it
// for good. No statement of the store takes a second of a server that works.
constexpr std::chrono::seconds answer_limit{10};
// For each address of the server: `localhost` has two.
constexpr int connect_limit_s = 5;

// Types of columns by their numbers in PostgreSQL's catalogue (pg_type.dat).
constexpr std::array<pqxx::oid, 3> integer_types{20, 21, 23};
constexpr std::array<pqxx::oid, 2> number_types{700, 701};

template <class Types>
bool is_one_of(const Types& types, pqxx::oid type) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

// As text, which the server reads exactly; nothing for NULL.
struct Parameter {
  bool known = false;
  std::string text;
};

Parameter parameter_of(const DatabaseValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return {true, std::to_string(*integer)};
  }
  if (const auto* number = std::get_if<double>(&value)) {
    return {true, fmt::format("{}", *number)};
  }
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? Parameter{true, *text} : Parameter{};
}

DatabaseValue value_of(const pqxx::field& field) {
  if (field.is_null()) {
    return std::monostate{};
  }
  if (is_one_of(integer_types, field.type())) {
    return std::int64_t{std::strtoll(field.c_str(), nullptr, 10)};
  }
  if (is_one_of(number_types, field.type())) {
    return std::strtod(field.c_str(), nullptr);
  }
  return std::string(field.c_str(), field.size());
}

// The place with the limit for connecting, unless it states one.
std::string with_connect_limit(const std::string& place) {
  if (place.find("connect_timeout") != std::string::npos) {
    return place;
  }
  if (place.find("://") == std::string::npos) {
    return fmt::format("{} connect_timeout={}", place, connect_limit_s);
  }
  const std::size_t host = place.rfind('@'); // a password may hold anything
  const bool has_settings = place.find('?', host == std::string::npos ? 0 : host) < place.size();
  return fmt::format("{}{}connect_timeout={}", place, has_settings ? '&' : '?', connect_limit_s);
}

// A limit for waiting at a socket in a library that has none of its own: when it has passed, the
// socket is shut down, and the library finds that its peer has gone.
//
// Made before the call that may wait, and gone after it, while the socket is still open. Throws
// std::system_error where no thread can be made.
class SocketDeadline {
public:
  SocketDeadline(int socket, std::chrono::milliseconds limit)
      : watch_([this, socket, limit](const std::stop_token& stop) {
          std::mutex mutex;
          std::unique_lock lock(mutex);
          std::condition_variable_any ended;
          ended.wait_for(lock, stop, limit, [] { return false; });
          if (!stop.stop_requested()) {
            passed_ = true;
            ::shutdown(socket, SHUT_RDWR);
          }
        }) {}

  [[nodiscard]] bool has_passed() const { return passed_; }

private:
  std::atomic<bool> passed_{false};
  std::jthread watch_; // the last member: it uses the others
};

class PostgresDatabase : public Database {
public:
  PostgresDatabase(std::unique_ptr<pqxx::connection> connection, std::string place)
      : connection_(std::move(connection)), work_(*connection_), place_(std::move(place)) {}

  using Database::execute;
  Expected<std::vector<DatabaseRow>> execute(const std::string& statement,
                                             const std::vector<DatabaseValue>& values) override {
    if (silent_) {
      return fail(no_answer()); // libpqxx would connect once more
    }
    std::optional<SocketDeadline> deadline;
    try {
      deadline.emplace(connection_->sock(), answer_limit);
      const pqxx::result result =
          values.empty() ? work_.exec(statement) : execute_with(statement, values);
      std::vector<DatabaseRow> rows;
      for (const pqxx::row& row : result) {
        DatabaseRow& taken = rows.emplace_back();
        for (const pqxx::field& field : row) {
          taken.push_back(value_of(field));
        }
      }
      return rows;
    } catch (const std::exception& problem) {
      silent_ = deadline && deadline->has_passed();
      return fail(silent_ ? no_answer() : error(problem));
    }
  }

private:
  pqxx::result execute_with(const std::string& statement,
                            const std::vector<DatabaseValue>& values) {
    std::vector<Parameter> parameters;
    std::vector<const char*> texts;
    for (const DatabaseValue& value : values) {
      parameters.push_back(parameter_of(value));
    }
    for (const Parameter& parameter : parameters) {
      texts.push_back(parameter.known ? parameter.text.c_str() : nullptr);
    }
#if PQXX_VERSION_MAJOR >= 7
    pqxx::params given;
    for (const char* text : texts) {
      text == nullptr ? given.append() : given.append(pqxx::zview(text));
    }
    return work_.exec(statement, given);
#else
    return work_.exec_params(statement, pqxx::prepare::make_dynamic_params(texts));
#endif
  }
  Expected<void> begin_writing() override {
    const auto begun = execute("BEGIN", {}).and_then([&](const auto& /*none*/) {
      return execute(lock_statement, {});
    });
    return begun ? Expected<void>{} : fail(begun.error());
  }
  [[nodiscard]] std::vector<std::string>
  append_only_statements(const std::string& table) const override {
    return {fmt::format("CREATE FUNCTION {0}_refuse_change() RETURNS trigger LANGUAGE plpgsql AS "
                        "'BEGIN RAISE EXCEPTION ''{0} is append-only''; END'",
                        table),
            fmt::format("CREATE TRIGGER {0}_refuses_change BEFORE UPDATE OR DELETE ON {0} FOR EACH "
                        "ROW EXECUTE PROCEDURE {0}_refuse_change()",
                        table),
            fmt::format("CREATE TRIGGER {0}_refuses_truncate BEFORE TRUNCATE ON {0} FOR EACH "
                        "STATEMENT EXECUTE PROCEDURE {0}_refuse_change()",
                        table)};
  }
  [[nodiscard]] Error no_answer() const {
    return {ErrorCode::bad_file,
            fmt::format("{}: the store has not answered within {} s; is its server, or the network "
                        "to it, stopped?",
                        without_password(place_), answer_limit.count())};
  }
  [[nodiscard]] Error error(const std::exception& problem) const {
    std::string reason = problem.what();
    for (char& c : reason) {
      c = c == '\n' ? ' ' : c;
    }
    return {ErrorCode::bad_file,
            fmt::format("{}: the store cannot be used ({})", without_password(place_), reason)};
  }

  std::unique_ptr<pqxx::connection> connection_;
  pqxx::nontransaction work_; // BEGIN and COMMIT are statements of Database
  std::string place_;
  bool silent_ = false; // a statement had no answer: the connection is shut down
};

} // namespace

Expected<std::unique_ptr<Database>> open_postgres(const std::string& place) {
  try {
    return std::make_unique<PostgresDatabase>(
        std::make_unique<pqxx::connection>(with_connect_limit(place)), place);
  } catch (const std::exception& problem) {
    std::string reason = problem.what();
    for (char& c : reason) {
      c = c == '\n' ? ' ' : c;
    }
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the store cannot be reached ({}); is the server running, and may "
                            "you use it?",
                            without_password(place), reason));
  }
}

#else

Expected<std::unique_ptr<Database>> open_postgres(const std::string& place) {
  return fail(
      ErrorCode::bad_argument,
      fmt::format("{}: this build has no PostgreSQL (Debian: libpqxx-dev); give --store the "
                  "path of a file",
                  without_password(place)));
}

#endif

} // namespace dyncal::inline records
