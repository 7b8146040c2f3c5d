// What is said of a run in which nothing was excited, and, the opposite, of a sync signal that is
// missing: in a conducted run, and in records that nobody conducted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using State = StepAnnouncement::State;

constexpr std::size_t reference = 0, acs_sync = 1;
constexpr std::size_t sensor = 0, dau_sync = 2;
constexpr const char* question = "is the sync signal connected?";
constexpr const char* none = "no excitation was found in acs/reference, acs/sync, dau/sync, "
                             "dau/acceleration_z either; was the exciter driven?";

class NoExcitation : public testing::TestWithParam<bool> { // conducted
protected:
  tests::SyntheticRun run_{.steps = {{"40", 10.0}, {"80", 10.0}}};
  std::vector<std::size_t> silent_in_acs_, silent_in_dau_; // channels

  static void silence(wire::SampleBlock& block, const std::vector<std::size_t>& channels) {
    for (const std::size_t channel : channels) {
      for (std::size_t i = 0; i < block.sample_count(); ++i) {
        block.values()[channel * block.sample_count() + i] = i % 2 == 0 ? 1e-3 : -1e-3;
      }
    }
  }
  std::vector<std::string> problems() {
    wire::Measurement measurement = run_.measurement();
    measurement.dut().push_back("dau/acceleration_z");
    RunEvaluator evaluator(*parse_recipe(measurement), {.ahead = GetParam()});
    EXPECT_TRUE(tests::describe(evaluator, run_.acs_description()));
    EXPECT_TRUE(tests::describe(evaluator, run_.dau_description()));
    auto acs = run_.acs_blocks();
    auto dau = run_.dau_blocks();
    std::vector<std::string> problems;
    const auto take = [&] {
      for (bool any = true; any;) {
        const EvaluationOutput output = evaluator.take_output();
        any = !output.results.empty();
        for (const StepResult& result : output.results) {
          problems.push_back(result.problem);
        }
      }
    };
    for (std::size_t i = 0; i < std::max(acs.size(), dau.size()); ++i) {
      if (GetParam() && (i == 0 || i == acs.size() / 2)) {
        evaluator.announce({.step = i == 0 ? 1U : 2U, .state = State::excited});
      }
      if (i < acs.size()) {
        silence(acs[i], silent_in_acs_);
        tests::feed(evaluator, acs[i]);
      }
      if (i < dau.size()) {
        silence(dau[i], silent_in_dau_);
        tests::feed(evaluator, dau[i]);
      }
      take();
    }
    if (GetParam()) {
      evaluator.announce({.step = 2, .state = State::done});
    }
    evaluator.end_of_excitation(false);
    take();
    evaluator.finish_now();
    take();
    return problems;
  }
  void expect_every(const testing::Matcher<std::string>& matcher) {
    const auto said = problems();
    ASSERT_EQ(said.size(), run_.steps.size());
    EXPECT_THAT(said, testing::Each(matcher));
  }
};

INSTANTIATE_TEST_SUITE_P(ConductedOrNot, NoExcitation, testing::Bool());

TEST_P(NoExcitation, IsNamedAndNoCableIsAskedAbout) {
  run_.steps = {{"40", 0.0}, {"80", 0.0}};
  expect_every(AllOf(HasSubstr(none), Not(HasSubstr(question))));
}

// The mains are a sine of a step's frequency, but no step.
TEST_P(NoExcitation, IsNamedBesideHum) {
  run_.steps = {{"50", 0.0}, {"50", 0.0}};
  run_.sensor_hum = 1.0;
  expect_every(AllOf(HasSubstr(none), Not(HasSubstr(question))));
}

TEST_P(NoExcitation, IsNotSaidWhereTheSensorsSyncIsMissing) {
  silent_in_dau_ = {dau_sync};
  expect_every(AllOf(HasSubstr("found in dau/sync, where acs/"), HasSubstr(question),
                     Not(HasSubstr("no excitation"))));
}

TEST_P(NoExcitation, IsNotSaidWhereTheReferencesSyncIsMissing) {
  silent_in_acs_ = {acs_sync};
  expect_every(AllOf(HasSubstr("found in acs/sync, where acs/reference shows one"),
                     HasSubstr(question), Not(HasSubstr("no excitation"))));
}

TEST_P(NoExcitation, IsNotSaidWhereBothSyncsAreMissing) {
  silent_in_acs_ = {acs_sync};
  silent_in_dau_ = {dau_sync};
  expect_every(AllOf(HasSubstr("acs/reference shows one"), HasSubstr(question)));
  silent_in_acs_.push_back(reference);
  expect_every(AllOf(HasSubstr("dau/acceleration_z shows one"), HasSubstr(question)));
  silent_in_dau_.push_back(sensor);
  expect_every(AllOf(HasSubstr(none), Not(HasSubstr(question))));
}

TEST_P(NoExcitation, IsNotSaidOfASineThatIsTooShort) {
  run_.on_s = 0.45; // of which 0.2 s are settling, and frames at both ends do not count
  const auto said = problems();
  ASSERT_EQ(said.size(), run_.steps.size());
  for (const std::string& problem : said) {
    EXPECT_THAT(problem, Not(HasSubstr("no excitation")));
  }
}

} // namespace
} // namespace dyncal::inline evaluation
