// What an instrument's answer to a SCPI query means (IEEE 488.2 response data).
//
// Fails: malformed, with the offending answer in the message (its first 60 characters, unprintable
// ones as '?'). Pure functions on text; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/error.hpp"

namespace dyncal::drivers {

// NR1, NR2 or NR3: "12", "+0.5", "-1.0E-3". Not a number, infinite, or followed by anything else:
// malformed.
[[nodiscard]] Expected<double> parse_scpi_number(std::string_view answer);

// "1,2.5,-3E-9": all fields must be numbers.
[[nodiscard]] Expected<std::vector<double>> parse_scpi_numbers(std::string_view answer);

// The answer to :SYSTem:ERRor?: code and text as the instrument gives them, e.g. -113 and
// "Undefined header". Code 0: no error.
struct InstrumentError {
  int code = 0;
  std::string text;
};
[[nodiscard]] Expected<InstrumentError> parse_instrument_error(std::string_view answer);

// The number of digits, 1..9, that a definite-length block (#<d><length of d digits><bytes>)
// announces in its "#d". An indefinite block (#0...) has no length that could be checked and is
// malformed.
[[nodiscard]] Expected<std::size_t> parse_block_digit_count(std::string_view hash_and_digit);
[[nodiscard]] Expected<std::size_t> parse_block_length(std::string_view digits);

// The shortest decimal text that reads back as the same number; never with an exponent, which some
// instruments do not understand.
[[nodiscard]] std::string scpi_decimal(double value);

// The answer to *IDN? (IEEE 488.2 10.14): "maker,model,serial number,firmware", the last two "0"
// where there is none. An answer without its four fields is all maker and model.
struct InstrumentIdentity {
  std::string device; // maker and model
  std::string serial;
  std::string firmware;
};
[[nodiscard]] InstrumentIdentity parse_instrument_identity(std::string_view answer);

// As much of an answer as belongs in a message.
[[nodiscard]] std::string shown(std::string_view answer);

} // namespace dyncal::drivers
