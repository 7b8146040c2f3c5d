#include "services/programs/command/condition_logger.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <random>

#include <gmock/gmock.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int64_t begin_ns = 1'772'366'400 * second_ns;

ConditionSummary temperature(double max_age_s) {
  ConditionSettings settings;
  settings.kind = "file";
  settings.name = "logger 174H";
  settings.file = "room.csv";
  settings.max_age_s = max_age_s;
  return {settings, {"temperature", "degC", "Temp", 0.4}};
}

Expected<ConditionReading> reading(std::int64_t at_s, double value) {
  return ConditionReading{begin_ns + at_s * second_ns, value};
}

TEST(ConditionSummary, IsOfAllReadings) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    std::mt19937 draw(seed);
    std::normal_distribution<double> value(23.0, 0.2);
    ConditionSummary summary = temperature(600.0);
    std::vector<double> values;
    for (int i = 0; i < 50; ++i) {
      values.push_back(value(draw));
      EXPECT_THAT(summary.take(reading(60 * i, values.back()), begin_ns + 60 * i * second_ns),
                  IsEmpty());
    }
    const LoggedCondition& logged = summary.logged();
    EXPECT_EQ(logged.count, 50U);
    EXPECT_EQ(logged.minimum, *std::ranges::min_element(values));
    EXPECT_EQ(logged.maximum, *std::ranges::max_element(values));
    EXPECT_NEAR(logged.mean, std::accumulate(values.begin(), values.end(), 0.0) / 50.0, 1e-12);
    EXPECT_EQ(logged.source, "logger 174H, file room.csv");
    EXPECT_THAT(logged.problem, IsEmpty());
  }
}

// The logger writes every ten minutes and is asked every minute.
TEST(ConditionSummary, CountsALineOfTheFileOnce) {
  ConditionSummary summary = temperature(900.0);
  for (int i = 0; i < 10; ++i) {
    EXPECT_THAT(summary.take(reading(0, 23.0), begin_ns + 60 * i * second_ns), IsEmpty());
  }
  EXPECT_EQ(summary.logged().count, 1U);
}

TEST(ConditionSummary, SaysThatALoggerHasStoppedAndTakesNoOldValue) {
  ConditionSummary summary = temperature(600.0);
  EXPECT_THAT(summary.take(reading(0, 23.0), begin_ns), IsEmpty());
  EXPECT_THAT(summary.take(reading(0, 23.0), begin_ns + 601 * second_ns),
              HasSubstr("temperature (logger 174H, file room.csv) is not logged: the newest "
                        "reading is of 2026-03-01T12:00:00.000000000Z, 601 s ago"));
  EXPECT_THAT(summary.take(reading(0, 23.0), begin_ns + 661 * second_ns), IsEmpty()); // said once
  EXPECT_THAT(summary.take(reading(700, 24.0), begin_ns + 720 * second_ns),
              HasSubstr("logged again"));
  EXPECT_EQ(summary.logged().count, 2U);
  EXPECT_THAT(summary.logged().problem, HasSubstr("601 s ago"));
}

TEST(ConditionSummary, TakesNeitherTheFutureNorWhatCannotBe) {
  ConditionSummary summary = temperature(600.0);
  EXPECT_THAT(summary.take(reading(3600, 23.0), begin_ns), HasSubstr("3600 s after now"));
  ConditionSummary hot = temperature(600.0);
  EXPECT_THAT(hot.take(reading(0, 2300.0), begin_ns), HasSubstr("beyond what a laboratory has"));
  ConditionSummary absent = temperature(600.0);
  EXPECT_THAT(absent.take(fail(ErrorCode::bad_file, "room.csv: is not there"), begin_ns),
              HasSubstr("room.csv: is not there"));
  EXPECT_EQ(absent.logged().count, 0U);
  EXPECT_NE(absent.logged().mean, absent.logged().mean); // no number at all
}

TEST(JoinedConditions, AreOfARunThatWasResumed) {
  LoggedCondition before{.quantity = "temperature",
                         .unit = "degC",
                         .source = "s",
                         .count = 3,
                         .minimum = 20.0,
                         .mean = 21.0,
                         .maximum = 22.0,
                         .expanded = 0.4,
                         .problem = {}};
  LoggedCondition since = before;
  since.count = 1;
  since.minimum = since.mean = since.maximum = 25.0;
  const auto joined = joined_conditions({before}, {since});
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(joined[0].count, 4U);
  EXPECT_EQ(joined[0].minimum, 20.0);
  EXPECT_EQ(joined[0].mean, 22.0);
  EXPECT_EQ(joined[0].maximum, 25.0);
  EXPECT_EQ(joined_conditions({}, {since})[0].count, 1U);
}

// Blocks of one channel, 10 samples each, as long as it is asked to.
class ChannelSource {
public:
  explicit ChannelSource(bus::MemoryNetwork& network) : there_(network.join("dau")) {}

  // Until `is_done`.
  void write(double value, const std::function<bool()>& is_done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!is_done() && std::chrono::steady_clock::now() < end) {
      wire::SampleBlock block;
      block.bench("acc-1");
      block.source("dau");
      block.session(7);
      block.block(number_);
      block.first_sample(number_ * 10);
      block.sample_count(10);
      block.channel_count(1);
      block.origin_ns(1'000);
      block.interval_numerator_ns(1'000'000);
      block.interval_denominator(1);
      block.values(std::vector<double>(10, value));
      writer_.write(block);
      ++number_;
      bus::WakeUp pacing;
      pacing.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(is_done());
  }

private:
  bus::Participant there_;
  bus::Writer<wire::SampleBlock> writer_ =
      there_
          .writer<wire::SampleBlock>(bus::topics::dau_samples, bus::Profile::live_samples, "acc-1")
          .value();
  std::uint64_t number_ = 0;
};

class ChannelConditions : public testing::Test {
protected:
  std::unique_ptr<ConditionLogger> logger_of(const std::string& unit) {
    ConditionSettings settings;
    settings.kind = "channel";
    settings.every_s = 0.1;
    settings.quantities = {{"temperature", "degC", "dau/temperature", 0.4}};
    bench_.bench = "acc-1";
    RunSource source;
    source.source = "dau";
    source.kind = SourceKind::dau;
    source.description.channels.resize(1);
    source.description.channels[0].name = "temperature";
    source.description.channels[0].unit = unit;
    planned_.sources = {source};
    return std::make_unique<ConditionLogger>(settings, bench_, planned_, here_,
                                             folder_.path() / "conditions.csv");
  }

  bus::MemoryNetwork network_;
  bus::Participant here_ = network_.join("run");
  ChannelSource source_{network_};
  BenchFile bench_;
  RunOutcome planned_;
  tests::TemporaryFolder folder_;
};

TEST_F(ChannelConditions, AreMeansOfWhatComes) {
  const auto logger = logger_of(R"(\degreecelsius)");
  source_.write(23.5, [&] { return logger->logged().front().count >= 2; });
  const LoggedCondition logged = logger->logged().front();
  EXPECT_EQ(logged.mean, 23.5);
  EXPECT_THAT(logged.problem, IsEmpty());
  EXPECT_THAT(logger->take_sentences(), IsEmpty());
}

TEST_F(ChannelConditions, AreStatedInTheirUnitWhateverThatOfTheChannel) {
  const auto logger = logger_of(R"(\kelvin)");
  source_.write(296.15, [&] { return logger->logged().front().count >= 1; });
  EXPECT_NEAR(logger->finish().front().mean, 23.0, 1e-9);
}

TEST_F(ChannelConditions, AreNoneInAUnitThatIsNotTheirs) {
  for (const char* unit : {R"(\volt)", "", R"(\one)"}) {
    const LoggedCondition logged = logger_of(unit)->finish().front();
    EXPECT_EQ(logged.count, 0U) << unit;
    EXPECT_THAT(logged.problem, HasSubstr("not in degC"));
  }
}

// What came before is still held, and not taken for what comes.
TEST_F(ChannelConditions, AreNotThoseOfASourceThatHasFallenSilent) {
  const auto logger = logger_of(R"(\degreecelsius)");
  source_.write(23.5, [&] { return logger->logged().front().count >= 1; });
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  std::vector<std::string> sentences;
  while (sentences.empty() && std::chrono::steady_clock::now() < end) {
    sentences = logger->take_sentences();
  }
  ASSERT_THAT(sentences, testing::ElementsAre(HasSubstr("source dau sends no samples")));
  const auto count = logger->logged().front().count;
  EXPECT_LE(count, 2U); // the one that was being taken may hold some
  EXPECT_EQ(logger->finish().front().count, count);
}

} // namespace
} // namespace dyncal::inline programs
