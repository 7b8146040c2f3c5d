#include "services/records/provenance/repeated_evaluation.hpp"

#include <functional>
#include <random>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/views/report/result_json.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline records {
namespace {

using testing::HasSubstr;

// As it is read from its file.
StoredResult stored(const RunOutcome& outcome) {
  ByteCount no_progress;
  const auto result = result_of_text(json_text(result_json(outcome)), "result.json", no_progress);
  EXPECT_TRUE(result) << result.error().message;
  return *result;
}

class RepeatedEvaluationTest : public testing::Test {
protected:
  // What is refused where the file has `changed`; empty: nothing.
  [[nodiscard]] std::string refusal(const std::function<void(StoredResult&)>& change) const {
    StoredResult kept = again_;
    change(kept);
    const auto held = hold_against(kept, again_);
    return held ? "" : held.error().message;
  }

  StoredResult again_ = stored(tests::example_outcome());
};

TEST_F(RepeatedEvaluationTest, GivesTheSameToTheLastBit) {
  const auto held = hold_against(again_, again_);
  ASSERT_TRUE(held) << held.error().message;
  EXPECT_TRUE(held->is_same_version);
  EXPECT_GT(held->values, 0U);
  EXPECT_EQ(held->missing, 0U);
}

TEST_F(RepeatedEvaluationTest, FindsWhatWasChangedByTheLastBit) {
  const auto next = [](double& value) { value = std::nextafter(value, 1e9); };
  EXPECT_THAT(refusal([&](StoredResult& one) { next(one.values.front().magnitude); }),
              HasSubstr("|H|"));
  EXPECT_THAT(refusal([&](StoredResult& one) { next(one.values.front().phase_rad); }),
              HasSubstr("differ"));
  EXPECT_THAT(refusal([&](StoredResult& one) { next(one.values.front().of_magnitude.expanded); }),
              HasSubstr("differ"));
  EXPECT_THAT(refusal([&](StoredResult& one) { next(one.points.front().magnitude); }),
              HasSubstr("|H|"));
  EXPECT_THAT(
      refusal([&](StoredResult& one) { next(one.points.front().budget.front().u_magnitude_rel); }),
      HasSubstr("budget"));
  EXPECT_THAT(refusal([](StoredResult& one) { one.sources.front().description.serial = "other"; }),
              HasSubstr("serial"));
  EXPECT_THAT(refusal([](StoredResult& one) { one.recipe += " "; }), HasSubstr("recipe"));
  EXPECT_THAT(refusal([](StoredResult& one) { ++one.planned_steps; }), HasSubstr("planned_steps"));
  EXPECT_THAT(refusal([](StoredResult& one) { one.values.pop_back(); }),
              HasSubstr("transfer_function"));
}

TEST_F(RepeatedEvaluationTest, LetsInstantsOfTheConductorDifferBySeconds) {
  again_.began_utc = "2026-03-01T12:00:05.000000000Z";
  EXPECT_EQ(refusal([](StoredResult& one) { one.began_utc = "2026-03-01T12:00:06.500000000Z"; }),
            "");
  EXPECT_THAT(refusal([](StoredResult& one) { one.began_utc = "2026-03-02T12:00:05.000000000Z"; }),
              HasSubstr("it began and ended"));
}

TEST_F(RepeatedEvaluationTest, LetsAnotherVersionDifferByATenthOfU) {
  const auto by_u = [&](double times) {
    return refusal([&](StoredResult& one) {
      one.analysis_software = "dyncal 0.1.9";
      StoredValue& value = one.values.front();
      value.magnitude += times * value.of_magnitude.expanded / value.of_magnitude.k;
    });
  };
  EXPECT_EQ(by_u(0.09), "");
  EXPECT_EQ(by_u(-0.09), "");
  EXPECT_THAT(by_u(0.11), HasSubstr("analyse it anew"));
  EXPECT_THAT(refusal([](StoredResult& one) {
                one.analysis_software = "dyncal 0.1.9";
                one.sources.front().description.serial = "other";
              }),
              HasSubstr("serial"));
}

// Another version may give flags of its own: what it doubts is analysed anew.
TEST_F(RepeatedEvaluationTest, FindsWhatCastsDoubtAndWasTakenOut) {
  again_.values.front().flag_names = {"samples_lost"};
  again_.points.front().flag_names = {"samples_lost"};
  again_.channels.front().flag_names = {"closure_open"};
  again_.channels.front().closures = {{.kind = ClosureKind::level,
                                       .subject = "dau",
                                       .verdict = Verdict::open,
                                       .sentence = "the level is another"}};
  const auto by_other = [&](const std::function<void(StoredResult&)>& change) {
    return refusal([&](StoredResult& one) {
      one.analysis_software = "dyncal 0.1.9";
      change(one);
    });
  };
  EXPECT_EQ(by_other([](StoredResult&) {}), "");
  EXPECT_EQ(by_other([](StoredResult& one) {
              one.values.front().flag_names.emplace_back("of another version");
              one.channels.front().closures.front().sentence = "said otherwise";
            }),
            "");
  EXPECT_THAT(by_other([](StoredResult& one) { one.values.front().flag_names.clear(); }),
              HasSubstr("has the flag samples_lost"));
  EXPECT_THAT(by_other([](StoredResult& one) { one.points.front().flag_names.clear(); }),
              HasSubstr("has the flag samples_lost"));
  EXPECT_THAT(by_other([](StoredResult& one) { one.channels.front().flag_names.clear(); }),
              HasSubstr("has the flag closure_open"));
  EXPECT_THAT(by_other([](StoredResult& one) {
                one.channels.front().closures.front().verdict = Verdict::closes;
              }),
              HasSubstr("a closure is open by the recording: the level is another"));
  EXPECT_THAT(by_other([](StoredResult& one) { one.channels.clear(); }),
              HasSubstr("is not in the file"));
}

TEST_F(RepeatedEvaluationTest, LetsTheGroupDelayOfAnotherVersionDifferByATenthOfU) {
  ASSERT_FALSE(again_.group_delays.empty());
  const auto by_u = [&](double times) {
    return refusal([&](StoredResult& one) {
      one.analysis_software = "dyncal 0.1.9";
      analysis::GroupDelay& delay = one.group_delays.front().delay;
      delay.delay_s += times * delay.u_delay_s();
    });
  };
  EXPECT_EQ(by_u(0.09), "");
  EXPECT_THAT(by_u(-0.2), HasSubstr("the group delay is another"));
}

TEST_F(RepeatedEvaluationTest, CountsWhatTheRecordingLacks) {
  StoredResult kept = again_;
  for (StoredPoint& point : again_.points) {
    point.valid = false;
  }
  const auto held = hold_against(kept, again_);
  ASSERT_TRUE(held) << held.error().message;
  EXPECT_EQ(held->missing, held->values);
  EXPECT_GT(held->values, 0U);
}

// A cut recording knows its clocks from less, and what all steps show: the values before the cut
// come out by last bits otherwise, and U by more, which is no reason to say that somebody changed
// them.
TEST_F(RepeatedEvaluationTest, HoldsOfACutRecordingTheValuesThatItHas) {
  again_.points.front().of_magnitude = {.u = 0.01, .k = 2.0, .expanded = 0.02};
  again_.points.push_back(again_.points.front());
  again_.points.back().step = 3;
  const StoredResult whole = again_;
  StoredPoint& point = again_.points.front();
  const auto by_u = [&](double times) {
    point.magnitude = whole.points.front().magnitude + times * 0.01;
    return hold_against(whole, again_);
  };
  EXPECT_TRUE(by_u(0.0));
  EXPECT_FALSE(by_u(1e-9)); // nothing is missing yet
  again_.points.back().valid = false;
  point.of_magnitude.expanded = 0.03;
  const auto held = by_u(1e-9);
  ASSERT_TRUE(held) << held.error().message;
  EXPECT_EQ(held->missing, 1U);
  EXPECT_EQ(held->values, 2U);
  EXPECT_TRUE(by_u(-0.09));
  EXPECT_THAT(by_u(0.2).error().message, HasSubstr("value or U differ by 0.2 u"));
}

} // namespace
} // namespace dyncal::inline records
