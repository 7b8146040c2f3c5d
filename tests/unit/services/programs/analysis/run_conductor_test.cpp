#include "services/programs/analysis/run_conductor.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;
using Claim = RunConductor::Claim;

wire::Measurement message(const char* conductor, wire::MeasurementState state,
                          const char* recipe = "recipe") {
  wire::Measurement measurement;
  measurement.conductor(conductor);
  measurement.state(state);
  measurement.recipe_sha256(recipe);
  return measurement;
}

class RunConductorTest : public testing::Test {
protected:
  Claim judge(const wire::Measurement& measurement, std::chrono::seconds unheard = 10s) {
    return conductor_.judge(measurement, unheard, 4s);
  }

  RunConductor conductor_{message("one", wire::MEASUREMENT_PLANNED)};
};

TEST_F(RunConductorTest, ItsOwnMessagesAreOfTheRun) {
  for (const auto state : {wire::MEASUREMENT_PLANNED, wire::MEASUREMENT_RUNNING,
                           wire::MEASUREMENT_DONE, wire::MEASUREMENT_ABORTED}) {
    EXPECT_EQ(judge(message("one", state)), Claim::this_run);
  }
  EXPECT_FALSE(conductor_.is_resumed());
}

TEST_F(RunConductorTest, AnotherOneResumesItWithRunningAndItsRecipe) {
  EXPECT_EQ(judge(message("two", wire::MEASUREMENT_RUNNING)), Claim::this_run);
  EXPECT_EQ(conductor_.name(), "two");
  EXPECT_TRUE(conductor_.is_resumed());
  conductor_.note_sources_seen();
  EXPECT_FALSE(conductor_.is_resumed());
}

TEST_F(RunConductorTest, AnotherRunOfTheNameIsNotTakenForIt) {
  EXPECT_EQ(judge(message("two", wire::MEASUREMENT_PLANNED)), Claim::another_run);
  EXPECT_EQ(judge(message("one", wire::MEASUREMENT_RUNNING, "other")), Claim::another_run);
  EXPECT_EQ(conductor_.name(), "one");
}

TEST_F(RunConductorTest, ResumingWithAnotherRecipeIsWrongWhereItsOwnConductorIsGone) {
  const wire::Measurement other = message("two", wire::MEASUREMENT_RUNNING, "other");
  EXPECT_EQ(judge(other, 4s), Claim::another_run); // two have one name, of which one lives
  EXPECT_EQ(judge(other, 5s), Claim::resumes_wrongly);
}

} // namespace
} // namespace dyncal::inline programs
