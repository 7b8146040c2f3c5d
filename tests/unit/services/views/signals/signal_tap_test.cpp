#include "services/views/signals/signal_tap.hpp"

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline views {
namespace {

wire::SampleBlock block_of(std::uint64_t number, double value) {
  wire::SampleBlock block;
  block.bench("acc-1");
  block.source("dau");
  block.session(7);
  block.block(number);
  block.first_sample(number * 2);
  block.sample_count(2);
  block.channel_count(2);
  block.origin_ns(1'000);
  block.interval_numerator_ns(1'000'000);
  block.interval_denominator(1);
  block.values({value, value + 1.0, -value, -value - 1.0});
  return block;
}

class SignalTapTest : public testing::Test {
protected:
  // Of column 1; writes blocks until some are there.
  std::vector<Sample> wait_for_samples() {
    std::vector<Sample> samples;
    const auto end = std::chrono::steady_clock::now() + patience;
    while (samples.empty() && std::chrono::steady_clock::now() < end) {
      writer_.write(block_of(number_, static_cast<double>(number_)));
      ++number_;
      EXPECT_TRUE(tap_->look({"acc-1", "dau", SourceKind::dau, 1},
                             [&](const ChannelRing& ring) { samples = ring.newest_stretch(100); }));
      bus::WakeUp pacing;
      pacing.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(10));
    }
    return samples;
  }

  static constexpr std::chrono::seconds patience{20};
  bus::MemoryNetwork network_;
  bus::Participant here_ = network_.join("web");
  bus::Participant there_ = network_.join("dau");
  bus::Writer<wire::SampleBlock> writer_ =
      there_
          .writer<wire::SampleBlock>(bus::topics::dau_samples, bus::Profile::live_samples, "acc-1")
          .value();
  std::uint64_t number_ = 0;
  std::unique_ptr<SignalTap> tap_ = std::make_unique<SignalTap>(here_, bus::system_clock());
};

TEST_F(SignalTapTest, ReadsNothingUntilSomebodyLooks) {
  writer_.write(block_of(0, 1.0));
  EXPECT_EQ(tap_->readers(), 0U);
  EXPECT_EQ(writer_.matched_readers(), 0);
}

TEST_F(SignalTapTest, FillsTheChannelThatIsLookedAt) {
  const std::vector<Sample> samples = wait_for_samples();
  ASSERT_GE(samples.size(), 2U);
  EXPECT_LT(samples[0].value, 0.5) << "the second column";
  EXPECT_EQ(samples[1].value, samples[0].value - 1.0);
  EXPECT_EQ((samples[0].stamp_ns - 1'000) % 2'000'000, 0);
  EXPECT_EQ(tap_->readers(), 1U);
}

TEST_F(SignalTapTest, HoldsNoMoreChannelsThanItsLimit) {
  const auto look = [&](std::size_t column) {
    return tap_->look({"acc-1", "dau", SourceKind::dau, column}, [](const ChannelRing&) {});
  };
  for (std::size_t column = 0; column < SignalTap::max_channels; ++column) {
    EXPECT_TRUE(look(column));
  }
  EXPECT_FALSE(look(SignalTap::max_channels));
  EXPECT_TRUE(look(0));
}

} // namespace
} // namespace dyncal::inline views
