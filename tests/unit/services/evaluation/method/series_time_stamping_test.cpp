// Series time stamping in the evaluation of a run: which shots count, and what a result says of
// them.
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/method/series_time_stamping.hpp"
#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/record/shot_record.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;

constexpr double nominal_rate_hz = 1000.0;
constexpr double real_rate_hz = 1003.0;
constexpr double dso_delay_s = 236e-9;
constexpr double magnitude = 0.95;
constexpr double delay_s = 1.5e-3;
constexpr double beta_rad[] = {-0.021, -0.012, -0.017, -0.025,
                               -0.015}; // of the triggers: always early

class SeriesRun : public testing::Test {
protected:
  static wire::Measurement measurement() {
    wire::Measurement measurement = tests::SyntheticRun{}.measurement();
    measurement.method(wire::METHOD_SERIES_TIMESTAMPING);
    measurement.sync_dau("");
    measurement.sync_dso("dso/sync");
    measurement.dut() = {"tss/acceleration_z"};
    measurement.shots(5);
    measurement.trigger_phase_correction(true);
    measurement.frequency_search_rel(1e-3);
    measurement.dso_delay_s(dso_delay_s);
    measurement.u_dso_delay_s(1e-9);
    return measurement;
  }

  void start(const wire::Measurement& message = measurement()) {
    const auto recipe = parse_recipe(message);
    ASSERT_TRUE(recipe) << recipe.error().message;
    evaluator_.emplace(*recipe);
    ASSERT_TRUE(tests::describe(*evaluator_, run_.acs_description()));
    ASSERT_TRUE(
        tests::describe(*evaluator_, description("dso", wire::SOURCE_DSO, "sync", R"(\volt)")));
    ASSERT_TRUE(tests::describe(*evaluator_, description("tss", wire::SOURCE_TSS, "acceleration_z",
                                                         R"(\metre\second\tothe{-2})")));
    EXPECT_TRUE(evaluator_->undescribed().empty());
  }

  static wire::SourceDescription description(const char* source, wire::SourceKind kind,
                                             const char* channel, const char* unit) {
    wire::SourceDescription message;
    message.bench("synthetic");
    message.source(source);
    message.session(9);
    message.kind(kind);
    message.channels().resize(1);
    message.channels()[0].name(channel);
    message.channels()[0].unit(unit);
    return message;
  }

  // One shot as the oscilloscope and the sensor record it.
  static std::pair<wire::TriggeredRecord, wire::TriggeredRecord>
  shot(std::uint64_t number, std::uint32_t step, double frequency_hz, std::size_t samples = 1000) {
    std::mt19937_64 random(number);
    std::normal_distribution<double> noise(0.0, 1e-3);
    const double w = 2.0 * std::numbers::pi * frequency_hz;
    const double beta = beta_rad[number % 5];
    wire::TriggeredRecord trace = head("dso", number, step, 2000, 2.0 / frequency_hz / 2000.0);
    trace.first_sample_s(-1.0 / frequency_hz);
    for (std::size_t i = 0; i < 2000; ++i) {
      trace.values()[i] =
          std::sin(w * (trace.first_sample_s() + static_cast<double>(i) * trace.interval_s()) +
                   beta) +
          noise(random);
    }
    wire::TriggeredRecord series = head("tss", number, step, samples, 1.0 / nominal_rate_hz);
    for (std::size_t n = 0; n < samples; ++n) {
      const double t = dso_delay_s + static_cast<double>(n) / real_rate_hz;
      series.values()[n] = 10.0 * (magnitude * std::sin(w * (t - delay_s) + beta) + noise(random));
    }
    return {trace, series};
  }

  static wire::TriggeredRecord head(const char* source, std::uint64_t number, std::uint32_t step,
                                    std::size_t samples, double interval_s) {
    wire::TriggeredRecord record;
    record.bench("synthetic");
    record.source(source);
    record.session(9);
    record.shot(number);
    record.run("r1");
    record.step(step);
    record.sample_count(static_cast<std::uint32_t>(samples));
    record.channel_count(1);
    record.interval_s(interval_s);
    record.values().resize(samples);
    return record;
  }

  void add(const std::pair<wire::TriggeredRecord, wire::TriggeredRecord>& records) {
    tests::feed(*evaluator_, records.first);
    tests::feed(*evaluator_, records.second);
  }

  void excite() {
    for (const wire::SampleBlock& block : run_.acs_blocks()) {
      tests::feed(*evaluator_, block);
    }
    evaluator_->end_of_excitation(false);
  }

  EvaluationOutput finish() {
    excite();
    EvaluationOutput output = evaluator_->take_output();
    EXPECT_TRUE(evaluator_->finished());
    return output;
  }

  static double phase_error(const StepResult& result) {
    const double truth = -2.0 * std::numbers::pi * result.frequency_hz * delay_s;
    return std::remainder(result.phase_rad - truth, 2.0 * std::numbers::pi);
  }

  tests::SyntheticRun run_;
  std::optional<RunEvaluator> evaluator_;
};

TEST_F(SeriesRun, GivesMagnitudePhaseAndRateOfTheSensor) {
  start();
  for (std::uint64_t number = 1; number <= 5; ++number) {
    add(shot(number, 1, 40.0));
    add(shot(5 + number, 2, 80.0));
  }
  const EvaluationOutput output = finish();
  ASSERT_EQ(output.results.size(), 2U);
  for (const StepResult& result : output.results) {
    ASSERT_TRUE(result.valid) << result.problem;
    EXPECT_NEAR(result.magnitude, magnitude, 4.0 * result.u_magnitude);
    EXPECT_LE(std::abs(phase_error(result)), 4.0 * result.u_phase_rad);
    EXPECT_LT(result.u_phase_rad, 1e-3);
    ASSERT_TRUE(result.series);
    EXPECT_NEAR(result.series->sample_rate_hz, real_rate_hz, 4.0 * result.series->u_sample_rate_hz);
    EXPECT_EQ(result.series->start, "with the trigger");
    EXPECT_TRUE(result.flags.empty());
    EXPECT_EQ(result.unit, R"(\one)");
    EXPECT_FALSE(result.data_sha256.empty());
  }
  ASSERT_EQ(output.clock_reports.size(), 1U);
  EXPECT_NEAR(output.clock_reports[0].clock.mean_interval_s, 1.0 / real_rate_hz,
              4.0 * output.clock_reports[0].clock.u_mean_interval_s);
  EXPECT_DOUBLE_EQ(output.clock_reports[0].clock.nominal_rate_hz, nominal_rate_hz);
  ASSERT_EQ(output.transfer_functions.size(), 1U);
}

TEST_F(SeriesRun, TheSameShotsInAnotherOrderGiveTheSameBits) {
  std::vector<double> phases;
  for (const bool backwards : {false, true}) {
    start();
    for (std::uint64_t i = 1; i <= 5; ++i) {
      add(shot(backwards ? 6 - i : i, 1, 40.0));
    }
    phases.push_back(finish().results.at(0).phase_rad);
  }
  EXPECT_EQ(phases[0], phases[1]);
}

TEST_F(SeriesRun, WithoutTheCorrectionThePhaseHoldsWhatNoiseDidToTheTrigger) {
  wire::Measurement without = measurement();
  without.trigger_phase_correction(false);
  start(without);
  for (std::uint64_t number = 1; number <= 5; ++number) {
    add(shot(number, 1, 40.0));
  }
  const StepResult result = finish().results.at(0);
  EXPECT_NEAR(phase_error(result), -0.018, 0.001); // mean of the triggers
  EXPECT_THAT(sentences_of(result.flags), testing::Contains(HasSubstr("is not corrected")));
}

TEST_F(SeriesRun, AStepWithFewerShotsIsEvaluatedAndSaysSo) {
  start();
  add(shot(1, 1, 40.0));
  add(shot(2, 1, 40.0));
  add(shot(3, 1, 40.0));
  add({shot(4, 1, 40.0).first, shot(5, 1, 40.0).second}); // two halves are no shot
  const EvaluationOutput output = finish();
  ASSERT_TRUE(output.results.at(0).valid) << output.results.at(0).problem;
  EXPECT_THAT(sentences_of(output.results.at(0).flags), testing::Contains("3 of 5 shots"));
  EXPECT_FALSE(output.results.at(1).valid);
  EXPECT_THAT(output.results.at(1).problem, HasSubstr("no shot of dso and tss"));
}

TEST_F(SeriesRun, RecordsThatContradictThemselvesOrBelongElsewhereAreNotUsed) {
  start();
  auto [trace, series] = shot(1, 1, 40.0);
  wire::TriggeredRecord half = series;
  half.values().resize(500);
  add({trace, half});
  auto other_run = shot(2, 1, 40.0);
  other_run.first.run("r0");
  other_run.second.run("r0");
  add(other_run);
  auto not_a_number = shot(3, 1, 40.0);
  not_a_number.second.values()[7] = std::nan("");
  add(not_a_number);
  EXPECT_FALSE(finish().results.at(0).valid);
}

TEST_F(SeriesRun, ASeriesOfAnotherLengthIsLeftOutAndNamed) {
  start();
  for (std::uint64_t number = 1; number <= 5; ++number) {
    add(shot(number, 1, 40.0, number == 4 ? 500 : 1000));
  }
  const StepResult result = finish().results.at(0);
  ASSERT_TRUE(result.valid) << result.problem;
  EXPECT_THAT(sentences_of(result.flags),
              testing::Contains(HasSubstr("1 shots of another length")));
  EXPECT_THAT(sentences_of(result.flags), testing::Contains("4 of 5 shots"));
}

TEST_F(SeriesRun, AStepWaitsForShotsThatComeAfterTheEndOfItsExcitation) {
  start();
  auto blocks = run_.acs_blocks();
  blocks.back().end_of_stream(false);
  for (const wire::SampleBlock& block : blocks) {
    tests::feed(*evaluator_, block);
  }
  evaluator_->announce({.step = 1, .state = StepAnnouncement::State::done});
  for (std::uint64_t number = 1; number <= 5; ++number) {
    EXPECT_TRUE(evaluator_->take_output().results.empty()) << number;
    add(shot(number, 1, 40.0));
  }
  const auto results = evaluator_->take_output().results;
  ASSERT_EQ(results.size(), 1U);
  EXPECT_TRUE(results[0].valid) << results[0].problem;
}

TEST_F(SeriesRun, WhatTheMethodDoesNotHaveIsRefused) {
  wire::Measurement message = measurement();
  message.dut().clear();
  EXPECT_THAT(parse_recipe(message).error().message, HasSubstr("names no channel"));
  message = measurement();
  message.settling_from_data(true);
  EXPECT_THAT(parse_recipe(message).error().message, HasSubstr("series time stamping has neither"));
}

std::vector<ResultFlag> kinds_of(const StepResult& result) {
  std::vector<ResultFlag> kinds;
  for (const Flag& flag : result.flags) {
    kinds.push_back(flag.kind);
  }
  return kinds;
}

void lose_a_sample(wire::TriggeredRecord& series) {
  series.values().erase(series.values().begin() + 400);
  series.values().push_back(series.values().back());
}

TEST_F(SeriesRun, ASampleThatASeriesLostIsFlagged) {
  start();
  for (std::uint64_t number = 1; number <= 5; ++number) {
    auto records = shot(number, 1, 40.0);
    if (number == 3) {
      lose_a_sample(records.second);
    }
    add(records);
  }
  const StepResult result = finish().results.at(0);
  ASSERT_TRUE(result.valid) << result.problem;
  EXPECT_THAT(kinds_of(result), testing::Contains(ResultFlag::shots_disagree));
  EXPECT_THAT(sentences_of(result.flags),
              testing::Contains(HasSubstr("the phase changes within a series")));
}

// Which of three steps carry the flag when shots disagree in so many of the first.
class DisagreeingSteps : public SeriesRun, public testing::WithParamInterface<std::uint32_t> {
protected:
  EvaluationOutput output_of(std::uint32_t losing) {
    run_.steps = {{"40", 10.0}, {"80", 10.0}, {"160", 10.0}};
    wire::Measurement message = measurement();
    message.steps(run_.measurement().steps());
    start(message);
    for (std::uint32_t step = 1; step <= 3; ++step) {
      for (std::uint64_t number = 1; number <= 5; ++number) {
        auto records = shot(5 * step + number, step, 20.0 * std::pow(2.0, step));
        if (step <= losing && number == 3) {
          lose_a_sample(records.second);
        }
        add(records);
      }
    }
    return finish();
  }
};

TEST_P(DisagreeingSteps, FlagTheOthersWhereTheyAreMost) {
  const std::uint32_t losing = GetParam();
  const EvaluationOutput output = output_of(losing);
  ASSERT_EQ(output.settled.size(), 3U);
  for (const StepResult& result : output.settled) {
    ASSERT_TRUE(result.valid) << result.problem;
    const bool flagged = losing == 2 || result.step <= losing;
    EXPECT_EQ(testing::Matches(testing::Contains(ResultFlag::shots_disagree))(kinds_of(result)),
              flagged)
        << result.step;
    const bool by_the_others = losing == 2 && result.step == 3;
    EXPECT_EQ(testing::Matches(testing::Contains(HasSubstr("so it is in 2 of 3 steps")))(
                  sentences_of(result.flags)),
              by_the_others)
        << result.step;
  }
}

// By 10 ppm in a second, which moves the first sample by 0.8 us.
TEST_F(SeriesRun, AClockThatDriftsIsFlaggedWhereOnlyAnotherStepShowsIt) {
  run_.steps = {{"20", 10.0}, {"25", 10.0}, {"160", 10.0}};
  wire::Measurement message = measurement();
  message.steps(run_.measurement().steps());
  start(message);
  for (std::uint32_t step = 1; step <= 3; ++step) {
    const double frequency_hz = std::stod(run_.steps[step - 1].frequency_hz);
    for (std::uint64_t number = 5 * step + 1; number <= 5 * step + 5; ++number) {
      auto records = shot(number, step, frequency_hz);
      std::mt19937_64 random(number);
      std::normal_distribution<double> noise(0.0, 1e-3);
      for (std::size_t n = 0; n < records.second.values().size(); ++n) {
        const double since_s = static_cast<double>(n) / real_rate_hz;
        const double t = dso_delay_s + since_s + 0.5 * 1e-5 * since_s * since_s - delay_s;
        const double turn = 2.0 * std::numbers::pi * frequency_hz * t + beta_rad[number % 5];
        records.second.values()[n] = 10.0 * (magnitude * std::sin(turn) + noise(random));
      }
      add(records);
    }
  }
  const EvaluationOutput output = finish();
  ASSERT_EQ(output.settled.size(), 3U);
  for (const StepResult& result : output.settled) {
    EXPECT_THAT(kinds_of(result), testing::Contains(ResultFlag::shots_disagree)) << result.step;
    EXPECT_EQ(testing::Matches(testing::Contains(HasSubstr("as other steps show")))(
                  sentences_of(result.flags)),
              result.step < 3)
        << result.step;
  }
}

INSTANTIATE_TEST_SUITE_P(NoneOneOrMost, DisagreeingSteps, testing::Values(0U, 1U, 2U));

TEST_F(SeriesRun, ATraceThatIsCutOffIsFlaggedAndRefusesNothing) {
  start();
  for (std::uint64_t number = 1; number <= 5; ++number) {
    auto records = shot(number, 1, 40.0);
    for (double& volts : records.first.values()) {
      volts = std::min(volts, 0.9);
    }
    add(records);
  }
  const StepResult result = finish().results.at(0);
  ASSERT_TRUE(result.valid) << result.problem;
  EXPECT_THAT(sentences_of(result.flags), testing::Contains(HasSubstr("dso/sync: over range")));
}

TEST_F(SeriesRun, ATraceShorterThanAPeriodIsFlagged) {
  start();
  for (std::uint64_t number = 1; number <= 5; ++number) {
    auto records = shot(number, 1, 40.0);
    records.first.values().resize(700); // of 1000 a period
    records.first.sample_count(700);
    records.first.first_sample_s(-0.25 / 40.0);
    add(records);
  }
  const StepResult result = finish().results.at(0);
  ASSERT_TRUE(result.valid) << result.problem;
  EXPECT_THAT(sentences_of(result.flags),
              testing::Contains(HasSubstr("dso/sync: signal not judged: its trace is shorter")));
}

TEST_F(SeriesRun, AStartWithinPartOfASampleIsUndecidedAndInTheUncertainty) {
  start();
  for (std::uint64_t number = 1; number <= 5; ++number) {
    // A motion that is ahead by so much is a series that began so much later.
    const double late_s = 50e-6 * static_cast<double>((number * 3) % 5);
    auto records = shot(number, 1, 40.0);
    std::mt19937_64 random(number);
    for (std::size_t n = 0; n < records.second.values().size(); ++n) {
      const double t = dso_delay_s + late_s + static_cast<double>(n) / real_rate_hz - delay_s;
      records.second.values()[n] =
          10.0 * magnitude * std::sin(2.0 * std::numbers::pi * 40.0 * t + beta_rad[number % 5]);
    }
    add(records);
  }
  const StepResult result = finish().results.at(0);
  ASSERT_TRUE(result.valid) << result.problem;
  EXPECT_THAT(kinds_of(result), testing::Contains(ResultFlag::start_undecided));
  const double error = std::abs(phase_error(result));
  EXPECT_NEAR(error, 2.0 * std::numbers::pi * 40.0 * 100e-6, 2e-3); // the mean is not corrected
  EXPECT_LE(error, 2.0 * result.u_phase_rad);
  EXPECT_GE(error, 0.3 * result.u_phase_rad);
}

TEST_F(SeriesRun, APointOfOneRepetitionHasOneUncertainty) {
  start();
  for (std::uint64_t number = 1; number <= 5; ++number) {
    add(shot(number, 1, 40.0));
    add(shot(5 + number, 2, 80.0));
  }
  const EvaluationOutput output = finish();
  ASSERT_EQ(output.transfer_functions.size(), 1U);
  const std::vector<FrequencyPoint>& points = output.transfer_functions.front().points;
  ASSERT_EQ(points.size(), 2U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const StepResult& result = output.settled.at(i); // all steps tell of the start
    std::vector<analysis::UncertaintyPart> magnitudes, phases;
    for (const analysis::Contribution& row : result.budget) {
      magnitudes.push_back({row.u_magnitude_rel, row.degrees_of_freedom});
      phases.push_back({row.u_phase_rad, row.degrees_of_freedom});
    }
    const auto k = [](const std::vector<analysis::UncertaintyPart>& parts) {
      return analysis::coverage_factor(analysis::effective_degrees_of_freedom(parts));
    };
    EXPECT_NEAR(2.0 * points[i].mean.u_magnitude / (k(magnitudes) * result.u_magnitude), 1.0, 1e-9);
    EXPECT_NEAR(2.0 * points[i].mean.u_phase_rad / (k(phases) * result.u_phase_rad), 1.0, 1e-9);
    EXPECT_NEAR(points[i].mean.phase.k, k(phases), 1e-9);
  }
}

TEST_F(SeriesRun, RecordsThatCannotBeUsedAreLostInTheResult) {
  start();
  for (std::uint64_t number = 1; number <= 5; ++number) {
    auto records = shot(number, 1, 40.0);
    if (number == 2) {
      records.second.values().resize(500); // of 1000
    }
    add(records);
  }
  const StepResult result = finish().results.at(0);
  ASSERT_TRUE(result.valid) << result.problem;
  EXPECT_THAT(sentences_of(result.flags),
              testing::Contains(HasSubstr("tss: records of shots lost")));
  ASSERT_EQ(result.samples.size(), 3U);
  EXPECT_EQ(result.samples[2].unusable, 1000U);
  EXPECT_EQ(result.lost, 1000U);
}

} // namespace
} // namespace dyncal::inline evaluation
