#include "services/views/report/closures_csv.hpp"

#include <gtest/gtest.h>

#include "services/views/report/run_figures.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

RunOutcome outcome_with_closures() {
  RunOutcome outcome = tests::example_outcome();
  outcome.transfer_functions[0].closures = {
      {.kind = ClosureKind::level,
       .subject = "80 Hz, 2 m/s^2",
       .verdict = Verdict::open,
       .value = 0.25,
       .limit = 0.125,
       .unit = "1",
       .sentence = R"(the level is "off", look at it)"},
      {.kind = ClosureKind::first_repeated, .sentence = "not planned"}};
  return outcome;
}

TEST(ClosuresCsv, HasALineForEachChannelAndClosure) {
  EXPECT_EQ(closures_csv(outcome_with_closures()),
            "channel,closure,title,compared,verdict,value,u,limit,unit,sentence\n"
            "\"dau/acceleration_z\",level,\"level of the excitation\",\"80 Hz, 2 m/s^2\",open,"
            "0.25,0,0.125,\"1\",\"the level is \"\"off\"\", look at it\"\n"
            "\"dau/acceleration_z\",first_repeated,\"first point repeated at the end\",\"\","
            "not_possible,,,,\"\",\"not planned\"\n");
}

TEST(ClosuresCsv, IsAFileBesideTheFiguresWhereThereAreClosures) {
  const tests::TemporaryFolder folder;
  EXPECT_EQ(closures_csv(tests::example_outcome()), "");
  ASSERT_TRUE(write_figures(tests::example_outcome(), folder.path()));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "closures.csv"));
  const auto written = write_figures(outcome_with_closures(), folder.path());
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->back(), folder.path() / "closures.csv");
  EXPECT_TRUE(std::filesystem::exists(written->back()));
}

} // namespace
} // namespace dyncal::inline views
