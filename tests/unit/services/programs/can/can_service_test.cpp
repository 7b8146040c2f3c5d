// What dyncal-can says on DDS of frames that a script brings.
#include "services/bus/vendor.hpp"
#include "services/programs/can/can_source.hpp"

#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/can/bus/scripted_source.hpp"
#include "services/programs/can/can_status.hpp"
#include "services/stream/source_service.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/drivers/collecting_sink.hpp"
#include "tests/unit/services/stream/bench_listener.hpp"

namespace dyncal::inline programs::can {
namespace {

using drivers::can::BusEvent;
using drivers::can::BusFault;
using drivers::can::BusState;
using drivers::can::CanFrame;
using drivers::can::FramesLost;
using drivers::can::FrameSource;
using drivers::can::LinkChange;
using drivers::can::LinkState;
using drivers::can::ScriptedSource;
using testing::HasSubstr;

constexpr std::int64_t epoch_ns = 1'700'000'000'000'000'000;

LinkState can0() {
  LinkState link;
  link.name = "can0";
  link.present = link.up = link.carrier = true;
  link.bus = BusState::error_active;
  link.bit_rate_per_s = 1'000'000;
  return link;
}

CanFrame sample(int k) {
  CanFrame frame;
  frame.id = 291;
  frame.length = 8;
  frame.data[0] = static_cast<std::uint8_t>(k % 50);
  frame.data[2] = static_cast<std::uint8_t>(k);
  frame.data[3] = static_cast<std::uint8_t>(k >> 8);
  frame.kernel_ns = epoch_ns + k * 1'000'000LL + 120'000;
  return frame;
}

class CanService : public testing::Test {
protected:
  CanService() {
    std::ofstream(folder / "sensor.dbc")
        << "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [-50|50] \"m/s^2\" S\n"
           " SG_ counter : 16|16@1+ (1,0) [0|0] \"\" S\n";
    settings.name = "sensor";
    CanSourceSettings& can = settings.driver.emplace<CanSourceSettings>();
    can.interface_name = "can0";
    can.dbc = folder / "sensor.dbc";
    can.counter = "counter";
    can.nominal_rate_hz = 1000.0;
    can.u_utc_s = 1e-6;
  }

  // Publishes the events until the source has ended and that was heard.
  void publish(std::vector<BusEvent> events) {
    auto source =
        CanSource::prepare(settings, [&](const CanSourceSettings&) -> std::unique_ptr<FrameSource> {
          return std::make_unique<ScriptedSource>(can0(), std::move(events));
        });
    ASSERT_TRUE(source) << source.error().message;
    auto publisher = service->add(options_of(bench, settings));
    ASSERT_TRUE(publisher) << publisher.error().message;
    service->start();
    ASSERT_TRUE(source->run(**publisher, {}));
    ASSERT_TRUE(listener.until([&] {
      const auto status = listener.last_status("sensor");
      const bool ended = status && status->state() == wire::SOURCE_ENDED &&
                         listener.samples_of("sensor") == status->received();
      // Topics come in no order among each other.
      return ended && !listener.descriptions.empty() && !listener.blocks.empty() &&
             listener.end_of_stream() != nullptr;
    }));
  }
  [[nodiscard]] std::uint64_t cause(const std::string& name) const {
    const auto status = listener.last_status("sensor");
    for (const wire::NamedCount& count : status->causes()) {
      if (count.name() == name) {
        return count.value();
      }
    }
    return 0;
  }

  const tests::TemporaryFolder own;
  const std::filesystem::path& folder = own.path();
  const std::string bench = "can";
  SourceSettings settings;
  bus::Participant network = tests::participant(bus::Vendor::fast_dds);
  bus::Participant reader_network = tests::participant(bus::Vendor::fast_dds);
  std::unique_ptr<SourceService> service = SourceService::create(network, {.software = "test 1.0"});
  tests::BenchListener listener{reader_network, bench, bus::topics::can_samples};
};

TEST_F(CanService, PublishesSamplesWithTheirDescriptionAsTheContractSays) {
  std::vector<BusEvent> events;
  events.reserve(3000);
  for (int k = 0; k < 3000; ++k) {
    events.emplace_back(sample(k));
  }
  publish(std::move(events));
  const wire::SourceDescription& description = listener.descriptions.back();
  EXPECT_EQ(description.kind(), wire::SOURCE_CAN);
  EXPECT_EQ(description.time_base(), wire::TIME_BASE_UTC);
  EXPECT_EQ(description.stamp_instant(), wire::STAMP_FRAME_START);
  EXPECT_EQ(description.driver(), "can can0, time by counter");
  EXPECT_DOUBLE_EQ(description.nominal_rate_hz(), 1000.0);
  EXPECT_GT(description.stamp_uncertainty_s(), 0.0);
  ASSERT_EQ(description.channels().size(), 1U);
  EXPECT_EQ(description.channels()[0].name(), "x");
  EXPECT_EQ(description.channels()[0].unit(), R"(\metre\second\tothe{-2})");
  EXPECT_DOUBLE_EQ(description.channels()[0].resolution(), 0.01);
  EXPECT_DOUBLE_EQ(description.channels()[0].maximum(), 50.0);
  EXPECT_EQ(listener.samples_of("sensor"), 3000U);
  std::uint64_t next = 0;
  for (const wire::SampleBlock& block : listener.blocks) {
    EXPECT_EQ(block.session(), description.session());
    if (block.sample_count() == 0) {
      continue;
    }
    EXPECT_EQ(block.first_sample(), next);
    EXPECT_EQ(block.stamps_ns().size(), block.sample_count());
    EXPECT_EQ(block.stamp_uncertainty_ns().size(), block.sample_count());
    EXPECT_EQ(block.stamp_flags().size(), block.sample_count());
    EXPECT_EQ(block.values().size(), block.sample_count());
    EXPECT_DOUBLE_EQ(block.values()[0], static_cast<double>(next % 50) * 0.01);
    next += block.sample_count();
  }
  EXPECT_EQ(listener.end_of_stream()->first_sample(), 3000U);
}

TEST_F(CanService, TellsBusStateErrorCountersDropsAndGapsInTheStatus) {
  std::vector<BusEvent> events;
  for (int k = 0; k < 2000; ++k) {
    if (k < 1000 || k >= 1007) {
      events.emplace_back(sample(k));
    }
  }
  events.emplace_back(FramesLost{3});
  events.emplace_back(sample(2003));
  events.emplace_back(sample(2003));
  events.emplace_back(BusFault{"stuff error", BusState::unknown, {}, {}, false});
  events.emplace_back(BusFault{"transmit passive", BusState::error_passive, 130, 10, false});
  publish(std::move(events));
  const auto status = listener.last_status("sensor");
  EXPECT_EQ(status->received(), 1994U);
  EXPECT_EQ(status->lost_in_transit(), 10U);
  EXPECT_EQ(status->duplicates(), 1U);
  EXPECT_GT(status->clock_uncertainty_s(), 0.0);
  EXPECT_EQ(cause("frames received"), 1995U);
  EXPECT_EQ(cause("frames dropped by the socket"), 3U);
  EXPECT_EQ(cause("bus: stuff error"), 1U);
  EXPECT_EQ(cause("transmit error counter"), 130U);
  EXPECT_EQ(cause("receive error counter"), 10U);
  EXPECT_THAT(status->message(), HasSubstr("interface 'can0' is error passive"));
  // Seven missing samples show between the numbers of two blocks.
  bool gap = false;
  for (std::size_t i = 1; i < listener.blocks.size(); ++i) {
    gap = gap || listener.blocks[i].first_sample() == listener.blocks[i - 1].first_sample() +
                                                          listener.blocks[i - 1].sample_count() + 7;
  }
  EXPECT_TRUE(gap);
}

TEST_F(CanService, SaysWhatIsWrongWithTheLinkInOneSentence) {
  auto dbc = drivers::can::read_dbc_file(folder / "sensor.dbc");
  const auto stream = *drivers::can::SensorStream::create(stream_settings(settings), *dbc);
  tests::CollectingSink sink;
  ASSERT_TRUE(stream->begin(can0(), sink));
  const auto said = [&](auto change) {
    LinkState link = can0();
    change(link);
    EXPECT_TRUE(stream->take(LinkChange{link, true, ""}, sink));
    return to_message(*stream, std::chrono::seconds(1));
  };
  EXPECT_EQ(said([](LinkState&) {}), "");
  EXPECT_THAT(said([](LinkState& link) { link.present = false; }),
              HasSubstr("'can0' is not there; waiting for it"));
  EXPECT_THAT(said([](LinkState& link) { link.up = false; }),
              HasSubstr("is down; 'ip link set can0 up'"));
  EXPECT_THAT(said([](LinkState& link) { link.bus = BusState::bus_off; }),
              HasSubstr("is bus-off: check bit rate"));
  EXPECT_THAT(said([](LinkState& link) { link.carrier = false; }), HasSubstr("has no bus"));
  EXPECT_EQ(said([](LinkState&) {}), "");
  EXPECT_THAT(to_message(*stream, std::chrono::seconds(3)),
              HasSubstr("none of the sensor's messages has come (0x123); check the ids"));
  CanFrame cut_short = sample(0);
  cut_short.length = 1;
  ASSERT_TRUE(stream->take(cut_short, sink)); // lacks its counter
  EXPECT_EQ(stream->counts().rejected, 1U);
  stream->count(sink);
  EXPECT_EQ(sink.counts.causes.front(), (drivers::NamedCount{"frames received", 1}));
}

TEST_F(CanService, NamesTheSourceAndWhatIsWrongBeforeAnythingIsPublished) {
  const auto refused = [&](const std::string& dbc) {
    std::ofstream(folder / "sensor.dbc") << dbc;
    const auto source = CanSource::prepare(settings, [](const CanSourceSettings&) {
      return std::make_unique<ScriptedSource>(can0(), std::vector<BusEvent>{});
    });
    return source ? std::string("accepted") : source.error().message;
  };
  EXPECT_THAT(refused("BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [0|0] \"furlong\" S\n SG_ "
                      "counter : 16|16@1+ (1,0) [0|0] \"\" S\n"),
              HasSubstr("source 'sensor': "));
  EXPECT_THAT(refused("BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0 [0|0] \"g\" S\n"),
              HasSubstr("sensor.dbc:2: "));
  EXPECT_THAT(refused("BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [0|0] \"g\" S\n"),
              HasSubstr("'counter'"));
}

TEST_F(CanService, SaysThatFramesAreShorterThanTheDbcFileOrAreNoneOfTheSensors) {
  auto& can = std::get<CanSourceSettings>(settings.driver);
  can.counter.clear();
  std::ofstream(folder / "drive.log") << "(1.000000) can0 123#0102\n(1.001000) can0 123#01\n";
  can.log = folder / "drive.log";
  can.bit_rates.nominal_per_s = 500e3;
  settings.channels = {{"x", "x"}};
  EXPECT_TRUE(CanSource::prepare(settings));
  std::ofstream(folder / "drive.log") << "(1.000000) can0 124#0102\n";
  EXPECT_THAT(CanSource::prepare(settings).error().message,
              HasSubstr("drive.log has none of the sensor's messages"));
  std::ofstream(folder / "drive.log") << "(1.000000) can0 123#0102\n(1.000000) can0 123#012\n";
  EXPECT_THAT(CanSource::prepare(settings).error().message, HasSubstr("drive.log:2"));
  const auto stream = *drivers::can::SensorStream::create(
      stream_settings(settings), *drivers::can::read_dbc_file(folder / "sensor.dbc"));
  tests::CollectingSink sink;
  ASSERT_TRUE(stream->begin(can0(), sink));
  CanFrame cut_short = sample(0);
  cut_short.length = 1;
  ASSERT_TRUE(stream->take(cut_short, sink));
  EXPECT_THAT(to_message(*stream, std::chrono::seconds(1)),
              HasSubstr("frames of the sensor are shorter than the DBC file says: 1 signals"));
}

// A recorded drive, through the program's own path: waits for the run, plays, and ends its stream.
TEST_F(CanService, PlaysARecordedLogWithTheMeansAndGapsThatItIsKnownToHave) {
  const std::filesystem::path data = DYNCAL_CAN_DATA;
  if (!std::filesystem::exists(data / "css-canmod-gps-imu-10hz.log")) {
    GTEST_SKIP() << "no recorded CAN log in " << data;
  }
  auto& can = settings.driver.emplace<CanSourceSettings>();
  can.log = data / "css-canmod-gps-imu-10hz.log";
  can.dbc = data / "css-gnss.dbc";
  can.messages = {"0x019"};
  can.nominal_rate_hz = 1.0 / 0.102;
  can.bit_rates.nominal_per_s = 500e3;
  auto source = CanSource::prepare(settings);
  ASSERT_TRUE(source) << source.error().message;
  auto publisher = service->add(options_of(bench, settings));
  ASSERT_TRUE(publisher);
  service->start();
  std::jthread player(
      [&](const std::stop_token& stop) { EXPECT_TRUE(source->run(**publisher, stop)); });
  ASSERT_TRUE(listener.armed("sensor", "run-1"));
  EXPECT_EQ(listener.samples_of("sensor"), 0U);
  listener.set_state("run-1", wire::MEASUREMENT_RUNNING);
  ASSERT_TRUE(listener.until([&] { return listener.end_of_stream() != nullptr; }));
  EXPECT_EQ(listener.samples_of("sensor"), 1669U);
  double sum[3] = {};
  std::uint64_t missing = 0;
  std::uint64_t next = 0;
  for (const wire::SampleBlock& block : listener.blocks) {
    if (block.sample_count() == 0) {
      continue;
    }
    missing += block.first_sample() - next;
    next = block.first_sample() + block.sample_count();
    for (std::size_t channel = 0; channel < 3; ++channel) {
      for (std::size_t i = 0; i < block.sample_count(); ++i) {
        sum[channel] += block.values()[channel * block.sample_count() + i];
      }
    }
  }
  EXPECT_NEAR(sum[0] / 1669.0, -0.3764, 5e-5);
  EXPECT_NEAR(sum[1] / 1669.0, 0.3417, 5e-5);
  EXPECT_NEAR(sum[2] / 1669.0, 10.0466, 5e-5);
  EXPECT_EQ(missing, 5U); // one pause of 606 ms
  ASSERT_TRUE(
      listener.until([&] { return listener.last_status("sensor")->lost_in_transit() == 5; }));
  EXPECT_GT(listener.descriptions.front().stamp_uncertainty_s(),
            9.0); // nobody knows how the recorder's clock was kept
}

} // namespace
} // namespace dyncal::inline programs::can
