#include "drivers/link/scpi_answer.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers {
namespace {

TEST(ScpiAnswer, NumbersAreReadInEveryFormThatIEEE488Allows) {
  EXPECT_EQ(parse_scpi_number("12").value(), 12.0);
  EXPECT_EQ(parse_scpi_number("+0.5").value(), 0.5);
  EXPECT_EQ(parse_scpi_number(" -1.000000E-03\r").value(), -1e-3);
}

TEST(ScpiAnswer, WhatIsNoNumberIsRefused) {
  for (const char* text : {"", "+", "++1", "1,2", "ON", "1.0V", "nan", "inf", "9.9E37X"}) {
    EXPECT_FALSE(parse_scpi_number(text).has_value()) << text;
  }
}

TEST(ScpiAnswer, AListNeedsANumberInEveryField) {
  EXPECT_EQ(parse_scpi_numbers("1,2.5,-3E-9").value(), (std::vector<double>{1.0, 2.5, -3e-9}));
  EXPECT_FALSE(parse_scpi_numbers("1,,2").has_value());
  EXPECT_FALSE(parse_scpi_numbers("").has_value());
}

TEST(ScpiAnswer, AnInstrumentErrorKeepsItsCodeAndWords) {
  const auto error = parse_instrument_error("-113,\"Undefined header; keyword cannot be found\"");
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->code, -113);
  EXPECT_EQ(error->text, "Undefined header; keyword cannot be found");
  EXPECT_EQ(parse_instrument_error("+0,\"No error\"")->code, 0);
  EXPECT_EQ(parse_instrument_error("0")->code, 0);
  EXPECT_FALSE(parse_instrument_error("RIGOL TECHNOLOGIES,MSO5072").has_value());
  EXPECT_FALSE(parse_instrument_error("0.000000e+00").has_value());
}

TEST(ScpiAnswer, AnIdentityHasItsFourFields) {
  const auto known = parse_instrument_identity("RIGOL TECHNOLOGIES,MSO5072, MS5A1 ,00.01.03\n");
  EXPECT_EQ(known.device, "RIGOL TECHNOLOGIES MSO5072");
  EXPECT_EQ(known.serial, "MS5A1");
  EXPECT_EQ(known.firmware, "00.01.03");
  const auto without = parse_instrument_identity("maker,model,0,0");
  EXPECT_EQ(without.serial, "");
  EXPECT_EQ(without.firmware, "");
  const auto other = parse_instrument_identity("an old scope");
  EXPECT_EQ(other.device, "an old scope");
  EXPECT_EQ(other.serial, "");
}

TEST(ScpiAnswer, OnlyBlocksOfDefiniteLengthAreBlocks) {
  EXPECT_EQ(parse_block_digit_count("#9").value(), 9U);
  EXPECT_FALSE(parse_block_digit_count("#0").has_value());
  EXPECT_FALSE(parse_block_digit_count("1.").has_value());
  EXPECT_EQ(parse_block_length("000001000").value(), 1000U);
  EXPECT_FALSE(parse_block_length("00000x000").has_value());
  EXPECT_FALSE(parse_block_length("-00000001").has_value());
}

TEST(ScpiAnswer, DecimalsHaveNoExponentAndReadBackTheSame) {
  EXPECT_EQ(scpi_decimal(2e-9), "0.000000002");
  EXPECT_EQ(scpi_decimal(-0.25), "-0.25");
  EXPECT_EQ(scpi_decimal(1e6), "1000000");
}

TEST(ScpiAnswer, AMessageShowsNoControlCharacters) {
  EXPECT_EQ(shown(std::string("a\0b\x80", 4)), "a?b?");
  EXPECT_EQ(shown(std::string(100, 'x')), std::string(60, 'x') + "...");
}

} // namespace
} // namespace dyncal::drivers
