#include "drivers/files/decimal.hpp"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace dyncal::drivers::files {
namespace {

constexpr std::size_t behind = 128; // so that the quick way is taken

// The value's bits, how far it reaches, and whether it was one.
template <class Number>
struct Reading {
  Number value;
  std::ptrdiff_t length;
  std::errc status;
};

template <class Number>
Reading<Number> by(std::from_chars_result (*read)(const char*, const char*, Number&),
                   const std::string& text) {
  Reading<Number> reading{};
  const auto [end, status] = read(text.data(), text.data() + text.size(), reading.value);
  reading.length = end - text.data();
  reading.status = status;
  return reading;
}

template <class Number>
void expect_as_standard(const std::string& number) {
  const std::string text = number + ',' + std::string(behind, '7');
  const auto quick = by<Number>(&read_number<Number>, text);
  const auto standard = by<Number>([](const char* at, const char* end,
                                      Number& value) { return std::from_chars(at, end, value); },
                                   text);
  ASSERT_EQ(quick.length, standard.length) << number;
  ASSERT_EQ(quick.status, standard.status) << number;
  ASSERT_EQ(std::bit_cast<std::uint64_t>(quick.value), std::bit_cast<std::uint64_t>(standard.value))
      << number;
}

TEST(ReadNumber, TakesEveryFormThatFromCharsTakesAndNoOther) {
  for (const char* number : {"0",
                             "-0",
                             "0.0",
                             "-0.000",
                             "1",
                             "007",
                             "0.1",
                             ".5",
                             "5.",
                             "-.5",
                             "+1",
                             "-",
                             "",
                             ".",
                             "e5",
                             "1e",
                             "1e+",
                             "1.e5",
                             "1e5",
                             "1e-5",
                             "1E-05",
                             "1e-005",
                             "1.5e-320",
                             "1e400",
                             "2.5e+3",
                             "1..2",
                             "1.2.3",
                             "nan",
                             "inf",
                             "-inf",
                             "0x1p3",
                             "1 2",
                             "12345678",
                             "123456789012345678",
                             "9223372036854775807",
                             "9223372036854775808",
                             "18446744073709551615",
                             "18446744073709551616",
                             "00000000000000000000000000000000000001",
                             "1234567890.12345678901234567890",
                             "0.00000000000000000000000000000123",
                             "0.0000000000000000000000000",
                             "1000000000000000000000000",
                             "99999999999999999999",
                             "-9223372036854775808",
                             "9007199254740993",
                             "9007199254740992.5",
                             "9007199254740993.0000000001"}) {
    expect_as_standard<double>(number);
    expect_as_standard<std::int64_t>(number);
    expect_as_standard<std::uint64_t>(number);
  }
}

TEST(ReadNumber, RoundsEveryDecimalExactly) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 400'000; ++i) {
    const auto digits = std::to_string(random() >> (random() % 64));
    const std::size_t point = random() % (digits.size() + 1);
    std::string number = (random() % 2 == 0 ? "-" : "") + digits.substr(0, point) + '.' +
                         std::string(random() % 4, '0') + digits.substr(point);
    if (random() % 3 == 0) {
      number += "e-" + std::to_string(random() % 60);
    }
    expect_as_standard<double>(number);
  }
}

TEST(ReadNumber, RoundsWhatLiesInTheMiddleOfTwoNumbersToEven) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 100'000; ++i) {
    // 54 binary digits, the last one set: with a quarter, a half, or nothing behind them, and one
    // decimal off.
    const std::uint64_t middle =
        (std::uint64_t{1} << 53U) + (random() >> 11U) % (std::uint64_t{1} << 53U) / 2 * 2 + 1;
    expect_as_standard<double>(std::to_string(middle));
    expect_as_standard<double>(std::to_string(middle) + ".000");
    expect_as_standard<double>(std::to_string(middle) + ".001");
    expect_as_standard<double>(std::to_string(middle - 1) + ".999");
    expect_as_standard<double>(std::to_string(middle * 5) + "e-1");
    expect_as_standard<double>(std::to_string(middle / 8 * 5) + "e-3");
  }
}

TEST(ReadNumber, BringsEveryNumberBackFromItsShortestDecimal) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(-40.0, 17.0);
  for (int i = 0; i < 200'000; ++i) {
    const double number =
        std::ldexp(static_cast<double>(random()), -64) * std::pow(10.0, exponent(random));
    char text[64 + behind] = {};
    const auto end = std::to_chars(text, text + 64, number).ptr;
    *end = ';';
    double read = 0.0;
    const auto result = read_number(text, text + sizeof text, read);
    ASSERT_EQ(result.ptr, end) << text;
    ASSERT_EQ(read, number) << text;
  }
}

TEST(ReadNumber, AgreesWithFromCharsOnAnyText) {
  constexpr std::string_view letters = "0123456789012345678900..ee+-, ";
  std::mt19937_64 random(4);
  for (int i = 0; i < 300'000; ++i) {
    std::string text;
    for (std::size_t length = random() % 40; text.size() < length;) {
      text += letters[random() % letters.size()];
    }
    expect_as_standard<double>(text);
    expect_as_standard<std::int64_t>(text);
  }
}

} // namespace
} // namespace dyncal::drivers::files
