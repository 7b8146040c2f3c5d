// What the reference shows of an exciter that goes on, and what looks like it: a drawn bench whose
// reference is played; no real time passes.
#include "services/programs/guard/reference_watch.hpp"

#include <functional>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;
using Phase = ReferenceWatch::Phase;

constexpr double rate_hz = 2000.0;
constexpr double level_m_s2 = 20.0;
constexpr double turn = 2.0 * std::numbers::pi;

class ReferenceWatchTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant sources_ = network_.join("sources");
  bus::Participant guard_ = network_.join("guard");
  bus::Writer<wire::SourceDescription> descriptions_ =
      sources_
          .writer<wire::SourceDescription>(bus::topics::source_description, bus::Profile::state,
                                           "b")
          .value();
  bus::Writer<wire::SampleBlock> blocks_ =
      sources_.writer<wire::SampleBlock>(bus::topics::acs_samples, bus::Profile::live_samples, "b")
          .value();
  ReferenceWatch watch_{
      guard_, "b", {"acs", "reference"}, {10.0, 40.0, 400.0}, std::make_shared<bus::WakeUp>()};
  std::mt19937 random_{20261126};
  double frequency_hz_ = 40.0;
  // m/s^2 by the time of the samples
  std::function<double(double)> motion_ = [](double) { return 0.0; };
  double hum_m_s2_ = 0.0;
  double hum_turns_ = 0.0;
  double hum_off_rel_ = 0.0;   // of its frequency
  double clock_off_rel_ = 0.0; // of the generator against the reference's
  std::uint64_t sample_ = 0;
  bool is_heard_ = true; // the run
  bus::Clock::Instant heard_{};

  void SetUp() override {
    wire::SourceDescription description;
    description.bench("b");
    description.source("acs");
    description.session(1);
    description.kind(wire::SOURCE_ACS);
    description.channels().resize(1);
    description.channels()[0].name("reference");
    descriptions_.write(description);
  }
  [[nodiscard]] double now_s() const { return static_cast<double>(sample_) / rate_hz; }
  void send_block() { // of 50 ms
    constexpr std::size_t samples = 100;
    wire::SampleBlock block;
    block.bench("b");
    block.source("acs");
    block.session(1);
    block.block(sample_ / samples);
    block.first_sample(sample_);
    block.sample_count(samples);
    block.channel_count(1);
    block.interval_numerator_ns(500'000);
    block.interval_denominator(1);
    std::normal_distribution<double> noise(0.0, 0.01 * level_m_s2);
    for (std::size_t i = 0; i < samples; ++i, ++sample_) {
      const double turns = frequency_hz_ * now_s();
      const double hum_turns = hum_turns_ + frequency_hz_ * hum_off_rel_ * now_s();
      block.values().push_back(motion_(now_s()) * std::sin(turn * turns * (1.0 + clock_off_rel_)) +
                               hum_m_s2_ * std::sin(turn * (turns + hum_turns)) + noise(random_));
    }
    blocks_.write(block, 0s);
  }
  void pass(Phase phase, std::chrono::milliseconds time) {
    for (; time > 0ms; time -= 50ms) {
      clock_.advance(50ms);
      send_block();
      heard_ = is_heard_ ? clock_.now() : heard_;
      watch_.look(phase, frequency_hz_, heard_, clock_.now());
    }
  }
  void drive() {
    motion_ = [](double) { return level_m_s2; };
    pass(Phase::driven, 3s);
  }
  [[nodiscard]] bool is_said_within(std::chrono::milliseconds time) {
    for (; time > 0ms && watch_.still_driven().empty(); time -= 50ms) {
      pass(Phase::off, 50ms);
    }
    return !watch_.still_driven().empty();
  }
  double draw(double low, double high) {
    return std::uniform_real_distribution(low, high)(random_);
  }
};

TEST_F(ReferenceWatchTest, ShowsAnExciterThatGoesOnWithinThreeSecondsAndUntilItStops) {
  for (const double frequency_hz : {10.0, 40.0, 400.0}) {
    frequency_hz_ = frequency_hz;
    pass(Phase::quiet, 2s);
    drive();
    EXPECT_EQ(watch_.still_driven(), "");
    EXPECT_TRUE(is_said_within(3s)) << frequency_hz;
    EXPECT_THAT(watch_.still_driven(), testing::HasSubstr("acs/reference still shows the 20"));
    const std::string said = watch_.still_driven();
    pass(Phase::off, 30s);
    EXPECT_EQ(watch_.still_driven(), said) << "the same words";
    motion_ = [](double) { return 0.0; };
    pass(Phase::off, 2s);
    EXPECT_EQ(watch_.still_driven(), "");
    pass(Phase::unwatched, 1s);
  }
}

TEST_F(ReferenceWatchTest, SaysNothingOfExcitersThatStopOrRing) {
  for (int drawn = 0; drawn < 30; ++drawn) {
    pass(Phase::quiet, 1s);
    drive();
    const double off_s = now_s();
    const double ring_s = std::exp(draw(std::log(0.02), std::log(30.0)));
    motion_ = [=](double time_s) { return level_m_s2 * std::exp(-(time_s - off_s) / ring_s); };
    EXPECT_FALSE(is_said_within(20s)) << "draw " << drawn << ", " << ring_s << " s";
    pass(Phase::unwatched, 1s);
  }
}

TEST_F(ReferenceWatchTest, SaysNothingOfHumThatWasThereBefore) {
  for (int drawn = 0; drawn < 30; ++drawn) {
    hum_m_s2_ = draw(0.2, 2.0) * level_m_s2;
    hum_turns_ = draw(0.0, 1.0);
    pass(Phase::quiet, 1s);
    drive();
    motion_ = [](double) { return 0.0; };
    EXPECT_FALSE(is_said_within(10s))
        << "draw " << drawn << ", " << hum_m_s2_ << ", " << hum_turns_;
    pass(Phase::unwatched, 1s);
  }
}

// Hum that is about as large as the level, and beats with it, may look like an exciter that rings.
TEST_F(ReferenceWatchTest, TellsHumThatItNeverHeardAloneFromTheLevel) {
  for (int drawn = 0; drawn < 60; ++drawn) {
    const bool beats = drawn % 2 == 0;
    hum_m_s2_ = draw(0.0, beats ? 0.4 : 2.5) * level_m_s2;
    hum_turns_ = draw(0.0, 1.0);
    clock_off_rel_ = draw(-1e-4, 1e-4);
    hum_off_rel_ = beats ? draw(-4e-4, 4e-4) : clock_off_rel_;
    drive();
    motion_ = [](double) { return 0.0; };
    EXPECT_FALSE(is_said_within(10s)) << "draw " << drawn << ", " << hum_m_s2_ << " m/s^2";
    drive();
    EXPECT_TRUE(is_said_within(3s))
        << "draw " << drawn << ", and now it goes on, with hum of " << hum_m_s2_ << " m/s^2";
    pass(Phase::unwatched, 1s);
  }
}

// With a generator whose clock is not that of the reference.
TEST_F(ReferenceWatchTest, FollowsTheSineOfTheGeneratorsClock) {
  for (int drawn = 0; drawn < 30; ++drawn) {
    frequency_hz_ = std::vector{10.0, 40.0, 400.0}[static_cast<std::size_t>(drawn % 3)];
    clock_off_rel_ = draw(-3e-4, 3e-4);
    drive();
    EXPECT_TRUE(is_said_within(3s)) << drawn << ": " << clock_off_rel_;
    const std::string said = watch_.still_driven();
    pass(Phase::off, 20s);
    EXPECT_EQ(watch_.still_driven(), said);
    pass(Phase::unwatched, 1s);
  }
}

// Its conductor has died, and its own guard has switched off: what is left is no level of the run.
TEST_F(ReferenceWatchTest, TakesNothingForTheLevelFromAfterTheRunWasLastHeard) {
  for (int drawn = 0; drawn < 30; ++drawn) {
    is_heard_ = true;
    hum_m_s2_ = draw(0.1, 2.5) * level_m_s2;
    hum_turns_ = draw(0.0, 1.0);
    hum_off_rel_ = draw(-4e-4, 4e-4);
    drive();
    is_heard_ = false;
    motion_ = [](double) { return 0.0; };
    pass(Phase::driven, 2s);
    EXPECT_FALSE(is_said_within(10s)) << "draw " << drawn << ", " << hum_m_s2_ << " m/s^2";
    pass(Phase::unwatched, 1s);
  }
}

TEST_F(ReferenceWatchTest, SaysNothingBetweenStepsOrWithoutSamples) {
  for (int step = 0; step < 10; ++step) {
    drive(); // the same frequency, again and again
    motion_ = [](double) { return 0.0; };
    EXPECT_FALSE(is_said_within(300ms)) << step;
  }
  drive();
  for (int turn_of_loop = 0; turn_of_loop < 200; ++turn_of_loop) {
    clock_.advance(50ms); // its source has died
    watch_.look(Phase::off, frequency_hz_, heard_, clock_.now());
  }
  EXPECT_EQ(watch_.still_driven(), "");
}

// A run paused, or begun anew, while the exciter goes on.
TEST_F(ReferenceWatchTest, GoesOnWithTheRunThatFollows) {
  drive();
  ASSERT_TRUE(is_said_within(3s));
  pass(Phase::quiet, 5s);
  EXPECT_NE(watch_.still_driven(), "");
  drive();
  EXPECT_EQ(watch_.still_driven(), "") << "somebody has hold of it";
  EXPECT_TRUE(is_said_within(3s)) << "what goes on is no hum";
}

} // namespace
} // namespace dyncal::inline programs
