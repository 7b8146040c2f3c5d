#include "services/records/store/store.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <random>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/records/store/example_results.hpp"
#include "tests/unit/services/records/store/store_places.hpp"

namespace dyncal::inline records {
namespace {

using testing::HasSubstr;
using testing::SizeIs;
using tests::ExampleResult;

class StoreTest : public tests::StorePlaces {
protected:
  void SetUp() override {
    StorePlaces::SetUp();
    if (!IsSkipped()) {
      auto opened = Store::open(place_);
      ASSERT_TRUE(opened) << opened.error().message;
      store_ = std::move(*opened);
    }
  }
  [[nodiscard]] Expected<StoreAddition> add(const RunOutcome& outcome) const {
    return store_->add(folder_.write("result.json", tests::text_of(outcome)));
  }
  [[nodiscard]] Expected<StoreAddition> add(const ExampleResult& example) const {
    return add(tests::outcome_of(example));
  }
  [[nodiscard]] std::int64_t count(const std::string& table) const {
    return integer_of(open()->execute("SELECT COUNT(*) FROM " + table)->front()[0]);
  }

  std::unique_ptr<Store> store_;
};

TEST_P(StoreTest, KeepsAResultWithAllThatItIsMadeFrom) {
  const auto added = add(ExampleResult{});
  ASSERT_TRUE(added) << added.error().message;
  EXPECT_EQ(*added, StoreAddition::added);
  const auto runs = store_->runs({});
  ASSERT_TRUE(runs);
  ASSERT_THAT(*runs, SizeIs(1));
  const StoredRun& run = runs->front();
  EXPECT_EQ(run.bench, "acc-1");
  EXPECT_EQ(run.run, "r1");
  EXPECT_EQ(run.began_utc, "2023-11-14T22:13:20.000000012Z");
  EXPECT_EQ(run.recipe_sha256, "abc");
  EXPECT_THAT(run.software, HasSubstr("dyncal"));
  EXPECT_EQ(run.planned_steps, 2);
  EXPECT_EQ(run.measured_steps, 1);
  EXPECT_EQ(run.state, "incomplete");
  ASSERT_THAT(run.sources, SizeIs(2));
  EXPECT_EQ(run.sources[0].description.serial, "42");
  EXPECT_EQ(count("points"), 4);
  EXPECT_EQ(count("samples"), 1);
  const auto stored = open()->execute("SELECT recipe, document FROM results");
  EXPECT_EQ(text_of(stored->front()[0]), "bench = \"acc-1\"\n");
  EXPECT_EQ(text_of(stored->front()[1]), tests::text_of(tests::outcome_of({})));
}

TEST_P(StoreTest, AddsAResultOnce) {
  ASSERT_TRUE(add(ExampleResult{}));
  EXPECT_EQ(add(ExampleResult{}).value(), StoreAddition::already_there);
  RunOutcome again = tests::outcome_of(ExampleResult{}); // the same, evaluated elsewhere and later
  again.analysis_host = "another";
  again.ended_utc_ns += 1'000'000'000;
  EXPECT_EQ(add(again).value(), StoreAddition::already_there);
  EXPECT_EQ(count("results"), 1);
  EXPECT_EQ(count("points"), 4);
}

TEST_P(StoreTest, RefusesAnotherResultOfTheSameRunAndRecipe) {
  ASSERT_TRUE(add(ExampleResult{}));
  const auto other = add(ExampleResult{.magnitude = 1.001});
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("another result of run 'r1' of bench 'acc-1'"));
  EXPECT_THAT(other.error().message, HasSubstr(folder_.path().string()));
  EXPECT_EQ(count("results"), 1);
  EXPECT_EQ(store_->calibrations("mpu-7")->front().points.front().magnitude, 1.0);
}

TEST_P(StoreTest, PutsAnotherEvaluationBeside) {
  ASSERT_TRUE(add(ExampleResult{}));
  EXPECT_EQ(add(ExampleResult{.magnitude = 1.1, .recipe_sha256 = "def"}).value(),
            StoreAddition::added);
  EXPECT_EQ(count("results"), 2);
}

TEST_P(StoreTest, LetsTheFinishedRunTakeThePlaceOfItsUnfinishedResult) {
  ASSERT_TRUE(add(ExampleResult{.magnitude = 0.9, .ended = false}));
  EXPECT_EQ(store_->runs({})->front().state, "unfinished");
  EXPECT_EQ(add(ExampleResult{}).value(), StoreAddition::replaced_unfinished);
  EXPECT_EQ(count("results"), 1);
  EXPECT_EQ(count("points"), 4);
  EXPECT_EQ(count("samples"), 1);
  EXPECT_FALSE(add(ExampleResult{.magnitude = 0.9, .ended = false})); // and not the other way round
}

TEST_P(StoreTest, FindsRuns) {
  ASSERT_TRUE(add(ExampleResult{}));
  ASSERT_TRUE(add(ExampleResult{.run = "r2", .days = 30, .serial = "mpu-8"}));
  RunOutcome interrupted = tests::outcome_of({.run = "r3", .days = 60});
  interrupted.interrupted = true;
  interrupted.bench = "acc-2";
  ASSERT_TRUE(add(interrupted));
  const auto found = [&](const RunFilter& filter) {
    std::string runs;
    const auto all = store_->runs(filter);
    for (const StoredRun& run : *all) {
      runs += run.run;
    }
    return runs;
  };
  EXPECT_EQ(found({}), "r1r2r3");
  EXPECT_EQ(found({.bench = "acc-2"}), "r3");
  EXPECT_EQ(found({.sensor = "mpu-7"}), "r1r3");
  EXPECT_EQ(found({.sensor = "SmartUp"}), "r1r2r3");
  EXPECT_EQ(found({.since = "2023-12"}), "r2r3");
  EXPECT_EQ(found({.since = "2023-11-14", .until = "2023-12-14"}), "r1r2");
  EXPECT_EQ(found({.state = "interrupted"}), "r3");
  EXPECT_EQ(found({.bench = "none"}), "");
}

TEST_P(StoreTest, NamesTheSensorsAndNoOtherInstruments) {
  EXPECT_THAT(store_->sensors().value(), testing::IsEmpty());
  ASSERT_TRUE(add(ExampleResult{}));
  ASSERT_TRUE(add(ExampleResult{.run = "r2", .days = 1, .serial = ""}));
  ASSERT_TRUE(add(ExampleResult{.run = "r3", .days = 2}));
  // Not the ACS, whose serial number is 42: a device where there is no number.
  EXPECT_THAT(store_->sensors().value(), testing::UnorderedElementsAre("SmartUp", "mpu-7"));
}

TEST_P(StoreTest, GivesTheCalibrationsOfASensorByTime) {
  ASSERT_TRUE(add(ExampleResult{.run = "r2", .days = 365, .magnitude = 1.25}));
  ASSERT_TRUE(add(ExampleResult{}));
  const auto calibrations = store_->calibrations("mpu-7");
  ASSERT_TRUE(calibrations);
  ASSERT_THAT(*calibrations, SizeIs(2));
  EXPECT_EQ((*calibrations)[0].run.run, "r1");
  ASSERT_THAT((*calibrations)[1].points, SizeIs(4));
  const StoredValue& point = (*calibrations)[1].points.front();
  EXPECT_EQ(point.channel, "dau/acceleration_z");
  EXPECT_EQ(point.frequency_text_hz, "10");
  EXPECT_EQ(point.magnitude, 1.25);
  EXPECT_GT(point.of_magnitude.expanded, 1.9e-3);
  EXPECT_EQ(point.phase_rad, -0.5);
  EXPECT_TRUE(store_->calibrations("42")->empty()); // the reference is calibrated by nobody
}

TEST_P(StoreTest, KeepsLevelsAxisAttemptAndClosures) {
  RunOutcome outcome = tests::outcome_of(ExampleResult{});
  outcome.results.front().attempt = 2;
  outcome.results.front().excited_axis = "z";
  TransferFunction& function = outcome.transfer_functions.front();
  function.excited_axis = "z";
  for (const double level : {2.0, 4.0, 15.0}) {
    function.points.push_back(function.points.back());
    function.points.back().level_m_s2 = level;
  }
  function.closures = {{.kind = ClosureKind::level,
                        .subject = "20 Hz, 2 m/s^2",
                        .verdict = Verdict::open,
                        .value = 0.25,
                        .limit = 0.1,
                        .unit = "1",
                        .sentence = "the level is off"},
                       {.kind = ClosureKind::delay_fit,
                        .verdict = Verdict::closes,
                        .value = 1.0,
                        .limit = 3.0,
                        .unit = "1",
                        .sentence = "phases are on a line"},
                       {.kind = ClosureKind::first_repeated, .sentence = "not planned"}};
  ASSERT_TRUE(add(outcome));
  const auto calibrations = store_->calibrations("mpu-7");
  ASSERT_TRUE(calibrations) << calibrations.error().message;
  const Calibration& one = calibrations->front();
  std::vector<double> levels;
  for (const StoredValue& value : one.points) {
    if (value.channel == "dau/acceleration_z" && value.frequency_hz == 20.0) {
      levels.push_back(value.level_m_s2);
      EXPECT_EQ(value.excited_axis, "z");
    }
  }
  EXPECT_EQ(levels, (std::vector<double>{2.0, 2.75, 4.0, 15.0}));
  ASSERT_THAT(one.open_closures, SizeIs(1));
  EXPECT_EQ(one.open_closures[0].sentence,
            "dau/acceleration_z: level of the excitation: the level is off");
  EXPECT_EQ(count("closures"), 3);
  const auto samples =
      open()->execute("SELECT frequency_hz, level_m_s2, excited_axis, repetition, attempt "
                      "FROM samples");
  ASSERT_THAT(*samples, SizeIs(1));
  EXPECT_EQ(number_of(samples->front()[0]), 10.0);
  EXPECT_EQ(number_of(samples->front()[1]), 2.75);
  EXPECT_EQ(text_of(samples->front()[2]), "z");
  EXPECT_EQ(integer_of(samples->front()[3]), 1);
  EXPECT_EQ(integer_of(samples->front()[4]), 2);
}

TEST_P(StoreTest, CountsTheRunsThatItLooksThrough) {
  ASSERT_TRUE(add(ExampleResult{}));
  ASSERT_TRUE(add(ExampleResult{.run = "r2", .days = 30, .serial = "mpu-8"}));
  ASSERT_TRUE(add(ExampleResult{.run = "r3", .days = 60}));
  const auto count = std::make_shared<WorkCount>("opening");
  ASSERT_THAT(*store_->runs({.sensor = "mpu-8"}, count), SizeIs(1));
  EXPECT_EQ(count->state().total, 3U);
  EXPECT_EQ(count->state().done, 3U);
  ASSERT_THAT(*store_->calibrations("mpu-7", count), SizeIs(2));
  EXPECT_EQ(count->state().what, "reading");
  EXPECT_EQ(count->state().total, 2U);
  EXPECT_EQ(count->state().done, 2U);
}

// Another process adds results and is killed in the middle of it, at a drawn instant after the
// first.
TEST_P(StoreTest, HasEveryResultWholeOrNotAtAllWhenAWriterIsKilled) {
  std::mt19937 random(4711);
  std::uniform_int_distribution<int> delay_us(1'000, 60'000);
  int number = 0;
  for (int kill_number = 0; kill_number < 10; ++kill_number) {
    number += 100;
    std::array<int, 2> added{};
    ASSERT_EQ(pipe2(added.data(), O_CLOEXEC), 0);
    const pid_t writer = fork();
    if (writer == 0) {
      auto own = Store::open(place_);
      for (int i = 0; own; ++i) {
        const auto path = folder_.write(
            "killed.json",
            tests::text_of(tests::outcome_of({.run = fmt::format("k{}", number + i)})));
        if ((*own)->add(path)) {
          static_cast<void>(write(added[1], "+", 1) < 0);
        }
      }
      _exit(1);
    }
    close(added[1]);
    pollfd first{.fd = added[0], .events = POLLIN, .revents = 0};
    constexpr int limit_ms = 120'000;
    EXPECT_EQ(poll(&first, 1, limit_ms), 1);
    usleep(static_cast<useconds_t>(delay_us(random)));
    kill(writer, SIGKILL);
    waitpid(writer, nullptr, 0);
    close(added[0]);
    const std::int64_t there = count("results");
    EXPECT_EQ(count("points"), 4 * there);
    EXPECT_EQ(count("sources"), 2 * there);
    EXPECT_EQ(count("samples"), there);
    EXPECT_GT(there, kill_number);
  }
  EXPECT_TRUE(add(ExampleResult{.run = "afterwards"}));
}

INSTANTIATE_TEST_SUITE_P(, StoreTest,
                         testing::Values(tests::StoreKind::sqlite, tests::StoreKind::postgres),
                         tests::kind_name);

TEST(OpenExistingStore, MakesNone) {
  const tests::TemporaryFolder folder;
  const auto place = folder.path() / "lab/dyncal.sqlite";
  EXPECT_FALSE(Store::open_existing(place.string()));
  EXPECT_FALSE(std::filesystem::exists(place.parent_path()));
  ASSERT_TRUE(Store::open(place.string()));
  EXPECT_TRUE(Store::open_existing(place.string()));
}

TEST(StorePlaceOption, IsBesideTheRunsUnlessGiven) {
  EXPECT_EQ(store_place("", "lab/runs"), "lab/runs/dyncal.sqlite");
  EXPECT_EQ(store_place("none", "lab/runs"), "");
  EXPECT_EQ(store_place("postgresql://db/lab", "lab/runs"), "postgresql://db/lab");
}

TEST(ResultRecord, RefusesWhatIsNotAResult) {
  const tests::TemporaryFolder folder;
  for (const char* text :
       {"", "{}", "[1, 2]", R"({"schema": {"name": "dyncal-model"}})", "{\"a\""}) {
    const auto record = read_result_record(folder.write("x.json", text));
    ASSERT_FALSE(record) << text;
    EXPECT_THAT(record.error().message, HasSubstr("x.json: ")) << text;
  }
  EXPECT_FALSE(read_result_record(folder.path()));
  EXPECT_FALSE(read_result_record(folder.path() / "none.json"));
}

TEST(ResultRecord, IsThatOfTheFolderOfARun) {
  const tests::TemporaryFolder folder;
  folder.write("result.json", tests::text_of(tests::outcome_of({})));
  const auto record = read_result_record(folder.path());
  ASSERT_TRUE(record) << record.error().message;
  EXPECT_EQ(record->folder, folder.path().string());
  EXPECT_EQ(record->result.sha256.size(), 64U);
}

} // namespace
} // namespace dyncal::inline records
