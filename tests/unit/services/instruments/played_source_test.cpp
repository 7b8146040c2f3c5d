#include "services/instruments/played_source.hpp"

#include <deque>
#include <functional>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

#include "services/bus/bus.hpp"
#include "services/contract/topics.hpp"
#include "services/stream/source_service.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"
#include "tests/unit/drivers/files/temporary_file.hpp"

namespace dyncal::inline instruments {
namespace {

using drivers::files::TemporaryFile;
using testing::HasSubstr;

SourceSettings file_settings(const std::filesystem::path& path) {
  SourceSettings settings;
  settings.name = "acs";
  FileSourceSettings file;
  file.path = path;
  settings.driver = file;
  return settings;
}

TEST(KindOf, FollowsFromTheRolesOfASource) {
  MethodSettings method;
  method.reference = {"laser", "reference"};
  method.sync_acs = {"laser", "sync"};
  method.sync_dau = {"unit", "sync"};
  method.dut = {{"unit", "z"}, {"other", "z"}};
  EXPECT_EQ(kind_of(method, "laser"), SourceKind::acs);
  EXPECT_EQ(kind_of(method, "unit"), SourceKind::dau);
  EXPECT_EQ(kind_of(method, "other"), SourceKind::dau);
  EXPECT_EQ(kind_of(method, "spare"), SourceKind::acs);
}

TEST(PlayedSource, SaysWhatIsWrongWithItsSettings) {
  const auto missing = PlayedSource::prepare(file_settings("/nowhere/acs.csv"), {});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::bad_file);
  EXPECT_THAT(missing.error().message, HasSubstr("source 'acs': /nowhere/acs.csv"));

  const TemporaryFile file("played_rate.csv", "a\n1\n");
  SourceSettings rate = file_settings(file.path());
  std::get<FileSourceSettings>(rate.driver).sample_rate_hz = -5.0;
  const auto impossible = PlayedSource::prepare(rate, {});
  ASSERT_FALSE(impossible);
  EXPECT_THAT(impossible.error().message, HasSubstr("sample_rate_hz = -5"));
}

TEST(PlayedSource, StopsTryingToReachAnInstrumentWhenAskedTo) {
  SourceSettings settings;
  settings.name = "acs";
  settings.driver = SocketSourceSettings{.address = "127.0.0.1:1"};
  std::stop_source stop;
  stop.request_stop();
  const auto prepared = PlayedSource::prepare(settings, stop.get_token());
  ASSERT_FALSE(prepared);
  EXPECT_EQ(prepared.error().code, ErrorCode::interrupted);
}

// A service with one file source, and what a reader gets of it.
class PlayedFile : public testing::Test {
protected:
  void SetUp() override {
    std::string text = "t_ns,reference,sync\n";
    for (int i = 0; i < 5000; ++i) {
      text += std::to_string(i * 50'000) + "," + std::to_string(i) + ",0\n";
    }
    file_.emplace("played.csv", text);
    bus::ParticipantOptions options;
    options.vendor = bus::vendors_in_this_build().front();
    options.domain = tests::own_dds_domain();
    participant_.emplace(bus::Participant::create(options).value());
    service_ = SourceService::create(*participant_, {.software = "test"});
    BenchFile bench;
    bench.bench = "bench";
    publisher_ = service_->add(options_of(bench, file_settings(file_->path()))).value();
    reader_.emplace(participant_
                        ->reader<dyncal::wire::SampleBlock>(
                            bus::topics::acs_samples, bus::Profile::samples, "bench", wake_up_)
                        .value());
    runs_.emplace(participant_
                      ->writer<dyncal::wire::Measurement>(bus::topics::measurement,
                                                          bus::Profile::state, "bench")
                      .value());
    commands_.emplace(
        participant_->writer<dyncal::wire::Command>(bus::topics::command, "bench").value());
    service_->start();
    SourceSettings settings = file_settings(file_->path());
    std::get<FileSourceSettings>(settings.driver).play_speed = speed_;
    source_.emplace(PlayedSource::prepare(settings, {}).value());
    thread_ = std::jthread(
        [this](const std::stop_token& stop) { EXPECT_TRUE(source_->run(*publisher_, stop)); });
  }
  void TearDown() override {
    thread_ = {};
    service_->stop();
  }

  void set_state(const std::string& run, dyncal::wire::MeasurementState state) {
    dyncal::wire::Measurement measurement;
    measurement.bench("bench");
    measurement.run(run);
    measurement.state(state);
    runs_->write(measurement);
  }

  using Block = dyncal::wire::SampleBlock;

  // Blocks up to the first of which this holds, or those that came in time.
  std::vector<Block> read_until(
      const std::function<bool(const Block&)>& last,
      const std::function<void()>& meanwhile = [] {}) {
    std::vector<Block> blocks;
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    while (std::chrono::steady_clock::now() < deadline) {
      reader_->take([&](const Block& block) { unread_.push_back(block); });
      while (!unread_.empty()) {
        blocks.push_back(unread_.front());
        unread_.pop_front();
        if (last(blocks.back())) {
          return blocks;
        }
      }
      meanwhile();
      wake_up_->wait_until(
          std::min(deadline, std::chrono::steady_clock::now() + std::chrono::milliseconds(100)));
    }
    throw std::runtime_error("what was waited for did not come");
  }
  std::vector<Block> play() {
    return read_until([](const Block& block) { return block.end_of_stream(); });
  }
  // The answer to ARM, asked for again and again.
  Block armed(const std::string& run) {
    return read_until([&](const Block& block) { return block.acknowledged_run() == run; },
                      [&] {
                        dyncal::wire::Command command;
                        command.bench("bench");
                        command.target("acs");
                        command.kind(dyncal::wire::COMMAND_ARM);
                        command.run(run);
                        commands_->write(command);
                      })
        .back();
  }
  static std::uint64_t samples(const std::vector<Block>& blocks) {
    std::uint64_t count = 0;
    for (const Block& block : blocks) {
      count += block.sample_count();
    }
    return count;
  }

  double speed_ = 0.0; // as fast as possible
  std::deque<Block> unread_;
  std::optional<bus::Writer<dyncal::wire::Command>> commands_;
  std::optional<TemporaryFile> file_;
  std::optional<bus::Participant> participant_;
  std::unique_ptr<SourceService> service_;
  std::shared_ptr<SourcePublisher> publisher_;
  std::shared_ptr<bus::WakeUp> wake_up_ = std::make_shared<bus::WakeUp>();
  std::optional<bus::Reader<dyncal::wire::SampleBlock>> reader_;
  std::optional<bus::Writer<dyncal::wire::Measurement>> runs_;
  std::optional<PlayedSource> source_;
  std::jthread thread_;
};

TEST_F(PlayedFile, IsPlayedOnceForEveryRunInASessionOfItsOwn) {
  std::uint64_t first_session = 0;
  for (const char* run : {"run-1", "run-2"}) {
    set_state(run, dyncal::wire::MEASUREMENT_RUNNING);
    const auto blocks = play();
    ASSERT_FALSE(blocks.empty());
    EXPECT_TRUE(blocks.back().end_of_stream());
    std::uint64_t next = 0;
    for (const auto& block : blocks) {
      EXPECT_EQ(block.session(), blocks.front().session());
      EXPECT_EQ(block.first_sample(), next);
      next += block.sample_count();
    }
    EXPECT_EQ(next, 5000U);
    EXPECT_NE(blocks.front().session(), first_session);
    first_session = blocks.front().session();
    set_state(run, dyncal::wire::MEASUREMENT_DONE);
  }
}

class SlowlyPlayedFile : public PlayedFile {
protected:
  SlowlyPlayedFile() { speed_ = 1e-3; } // four minutes
};

TEST_F(SlowlyPlayedFile, StopsWithItsRunAndBeginsTheNextOneFromItsBeginning) {
  const Block first_answer = armed("run-1");
  set_state("run-1", dyncal::wire::MEASUREMENT_RUNNING);
  const auto begun = read_until([](const Block& block) { return block.sample_count() > 0; });
  EXPECT_EQ(begun.back().session(), first_answer.session());
  set_state("run-1", dyncal::wire::MEASUREMENT_ABORTED);
  EXPECT_LT(samples(begun) + samples(play()), 5000U);
  const Block answer = armed("run-2");
  EXPECT_NE(answer.session(), first_answer.session());
  set_state("run-2", dyncal::wire::MEASUREMENT_RUNNING);
  const auto again = read_until([](const Block& block) { return block.sample_count() > 0; });
  EXPECT_EQ(again.back().session(), answer.session());
  EXPECT_EQ(again.back().first_sample(), 0U);
}

TEST_F(SlowlyPlayedFile, AnswersAnotherRunInTheSessionThatWillBePlayed) {
  set_state("run-1", dyncal::wire::MEASUREMENT_RUNNING); // and its conductor dies
  const auto begun = read_until([](const Block& block) { return block.sample_count() > 0; });
  const Block answer = armed("run-2");
  EXPECT_NE(answer.session(), begun.back().session());
  set_state("run-2", dyncal::wire::MEASUREMENT_RUNNING);
  const auto again = read_until([](const Block& block) { return block.sample_count() > 0; });
  EXPECT_EQ(again.back().session(), answer.session());
  EXPECT_EQ(again.back().first_sample(), 0U);
}

} // namespace
} // namespace dyncal::inline instruments
