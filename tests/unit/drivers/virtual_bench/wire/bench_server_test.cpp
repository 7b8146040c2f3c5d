// The bench behind its sockets, met through the drivers that meet real instruments.
#include "drivers/virtual_bench/wire/bench_server.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cmath>
#include <gtest/gtest.h>
#include <mutex>
#include <numbers>
#include <sys/socket.h>
#include <sys/time.h>
#include <thread>

#include "drivers/acs/socket_acs.hpp"
#include "drivers/generator/scpi_generator.hpp"
#include "drivers/virtual_bench/wire/receive_queue.hpp"
#include "tests/patience.hpp"
#include "tests/unit/drivers/collecting_sink.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

// Collects datagrams at a port of its own.
class UnitReceiver {
public:
  UnitReceiver() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    bind(socket_.number(), reinterpret_cast<sockaddr*>(&address), sizeof(address));
    socklen_t size = sizeof(address);
    getsockname(socket_.number(), reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    const timeval limit{0, 50'000};
    setsockopt(socket_.number(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
    thread_ = std::jthread([this](const std::stop_token& stop) {
      char datagram[2048];
      while (!stop.stop_requested()) {
        const ssize_t count = recv(socket_.number(), datagram, sizeof(datagram), 0);
        if (count > 0) {
          datagrams_.emplace_back(datagram, static_cast<std::size_t>(count));
        }
      }
    });
  }

  [[nodiscard]] std::uint16_t port() const { return port_; }
  std::vector<std::string> finish() {
    thread_ = {};
    return datagrams_;
  }

private:
  FileDescriptor socket_;
  std::uint16_t port_ = 0;
  std::vector<std::string> datagrams_;
  std::jthread thread_;
};

std::stop_token already_stopped() {
  std::stop_source stopped;
  stopped.request_stop();
  return stopped.get_token();
}

BenchSettings bench_settings() {
  BenchSettings settings;
  settings.preset = *preset_by_name("mpu9250-paper");
  settings.highest_level_m_s2 = 10.0;
  return settings;
}

class ServedBench : public testing::Test {
protected:
  explicit ServedBench(const BenchSettings& settings = bench_settings()) : bench_(settings) {}
  void start(double speed, double duration_s) {
    ServerSettings settings;
    settings.dau = {"127.0.0.1", receiver_.port()};
    settings.acs_listen = {"127.0.0.1", 0};
    settings.generator_listen = {"127.0.0.1", 0};
    settings.speed = speed;
    settings.duration_s = duration_s;
    server_.emplace(bench_, settings);
    const auto opened = server_->open();
    ASSERT_TRUE(opened) << opened.error().message;
    thread_ = std::jthread([this] { server_->run(stop_); });
  }
  void TearDown() override {
    stop_.raise();
    thread_ = {};
  }
  [[nodiscard]] std::string address(std::uint16_t port) const {
    return "127.0.0.1:" + std::to_string(port);
  }

  VirtualBench bench_;
  UnitReceiver receiver_;
  std::optional<BenchServer> server_;
  StopSignal stop_;
  std::jthread thread_;
};

TEST_F(ServedBench, RunsAStepAsFastAsTheConsumersAllow) {
  start(0.0, 6.0);
  acs::SocketAcs acs({address(server_->acs_port())});
  const auto description = acs.describe();
  ASSERT_TRUE(description) << description.error().message;
  tests::CollectingSink sink;
  std::jthread reading([&] { EXPECT_TRUE(acs.run(sink)); });

  auto connected = generator::ScpiGenerator::connect(address(server_->generator_port()));
  ASSERT_TRUE(connected) << connected.error().message;
  generator::Generator& source = **connected;
  ASSERT_TRUE(source.set_frequency("40"));
  ASSERT_TRUE(source.set_amplitude_v(0.2));
  const double begin_s = source.clock_now_s().value();
  ASSERT_TRUE(source.set_output(true));
  const auto end_s = source.wait_until_s(begin_s + 3.0, {});
  ASSERT_TRUE(end_s) << end_s.error().message;
  EXPECT_GE(*end_s, begin_s + 3.0);
  EXPECT_LT(*end_s, begin_s + 3.5);
  ASSERT_TRUE(source.set_output(false));
  static_cast<void>(source.wait_until_s(6.0, {}));
  reading.join();

  ASSERT_EQ(sink.descriptions.size(), 1U);
  EXPECT_EQ(sink.descriptions[0].channels[0].name, "reference");
  EXPECT_EQ(sink.descriptions[0].nominal_rate_hz, 20000.0);
  std::uint64_t next = sink.blocks.front().first_sample;
  double largest = 0.0;
  for (const SampleBlock& block : sink.blocks) {
    ASSERT_EQ(block.first_sample, next);
    next += block.samples;
    largest = std::max(largest, *std::max_element(block.values.begin(),
                                                  block.values.begin() +
                                                      static_cast<std::ptrdiff_t>(block.samples)));
    EXPECT_EQ(block.clock->stamp_ns(block.first_sample), bench_.acs().stamp_ns(block.first_sample));
  }
  EXPECT_NEAR(static_cast<double>(next), 120000.0,
              1.0); // the end of the stream comes after the last sample
  EXPECT_NEAR(largest, 10.0, 0.7);
  const auto datagrams = receiver_.finish();
  const auto data = std::count_if(datagrams.begin(), datagrams.end(),
                                  [](const std::string& d) { return d.starts_with("DATA"); });
  EXPECT_NEAR(static_cast<double>(data), 600.0, 15.0);
  EXPECT_EQ(datagrams.size() - static_cast<std::size_t>(data), 12U); // two bursts of six
}

class ServedInterferometer : public ServedBench {
protected:
  ServedInterferometer() : ServedBench(settings()) {}
  static BenchSettings settings() {
    BenchSettings settings = bench_settings();
    settings.acs_rate_hz = 1'000'000; // frames of 50 ms would be too long for the stream
    settings.interferometer.emplace();
    return settings;
  }
};

TEST_F(ServedInterferometer, SendsBothSignalsAndSync) {
  start(0.0, 1.0);
  acs::SocketAcs acs({address(server_->acs_port())});
  const auto description = acs.describe();
  ASSERT_TRUE(description) << description.error().message;
  ASSERT_EQ(description->channels.size(), 3U);
  tests::CollectingSink sink;
  std::jthread reading([&] { EXPECT_TRUE(acs.run(sink)); });
  auto connected = generator::ScpiGenerator::connect(address(server_->generator_port()));
  ASSERT_TRUE(connected) << connected.error().message;
  generator::Generator& source = **connected;
  ASSERT_TRUE(source.set_frequency("80"));
  ASSERT_TRUE(source.set_amplitude_v(0.2));
  ASSERT_TRUE(source.set_output(true));
  static_cast<void>(source.wait_until_s(1.0, {}));
  reading.join();

  std::uint64_t next = sink.blocks.front().first_sample;
  double high[3] = {-10.0, -10.0, -10.0};
  double low[3] = {10.0, 10.0, 10.0};
  for (const SampleBlock& block : sink.blocks) {
    ASSERT_EQ(block.first_sample, next);
    next += block.samples;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const auto values =
          block.values.begin() + static_cast<std::ptrdiff_t>(channel * block.samples);
      const auto [least, most] =
          std::minmax_element(values, values + static_cast<std::ptrdiff_t>(block.samples));
      low[channel] = std::min(low[channel], *least);
      high[channel] = std::max(high[channel], *most);
    }
  }
  EXPECT_NEAR(static_cast<double>(next), 1e6, 2.0);
  const InterferometerTruth& truth = bench_.acs().interferometer()->truth();
  EXPECT_NEAR((high[0] - low[0]) / 2.0, truth.radius_v, 0.02 * truth.radius_v);
  EXPECT_NEAR((high[0] + low[0]) / 2.0, truth.p_v, 0.01);
  EXPECT_NEAR((high[1] - low[1]) / 2.0, truth.radius_v / truth.r, 0.02 * truth.radius_v);
  EXPECT_NEAR(high[2], VirtualBench::sync_amplitude_v, 0.02);
}

TEST_F(ServedBench, KeepsRealTimeWhenAskedTo) {
  start(2.0, 1.0);
  const auto begin = std::chrono::steady_clock::now();
  thread_ = {};
  const double passed_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GT(passed_s, 0.45);
  EXPECT_DOUBLE_EQ(bench_.now_s(), 1.0);
}

TEST_F(ServedBench, WaitsForAClientOfTheStreamThatDoesNotRead) {
  start(1000.0, 1000.0);
  StopSignal never;
  const auto connection =
      TcpConnection::connect({"127.0.0.1", server_->acs_port()}, tests::patience, never);
  ASSERT_TRUE(connection);
  auto generator = generator::ScpiGenerator::connect(address(server_->generator_port()));
  ASSERT_TRUE(generator) << generator.error().message;
  double before_s = -1.0;
  double now_s = (*generator)->clock_now_s().value();
  // Bench time comes to a stand when the sockets' buffers are full.
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (now_s != before_s && std::chrono::steady_clock::now() < deadline) {
    before_s = now_s;
    now_s = (*generator)->wait_until_s(now_s + 0.5, already_stopped()).value();
  }
  EXPECT_EQ(now_s, before_s);
  EXPECT_LT(now_s, 60.0); // the receive buffer of the client may be large
}

TEST_F(ServedBench, WaitsForAReceiverOfTheDatagramsThatDoesNotRead) {
  receiver_.finish();
  start(1000.0, 0.0);
  auto generator = generator::ScpiGenerator::connect(address(server_->generator_port()));
  ASSERT_TRUE(generator) << generator.error().message;
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  std::size_t waiting = 0;
  std::size_t before = 0;
  do {
    before = waiting;
    ASSERT_TRUE(
        (*generator)->wait_until_s((*generator)->clock_now_s().value() + 0.5, already_stopped()));
    waiting = udp_receive_queue(receiver_.port());
  } while ((waiting == 0 || waiting != before) && std::chrono::steady_clock::now() < deadline);
  EXPECT_GT(waiting, 64U * 1024U);
  EXPECT_LT(waiting, 160U * 1024U); // nothing had to be dropped
}

TEST_F(ServedBench, PassesErrorsOfTheInstrumentOn) {
  start(1.0, 0.0);
  auto generator = generator::ScpiGenerator::connect(address(server_->generator_port()));
  ASSERT_TRUE(generator) << generator.error().message;
  const auto refused = (*generator)->set_frequency("1e9");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::refused);
  EXPECT_NE(refused.error().message.find("-222,\"Data out of range\""), std::string::npos)
      << refused.error().message;
  EXPECT_TRUE((*generator)->set_frequency("50"));
}

TEST_F(ServedBench, SwitchesTheOutputOffWhenTheGeneratorIsGivenBack) {
  start(1.0, 0.0);
  {
    auto generator = generator::ScpiGenerator::connect(address(server_->generator_port()));
    ASSERT_TRUE(generator);
    ASSERT_TRUE((*generator)->set_output(true));
  }
  stop_.raise();
  thread_ = {};
  EXPECT_FALSE(bench_.drive().on);
}

// In packets whose bytes may be line ends.
TEST_F(ServedBench, PlaysTheWaveformThatTheDriverOfTheGeneratorLoads) {
  constexpr double two_pi = 2.0 * std::numbers::pi;
  constexpr double rate_hz = 2000.0;
  std::vector<double> samples_v;
  for (int i = 0; i < 20'000; ++i) {
    const double t = i / rate_hz;
    samples_v.push_back(0.2 * std::sin(two_pi * 10.1 * t) + 0.1 * std::cos(two_pi * 63.1 * t));
  }
  start(1.0, 0.0);
  {
    auto generator = generator::ScpiGenerator::connect(address(server_->generator_port()), 0.4);
    ASSERT_TRUE(generator) << generator.error().message;
    const auto loaded = (*generator)->set_waveform(samples_v, rate_hz);
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_TRUE((*generator)->set_output(true));
    for (double& value : samples_v) {
      value *= 2.0;
    }
    const auto refused = (*generator)->set_waveform(samples_v, rate_hz);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_setting); // above its maximum voltage
  }
  stop_.raise();
  thread_ = {};
  const std::vector<DriveLine> lines = bench_.drive().lines;
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NEAR(lines[0].frequency_hz, 10.1, 1e-9);
  EXPECT_NEAR(lines[0].amplitude_v, 0.2, 1e-4);
  EXPECT_NEAR(lines[0].phase_rad, 0.0, 1e-3);
  EXPECT_NEAR(lines[1].frequency_hz, 63.1, 1e-9);
  EXPECT_NEAR(lines[1].amplitude_v, 0.1, 1e-4);
  EXPECT_NEAR(lines[1].phase_rad, 0.5 * std::numbers::pi, 1e-3);
}

TEST(BenchServer, RefusesAnAddressThatIsTaken) {
  VirtualBench bench(bench_settings());
  UnitReceiver receiver;
  ServerSettings settings;
  settings.dau = {"127.0.0.1", receiver.port()};
  settings.acs_listen = {"127.0.0.1", 0};
  settings.generator_listen = {"127.0.0.1", 0};
  BenchServer first(bench, settings);
  ASSERT_TRUE(first.open());
  settings.acs_listen.port = first.acs_port();
  BenchServer second(bench, settings);
  const auto opened = second.open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::refused);
}

// What another program left in the generator, of two families.
struct LeftOverCase {
  GeneratorWords words;
  LeftInGenerator left;
  const char* refused; // what the driver names; nothing: it goes on
};

class LeftOverBench : public ServedBench, public testing::WithParamInterface<LeftOverCase> {
protected:
  static BenchSettings settings() {
    BenchSettings result = bench_settings();
    result.generator_words = GetParam().words;
    result.faults.left_in_generator = GetParam().left;
    return result;
  }
  LeftOverBench() : ServedBench(settings()) {}

  std::string ask(const std::string& line) {
    StopSignal never;
    auto connection =
        TcpConnection::connect({"127.0.0.1", server_->generator_port()}, tests::patience, never);
    if (!connection || !connection->send_all(line + "\n", tests::patience)) {
      return "";
    }
    return connection->read_line(100, tests::patience).value_or("");
  }
};

TEST_P(LeftOverBench, IsResetAndReadBackBeforeItsOutputIsOn) {
  start(1.0, 0.0);
  auto generator = generator::ScpiGenerator::connect(address(server_->generator_port()));
  if (GetParam().refused != nullptr) {
    ASSERT_FALSE(generator);
    EXPECT_EQ(generator.error().code, ErrorCode::refused);
    EXPECT_NE(generator.error().message.find(GetParam().refused), std::string::npos)
        << generator.error().message;
    return;
  }
  ASSERT_TRUE(generator) << generator.error().message;
  EXPECT_TRUE((*generator)->set_output(true));
  EXPECT_TRUE((*generator)->output_is_on().value().value());
  EXPECT_TRUE((*generator)->set_output(false));
  // A person at the front panel, between two steps.
  EXPECT_NE(ask(":SOURce1:VOLTage:OFFSet 1.5\n:SYSTem:ERRor?"), "");
  const auto refused = (*generator)->set_output(true);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("its DC offset is 1.5 V"), std::string::npos)
      << refused.error().message;
  EXPECT_FALSE((*generator)->output_is_on().value().value());
}

constexpr auto dg4000 = GeneratorWords::dg4000;
constexpr auto keysight = GeneratorWords::keysight_33500;
INSTANTIATE_TEST_SUITE_P(
    OfBothFamilies, LeftOverBench,
    testing::Values(LeftOverCase{dg4000, {}, nullptr}, LeftOverCase{keysight, {}, nullptr},
                    LeftOverCase{dg4000, {.offset_v = -2.0, .in_burst = true}, nullptr},
                    LeftOverCase{keysight, {.offset_v = 2.0, .in_burst = true}, nullptr},
                    LeftOverCase{dg4000, {.offset_v = 0.05, .is_kept = true}, "(DC offset)"},
                    LeftOverCase{keysight, {.offset_v = -2.0, .is_kept = true}, "(DC offset)"},
                    LeftOverCase{dg4000, {.in_burst = true, .is_kept = true}, "(burst)"},
                    LeftOverCase{keysight, {.in_burst = true, .is_kept = true}, "(burst)"}));

} // namespace
} // namespace dyncal::drivers::virtual_bench
