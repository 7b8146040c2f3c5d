// Reads the names, numbers and strings of a DBC file one after the other, and knows its line.
//
// Every reader skips white space first, and comments from // to the end of a line, and leaves its
// place unchanged when something else than expected follows. White space separates; line ends
// matter to same_line() and where a statement without ';' ends.
//
// One thread; the text must outlive it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace dyncal::drivers::can {

class DbcScanner {
public:
  explicit DbcScanner(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end();
  [[nodiscard]] std::size_t line() const {
    return line_;
  } // of the next character that was not read, from 1
  // Whether what comes next stands in the line in which the last thing ended.
  [[nodiscard]] bool same_line();
  [[nodiscard]] bool next_is(char character);
  [[nodiscard]] bool next_begins_statement();

  bool character(char wanted);
  // Letters, digits and whatever else names hold: all but white space and the signs of the grammar.
  std::optional<std::string> name();
  std::optional<std::uint64_t> unsigned_integer();
  // Decimal with optional sign, fraction and exponent; not infinite.
  std::optional<double> number();
  // The same where no limit may be written as well: beyond the range of a double (1.8E+308, E+481),
  // inf, nan, 1.#INF. These give an infinite value.
  std::optional<double> limit();
  // Between double quotes, over line ends; \" is a quote within it.
  std::optional<std::string> string();

  enum class StatementEnd { semicolon, next_statement, file };
  // To behind the next ';' outside strings, to the next line that begins a statement, or to the
  // end.
  StatementEnd skip_statement();
  void skip_line();
  // The line in which a string begins that does not end, or that ends in the middle of another
  // statement: a quotation mark is missing, and what lies behind it cannot be trusted.
  [[nodiscard]] std::optional<std::size_t> broken_string() const { return broken_string_; }

  struct Place {
    std::size_t at;
    std::size_t line;
    std::size_t last_line;
  };
  [[nodiscard]] Place place() const { return {at_, line_, last_line_}; }
  void go_back(Place place);

  // What stands next, for messages: at most a dozen characters.
  [[nodiscard]] std::string next_text();

private:
  void skip_space();
  [[nodiscard]] bool statement_begins_at(std::size_t at) const;

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  std::size_t last_line_ = 1; // in which the last thing that was read ended
  std::optional<std::size_t> broken_string_;
};

} // namespace dyncal::drivers::can
