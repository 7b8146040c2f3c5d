#include "services/records/capture/recorder.hpp"

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/bus/payload_checksum.hpp"
#include "services/records/capture/recorded_topics.hpp"
#include "tests/patience.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/mcap/recorded_example.hpp"

namespace dyncal::inline records::recording {
namespace {

wire::SampleBlock block_of(std::uint64_t number) {
  wire::SampleBlock block;
  block.bench("acc-1");
  block.source("dau");
  block.session(5);
  block.block(number);
  block.first_sample(number * 10);
  block.sample_count(10);
  block.channel_count(1);
  block.interval_numerator_ns(1);
  block.interval_denominator(1);
  block.values().assign(10, 0.1 * static_cast<double>(number));
  return block;
}

wire::Measurement measurement_of(const std::string& run) {
  wire::Measurement measurement;
  measurement.bench("acc-1");
  measurement.run(run);
  measurement.recipe("bench = \"acc-1\"\n");
  return measurement;
}

wire::CalibrationResult result_of(const std::string& run) {
  wire::CalibrationResult result;
  result.bench("acc-1");
  result.run(run);
  return result;
}

class RecorderTest : public testing::Test {
protected:
  RecorderOptions options(const std::string& run = "") const {
    RecorderOptions options;
    options.path = folder_.path() / "a.mcap";
    options.bench = "acc-1";
    options.run = run;
    options.dds = "memory";
    options.min_free_bytes = 0;
    return options;
  }
  struct Recorded {
    std::vector<std::uint64_t> blocks;
    std::vector<std::string> runs;
    std::vector<std::string> runs_of_results;
    std::string recipe;
    TextMap losses;
    ScanReport report;
  };
  Recorded read() const {
    Recorded recorded;
    auto reader = RecordingReader::open(folder_.path() / "a.mcap").value();
    recorded.report =
        reader
            .scan(
                {.message =
                     [&](const MessageInFile& one) {
                       if (one.channel.topic == bus::topics::dau_samples.name) {
                         const auto block = decode<wire::SampleBlock>(one.message.data).value();
                         EXPECT_EQ(block, block_of(block.block()));
                         recorded.blocks.push_back(block.block());
                       } else if (one.channel.topic == bus::topics::calibration_result.name) {
                         recorded.runs_of_results.push_back(
                             decode<wire::CalibrationResult>(one.message.data)
                                 .value()
                                 .run()
                                 .to_string());
                       } else if (one.channel.topic == bus::topics::measurement.name) {
                         recorded.runs.push_back(
                             decode<wire::Measurement>(one.message.data).value().run().to_string());
                       }
                     },
                 .attachment = [&](const Attachment& one) { recorded.recipe = one.data; },
                 .metadata =
                     [&](const Metadata& one) {
                       if (one.name == "dyncal.losses") {
                         recorded.losses = one.entries;
                       }
                     }})
            .value();
    return recorded;
  }

  std::vector<std::string> bytes_of_blocks() const {
    std::vector<std::string> all;
    auto reader = RecordingReader::open(folder_.path() / "a.mcap").value();
    ScanEvents events;
    events.message = [&](const MessageInFile& one) {
      if (one.channel.topic == bus::topics::dau_samples.name) {
        all.emplace_back(one.message.data);
      }
    };
    EXPECT_TRUE(reader.scan(events));
    return all;
  }

  tests::TemporaryFolder folder_;
  bus::MemoryNetwork network_;
  bus::Participant others_ = network_.join("others");
  bus::Participant own_ = network_.join("recorder");
};

TEST_F(RecorderTest, HasEveryMessageOfItsBench) {
  auto blocks = others_.writer(bus::topics::dau_samples, "acc-1").value();
  auto runs = others_.writer(bus::topics::measurement, "acc-1").value();
  auto other_bench = others_.writer(bus::topics::dau_samples, "acc-2").value();
  auto recorder = Recorder::start(own_, options()).value();
  runs.write(measurement_of("R1"));
  for (std::uint64_t number = 0; number < 500; ++number) {
    ASSERT_EQ(blocks.write(block_of(number)), bus::WriteOutcome::written);
  }
  wire::SampleBlock foreign = block_of(0);
  foreign.bench("acc-2");
  other_bench.write(foreign);
  const auto status = recorder->stop();
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_GE(status->stored, 501U); // and states of the recorder itself
  EXPECT_EQ(status->not_stored, 0U);
  const Recorded recorded = read();
  ASSERT_EQ(recorded.blocks.size(), 500U);
  EXPECT_EQ(recorded.runs, std::vector<std::string>{"R1"});
  EXPECT_EQ(recorded.recipe, "bench = \"acc-1\"\n");
  EXPECT_EQ(recorded.losses.at("dau.messages"), "500");
  EXPECT_TRUE(recorded.report.ended_in_order);
  EXPECT_EQ(recorded.report.damage_count, 0U);
}

TEST_F(RecorderTest, HasTheBytesThatCame) {
  auto blocks = others_.writer(bus::topics::dau_samples, "acc-1").value();
  auto recorder = Recorder::start(own_, options()).value();
  const auto sent = bus::encode(block_of(3));
  ASSERT_EQ(blocks.write_encoded(sent, std::chrono::seconds(1)), bus::WriteOutcome::written);
  ASSERT_TRUE(recorder->stop());
  EXPECT_EQ(bytes_of_blocks(), std::vector<std::string>{*sent});
}

// A program of another tool gives no checksum, one of an older contract has fewer members.
TEST_F(RecorderTest, BringsWhatOthersSendIntoTheFormOfItsSchema) {
  auto recorder = Recorder::start(own_, options()).value();
  const std::string whole = *bus::encode(block_of(3));
  std::string unsealed = whole;
  unsealed.replace(whole.size() - bus::checksum_bytes, bus::checksum_bytes, bus::checksum_bytes,
                   '\0');
  network_.inject(bus::topics::dau_samples.name, "acc-1", unsealed);
  std::string older = *bus::encode(block_of(4));
  network_.inject(bus::topics::dau_samples.name, "acc-1",
                  older.substr(0, older.size() - bus::checksum_bytes));
  ASSERT_TRUE(recorder->stop());
  EXPECT_EQ(bytes_of_blocks(), (std::vector<std::string>{whole, older}));
}

TEST_F(RecorderTest, LeavesOutOtherRunsWhenItRecordsOne) {
  auto runs = others_.writer(bus::topics::measurement, "acc-1").value();
  auto recorder = Recorder::start(own_, options("R2")).value();
  for (const char* run : {"R1", "R2", "R3"}) {
    runs.write(measurement_of(run));
  }
  ASSERT_TRUE(recorder->stop());
  EXPECT_EQ(read().runs, std::vector<std::string>{"R2"});
}

TEST_F(RecorderTest, IsSentNoResultsOfOtherRunsWhenItRecordsOne) {
  auto before = others_.writer_of_run(bus::topics::calibration_result, "acc-1", "R1").value();
  auto now = others_.writer_of_run(bus::topics::calibration_result, "acc-1", "R2").value();
  before.write(result_of("R1"));
  now.write(result_of("R2"));
  auto recorder = Recorder::start(own_, options("R2")).value();
  EXPECT_EQ(before.matched_readers(), 0);
  EXPECT_EQ(now.matched_readers(), 1);
  ASSERT_TRUE(recorder->stop());
  EXPECT_EQ(read().runs_of_results, std::vector<std::string>{"R2"});
}

TEST_F(RecorderTest, HasTheResultsOfAnAnalysisOfContract1) {
  auto results = others_.writer(bus::topics::calibration_result, "acc-1").value();
  auto status = others_.writer(bus::topics::service_status, "acc-1").value();
  results.write(result_of("R1"));
  results.write(result_of("R2"));
  wire::ServiceStatus report;
  report.bench("acc-1");
  report.run("R2");
  report.contract_version(1);
  auto recorder = Recorder::start(own_, options("R2")).value();
  EXPECT_EQ(results.matched_readers(), 0);
  status.write(report);
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (results.matched_readers() == 0 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  EXPECT_EQ(results.matched_readers(), 1);
  ASSERT_TRUE(recorder->stop());
  EXPECT_EQ(read().runs_of_results, std::vector<std::string>{"R2"});
}

TEST_F(RecorderTest, CountsWhatHasNoRoomInItsQueue) {
  auto blocks = others_.writer(bus::topics::dau_samples, "acc-1").value();
  RecorderOptions small = options();
  small.max_queue_bytes = 5000;
  auto recorder = Recorder::start(own_, small).value();
  for (std::uint64_t number = 0; number < 500; ++number) {
    blocks.write(block_of(number));
  }
  const auto status = recorder->stop();
  ASSERT_TRUE(status);
  EXPECT_GT(status->not_stored, 0U);
  EXPECT_GE(status->stored + status->not_stored, 500U); // and states of the recorder itself
  EXPECT_LT(read().blocks.size(), 500U);
  EXPECT_LE(read().blocks.size(), status->stored);
}

TEST_F(RecorderTest, AsksForWhatItMissedAndSaysWhatItCouldNotHave) {
  auto requests = others_.reader(bus::topics::catch_up_request, "acc-1", nullptr).value();
  auto blocks = others_.writer(bus::topics::dau_samples, "acc-1").value();
  auto recorder = Recorder::start(own_, options()).value();
  for (const std::uint64_t number : {0U, 1U, 5U}) {
    blocks.write(block_of(number));
  }
  std::optional<wire::CatchUpRequest> request;
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (!request && std::chrono::steady_clock::now() < deadline) {
    requests.take([&](const wire::CatchUpRequest& one) { request = one; });
  }
  ASSERT_TRUE(request);
  EXPECT_EQ(request->session(), 5U);
  EXPECT_EQ(request->after(), 1U);
  while (!recorder->status().catches_up && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield(); // it tells so behind its request
  }
  EXPECT_TRUE(recorder->status().catches_up);
  auto answer = others_.writer(bus::topics::catch_up_samples, request->asker().to_string()).value();
  answer.write(block_of(2));
  answer.write(block_of(3));
  wire::SampleBlock end = block_of(5);
  end.sample_count(0);
  end.values().clear();
  end.acknowledged_run(request->request());
  answer.write(end);
  while ((recorder->status().recovered < 2 || recorder->status().catches_up) &&
         std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  EXPECT_FALSE(recorder->status().catches_up);
  const auto status = recorder->stop();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->recovered, 2U);
  EXPECT_EQ(status->missing, 1U);
  const Recorded recorded = read();
  EXPECT_EQ(recorded.blocks, (std::vector<std::uint64_t>{0, 1, 5, 2, 3}));
  EXPECT_EQ(recorded.losses.at("dau.missing"), "1");
  EXPECT_EQ(recorded.losses.at("dau.recovered"), "2");
}

TEST_F(RecorderTest, TellsTheBusWhatItHasStored) {
  auto states = others_.reader(bus::topics::recorder_status, "acc-1", nullptr).value();
  auto blocks = others_.writer(bus::topics::dau_samples, "acc-1").value();
  auto recorder = Recorder::start(own_, options()).value();
  blocks.write(block_of(0));
  std::uint64_t stored = 0;
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (stored == 0 && std::chrono::steady_clock::now() < deadline) {
    states.take([&](const wire::ServiceStatus& status) {
      EXPECT_EQ(status.recording(), (folder_.path() / "a.mcap").string());
      EXPECT_EQ(status.run().to_string(), "");
      stored = status.messages_stored();
    });
  }
  EXPECT_GE(stored, 1U);
}

} // namespace
} // namespace dyncal::inline records::recording
