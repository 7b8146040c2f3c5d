#include "drivers/smartup/sample_numbering.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers::smartup {
namespace {

constexpr std::int64_t start_ns = 1'600'000'000'000'000'000;
constexpr std::int64_t period_ns = 1'000'000;

std::int64_t stamp(std::int64_t n) {
  return start_ns + n * period_ns;
}

TEST(SampleNumbering, CountsOnFromTheFirstNumberItSees) {
  SampleNumbering numbering;
  EXPECT_EQ(numbering.place(5001, stamp(0)).sample, 5001U);
  const auto place = numbering.place(5002, stamp(1));
  EXPECT_EQ(place.arrival, Arrival::next);
  EXPECT_EQ(place.sample, 5002U);
}

TEST(SampleNumbering, CountsWhatIsMissing) {
  SampleNumbering numbering;
  (void)numbering.place(10, stamp(10));
  const auto place = numbering.place(14, stamp(14));
  EXPECT_EQ(place.arrival, Arrival::after_gap);
  EXPECT_EQ(place.missing, 3U);
  EXPECT_EQ(place.sample, 14U);
}

TEST(SampleNumbering, GoesOnWhenTheNumberWraps) {
  SampleNumbering numbering;
  (void)numbering.place(UINT32_MAX - 1, stamp(0));
  EXPECT_EQ(numbering.place(UINT32_MAX, stamp(1)).sample, UINT32_MAX);
  const auto wrapped = numbering.place(0, stamp(2));
  EXPECT_EQ(wrapped.arrival, Arrival::next);
  EXPECT_EQ(wrapped.sample, std::uint64_t{1} << 32U);
  const auto gap = numbering.place(3, stamp(5));
  EXPECT_EQ(gap.arrival, Arrival::after_gap);
  EXPECT_EQ(gap.missing, 2U);
  EXPECT_EQ(gap.sample, (std::uint64_t{1} << 32U) + 3);
}

TEST(SampleNumbering, RecognisesDuplicates) {
  SampleNumbering numbering;
  for (std::uint32_t n = 1; n <= 100; ++n) {
    (void)numbering.place(n, stamp(n));
  }
  for (std::uint32_t n = 89; n <= 100; ++n) {
    EXPECT_EQ(numbering.place(n, stamp(n)).arrival, Arrival::duplicate);
  }
  EXPECT_EQ(numbering.place(101, stamp(101)).arrival, Arrival::next);
}

TEST(SampleNumbering, WhatComesAfterItsPlaceWasPassedIsLate) {
  SampleNumbering numbering;
  (void)numbering.place(10, stamp(10));
  (void)numbering.place(14, stamp(14));
  EXPECT_EQ(numbering.place(12, stamp(12)).arrival, Arrival::late);
  EXPECT_EQ(numbering.place(15, stamp(15)).arrival, Arrival::next);
}

TEST(SampleNumbering, RestartsWhenTheSensorIsInitialisedAgain) {
  SampleNumbering numbering;
  for (std::uint32_t n = 1; n <= 1000; ++n) {
    (void)numbering.place(n, stamp(n));
  }
  const auto place = numbering.place(1, stamp(31000));
  EXPECT_EQ(place.arrival, Arrival::restart);
  EXPECT_EQ(place.sample, 1U);
  EXPECT_EQ(numbering.place(2, stamp(31001)).arrival, Arrival::next);
}

TEST(SampleNumbering, RestartsThoughTheFirstNumbersWereLost) {
  SampleNumbering numbering;
  for (std::uint32_t n = 1; n <= 1000; ++n) {
    (void)numbering.place(n, stamp(n));
  }
  EXPECT_EQ(numbering.place(25, stamp(31000)).arrival, Arrival::restart);
  // a number that the history knew with another stamp
  EXPECT_EQ(numbering.place(25, stamp(31000)).arrival, Arrival::duplicate);
  EXPECT_EQ(numbering.place(26, stamp(31001)).sample, 26U);
}

TEST(SampleNumbering, RestartsBeyondHalfOfTheRangeToo) {
  SampleNumbering numbering;
  (void)numbering.place(3'000'000'000U, stamp(0));
  EXPECT_EQ(numbering.place(1, stamp(1000)).arrival, Arrival::restart);
}

TEST(SampleNumbering, RestartsWithoutUsableStampsOnceNumbersContinue) {
  SampleNumbering numbering;
  for (std::uint32_t n = 1; n <= 1000; ++n) {
    (void)numbering.place(n, stamp(n));
  }
  std::uint32_t n = 30; // the unit has lost its fix: time begins at zero
  int stale = 0;
  while (numbering.place(n, n).arrival == Arrival::stale && stale < 100) {
    ++stale;
    ++n;
  }
  EXPECT_EQ(stale, 16);
  EXPECT_EQ(numbering.place(n + 1, n + 1).arrival, Arrival::next);
}

TEST(SampleNumbering, ADatagramFromBeforeTheRestartIsStale) {
  SampleNumbering numbering;
  for (std::uint32_t n = 1; n <= 5000; ++n) {
    (void)numbering.place(n, stamp(n));
  }
  (void)numbering.place(1, stamp(31000));
  for (std::uint32_t n = 4990; n <= 5000; ++n) {
    EXPECT_EQ(numbering.place(n, stamp(n)).arrival, Arrival::stale);
  }
  EXPECT_EQ(numbering.place(2, stamp(31001)).arrival, Arrival::next);
}

TEST(SampleNumbering, AGapIsBelievedThoughItsStampIsASecondEarly) {
  SampleNumbering numbering;
  (void)numbering.place(2000, stamp(2000));
  EXPECT_EQ(numbering.place(2100, stamp(2100) - 1'000'000'000).arrival, Arrival::after_gap);
}

TEST(SampleNumbering, ASkippedNumberIsNotMissing) {
  SampleNumbering numbering;
  (void)numbering.place(1, stamp(1));
  EXPECT_TRUE(numbering.skip(2));
  EXPECT_FALSE(numbering.skip(9));
  const auto place = numbering.place(3, stamp(3));
  EXPECT_EQ(place.arrival, Arrival::next);
  EXPECT_EQ(place.sample, 3U);
}

} // namespace
} // namespace dyncal::drivers::smartup
