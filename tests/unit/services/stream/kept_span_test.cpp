#include "services/stream/kept_span.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/stream/source_publication.hpp"

namespace dyncal::inline stream {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

drivers::SourceDescription source(std::size_t channels, double rate_hz) {
  drivers::SourceDescription description;
  for (std::size_t i = 0; i < channels; ++i) {
    description.channels.emplace_back().name = "channel-" + std::to_string(i);
  }
  description.nominal_rate_hz = rate_hz;
  return description;
}

// The rates of the table in deploy/README.md.
TEST(KeptSpan, IsWhatTheBoundOfTheFileHoldsAtTheRateOfTheSource) {
  const auto acs = kept_span(SourceKind::acs, source(2, 50e3), {});
  ASSERT_TRUE(acs);
  EXPECT_NEAR(acs->minutes, 22.4, 0.1);
  EXPECT_FALSE(acs->is_short);
  EXPECT_THAT(acs->sentence, HasSubstr("keeps up to 22.4 min"));
  const auto dau = kept_span(SourceKind::dau, source(13, 1e3), {});
  ASSERT_TRUE(dau);
  EXPECT_NEAR(dau->minutes, 153.0, 0.1);
  EXPECT_FALSE(dau->is_short);
}

TEST(KeptSpan, SaysWhereTenMinutesDoNotFit) {
  const auto fast = kept_span(SourceKind::acs, source(4, 100e3), {});
  ASSERT_TRUE(fast);
  EXPECT_NEAR(fast->minutes, 5.6, 0.1);
  EXPECT_TRUE(fast->is_short);
  EXPECT_THAT(fast->sentence, HasSubstr("less than 10 min"));
  EXPECT_FALSE(kept_span(SourceKind::acs, source(4, 100e3), {.file_bytes = 4ULL << 30U})->is_short);
}

TEST(KeptSpan, IsNotKnownWithoutARateOrWithShots) {
  EXPECT_FALSE(kept_span(SourceKind::acs, source(2, 0.0), {}));
  EXPECT_FALSE(kept_span(SourceKind::acs, source(0, 50e3), {}));
  EXPECT_FALSE(kept_span(SourceKind::dso, source(2, 1e6), {}));
}

TEST(KeptSpan, IsInTheLogOfASourceOnceForEachRate) {
  bus::MemoryNetwork network;
  bus::Participant participant = network.join("source");
  const auto publisher = std::make_shared<SourcePublisher>(
      SourceOptions{.bench = "b", .source = "acs"}, std::make_shared<bus::WakeUp>());
  const auto channel =
      SourcePublication::create(participant, publisher,
                                std::make_shared<RetransmissionBuffer>(KeptLimits{}), "")
          .value();
  testing::internal::CaptureStdout(); // where the log goes
  for (const char* firmware : {"1", "2", "3"}) {
    drivers::SourceDescription described = source(2, *firmware == '3' ? 200e3 : 50e3);
    described.firmware = firmware;
    publisher->describe(described);
    (void)channel->step(1ms);
  }
  const std::string text = testing::internal::GetCapturedStdout();
  const std::size_t first = text.find("keeps up to 22.4 min");
  ASSERT_NE(first, std::string::npos) << text;
  EXPECT_EQ(text.find("keeps up to 22.4 min", first + 1), std::string::npos) << text;
  EXPECT_THAT(text, HasSubstr("keeps up to 5.6 min"));
  EXPECT_THAT(text, HasSubstr("warning"));
}

} // namespace
} // namespace dyncal::inline stream
