// Numbers as std::from_chars reads them, bit for bit and with the same end, several times as fast
// for what instruments write: up to 19 digits, values below 1e19 in size with up to 54 decimals.
// Everything else is left to std::from_chars.
//
// A decimal w 10^q with q <= 0 is w 5^q 2^q. 5^q is known to 128 bits (rounded down), so the
// product with w is known to within two units of its 128th bit. Whatever the truth between these
// two is, it is rounded to the same 53 bits, unless the product lies that close to the middle of
// two numbers: then std::from_chars decides. So every number is rounded exactly. No state; any
// thread.
#pragma once

#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace dyncal::drivers::files {

namespace decimal {

__extension__ using Wide = unsigned __int128;

inline constexpr int max_decimals =
    54; // 5^54 is below 2^126: its remainder can be doubled in 128 bits
inline constexpr int max_digits = 19;              // hold in 64 bits
inline constexpr std::ptrdiff_t taken_digits = 24; // at most, in one go
inline constexpr std::ptrdiff_t room =
    3 * taken_digits + 16; // bytes read at most from the first one of a number on

struct ReciprocalPower {
  std::uint64_t high = 0; // of floor(2^shift / 5^k), which has 128 bits
  std::uint64_t low = 0;
  int shift = 0;
};

constexpr std::array<ReciprocalPower, max_decimals + 1> reciprocal_powers_of_five() {
  std::array<ReciprocalPower, max_decimals + 1> powers;
  Wide five_to_k = 1;
  for (int k = 0; k <= max_decimals; ++k, five_to_k *= 5) {
    int shift = 127;
    for (Wide rest = k == 0 ? 0 : five_to_k; rest != 0; rest >>= 1U) {
      ++shift;
    }
    Wide quotient = 0;
    Wide remainder = 1; // the leading digit of 2^shift; long division follows with its zeros
    for (int bit = 0; bit <= shift; ++bit) {
      quotient <<= 1U;
      if (remainder >= five_to_k) {
        remainder -= five_to_k;
        quotient |= 1U;
      }
      remainder <<= 1U;
    }
    powers[static_cast<std::size_t>(k)] = {static_cast<std::uint64_t>(quotient >> 64U),
                                           static_cast<std::uint64_t>(quotient), shift};
  }
  return powers;
}

inline constexpr auto reciprocals = reciprocal_powers_of_five();
inline constexpr std::array<std::uint64_t, 9> powers_of_ten{
    1, 10, 100, 1'000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000};

// Eight bytes of text as the digits' values, for as many as are digits.
inline std::uint64_t eight_bytes(const char* at) {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, at, sizeof(bytes));
  return bytes ^ 0x3030303030303030;
}

// With how many digits they begin. A carry only reaches bytes behind the first one that is none.
inline unsigned leading_digits(std::uint64_t bytes) {
  const std::uint64_t others = ((bytes + 0x7676767676767676) | bytes) & 0x8080808080808080;
  return static_cast<unsigned>(std::countr_zero(others)) / 8U;
}

// The first `count` of eight bytes appended to `number`, modulo 2^64. Neighbours are added side by
// side: 8 of 1, 4 of 2, 2 of 4 digits.
inline std::uint64_t appended(std::uint64_t number, std::uint64_t bytes, unsigned count) {
  const unsigned half_of_rest = 4U * (8U - count); // a shift by all 64 bits must be made of two
  bytes = bytes << half_of_rest << half_of_rest;
  bytes = (bytes * 10 + (bytes >> 8U)) & 0x00FF00FF00FF00FF;
  bytes = (bytes * 100 + (bytes >> 16U)) & 0x0000FFFF0000FFFF;
  bytes = (bytes * 10'000 + (bytes >> 32U)) & 0x00000000FFFFFFFF;
  return number * powers_of_ten[count] + bytes;
}

// Digits from `at` on, appended to `number` modulo 2^64; at most `taken_digits`.
inline const char* read_digits(const char* at, std::uint64_t& number) {
  for (std::ptrdiff_t words = 0; words < taken_digits / 8; ++words) {
    const std::uint64_t bytes = eight_bytes(at);
    const unsigned count = leading_digits(bytes);
    number = appended(number, bytes, count);
    at += count;
    if (count < 8) {
      break;
    }
  }
  return at;
}

// w 10^-decimals, rounded to nearest. False: too close to the middle of two numbers to be told.
// REQUIRES: w > 0
inline bool scaled_down(std::uint64_t w, int decimals, double& value) {
  const ReciprocalPower& power = reciprocals[static_cast<std::size_t>(decimals)];
  const int leading = std::countl_zero(w);
  w <<= static_cast<unsigned>(leading);
  const auto below = static_cast<std::uint64_t>((static_cast<Wide>(w) * power.low) >> 64U);
  const Wide product =
      static_cast<Wide>(w) * power.high + below; // the truth is in [product, product + 2)
  const auto high = static_cast<std::uint64_t>(product >> 64U);
  const auto low = static_cast<std::uint64_t>(product);
  const auto dropped =
      10U + static_cast<unsigned>(high >> 63U); // of the bits of `high`, and all of `low`
  if (low + 1 <= 1) {
    const std::uint64_t half = std::uint64_t{1} << (dropped - 1);
    const std::uint64_t rest = high & (2 * half - 1);
    if (low == 0 ? rest == half : rest == half - 1) {
      return false;
    }
  }
  const auto digits = static_cast<std::int64_t>((high >> dropped) + (high >> (dropped - 1) & 1U));
  const int exponent = static_cast<int>(dropped) - decimals - leading - power.shift + 128;
  const auto power_of_two =
      std::bit_cast<double>(static_cast<std::uint64_t>(1023 + exponent) << 52U);
  value = static_cast<double>(digits) * power_of_two; // both factors and the product are exact
  return true;
}

// "e-5" and the like; leaves `at` and `exponent` alone where there is none. False: more digits than
// two.
inline bool read_exponent(const char*& at, int& exponent) {
  if (*at != 'e' && *at != 'E') {
    return true;
  }
  const char* c = at + 1;
  const bool negative = *c == '-';
  c += negative || *c == '+' ? 1 : 0;
  std::uint64_t digits = 0;
  const char* const end = read_digits(c, digits);
  if (end == c || end - c > 2) {
    return false;
  }
  exponent = negative ? -static_cast<int>(digits) : static_cast<int>(digits);
  at = end;
  return true;
}

// A decimal as it is written: w 10^-decimals.
struct Decimal {
  std::uint64_t w = 0;
  int decimals = 0;
};

// Digits with a point among the second to the eighth byte; null: something else. The point is taken
// out of the first word of digits, then three words are read without a jump that depends on the
// number of digits: it varies as it pleases, and a jump that was guessed wrong costs more than the
// work that it saves.
inline const char* read_with_point(const char* at, Decimal& decimal) {
  const std::uint64_t bytes = eight_bytes(at);
  const unsigned point = leading_digits(bytes);
  if (point == 0 || point == 8 || at[point] != '.') {
    return nullptr;
  }
  const std::uint64_t before = (std::uint64_t{1} << (8U * point)) - 1;
  const std::uint64_t first = (bytes & before) | (eight_bytes(at + 1) & ~before);
  const std::uint64_t second = eight_bytes(at + 9);
  const std::uint64_t third = eight_bytes(at + 17);
  const unsigned in_first = leading_digits(first);
  const unsigned in_second = in_first == 8 ? leading_digits(second) : 0;
  const unsigned in_third = in_second == 8 ? leading_digits(third) : 0;
  const unsigned digits = in_first + in_second + in_third;
  const unsigned zeros = static_cast<unsigned>(std::countr_zero(first)) / 8U; // leading ones
  if (digits == point || in_third == 8 || digits > max_digits + zeros) {
    return nullptr;
  }
  decimal.w = appended(appended(appended(0, first, in_first), second, in_second), third, in_third);
  decimal.decimals = static_cast<int>(digits - point);
  return at + digits + 1;
}

inline const char* read_without_point(const char* at, Decimal& decimal) {
  const char* const end = read_digits(at, decimal.w);
  return end == at || end - at > max_digits || *end == '.' ? nullptr : end;
}

// Null: not one of the numbers for which this is made. REQUIRES: `room` bytes at `at`.
inline const char* read_quickly(const char* at, double& value) {
  const bool negative = *at == '-';
  at += negative ? 1 : 0;
  Decimal decimal;
  const char* end = read_with_point(at, decimal);
  if (end == nullptr && (end = read_without_point(at, decimal)) == nullptr) {
    return nullptr;
  }
  int exponent = 0;
  if (!read_exponent(end, exponent)) {
    return nullptr;
  }
  const int scale = decimal.decimals - exponent;
  double size = 0.0;
  if (decimal.w != 0 &&
      (scale < 0 || scale > max_decimals || !scaled_down(decimal.w, scale, size))) {
    return nullptr;
  }
  value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(size) |
                                (negative ? std::uint64_t{1} << 63U : 0));
  return end;
}

inline const char* read_quickly(const char* at, std::uint64_t& value) {
  std::uint64_t number = 0;
  const char* const end = read_digits(at, number);
  if (end == at || end - at > max_digits) {
    return nullptr;
  }
  value = number;
  return end;
}

inline const char* read_quickly(const char* at, std::int64_t& value) {
  std::uint64_t size = 0;
  const char* const end = read_quickly(at, size);
  if (end == nullptr ||
      size > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
    return nullptr;
  }
  value = static_cast<std::int64_t>(size);
  return end;
}

} // namespace decimal

// As std::from_chars(at, end, value), for double, int64 and uint64.
template <class Number>
std::from_chars_result read_number(const char* at, const char* end, Number& value) {
  if constexpr (std::endian::native == std::endian::little) {
    if (end - at >= decimal::room) {
      if (const char* const next = decimal::read_quickly(at, value)) {
        return {next, std::errc()};
      }
    }
  }
  return std::from_chars(at, end, value);
}

} // namespace dyncal::drivers::files
