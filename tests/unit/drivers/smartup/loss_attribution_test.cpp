#include "drivers/smartup/loss_attribution.hpp"

#include <map>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::drivers::smartup {
namespace {

constexpr std::size_t message_bytes = 75;

// A unit whose sensors take turns; datagrams are filled with twelve messages.
class SimulatedUnit {
public:
  explicit SimulatedUnit(std::vector<std::uint32_t> turns) : turns_(std::move(turns)) {}

  // The next sample of the unit; lost inside it or sent.
  void sample(bool lost_inside = false) {
    const std::uint32_t sensor = turns_[next_++ % turns_.size()];
    const std::uint64_t number = ++numbers_[sensor];
    if (lost_inside) {
      return;
    }
    datagram_.push_back({sensor, number});
    if (datagram_.size() == 12) {
      ship();
    }
  }

  void samples(int count) {
    for (int i = 0; i < count; ++i) {
      sample();
    }
  }

  void lose_next_datagram() { losing_ = true; }

  std::uint64_t in_unit = 0;
  std::uint64_t on_way = 0;
  LossAttribution losses;

private:
  void ship() {
    if (!std::exchange(losing_, false)) {
      losses.begin(datagram_.size() * message_bytes);
      for (const auto& [sensor, number] : datagram_) {
        const std::uint64_t last = std::exchange(last_[sensor], number);
        losses.message(sensor, last == 0 ? 0 : number - last - 1, message_bytes);
      }
      for (const auto& loss : losses.end()) {
        in_unit += loss.in_unit;
        on_way += loss.on_way;
      }
    }
    datagram_.clear();
  }

  std::vector<std::uint32_t> turns_;
  std::size_t next_ = 0;
  std::map<std::uint32_t, std::uint64_t> numbers_;
  std::map<std::uint32_t, std::uint64_t> last_;
  std::vector<std::pair<std::uint32_t, std::uint64_t>> datagram_;
  bool losing_ = false;
};

TEST(LossAttribution, ALostDatagramOfSeveralSensorsWasLostOnTheWay) {
  SimulatedUnit unit({1, 2, 3, 4});
  unit.samples(24 * 12);
  unit.lose_next_datagram();
  unit.samples(4 * 12);
  EXPECT_EQ(unit.on_way, 12U);
  EXPECT_EQ(unit.in_unit, 0U);
  EXPECT_EQ(unit.losses.datagrams_lost(), 1U);
}

TEST(LossAttribution, ALostDatagramOfASingleSensorWasLostOnTheWay) {
  SimulatedUnit unit({1});
  unit.samples(24 * 12);
  unit.lose_next_datagram();
  unit.samples(24);
  EXPECT_EQ(unit.on_way, 12U);
  EXPECT_EQ(unit.in_unit, 0U);
}

TEST(LossAttribution, AGapInTheMiddleOfADatagramWasLostInTheUnit) {
  SimulatedUnit unit({1, 2});
  unit.samples(24 * 12 + 5);
  unit.sample(true);
  unit.samples(30);
  EXPECT_EQ(unit.in_unit, 1U);
  EXPECT_EQ(unit.on_way, 0U);
}

TEST(LossAttribution, ASmallGapBetweenDatagramsWasLostInTheUnit) {
  SimulatedUnit unit({1, 2});
  unit.samples(24 * 12);
  unit.sample(true); // the first of the next datagram
  unit.samples(30);
  EXPECT_EQ(unit.in_unit, 1U);
  EXPECT_EQ(unit.on_way, 0U);
}

TEST(LossAttribution, ALargeGapOfOneSensorWhileTheOthersGoOnWasLostInTheUnit) {
  SimulatedUnit unit({1, 2, 3, 4});
  unit.samples(24 * 12);
  for (int i = 0; i < 20 * 4; ++i) {
    unit.sample(i % 4 == 0); // sensor 1 loses twenty samples in a row
  }
  unit.samples(5 * 12);
  EXPECT_EQ(unit.in_unit, 20U);
  EXPECT_EQ(unit.on_way, 0U);
}

TEST(LossAttribution, ASlowSensorNoticesLaterThatItsSampleWasInTheLostDatagram) {
  std::vector<std::uint32_t> turns(50, 1);
  turns[3] = 2; // one sample of sensor 2 in fifty
  SimulatedUnit unit(turns);
  unit.samples(
      50 *
      12); // fifty whole datagrams and twelve rounds: the next datagram holds a sample of sensor 2
  unit.lose_next_datagram();
  unit.samples(50 * 3);
  EXPECT_EQ(unit.on_way, 12U);
  EXPECT_EQ(unit.in_unit, 0U);
}

TEST(LossAttribution, SeveralDatagramsInARowAreCounted) {
  SimulatedUnit unit({1, 2, 3});
  unit.samples(24 * 12);
  for (int i = 0; i < 3; ++i) {
    unit.lose_next_datagram();
    unit.samples(12);
  }
  unit.samples(24);
  EXPECT_EQ(unit.on_way, 36U);
  EXPECT_EQ(unit.losses.datagrams_lost(), 3U);
}

} // namespace
} // namespace dyncal::drivers::smartup
