#include "services/records/store/database.hpp"

#include <limits>
#include <regex>

namespace dyncal::inline records {

Expected<void> Database::transaction(const std::function<Expected<void>()>& write) {
  DYNCAL_TRY(begin_writing());
  if (auto written = write(); !written) {
    static_cast<void>(execute("ROLLBACK")); // the error of the write is what counts
    return written;
  }
  if (const auto committed = execute("COMMIT"); !committed) {
    static_cast<void>(execute("ROLLBACK"));
    return fail(committed.error());
  }
  return {};
}

Expected<void> Database::make_append_only(const std::string& table) {
  for (const std::string& statement : append_only_statements(table)) {
    DYNCAL_TRY(execute(statement));
  }
  return {};
}

bool is_server(const std::string& place) {
  return place.starts_with("postgresql://") || place.starts_with("postgres://") ||
         place.find("dbname=") != std::string::npos;
}

std::string without_password(const std::string& place) {
  static const std::regex in_address("(postgres(?:ql)?://[^:/@]*):.*@");
  static const std::regex in_words("password *= *('[^']*'|[^ ]*)");
  return std::regex_replace(std::regex_replace(place, in_address, "$1@"), in_words, "password=...");
}

std::string text_of(const DatabaseValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : std::string();
}

std::int64_t integer_of(const DatabaseValue& value) {
  const auto* integer = std::get_if<std::int64_t>(&value);
  return integer != nullptr ? *integer : 0;
}

double number_of(const DatabaseValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return static_cast<double>(*integer);
  }
  const auto* number = std::get_if<double>(&value);
  return number != nullptr ? *number : std::numeric_limits<double>::quiet_NaN();
}

} // namespace dyncal::inline records
