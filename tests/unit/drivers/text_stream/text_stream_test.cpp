#include "drivers/text_stream/text_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/collecting_sink.hpp"
#include "tests/unit/drivers/link/scripted_instrument.hpp"

namespace dyncal::drivers::text_stream {
namespace {

using testing::HasSubstr;
using tests::CollectingSink;

AcsKeys keys(const std::string& address) {
  return {.texts = {{"address", address}},
          .numbers = {{"sample_rate_hz", 1000.0}},
          .channels = {{"channel_1", "reference"}, {"channel_2", "sync"}},
          .units = {{"sync", "\\volt"}}};
}

// Samples n and -n, after the rest of a line.
std::string lines(int count, const char* between = ",") {
  std::string text = "75\n";
  for (int n = 0; n < count; ++n) {
    text += std::to_string(n) + between + std::to_string(-n) + "\r\n";
  }
  return text;
}

TEST(TextStream, NumbersItsLinesAndReachesTheInstrumentAgain) {
  const ScriptedInstrument instrument([](int number, ScriptedInstrument::Client& client) {
    client.say(lines(number == 0 ? 121 : 51, number == 0 ? ", " : " "));
  });
  const auto source = driver().make(keys(instrument.address()));
  ASSERT_TRUE(source) << source.error().message;
  const auto described = (*source)->describe();
  ASSERT_TRUE(described) << described.error().message;
  EXPECT_EQ(described->driver, driver().name);
  ASSERT_EQ(described->channels.size(), 2U);
  EXPECT_EQ(described->channels[1].name, "sync");
  EXPECT_EQ(described->channels[1].unit, "\\volt");
  CollectingSink sink;
  sink.after_block = [&] {
    if (sink.sessions_begun_at.size() == 2) {
      (*source)->stop();
    }
  };
  ASSERT_TRUE((*source)->run(sink));
  ASSERT_GE(sink.blocks.size(), 4U); // 50, 50 and the rest of the first session
  EXPECT_EQ(sink.blocks[0].samples, 50U);
  EXPECT_EQ(sink.sessions_begun_at, (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ(sink.numbers[119], 119U);
  EXPECT_EQ(sink.stamps_ns[119], 119'000'000);
  EXPECT_EQ(sink.channel(0)[118], 119.0); // the line that described it was taken for that
  EXPECT_EQ(sink.channel(1)[118], -119.0);
  EXPECT_EQ(sink.numbers[120], 0U);
  EXPECT_EQ(sink.counts.lost_in_device, 0U);
}

TEST(TextStream, RefusesWhatIsNoNumberAndWhatIsNotThere) {
  for (const std::string wrong : {"1.0 overload", "1 inf", "1 2 3", "+1E0"}) {
    const ScriptedInstrument instrument([&](int, ScriptedInstrument::Client& client) {
      client.say(lines(2) + wrong + "\n");
      static_cast<void>(client.hear());
    });
    const auto source = driver().make(keys(instrument.address()));
    ASSERT_TRUE(source && (*source)->describe());
    CollectingSink sink;
    const auto ended = (*source)->run(sink);
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().code, ErrorCode::malformed);
    EXPECT_THAT(ended.error().message, HasSubstr("'" + wrong + "'"));
    EXPECT_EQ(sink.counts.received, 1U);
  }
  const ScriptedInstrument instrument([](int, ScriptedInstrument::Client& client) {
    client.say("\n1\n");
    static_cast<void>(client.hear());
  });
  const auto source = driver().make(keys(instrument.address()));
  const auto described = (*source)->describe();
  ASSERT_FALSE(described);
  EXPECT_THAT(described.error().message, HasSubstr("no channel 'channel_2'"));
  AcsKeys never = keys("127.0.0.1:1");
  never.numbers["sample_rate_hz"] = -1.0;
  EXPECT_THAT(driver().make(never).error().message, HasSubstr("sample_rate_hz"));
}

} // namespace
} // namespace dyncal::drivers::text_stream
