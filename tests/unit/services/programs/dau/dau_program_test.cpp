// The program itself: datagrams in, DDS out.
#include <atomic>

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/program_run.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/udp_port.hpp"
#include "tests/unit/drivers/smartup/datagram_writer.hpp"
#include "tests/unit/drivers/smartup/udp_sender.hpp"
#include "tests/unit/services/programs/dau/bench_text.hpp"
#include "tests/unit/services/stream/bench_listener.hpp"

namespace dyncal {
namespace {

using testing::HasSubstr;
using tests::DatagramWriter;
using tests::ProgramRun;
using tests::UdpSender;

constexpr std::uint32_t sensor_id = 0xbccb0100;
const std::string bench_name = "dau";

// A unit with one MPU9250, three declared channels and the sync ADC, that runs at its real pace
// until it is destroyed.
class SimulatedUnit {
public:
  explicit SimulatedUnit(std::uint16_t port, std::uint32_t sensor = sensor_id)
      : sender_(port), sensor_(sensor),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

  void lose_datagrams(int count) { losing_ += count; }

private:
  void run(const std::stop_token& stop) {
    auto due = std::chrono::steady_clock::now();
    for (std::uint32_t n = 1; !stop.stop_requested(); n += 12) {
      if ((n - 1) % 480 == 0) {
        describe();
      }
      DatagramWriter datagram("DATA");
      for (std::uint32_t i = n; i < n + 12; ++i) {
        datagram.data({.sensor = sensor_,
                       .sample_number = i,
                       .stamp_ns = 1'600'000'000'000'000'000 + i * 1'000'000LL,
                       .values = {{1, 0.5F}, {2, -0.5F}, {3, static_cast<float>(i)}, {11, 2.5F}}});
      }
      if (losing_ > 0) {
        --losing_;
      } else {
        sender_.send(datagram.bytes());
      }
      std::this_thread::sleep_until(due += std::chrono::milliseconds(12));
    }
  }
  void describe() {
    for (const auto& bytes : tests::mpu9250_descriptions(sensor_)) {
      sender_.send(bytes);
    }
  }

  UdpSender sender_;
  const std::uint32_t sensor_;
  std::atomic<int> losing_{0};
  std::jthread thread_;
};

class DauProgram : public testing::TestWithParam<bus::Vendor> {
protected:
  std::unique_ptr<ProgramRun> start(const std::vector<std::string>& benches) {
    std::vector<std::string> arguments{"--dds", bus::to_string(GetParam()), "--domain",
                                       std::to_string(tests::own_dds_domain())};
    arguments.insert(arguments.end(), benches.begin(), benches.end());
    return std::make_unique<ProgramRun>("dyncal-dau", arguments, folder.path());
  }
  std::string bench_file(const std::string& sensor = "0xbccb0100") {
    return folder.write(
        "bench.toml", tests::bench_text(bench_name, tests::smartup_source("dau", listen, sensor)));
  }

  tests::TemporaryFolder folder;
  const std::uint16_t port = tests::own_udp_port();
  const std::string listen = "127.0.0.1:" + std::to_string(port);
};

TEST_P(DauProgram, CarriesAUnitToTheBus) {
  auto network = tests::participant(GetParam());
  tests::BenchListener listener(network, bench_name, bus::topics::dau_samples);
  auto program = start({bench_file()});
  SimulatedUnit unit(port);

  ASSERT_TRUE(listener.armed("dau", "run-1")) << program->errors();
  const auto before = listener.samples_of("dau");
  ASSERT_TRUE(listener.until([&] { return listener.samples_of("dau") > before + 1000; }))
      << program->errors();

  ASSERT_FALSE(listener.descriptions.empty());
  const auto& description = listener.descriptions.back();
  ASSERT_EQ(description.channels().size(), 4U);
  EXPECT_EQ(description.channels()[2].name(), "acceleration_z");
  EXPECT_EQ(description.channels()[3].name(), "sync");
  EXPECT_EQ(description.channels()[3].unit(), "\\volt");
  EXPECT_EQ(description.device(), "MPU_9250");
  EXPECT_EQ(description.serial(), "0xbccb0100");
  EXPECT_EQ(description.time_base(), wire::TIME_BASE_UTC);
  EXPECT_EQ(description.stamp_instant(), wire::STAMP_DATA_READY_EDGE);

  std::uint64_t next = 0;
  for (const auto& block : listener.blocks) {
    if (block.sample_count() == 0) {
      continue;
    }
    EXPECT_TRUE(next == 0 || block.first_sample() == next);
    next = block.first_sample() + block.sample_count();
    ASSERT_EQ(block.values().size(), 4 * block.sample_count());
    EXPECT_EQ(block.values()[2 * block.sample_count()], static_cast<double>(block.first_sample()));
    EXPECT_EQ(block.stamps_ns()[0],
              1'600'000'000'000'000'000 +
                  static_cast<std::int64_t>(block.first_sample()) * 1'000'000);
  }

  unit.lose_datagrams(2);
  ASSERT_TRUE(listener.until([&] { return listener.last_status("dau")->lost_in_transit() == 24; }))
      << program->errors();
  EXPECT_EQ(listener.last_status("dau")->lost_in_device(), 0U);
  EXPECT_EQ(listener.last_status("dau")->state(), wire::SOURCE_RUNNING);

  program->send(SIGTERM);
  const auto exit = program->wait(tests::patience);
  ASSERT_TRUE(exit);
  EXPECT_EQ(*exit, 0) << program->errors();
  EXPECT_TRUE(listener.until([&] {
    return listener.end_of_stream() != nullptr && listener.saw_state("dau", wire::SOURCE_ENDED);
  }));
  EXPECT_THAT(program->errors(), HasSubstr("sensor 0xbccb0100 is there"));
  EXPECT_THAT(program->errors(), HasSubstr("samples lost on the way"));
}

TEST_P(DauProgram, SaysWhichSensorsComeWhenTheWantedOneDoesNot) {
  auto network = tests::participant(GetParam());
  tests::BenchListener listener(network, bench_name, bus::topics::dau_samples);
  auto program = start({bench_file("0x1fe40100")});
  SimulatedUnit unit(port);
  ASSERT_TRUE(listener.until([&] {
    const auto status = listener.last_status("dau");
    return status && status->state() == wire::SOURCE_SILENT &&
           status->message().find("0xbccb0100 (MPU_9250)") != std::string::npos;
  })) << program->errors();
  EXPECT_THAT(listener.last_status("dau")->message(),
              HasSubstr("sensor 0x1fe40100 does not send to " + listen));
  EXPECT_THAT(program->errors(), HasSubstr("sensor 0xbccb0100 (MPU_9250) sends to " + listen));
}

TEST_P(DauProgram, OneProcessServesSeveralBenches) {
  const std::string second = bench_name + "-b";
  const auto first_file = folder.write(
      "a.toml", tests::bench_text(bench_name, tests::smartup_source("dau", listen, "0xbccb0100")));
  const auto second_file = folder.write(
      "b.toml", tests::bench_text(second, tests::smartup_source("dau", listen, "0x1fe40100")));
  auto network = tests::participant(GetParam());
  tests::BenchListener here(network, bench_name, bus::topics::dau_samples);
  tests::BenchListener there(network, second, bus::topics::dau_samples);
  auto program = start({first_file, second_file});
  SimulatedUnit unit(port);
  SimulatedUnit other(port, 0x1fe40100);
  EXPECT_TRUE(here.until([&] { return here.samples_of("dau") > 500; })) << program->errors();
  EXPECT_TRUE(there.until([&] { return there.samples_of("dau") > 500; })) << program->errors();
}

class DauProgramErrors : public DauProgram {
protected:
  // Exit status and the only line.
  std::pair<int, std::string> failure_of(const std::vector<std::string>& benches) {
    auto program = start(benches);
    const auto exit = program->wait(tests::patience);
    EXPECT_TRUE(exit) << "it runs: " << program->errors();
    const std::string said = program->errors();
    EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
    return {exit.value_or(0), said};
  }
};

TEST_P(DauProgramErrors, APortInUseIsOneLine) {
  const int blocker = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(bind(blocker, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const auto [status, line] = failure_of({bench_file()});
  close(blocker);
  EXPECT_NE(status, 0);
  EXPECT_THAT(line,
              HasSubstr("cannot listen at UDP " + listen + ": another program uses this port"));
}

TEST_P(DauProgramErrors, AMissingFileIsOneLine) {
  const auto [status, line] = failure_of({"/no/such/bench.toml"});
  EXPECT_NE(status, 0);
  EXPECT_THAT(line, HasSubstr("/no/such/bench.toml"));
}

TEST_P(DauProgramErrors, AMalformedSensorIsOneLine) {
  const auto [status, line] = failure_of({bench_file("0xsensor")});
  EXPECT_NE(status, 0);
  EXPECT_THAT(line, HasSubstr("sensor"));
}

TEST_P(DauProgramErrors, AnAddressOfAnotherHostIsOneLine) {
  const auto file = folder.write(
      "bench.toml",
      tests::bench_text(bench_name, tests::smartup_source("dau", "192.0.2.1:7654", "0xbccb0100")));
  const auto [status, line] = failure_of({file});
  EXPECT_NE(status, 0);
  EXPECT_THAT(line, HasSubstr("no such address"));
}

const auto vendor_name = [](const auto& vendor) { return bus::to_string(vendor.param); };
INSTANTIATE_TEST_SUITE_P(Bus, DauProgram, testing::ValuesIn(bus::vendors_in_this_build()),
                         vendor_name);
INSTANTIATE_TEST_SUITE_P(Bus, DauProgramErrors,
                         testing::Values(bus::vendors_in_this_build().front()), vendor_name);

} // namespace
} // namespace dyncal
