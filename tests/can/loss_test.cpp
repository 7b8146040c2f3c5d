// Every sample that is lost on purpose is in the counts of the sensor: link down, interface pulled
// out, overload.
#include <cstring>
#include <thread>

#include <gtest/gtest.h>

#include "drivers/can/bus/socketcan_source.hpp"
#include "drivers/can/sensor_stream.hpp"
#include "tests/can/kernel_can.hpp"

namespace dyncal::drivers::can {
namespace {

using tests::ip;
using tests::Sender;
using tests::VirtualCan;

struct Numbers : SampleSink {
  std::uint64_t samples = 0;
  std::uint64_t missing = 0; // between the numbers of what came
  std::uint64_t next = 0;

  void describe(const SourceDescription&) override {}
  void begin_session() override { ADD_FAILURE() << "the sensor did not restart"; }
  void count(const SampleCounts&) override {}
  void warn(const std::string&) override {}
  void take(SampleBlock block) override {
    missing += samples > 0 ? block.first_sample - next : 0;
    next = block.first_sample + block.samples;
    samples += block.samples;
  }
};

class Losses : public testing::Test {
protected:
  void open(int receive_buffer_bytes) {
    SocketCanSettings socket;
    socket.interface_name = "vcan0";
    socket.receive_buffer_bytes = receive_buffer_bytes;
    source.emplace(socket);
    StreamSettings settings;
    settings.counter = "counter";
    settings.nominal_rate_hz = 2000.0;
    settings.bit_rates.nominal_per_s = 1e6;
    settings.time_source = TimeSource::kernel_stamp;
    stream = *SensorStream::create(
        settings, *parse_dbc("BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (1,0) [0|0] \"m/s^2\" S\n"
                             " SG_ counter : 16|32@1+ (1,0) [0|0] \"\" S\n",
                             "sensor.dbc"));
    const auto state = source->open(stream->filters());
    ASSERT_TRUE(state) << state.error().message;
    ASSERT_TRUE(stream->begin(*state, numbers));
  }

  // Sends the next samples of the sensor at its pace; it counts on whether or not the bus takes
  // them.
  void send(int samples, bool somebody_hears) {
    std::optional<Sender> sender;
    if (somebody_hears) {
      sender.emplace("vcan0");
    }
    auto due = std::chrono::steady_clock::now();
    for (int i = 0; i < samples; ++i, ++counter) {
      std::vector<std::uint8_t> data(8, 0);
      std::memcpy(&data[2], &counter, sizeof counter);
      if (sender) {
        ASSERT_TRUE(sender->send(0x123, data));
      }
      due += std::chrono::microseconds(500);
      std::this_thread::sleep_until(due);
    }
  }

  // Reads until nothing more comes.
  void take_all() {
    for (bool more = true; more;) {
      std::vector<BusEvent> events;
      ASSERT_TRUE(source->read(events, std::chrono::milliseconds(100)));
      for (const BusEvent& event : events) {
        ASSERT_TRUE(stream->take(event, numbers));
      }
      more = !events.empty();
    }
    stream->flush(numbers);
  }

  std::optional<VirtualCan> link{std::in_place, "vcan0"};
  std::optional<SocketCanSource> source;
  std::unique_ptr<SensorStream> stream;
  Numbers numbers;
  std::uint32_t counter = 0;
};

TEST_F(Losses, OfALinkThatWasDownAreCounted) {
  open(8 << 20);
  send(200, true);
  take_all();
  ip("set vcan0 down");
  send(150, false);
  ip("set vcan0 up");
  send(200, true);
  take_all();
  EXPECT_EQ(numbers.samples, 400U);
  EXPECT_EQ(numbers.missing, 150U);
  EXPECT_EQ(stream->counts().lost, 150U);
  EXPECT_GE(stream->counts().interruptions, 1U);
}

TEST_F(Losses, OfAnInterfaceThatWasPulledOutAreCounted) {
  open(8 << 20);
  send(200, true);
  take_all();
  link.reset();
  send(150, false);
  take_all();
  link.emplace("vcan0");
  take_all();
  send(200, true);
  take_all();
  EXPECT_EQ(numbers.samples, 400U);
  EXPECT_EQ(numbers.missing, 150U);
  EXPECT_EQ(stream->counts().lost, 150U);
}

TEST_F(Losses, OfAnOverloadAreCountedBySocketAndCounter) {
  open(64 << 10);
  send(20, true);
  take_all();
  send(3000, true); // nobody reads meanwhile
  std::vector<BusEvent> events;
  ASSERT_TRUE(source->read(
      events, std::chrono::milliseconds(100))); // makes room for what tells of the loss
  for (const BusEvent& event : events) {
    ASSERT_TRUE(stream->take(event, numbers));
  }
  send(20, true);
  take_all();
  EXPECT_LT(numbers.samples, 3040U);
  EXPECT_EQ(numbers.samples + numbers.missing, 3040U);
  EXPECT_EQ(stream->counts().dropped_frames, numbers.missing);
}

} // namespace
} // namespace dyncal::drivers::can
