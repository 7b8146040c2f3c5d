#include "drivers/can/time/wrapping_counter.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers::can {
namespace {

using Step = WrappingCounter::Step;

std::int64_t ms(int k) {
  return 1'000'000LL * k;
}

TEST(WrappingCounter, AReadingBehindTheLastOneIsLate) {
  for (const unsigned bits : {4U, 8U, 16U, 32U, 64U}) {
    for (const double rate_hz : {0.0, 1000.0}) {
      WrappingCounter counter(bits, rate_hz);
      const std::uint64_t mask = bits == 64 ? ~0ULL : (1ULL << bits) - 1;
      std::uint64_t raw = 100;
      for (int k = 0; k < 1000; ++k, ++raw) {
        EXPECT_EQ(counter.read(raw & mask, ms(k)).value, k);
      }
      EXPECT_EQ(counter.read((raw + 1) & mask, ms(1001)).value, 1001);
      const auto late = counter.read(raw & mask, ms(1000));
      EXPECT_EQ(late.step, Step::late) << bits << ", " << rate_hz;
      EXPECT_EQ(late.value, 1000);
      const auto next = counter.read((raw + 2) & mask, ms(1002));
      EXPECT_EQ(next.step, Step::forward);
      EXPECT_EQ(next.value, 1002);
    }
  }
}

TEST(WrappingCounter, LateOnesInARowAreARestart) {
  WrappingCounter counter(16, 1000.0);
  for (int k = 0; k < 30; ++k) {
    counter.read(static_cast<std::uint64_t>(k), ms(k));
  }
  int restarts = 0;
  for (int k = 0; k < 20; ++k) {
    const auto reading = counter.read(static_cast<std::uint64_t>(k), ms(2030 + k));
    restarts += reading.step == Step::restarted ? 1 : 0;
    EXPECT_EQ(reading.step == Step::late, k < 7);
  }
  EXPECT_EQ(restarts, 1);
}

TEST(WrappingCounter, ALongPauseIsNeitherLateNorARestart) {
  WrappingCounter counter(8, 1000.0);
  counter.read(10, ms(0));
  EXPECT_EQ(counter.read(9, ms(255)).value, 255);
  EXPECT_EQ(counter.read(8, ms(255 + 511)).value, 255 + 511);
}

} // namespace
} // namespace dyncal::drivers::can
