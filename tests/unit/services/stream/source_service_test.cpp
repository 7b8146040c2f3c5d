#include "services/stream/source_service.hpp"

#include <sys/resource.h>

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/vendor.hpp"
#include "tests/unit/services/stream/bench_listener.hpp"

namespace dyncal::inline stream {
namespace {

using testing::HasSubstr;

const std::string bench_name = "acc";

drivers::SampleBlock block_from(std::uint64_t first, std::size_t samples = 50) {
  drivers::SampleBlock block;
  block.first_sample = first;
  block.samples = samples;
  block.clock = drivers::RegularClock{
      .origin_ns = 1000, .interval_numerator_ns = 1'000'000, .interval_denominator = 1};
  for (std::size_t i = 0; i < 2 * samples; ++i) {
    block.values.push_back(static_cast<double>(first + i));
  }
  return block;
}

drivers::SourceDescription two_channels(const std::string& first_name = "reference") {
  drivers::SourceDescription description;
  description.device = "test instrument";
  for (const auto& name : {first_name, std::string("sync")}) {
    drivers::ChannelDescription channel;
    channel.name = name;
    channel.unit = "\\volt";
    description.channels.push_back(channel);
  }
  description.nominal_rate_hz = 1000.0;
  return description;
}

class SourceServiceTest : public testing::TestWithParam<bus::Vendor> {
protected:
  std::shared_ptr<SourcePublisher>
  add(const std::string& bench = bench_name, const std::string& source = "acs",
      std::chrono::nanoseconds silent_after = std::chrono::seconds(2)) {
    auto publisher = service->add(
        {.bench = bench, .source = source, .kind = SourceKind::acs, .silent_after = silent_after});
    EXPECT_TRUE(publisher) << publisher.error().message;
    return *publisher;
  }

  bus::Participant network = tests::participant(GetParam());
  bus::Participant reader_network = tests::participant(GetParam());
  std::unique_ptr<SourceService> service = SourceService::create(network, {.software = "test 1.0"});
  tests::BenchListener listener{reader_network, bench_name, bus::topics::acs_samples};
};

TEST_P(SourceServiceTest, PublishesDescriptionStatusAndBlocksInOrder) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.armed("acs", "run-1"));
  for (std::uint64_t n = 0; n < 100; ++n) {
    source->take(block_from(n * 50));
  }
  ASSERT_TRUE(listener.until([&] { return listener.samples_of("acs") == 5000; }));

  std::uint64_t next_sample = 0;
  for (std::size_t i = 0; i < listener.blocks.size(); ++i) {
    const auto& block = listener.blocks[i];
    EXPECT_EQ(block.block(), i);
    EXPECT_EQ(block.session(), listener.blocks[0].session());
    EXPECT_NE(block.session(), 0U);
    EXPECT_EQ(block.first_sample(), next_sample);
    EXPECT_EQ(block.channel_count(), block.sample_count() == 0 ? 0U : 2U);
    next_sample += block.sample_count();
  }
  const auto& last = listener.blocks.back();
  EXPECT_EQ(last.interval_numerator_ns(), 1'000'000);
  EXPECT_EQ(last.values()[0], 4950.0);
  ASSERT_FALSE(listener.descriptions.empty());
  EXPECT_EQ(listener.descriptions.back().session(), last.session());
  EXPECT_EQ(listener.descriptions.back().channels().size(), 2U);
  EXPECT_EQ(listener.descriptions.back().kind(), wire::SOURCE_ACS);
  EXPECT_EQ(listener.descriptions.back().software(), "test 1.0");
  EXPECT_TRUE(listener.until([&] { return listener.saw_state("acs", wire::SOURCE_RUNNING); }));
}

TEST_P(SourceServiceTest, AnswersArmWithAnEmptyBlockBehindWhatWasWritten) {
  auto source = add();
  source->describe(two_channels());
  source->take(block_from(0));
  service->start();
  ASSERT_TRUE(listener.armed("acs", "run-7"));
  const auto answer = std::ranges::find_if(
      listener.blocks, [](const auto& block) { return block.acknowledged_run() == "run-7"; });
  EXPECT_EQ(answer->sample_count(), 0U);
  EXPECT_EQ(answer->first_sample(), 50U);
  EXPECT_FALSE(answer->end_of_stream());
}

TEST_P(SourceServiceTest, BlocksAndAnswersWaitForTheDescription) {
  auto source = add();
  source->take(block_from(0));
  service->start();
  ASSERT_TRUE(listener.until([&] { return listener.last_status("acs").has_value(); }));
  listener.arm("acs", "run-1");
  ASSERT_TRUE(listener.until([&] { return listener.statuses.size() >= 3; }));
  EXPECT_TRUE(listener.blocks.empty());
  source->describe(two_channels());
  EXPECT_TRUE(listener.until([&] { return listener.samples_of("acs") == 50; }));
}

TEST_P(SourceServiceTest, PublishesInDsiWhatComesInG) {
  DeviceIdentity identity;
  identity.units = {{"x", *parse_channel_unit("g")}};
  auto publisher = service->add({.bench = bench_name, .source = "acs", .identity = identity});
  ASSERT_TRUE(publisher) << publisher.error().message;
  drivers::SourceDescription description = two_channels("x");
  description.channels[0].unit = "";
  (*publisher)->take(block_from(1, 2)); // before it is known which column is in g
  (*publisher)->describe(description);
  service->start();
  ASSERT_TRUE(listener.until(
      [&] { return listener.samples_of("acs") == 2 && !listener.descriptions.empty(); }));
  const auto& values = listener.blocks.back().values();
  ASSERT_EQ(values.size(), 4U);
  EXPECT_EQ(values[0], 9.80665);
  EXPECT_EQ(values[1], 2 * 9.80665);
  EXPECT_EQ(values[2], 3.0);
  EXPECT_EQ(listener.descriptions.back().channels()[0].unit(), R"(\metre\second\tothe{-2})");
}

TEST_P(SourceServiceTest, AChangedDescriptionIsPublishedAgain) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.until([&] { return listener.descriptions.size() == 1; }));
  source->describe(two_channels());
  source->describe(two_channels("laser"));
  ASSERT_TRUE(
      listener.until([&] { return listener.descriptions.back().channels()[0].name() == "laser"; }));
  EXPECT_EQ(listener.descriptions.size(), 2U);
}

TEST_P(SourceServiceTest, ANewSessionHasItsOwnNumberAndDescription) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.armed("acs", "run-1"));
  source->take(block_from(0));
  source->begin_session();
  source->take(block_from(0));
  ASSERT_TRUE(listener.until([&] { return listener.samples_of("acs") == 100; }));
  // A repeated request may still be answered, before or behind the samples: in either session
  // answers and samples are counted together, from 0 on.
  std::vector<std::uint64_t> sessions;
  std::uint64_t next = 0;
  for (const auto& block : listener.blocks) {
    if (sessions.empty() || block.session() != sessions.back()) {
      sessions.push_back(block.session());
      next = 0;
    }
    EXPECT_EQ(block.block(), next++);
    EXPECT_TRUE(block.sample_count() == 0 || block.first_sample() == 0);
  }
  ASSERT_EQ(sessions.size(), 2U);
  EXPECT_NE(sessions[0], sessions[1]);
  EXPECT_TRUE(
      listener.until([&] { return listener.descriptions.back().session() == sessions[1]; }));
}

TEST_P(SourceServiceTest, SaysWhenASourceIsSilentAndWhenItIsThereAgain) {
  auto source = add(bench_name, "acs", std::chrono::milliseconds(300));
  source->describe(two_channels());
  service->start();
  EXPECT_TRUE(listener.until([&] { return listener.saw_state("acs", wire::SOURCE_SILENT); }));
  // Readers get the newest state only: the source goes on until it has been seen.
  std::uint64_t sample = 0;
  EXPECT_TRUE(listener.until([&] {
    source->take(block_from(sample));
    sample += 50;
    return listener.last_status("acs")->state() == wire::SOURCE_RUNNING;
  }));
  EXPECT_TRUE(
      listener.until([&] { return listener.last_status("acs")->state() == wire::SOURCE_SILENT; }));
}

TEST_P(SourceServiceTest, AFileIsNeverSilent) {
  auto source = add(bench_name, "acs", std::chrono::nanoseconds(0));
  source->describe(two_channels());
  service->start();
  EXPECT_TRUE(listener.until([&] { return listener.statuses.size() >= 6; }));
  EXPECT_EQ(listener.last_status("acs")->state(), wire::SOURCE_STARTING);
}

TEST_P(SourceServiceTest, EndsTheStreamInBand) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.armed("acs", "run-1"));
  source->take(block_from(0));
  source->end();
  ASSERT_TRUE(listener.until([&] { return listener.saw_state("acs", wire::SOURCE_ENDED); }));
  ASSERT_TRUE(listener.until([&] { return listener.end_of_stream() != nullptr; }));
  EXPECT_EQ(listener.end_of_stream()->sample_count(), 0U);
  EXPECT_EQ(listener.end_of_stream()->first_sample(), 50U);
  EXPECT_EQ(listener.samples_of("acs"), 50U);
}

TEST_P(SourceServiceTest, AFailedSourceSaysWhy) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  source->fail("127.0.0.1:5026 closed the connection");
  ASSERT_TRUE(listener.until([&] { return listener.saw_state("acs", wire::SOURCE_FAILED); }));
  EXPECT_EQ(listener.last_status("acs")->message(), "127.0.0.1:5026 closed the connection");
}

TEST_P(SourceServiceTest, StopPublishesWhatIsHeldAndSaysEnded) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.armed("acs", "run-1"));
  for (std::uint64_t n = 0; n < 200; ++n) {
    source->take(block_from(n * 50));
  }
  service->stop();
  EXPECT_TRUE(listener.until(
      [&] { return listener.samples_of("acs") == 10000 && listener.end_of_stream() != nullptr; }));
  EXPECT_EQ(listener.end_of_stream()->first_sample(), 10000U);
  EXPECT_TRUE(listener.until([&] { return listener.saw_state("acs", wire::SOURCE_ENDED); }));
}

TEST_P(SourceServiceTest, PublishesTheCountsOfTheDriver) {
  auto source = add();
  source->describe(two_channels());
  source->count({.received = 10,
                 .lost_in_device = 1,
                 .lost_on_way = 2,
                 .duplicates = 3,
                 .rejected = 4,
                 .stamps_not_trusted = 5,
                 .causes = {{"late", 6}},
                 .clock_uncertainty_s = 1e-7});
  source->set_message("all is well");
  service->start();
  ASSERT_TRUE(listener.until([&] { return listener.last_status("acs").has_value(); }));
  const auto status = *listener.last_status("acs");
  EXPECT_EQ(status.received(), 10U);
  EXPECT_EQ(status.lost_in_device(), 1U);
  EXPECT_EQ(status.lost_in_transit(), 2U);
  EXPECT_EQ(status.duplicates(), 3U);
  EXPECT_EQ(status.rejected(), 4U);
  EXPECT_EQ(status.stamps_not_trusted(), 5U);
  EXPECT_EQ(status.causes().at(0).name(), "late");
  EXPECT_EQ(status.message(), "all is well");
  EXPECT_EQ(status.clock_uncertainty_s(), 1e-7);
}

TEST_P(SourceServiceTest, MeasuresTheRate) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  std::jthread device([&](const std::stop_token& stop) {
    auto due = std::chrono::steady_clock::now();
    for (std::uint64_t n = 0; !stop.stop_requested(); n += 50) {
      source->take(block_from(n));
      std::this_thread::sleep_until(
          due += std::chrono::milliseconds(50)); // the pace of the device, not a wait for a result
    }
  });
  EXPECT_TRUE(listener.until([&] {
    const auto status = listener.last_status("acs");
    return status && status->rate_hz() > 950 && status->rate_hz() < 1050;
  }));
}

TEST_P(SourceServiceTest, AFileWaitsForItsRunAndPlaysEachRunOnce) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  std::vector<std::string> runs;
  std::mutex mutex;
  const std::jthread file([&](const std::stop_token& stop) {
    while (const auto run = source->wait_for_run(stop)) {
      const std::lock_guard lock(mutex);
      runs.push_back(*run);
    }
  });
  const auto played = [&] {
    const std::lock_guard lock(mutex);
    return runs;
  };
  listener.set_state("run-1", wire::MEASUREMENT_PLANNED);
  ASSERT_TRUE(listener.armed("acs", "run-1"));
  EXPECT_TRUE(played().empty());
  listener.set_state("run-1", wire::MEASUREMENT_RUNNING);
  ASSERT_TRUE(listener.until([&] { return played() == std::vector<std::string>{"run-1"}; }));
  listener.set_state("run-1", wire::MEASUREMENT_DONE);
  listener.set_state("run-2", wire::MEASUREMENT_RUNNING);
  EXPECT_TRUE(listener.until([&] {
    return played() == std::vector<std::string>{"run-1", "run-2"};
  }));
}

TEST_P(SourceServiceTest, BenchesAreKeptApart) {
  auto here = add(bench_name);
  auto elsewhere = add(bench_name + "-b");
  here->describe(two_channels());
  elsewhere->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.armed("acs", "run-1"));
  elsewhere->take(block_from(0, 10));
  here->take(block_from(0));
  ASSERT_TRUE(listener.until([&] { return listener.samples_of("acs") > 0; }));
  for (const auto& block : listener.blocks) {
    EXPECT_EQ(block.bench().c_str(), bench_name);
  }
}

TEST_P(SourceServiceTest, RefusesNamesThatCannotBe) {
  add(bench_name, "acs");
  const auto twice = service->add({.bench = bench_name, .source = "acs"});
  ASSERT_FALSE(twice);
  EXPECT_THAT(twice.error().message, HasSubstr("'acs' twice"));
  EXPECT_FALSE(service->add({.bench = "", .source = "acs"}));
  EXPECT_FALSE(service->add({.bench = bench_name, .source = std::string(65, 'x')}));
  EXPECT_TRUE(service->add({.bench = std::string(64, 'b'), .source = std::string(64, 's')}));
}

TEST_P(SourceServiceTest, RestsWhenThereIsNothingToDo) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.until([&] { return listener.last_status("acs").has_value(); }));
  const auto used_s = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) * 1e-6;
  };
  const double before_s = used_s();
  const auto begin = listener.statuses.size();
  ASSERT_TRUE(listener.until([&] { return listener.statuses.size() >= begin + 4; })); // two seconds
  EXPECT_LT(used_s() - before_s, 1.0) << "a thread that spins would have used two seconds";
}

TEST_P(SourceServiceTest, AReaderThatHangsHoldsNothingUp) {
  if (GetParam() == bus::Vendor::cyclone_dds) {
    GTEST_SKIP() << "readers of one process share a queue in Cyclone DDS, and one that hangs holds "
                    "up the others of its process: tests/interop has one process a reader";
  }
  auto hanging = reader_network
                     .reader<wire::SampleBlock>(bus::topics::acs_samples, bus::Profile::samples,
                                                bench_name, nullptr)
                     .value();
  auto source = add();
  source->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.armed("acs", "run-1"));
  // More than that reader holds, faster than real time; the other one takes all the while.
  constexpr std::uint64_t blocks = 1800;
  std::jthread device([&](const std::stop_token& stop) {
    for (std::uint64_t n = 0; n < blocks && !stop.stop_requested(); ++n) {
      source->take(block_from(n * 50));
      std::this_thread::sleep_for(std::chrono::milliseconds(4)); // its pace
    }
  });
  EXPECT_TRUE(listener.until([&] { return listener.samples_of("acs") == blocks * 50; }))
      << listener.samples_of("acs");
  EXPECT_EQ(listener.last_status("acs")->dropped_in_service(), 0U);
}

TEST_P(SourceServiceTest, AStreamFasterThanRealTimeGoesAsFastAsItsReaders) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.armed("acs", "run-1"));
  constexpr std::uint64_t blocks = 3000;
  for (std::uint64_t n = 0; n < blocks; ++n) {
    source->take(block_from(n * 50));
  }
  ASSERT_TRUE(listener.until([&] { return listener.samples_of("acs") == blocks * 50; }))
      << listener.samples_of("acs");
}

TEST_P(SourceServiceTest, GivesAgainWhatItHasSentToWhoAsks) {
  auto source = add();
  source->describe(two_channels());
  service->start();
  ASSERT_TRUE(listener.armed("acs", "run-1"));
  for (std::uint64_t n = 0; n < 100; ++n) {
    source->take(block_from(n * 50));
  }
  ASSERT_TRUE(listener.until([&] { return listener.samples_of("acs") == 5000; }));
  const auto bell = std::make_shared<bus::WakeUp>();
  auto answer =
      reader_network.reader(bus::topics::catch_up_samples, "analysis@host/acc", bell).value();
  auto requests = reader_network.writer(bus::topics::catch_up_request, bench_name).value();
  wire::CatchUpRequest request;
  request.bench(bench_name);
  request.source("acs");
  request.asker("analysis@host/acc");
  request.request("request-1");
  request.run("run-1");
  std::vector<wire::SampleBlock> again;
  const auto ended = [&] {
    answer.take([&](const wire::SampleBlock& block) { again.push_back(block); });
    return !again.empty() && again.back().acknowledged_run() == "request-1";
  };
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (!ended() && std::chrono::steady_clock::now() < deadline) {
    requests.write(request);
    bell->wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(250));
  }
  ASSERT_FALSE(again.empty());
  ASSERT_EQ(again.back().acknowledged_run(), "request-1");
  again.pop_back();
  const auto first = std::ranges::find_if(
      listener.blocks, [](const auto& block) { return block.acknowledged_run() == "run-1"; });
  EXPECT_EQ(again, std::vector<wire::SampleBlock>(first, listener.blocks.end()));
}

INSTANTIATE_TEST_SUITE_P(Bus, SourceServiceTest, testing::ValuesIn(bus::vendors_in_this_build()),
                         [](const auto& vendor) { return bus::to_string(vendor.param); });

} // namespace
} // namespace dyncal::inline stream
