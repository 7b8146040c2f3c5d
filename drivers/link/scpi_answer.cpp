#include "drivers/link/scpi_answer.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "analysis/base/text.hpp"

namespace dyncal::drivers {
namespace {

tl::unexpected<Error> malformed(std::string message) {
  return fail(ErrorCode::malformed, std::move(message));
}

} // namespace

Expected<double> parse_scpi_number(std::string_view answer) {
  std::string_view text = trimmed(answer);
  if (text.starts_with('+')) { // from_chars reads no plus sign
    text.remove_prefix(1);
  }
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value) ||
      text.starts_with('+')) {
    return malformed("'" + shown(answer) + "' is not a number");
  }
  return value;
}

Expected<std::vector<double>> parse_scpi_numbers(std::string_view answer) {
  std::vector<double> numbers;
  for (std::string_view rest = answer;;) {
    const std::size_t comma = rest.find(',');
    const auto number = parse_scpi_number(rest.substr(0, comma));
    if (!number) {
      return malformed("'" + shown(answer) + "' is not a list of numbers");
    }
    numbers.push_back(*number);
    if (comma == std::string_view::npos) {
      return numbers;
    }
    rest.remove_prefix(comma + 1);
  }
}

Expected<InstrumentError> parse_instrument_error(std::string_view answer) {
  std::string_view text = trimmed(answer);
  if (text.starts_with('+')) {
    text.remove_prefix(1);
  }
  InstrumentError error;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), error.code);
  std::string_view rest = text.substr(static_cast<std::size_t>(end - text.data()));
  if (status != std::errc() || (!rest.empty() && !rest.starts_with(','))) {
    return malformed("'" + shown(answer) + "' is not an answer to :SYSTem:ERRor?");
  }
  if (!rest.empty()) {
    rest = trimmed(rest.substr(1));
  }
  if (rest.size() >= 2 && rest.front() == '"' && rest.back() == '"') {
    rest = rest.substr(1, rest.size() - 2);
  }
  error.text = shown(rest);
  return error;
}

Expected<std::size_t> parse_block_digit_count(std::string_view hash_and_digit) {
  if (hash_and_digit.size() != 2 || hash_and_digit[0] != '#' || hash_and_digit[1] < '1' ||
      hash_and_digit[1] > '9') {
    return malformed("'" + shown(hash_and_digit) + "' does not begin a block of definite length");
  }
  return static_cast<std::size_t>(hash_and_digit[1] - '0');
}

Expected<std::size_t> parse_block_length(std::string_view digits) {
  std::size_t length = 0;
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), length);
  if (digits.empty() || status != std::errc() || end != digits.data() + digits.size()) {
    return malformed("'" + shown(digits) + "' is not the length of a block");
  }
  return length;
}

std::string scpi_decimal(double value) {
  char text[400]; // the longest finite double in fixed notation has 327 characters
  const auto [end, status] =
      std::to_chars(text, text + sizeof(text), value, std::chars_format::fixed);
  return status == std::errc() ? std::string(text, end) : std::string("0");
}

InstrumentIdentity parse_instrument_identity(std::string_view answer) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= answer.size();) {
    const std::size_t end = std::min(answer.find(',', begin), answer.size());
    const std::string_view field = answer.substr(begin, end - begin);
    const std::size_t first = std::min(field.find_first_not_of(" \t\r\n"), field.size());
    const std::size_t last = field.find_last_not_of(" \t\r\n");
    fields.emplace_back(first < field.size() ? field.substr(first, last - first + 1) : "");
    begin = end + 1;
  }
  if (fields.size() != 4) {
    return {std::string(answer), "", ""};
  }
  const auto known = [](const std::string& text) { return text == "0" ? "" : text; };
  return {fields[0] + " " + fields[1], known(fields[2]), known(fields[3])};
}

std::string shown(std::string_view answer) {
  constexpr std::size_t max_shown = 60;
  std::string text(answer.substr(0, max_shown));
  for (char& character : text) {
    if (character < ' ' || character > '~') {
      character = '?';
    }
  }
  return answer.size() > max_shown ? text + "..." : text;
}

} // namespace dyncal::drivers
