#include "drivers/acs/socket_acs.hpp"

#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/collecting_sink.hpp"
#include "tests/unit/drivers/link/scripted_instrument.hpp"

namespace dyncal::drivers::acs {
namespace {

using testing::HasSubstr;
using tests::CollectingSink;

std::string description(const std::string& values, int rate_hz) {
  return R"({"protocol":"dyncal-acs-stream","version":1,"sample_rate_hz":{"numerator":)" +
         std::to_string(rate_hz) + R"(,"denominator":1},"origin_ns":1000,"values":")" + values +
         R"(","channels":[{"name":"reference","unit":"\\metre\\second\\tothe{-2}","scale":0.5},{"name":"sync","unit":"\\volt","scale":0.25}]})"
         "\n";
}

template <class Value>
void put(std::string& out, Value value) {
  char bytes[sizeof(Value)];
  std::memcpy(bytes, &value, sizeof(Value));
  out.append(bytes, sizeof(Value));
}

// Two channels: the sample number, and its negative.
template <class Value>
std::string frame(std::uint64_t first_sample, std::uint32_t samples) {
  std::string out;
  put(out, std::uint32_t{0x46534341});
  put(out, samples);
  put(out, first_sample);
  for (std::uint32_t i = 0; i < samples; ++i) {
    put(out, static_cast<Value>(first_sample + i));
    put(out, static_cast<Value>(-static_cast<Value>(first_sample + i)));
  }
  return out;
}

const std::string end_of_stream = frame<std::int32_t>(0, 0);

TEST(SocketAcs, TurnsCountsIntoUnitsAndFramesIntoBlocks) {
  const ScriptedInstrument instrument([](int, ScriptedInstrument::Client& client) {
    client.say(description("int32", 1000) + frame<std::int32_t>(40, 50) +
               frame<std::int32_t>(90, 30) + end_of_stream);
    static_cast<void>(client.hear());
  });
  SocketAcs acs({instrument.address()});
  const auto described = acs.describe();
  ASSERT_TRUE(described) << described.error().message;
  EXPECT_EQ(described->driver, "socket");
  CollectingSink sink;
  ASSERT_TRUE(acs.run(sink));
  ASSERT_EQ(sink.blocks.size(), 2U);
  EXPECT_EQ(sink.numbers.front(), 40U);
  EXPECT_EQ(sink.numbers.back(), 119U);
  EXPECT_EQ(sink.stamps_ns.front(), 1000 + 40'000'000);
  EXPECT_EQ(sink.channel(0)[3], 21.5);
  EXPECT_EQ(sink.channel(1)[3], -10.75);
}

TEST(SocketAcs, ReadsTheFrameOfTheReadme) {
  const ScriptedInstrument instrument([](int, ScriptedInstrument::Client& client) {
    const unsigned char bytes[] = {0x41, 0x43, 0x53, 0x46, 2, 0, 0,    0,    0xe8, 3,    0,
                                   0,    0,    0,    0,    0, 3, 0,    0,    0,    0xff, 0xff,
                                   0xff, 0xff, 4,    0,    0, 0, 0xfe, 0xff, 0xff, 0xff};
    client.say(description("int32", 1000) +
               std::string(reinterpret_cast<const char*>(bytes), sizeof(bytes)) + end_of_stream);
    static_cast<void>(client.hear());
  });
  SocketAcs acs({instrument.address()});
  ASSERT_TRUE(acs.describe());
  CollectingSink sink;
  ASSERT_TRUE(acs.run(sink));
  EXPECT_THAT(sink.numbers, testing::ElementsAre(1000, 1001));
  EXPECT_THAT(sink.channel(0), testing::ElementsAre(1.5, 2.0));
  EXPECT_THAT(sink.channel(1), testing::ElementsAre(-0.25, -0.5));
}

TEST(SocketAcs, JoinsShortFramesAndKeepsFloat64Exactly) {
  const ScriptedInstrument instrument([](int, ScriptedInstrument::Client& client) {
    std::string stream = description("float64", 1000);
    for (std::uint64_t i = 0; i < 100; ++i) {
      stream += frame<double>(i, 1);
    }
    client.say(stream + end_of_stream);
    static_cast<void>(client.hear());
  });
  SocketAcs acs({instrument.address()});
  ASSERT_TRUE(acs.describe());
  CollectingSink sink;
  ASSERT_TRUE(acs.run(sink));
  ASSERT_EQ(sink.blocks.size(), 5U); // 20 ms each
  const std::vector<double> sync = sink.channel(1);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(sync[i], -static_cast<double>(i));
  }
}

TEST(SocketAcs, ShowsSamplesThatTheInstrumentLostAsAGap) {
  const ScriptedInstrument instrument([](int, ScriptedInstrument::Client& client) {
    client.say(description("int32", 1000) + frame<std::int32_t>(0, 10) +
               frame<std::int32_t>(15, 10) + end_of_stream);
    static_cast<void>(client.hear());
  });
  SocketAcs acs({instrument.address()});
  ASSERT_TRUE(acs.describe());
  CollectingSink sink;
  ASSERT_TRUE(acs.run(sink));
  ASSERT_EQ(sink.blocks.size(), 2U);
  EXPECT_EQ(sink.blocks[1].first_sample, 15U);
  EXPECT_EQ(sink.counts.received, 20U);
  EXPECT_EQ(sink.counts.lost_in_device, 5U);
}

TEST(SocketAcs, GivesChannelsTheNamesAndUnitsOfTheSettings) {
  const ScriptedInstrument instrument([](int, ScriptedInstrument::Client& client) {
    client.say(description("int32", 1000) + frame<std::int32_t>(0, 10) + end_of_stream);
    static_cast<void>(client.hear());
  });
  SocketAcs acs({.address = instrument.address(),
                 .channels = {{"reference", "laser"}},
                 .units = {{"laser", R"(\metre\second\tothe{-1})"}}});
  ASSERT_TRUE(acs.describe());
  CollectingSink sink;
  ASSERT_TRUE(acs.run(sink));
  ASSERT_EQ(sink.descriptions.size(), 1U);
  EXPECT_EQ(sink.descriptions[0].channels[0].name, "laser");
  EXPECT_EQ(sink.descriptions[0].channels[0].unit, R"(\metre\second\tothe{-1})");
  EXPECT_EQ(sink.descriptions[0].channels[1].name, "sync");
}

TEST(SocketAcs, RefusesNamesOfChannelsThatTheInstrumentDoesNotHave) {
  const ScriptedInstrument instrument([](int, ScriptedInstrument::Client& client) {
    client.say(description("int32", 1000));
    static_cast<void>(client.hear());
  });
  SocketAcs acs({.address = instrument.address(), .channels = {{"velocity", "laser"}}});
  const auto described = acs.describe();
  ASSERT_FALSE(described);
  EXPECT_EQ(described.error().code, ErrorCode::invalid_setting);
  EXPECT_THAT(described.error().message, HasSubstr("has no channel 'velocity'"));
}

TEST(SocketAcs, WarnsOfAnInstrumentThatComesBackWithoutAChannel) {
  const ScriptedInstrument instrument([](int number, ScriptedInstrument::Client& client) {
    std::string line = description("int32", 1000);
    if (number > 0) {
      line.replace(line.find("reference"), 9, "velocity!");
    }
    client.say(line + frame<std::int32_t>(0, 20));
    if (number > 0) {
      client.say(end_of_stream);
      static_cast<void>(client.hear());
    }
  });
  SocketAcs acs({.address = instrument.address(), .channels = {{"reference", "laser"}}});
  ASSERT_TRUE(acs.describe());
  CollectingSink sink;
  ASSERT_TRUE(acs.run(sink));
  ASSERT_EQ(sink.warnings.size(), 1U);
  EXPECT_THAT(sink.warnings[0], HasSubstr("has no channel 'reference'"));
  EXPECT_EQ(sink.counts.causes, (std::vector<NamedCount>{{"reconnections without a channel", 1}}));
  EXPECT_EQ(sink.descriptions.back().channels[0].name, "velocity!");
}

TEST(SocketAcs, BeginsANewSessionWhenTheInstrumentIsBack) {
  const ScriptedInstrument instrument([](int number, ScriptedInstrument::Client& client) {
    client.say(description("int32", 1000) + frame<std::int32_t>(number == 0 ? 500 : 0, 20));
    if (number > 0) {
      client.say(end_of_stream);
      static_cast<void>(client.hear());
    }
  });
  SocketAcs acs({instrument.address()});
  ASSERT_TRUE(acs.describe());
  CollectingSink sink;
  ASSERT_TRUE(acs.run(sink));
  EXPECT_EQ(sink.sessions_begun_at, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(sink.descriptions.size(), 2U);
  EXPECT_EQ(sink.counts.received, 40U);
  EXPECT_EQ(sink.counts.lost_in_device, 0U);
  ASSERT_EQ(sink.blocks.size(), 2U);
  EXPECT_EQ(sink.blocks[0].first_sample, 500U);
  EXPECT_EQ(sink.blocks[1].first_sample, 0U);
}

TEST(SocketAcs, LeavesAnInstrumentThatFallsSilentWithinAFrame) {
  for (const std::size_t sent : {std::size_t{7}, std::size_t{40}}) {
    const ScriptedInstrument instrument([&](int turn, ScriptedInstrument::Client& client) {
      const std::string whole = frame<std::int32_t>(0, 10);
      client.say(description("int32", 1000) +
                 (turn == 0 ? whole + frame<std::int32_t>(10, 10).substr(0, sent)
                            : whole + end_of_stream));
      static_cast<void>(client.hear());
    });
    SocketAcs acs({.address = instrument.address(), .frame_limit = std::chrono::milliseconds(50)});
    ASSERT_TRUE(acs.describe());
    CollectingSink sink;
    ASSERT_TRUE(acs.run(sink));
    EXPECT_EQ(sink.sessions_begun_at.size(), 2U) << sent;
    EXPECT_EQ(sink.blocks.size(), 2U) << sent;
    ASSERT_EQ(sink.warnings.size(), 1U) << sent;
    EXPECT_THAT(sink.warnings[0], HasSubstr("has sent part of a frame and then nothing for 50 ms"));
  }
}

TEST(SocketAcs, EndsWithASentenceWhenTheStreamCannotBeUnderstood) {
  const std::pair<std::string, const char*> cases[] = {
      {"this is no frame at all", "is not a frame"},
      {frame<std::int32_t>(100, 30) + frame<std::int32_t>(50, 30), "go back from 130 to 50"},
  };
  for (const auto& [bytes, message] : cases) {
    const ScriptedInstrument instrument([&sent = bytes](int, ScriptedInstrument::Client& client) {
      client.say(description("int32", 1000) + sent);
      static_cast<void>(client.hear());
    });
    SocketAcs acs({instrument.address()});
    ASSERT_TRUE(acs.describe());
    CollectingSink sink;
    const auto ended = acs.run(sink);
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().code, ErrorCode::malformed);
    EXPECT_THAT(ended.error().message, HasSubstr(message));
  }
}

TEST(SocketAcs, SaysWithinItsLimitThatNobodyIsThere) {
  std::string address;
  {
    const ScriptedInstrument gone([](int, ScriptedInstrument::Client&) {});
    address = gone.address();
  }
  SocketAcs acs({address, std::chrono::milliseconds(700)});
  const auto described = acs.describe();
  ASSERT_FALSE(described);
  EXPECT_EQ(described.error().code, ErrorCode::refused);
  EXPECT_THAT(described.error().message, HasSubstr(address));
}

TEST(SocketAcs, StopsWhileItWaitsForSamples) {
  const ScriptedInstrument instrument([](int, ScriptedInstrument::Client& client) {
    client.say(description("int32", 1000) + frame<std::int32_t>(0, 50));
    static_cast<void>(client.hear());
  });
  SocketAcs acs({instrument.address()});
  ASSERT_TRUE(acs.describe());
  CollectingSink sink;
  sink.after_block = [&] { acs.stop(); };
  EXPECT_TRUE(acs.run(sink));
  EXPECT_EQ(sink.blocks.size(), 1U);
}

} // namespace
} // namespace dyncal::drivers::acs
