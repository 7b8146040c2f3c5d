// What a source sends, seen by whoever scrapes its program, and the turns of its loop.
#include "services/stream/supervised.hpp"

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/daemon/supervision/metrics_server.hpp"
#include "tests/patience.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/udp_port.hpp"
#include "tests/unit/services/daemon/supervision/notify_socket.hpp"
#include "tests/unit/services/daemon/supervision/scrape.hpp"

namespace dyncal::inline stream {
namespace {

const std::string of_source = R"({bench="acc",source="acs"})";

class SupervisedTest : public testing::Test {
protected:
  std::shared_ptr<SourcePublisher> add(SourceService& service) {
    auto source = std::move(*service.add({.bench = "acc", .source = "acs"}));
    drivers::SourceDescription description;
    description.channels.resize(1);
    source->describe(description);
    return source;
  }
  static drivers::SampleBlock block_from(std::uint64_t first) {
    drivers::SampleBlock block;
    block.first_sample = first;
    block.samples = 10;
    block.clock = drivers::RegularClock{
        .origin_ns = 0, .interval_numerator_ns = 1'000'000, .interval_denominator = 1};
    block.values.resize(10);
    return block;
  }

  bus::MemoryNetwork network_;
  bus::Participant participant_ = network_.join("source");
  ProgramIdentity identity_{"dyncal-acs", "lab-2", 1, "dyncal 0.2.0", "memory"};
};

TEST_F(SupervisedTest, OffersWhatItHasSentAndLost) {
  if (!can_serve_metrics()) {
    GTEST_SKIP() << "this build has no prometheus-cpp";
  }
  const int port = tests::own_udp_port(); // no other test of this machine has its number
  const auto supervisor =
      std::move(*Supervisor::create(identity_, "127.0.0.1:" + std::to_string(port)));
  const auto service =
      SourceService::create(participant_, supervised(*supervisor, participant_, false));
  const auto source = add(*service);
  service->start();
  for (std::uint64_t block = 0; block < 7; ++block) {
    source->take(block_from(10 * block));
  }
  drivers::SampleCounts counts;
  counts.received = 70;
  counts.lost_on_way = 4;
  counts.duplicates = 3;
  source->count(counts);
  std::map<std::string, double> values;
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  const auto shown = [&](const std::string& name) { return values[name + of_source]; };
  do {
    values = tests::metrics_in(tests::fetch_metrics(port));
  } while ((shown("dyncal_source_blocks_written_total") < 7 ||
            shown("dyncal_source_samples_received_total") < 70) &&
           std::chrono::steady_clock::now() < deadline);
  EXPECT_EQ(shown("dyncal_source_blocks_written_total"), 7);
  EXPECT_EQ(shown("dyncal_source_samples_received_total"), 70);
  EXPECT_EQ(shown("dyncal_source_samples_duplicate_total"), 3);
  EXPECT_EQ(shown("dyncal_source_samples_dropped_total"), 0);
  EXPECT_EQ(values[R"(dyncal_source_samples_lost_total{bench="acc",place="transit",source="acs"})"],
            4);
}

TEST_F(SupervisedTest, ShowsTheWatchdogThatItsLoopTurns) {
  if (!can_notify_service_manager()) {
    GTEST_SKIP() << "this build has no libsystemd";
  }
  const tests::TemporaryFolder folder;
  tests::NotifySocket socket(folder.path().string(), std::chrono::seconds(1));
  const auto supervisor = std::move(*Supervisor::create(identity_, ""));
  supervisor->describe("bench acc");
  const auto service =
      SourceService::create(participant_, supervised(*supervisor, participant_, false));
  const auto source = add(*service);
  supervisor->serving();
  EXPECT_EQ(socket.next(), "") << "its loop has not turned";
  service->start();
  const auto limit = std::chrono::duration_cast<std::chrono::milliseconds>(tests::patience);
  EXPECT_EQ(socket.next(limit), "READY=1\nSTATUS=bench acc");
  for (int sign = 0; sign < 3; ++sign) {
    EXPECT_EQ(socket.next(limit), "WATCHDOG=1");
  }
  service->stop();
  while (!socket.next().empty()) {
  }
  EXPECT_EQ(socket.next(std::chrono::milliseconds(1200)), "") << "no loop, no sign";
}

} // namespace
} // namespace dyncal::inline stream
