// One bench, one run: a second run is refused while the first lives, and gets the bench of one that
// was killed, whose results hold nothing of what the second excites.
#include <algorithm>
#include <csignal>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/bus.hpp"
#include "services/contract/run_identity.hpp"
#include "services/contract/topics.hpp"
#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;

LiveBenchSettings three_steps(const std::string& dds) {
  LiveBenchSettings settings;
  settings.dds = dds;
  settings.bench_arguments = {"--frequencies", "40,80,125", "--levels", "20"};
  settings.excitation = "frequencies_hz = [\"40\", \"80\", \"125\"]\nlevel = 20.0\n"
                        "settling_s = 0.5\nduration_s = 1.5\n";
  settings.rest = "adc_delay_s = 1e-6\n";
  return settings;
}

class OneRun : public testing::TestWithParam<std::string> {}; // of DDS

TEST_P(OneRun, ASecondRunIsRefusedAndDoesNotTouchTheFirst) {
  const auto folder = fresh_folder("second_run_" + GetParam());
  LiveBench bench(folder, three_steps(GetParam()));
  ProgramRun& first =
      bench.start({"run", bench.bench_file(), "--run", "first", "--output", folder / "first.json"});
  ASSERT_TRUE(first.wait_for_error_text("step 1 of 3", patience)) << first.errors();
  ProgramRun& second = bench.start({"run", bench.bench_file(), "--run", "second"});
  const auto refused = second.wait(patience);
  ASSERT_TRUE(refused);
  EXPECT_NE(*refused, 0);
  EXPECT_THAT(second.errors(), AllOf(HasSubstr("bench 'live' is in use by run 'first' of "),
                                     HasSubstr("; wait for its end, or end it there")));
  const auto status = first.wait(patience);
  ASSERT_TRUE(status);
  EXPECT_EQ(*status, 0) << first.errors();
  const auto result = read_json(folder / "first.json");
  ASSERT_EQ(result["points"].size(), 9U);
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"].get<bool>()) << point["problem"];
    EXPECT_EQ(point["flags"].size(), 0U) << point["flags"];
  }
}

bus::Participant participant(const std::string& dds) {
  bus::ParticipantOptions options;
  options.vendor = bus::parse_vendor(dds).value();
  options.domain = own_dds_domain();
  options.name = "test";
  return bus::Participant::create(options).value();
}

// What is published of the runs of a bench from now on, the newest of each value.
class PublishedResults {
public:
  explicit PublishedResults(const std::string& dds)
      : participant_(participant(dds)),
        reader_(participant_.reader(bus::topics::calibration_result, "live", nullptr).value()) {}

  std::vector<wire::CalibrationResult> of_run(const std::string& run) {
    reader_.take([this](const wire::CalibrationResult& result) { all_.push_back(result); });
    std::vector<wire::CalibrationResult> found;
    std::copy_if(all_.begin(), all_.end(), std::back_inserter(found),
                 [&](const wire::CalibrationResult& result) {
                   return contract::RunIdentity::parse(result.run().to_string()).name == run;
                 });
    return found;
  }

private:
  bus::Participant participant_;
  bus::Reader<wire::CalibrationResult> reader_;
  std::vector<wire::CalibrationResult> all_;
};

// It is killed in its second step, whose excitation ends then.
void expect_nothing_of_other_excitation(const std::vector<wire::CalibrationResult>& of_killed) {
  std::size_t of_first_step = 0;
  for (const wire::CalibrationResult& result : of_killed) {
    of_first_step += result.step() == 1 ? 1 : 0;
    if (result.step() == 1) {
      EXPECT_TRUE(result.valid()) << result.problem();
    } else {
      EXPECT_FALSE(result.valid() && result.flags().empty())
          << "step " << result.step() << " has the value " << result.magnitude();
      EXPECT_FALSE(result.valid() && result.step() > 2) << "step 3 had not begun";
    }
  }
  EXPECT_EQ(of_first_step, 3U);
}

TEST_P(OneRun, TheNextRunGetsTheBenchOfOneThatWasKilled) {
  const auto folder = fresh_folder("killed_run_" + GetParam());
  LiveBench bench(folder, three_steps(GetParam()));
  PublishedResults published(GetParam());
  ProgramRun& killed = bench.start({"run", bench.bench_file(), "--run", "killed"});
  ASSERT_TRUE(killed.wait_for_error_text("step 2 of 3", patience)) << killed.errors();
  killed.send(SIGKILL);
  EXPECT_TRUE(killed.wait(patience));
  ProgramRun& watch = bench.start({"watch"});
  ProgramRun& next =
      bench.start({"run", bench.bench_file(), "--run", "next", "--output", folder / "next.json"});
  const auto status = next.wait(patience);
  ASSERT_TRUE(status);
  EXPECT_EQ(*status, 0) << next.errors();
  const auto result = read_json(folder / "next.json");
  ASSERT_EQ(result["points"].size(), 9U);
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"].get<bool>()) << point["problem"];
    EXPECT_EQ(point["flags"].size(), 0U) << point["flags"];
  }
  EXPECT_TRUE(watch.wait_for_output_text("its bench was given to run 'next'", patience))
      << watch.output();
  watch.send(SIGTERM);
  expect_nothing_of_other_excitation(published.of_run("killed"));
  EXPECT_EQ(published.of_run("next").size(), 9U);
}

// What a person does after a run that was killed: the same command once more, at once.
TEST_P(OneRun, TheSameNameAgainIsAnotherRun) {
  const auto folder = fresh_folder("same_name_" + GetParam());
  LiveBench bench(folder, three_steps(GetParam()));
  PublishedResults published(GetParam());
  ProgramRun& killed = bench.start({"run", bench.bench_file(), "--run", "R1"});
  ASSERT_TRUE(killed.wait_for_error_text("step 3 of 3", patience)) << killed.errors();
  killed.send(SIGKILL);
  EXPECT_TRUE(killed.wait(patience));
  const auto of_killed = published.of_run("R1");
  ASSERT_GE(of_killed.size(), 3U);
  ProgramRun& again =
      bench.start({"run", bench.bench_file(), "--run", "R1", "--output", folder / "again.json"});
  ASSERT_EQ(again.wait(patience), 0) << again.errors();
  const auto result = read_json(folder / "again.json");
  EXPECT_TRUE(result["run"].get<std::string>().starts_with("R1."));
  EXPECT_NE(result["run"], of_killed.front().run().to_string());
  ASSERT_EQ(result["points"].size(), 9U);
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"].get<bool>()) << point["problem"];
    for (const wire::CalibrationResult& old : of_killed) {
      EXPECT_NE(point["data_sha256"], old.data_sha256()) << "a value of the killed run";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Vendors, OneRun, testing::Values("cyclonedds", "fastdds"));

} // namespace
} // namespace dyncal::tests
