// A table's source beside a run that is under way: what it hands out depends on whether it was
// there when the run began.
#include "services/instruments/table_source.hpp"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/wake_up.hpp"
#include "tests/patience.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline instruments {
namespace {

using testing::HasSubstr;

constexpr const char* head =
    "loop;frequency;ex_amp;ex_amp_std;phase;phase_std\n\n#Number;Hz;m/s^2;m/s^2;deg;deg\n";
constexpr const char* rows = "0;20;10;0.002;12.5;0.02\n0;40;11;0.002;12.5;0.02\n";

class RunningTable : public testing::Test {
protected:
  RunningTable() {
    table_ = folder_.write("table.csv", head);
    SourceSettings settings;
    settings.name = "acs";
    TableSourceSettings keys;
    keys.paths = {table_};
    keys.coverage = 2.0;
    settings.driver = keys;
    auto source = TableSource::prepare(settings);
    EXPECT_TRUE(source) << source.error().message;
    thread_ =
        std::jthread([this, source = *std::move(source)](const std::stop_token& stop) mutable {
          EXPECT_TRUE(source.run(publisher_, stop));
        });
  }
  void note(bool is_under_way, bool is_running) {
    publisher_.note_run({.run = "r1",
                         .steps = {{1, 1, "20", 2.0}, {2, 1, "40", 2.0}},
                         .is_under_way = is_under_way,
                         .is_running = is_running});
  }
  // Waits until it holds, for as long as any test does.
  template <class Condition>
  [[nodiscard]] static bool comes_true(Condition holds) {
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    while (!holds()) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      std::this_thread::yield();
    }
    return true;
  }
  // Blocks without samples, by which a run sees that the source is there.
  [[nodiscard]] bool shows_itself() {
    return comes_true([&] {
      const auto entry = publisher_.ring().take();
      return entry && entry->block.samples == 0;
    });
  }

  tests::TemporaryFolder folder_;
  std::string table_;
  SourcePublisher publisher_{{.bench = "b", .source = "acs", .hands_out_steps = true},
                             std::make_shared<bus::WakeUp>()};
  std::jthread thread_;
};

TEST_F(RunningTable, HandsOutTheStepsOfARunThatItHasAnsweredTo) {
  ASSERT_TRUE(publisher_.may_answer("r1"));
  note(true, true);
  ASSERT_TRUE(shows_itself() && shows_itself()); // it has looked at the table meanwhile
  folder_.write("table.csv", std::string(head) + rows);
  std::vector<HandedOutStep> steps;
  EXPECT_TRUE(comes_true([&] {
    for (HandedOutStep& step : publisher_.take_handed_out()) {
      steps.push_back(std::move(step));
    }
    return !steps.empty();
  }));
  note(false, false); // the run is over: the last row counts
  EXPECT_TRUE(comes_true([&] {
    for (HandedOutStep& step : publisher_.take_handed_out()) {
      steps.push_back(std::move(step));
    }
    return steps.size() == 2;
  }));
  EXPECT_EQ(steps.front().run, "r1");
  EXPECT_EQ(steps.back().step.amplitude_m_s2, 11.0);
  EXPECT_EQ(publisher_.snapshot().message, "");
}

TEST_F(RunningTable, HandsNothingOutOfARunThatBeganBeforeIt) {
  note(true, true);
  EXPECT_TRUE(comes_true([&] { return !publisher_.snapshot().message.empty(); }));
  EXPECT_THAT(publisher_.snapshot().message, HasSubstr("started in the middle of run r1"));
  folder_.write("table.csv", std::string(head) + rows);
  note(false, false);
  ASSERT_TRUE(shows_itself() && shows_itself());
  EXPECT_TRUE(publisher_.take_handed_out().empty());
}

TEST_F(RunningTable, SaysWhatIsWrongWithItsTableUntilThatIsMended) {
  ASSERT_TRUE(publisher_.may_answer("r1"));
  note(true, false);
  folder_.write("table.csv", std::string(head) + "0;20;ten;0.002;12.5;0.02\n");
  EXPECT_TRUE(comes_true([&] { return !publisher_.snapshot().message.empty(); }));
  EXPECT_THAT(publisher_.snapshot().message, HasSubstr("line 4"));
  folder_.write("table.csv", head);
  EXPECT_TRUE(comes_true([&] { return publisher_.snapshot().message.empty(); }));
}

} // namespace
} // namespace dyncal::inline instruments
