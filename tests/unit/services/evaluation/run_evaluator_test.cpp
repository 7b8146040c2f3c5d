#include "services/evaluation/run_evaluator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/monte_carlo_agreement.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;

// Settled results stand among all results; `first`, if given, has these as they came first.
EvaluationOutput evaluate(const tests::SyntheticRun& run, const wire::Measurement& measurement,
                          const EvaluationLimits& limits = {},
                          std::vector<StepResult>* first = nullptr) {
  auto recipe = parse_recipe(measurement);
  EXPECT_TRUE(recipe) << recipe.error().message;
  RunEvaluator evaluator(std::move(*recipe), limits);
  EXPECT_TRUE(tests::describe(evaluator, run.acs_description()));
  EXPECT_TRUE(tests::describe(evaluator, run.dau_description()));
  EvaluationOutput all;
  const auto collect = [&] {
    EvaluationOutput output = evaluator.take_output();
    all.results.insert(all.results.end(), output.results.begin(), output.results.end());
    all.settled.insert(all.settled.end(), output.settled.begin(), output.settled.end());
    if (!output.transfer_functions.empty()) {
      all.transfer_functions = output.transfer_functions;
      all.clock_reports = output.clock_reports;
    }
  };
  const auto acs = run.acs_blocks();
  const auto dau = run.dau_blocks();
  for (std::size_t i = 0; i < std::max(acs.size(), dau.size()); ++i) {
    if (i < acs.size()) {
      tests::feed(evaluator, acs[i]);
    }
    if (i < dau.size()) {
      tests::feed(evaluator, dau[i]);
    }
    collect();
  }
  EXPECT_TRUE(evaluator.finished());
  if (first != nullptr) {
    *first = all.results;
  }
  for (const StepResult& settled : all.settled) {
    for (StepResult& result : all.results) {
      if (result.channel == settled.channel && result.step == settled.step) {
        result = settled;
      }
    }
  }
  return all;
}

EvaluationOutput evaluate(const tests::SyntheticRun& run) {
  return evaluate(run, run.measurement());
}

// Messages can be compared as a whole.
template <class Result>
auto message_of(const Result& result) {
  return to_message(Recipe{}, result);
}

// Sync as the sensor, against the reference beside it.
wire::Measurement analogue(wire::Measurement measurement) {
  measurement.method(wire::METHOD_ANALOGUE);
  measurement.sync_acs("");
  measurement.sync_dau("");
  measurement.dut() = {"acs/sync"};
  return measurement;
}

// Two frequencies leave the group delay open, which has a flag of its own.
const std::vector<tests::SyntheticStep> steps_that_tell_the_delay{{"40"}, {"63"}, {"80"}};

TEST(RunEvaluator, FlagsWhatTheRecipeLeavesUnstated) {
  const tests::SyntheticRun run{.steps = steps_that_tell_the_delay};
  wire::Measurement measurement = run.measurement();
  measurement.u_reference_phase_rad(0.0);
  measurement.u_adc_delay_s(0.0);
  const EvaluationOutput output = evaluate(run, measurement);
  const auto both = testing::ElementsAre(HasSubstr("uncertainty of the reference is not stated"),
                                         HasSubstr("sync ADC not calibrated"));
  ASSERT_FALSE(output.results.empty());
  for (const StepResult& result : output.results) {
    EXPECT_THAT(sentences_of(result.flags), both);
  }
  ASSERT_FALSE(output.transfer_functions.empty());
  EXPECT_THAT(sentences_of(output.transfer_functions.front().flags), both);
}

TEST(RunEvaluator, TakesTheUncertaintyOfAnAdcThatIsNotCalibratedIntoTheBudget) {
  const tests::SyntheticRun run;
  wire::Measurement measurement = run.measurement();
  measurement.u_adc_delay_s(1e-5);
  for (const StepResult& result : evaluate(run, measurement).results) {
    EXPECT_THAT(sentences_of(result.flags), testing::IsEmpty());
    EXPECT_GT(result.u_phase_rad, 2.0 * std::numbers::pi * result.frequency_hz * 1e-5);
  }
}

double u_hum_of_sensor(const StepResult& result) {
  double squares = 0.0;
  for (const analysis::Contribution& row : result.budget) {
    if (row.kind == analysis::ContributionKind::mains_hum && row.subject == "the sensor") {
      squares += row.u_phase_rad * row.u_phase_rad;
    }
  }
  return std::sqrt(squares);
}

TEST(RunEvaluator, BoundsHumBesideAStepByOtherStepsAndByQuietTime) {
  const tests::SyntheticRun others{.steps = {{"40"}, {"50.1"}, {"80"}}, .sensor_hum = 0.1};
  const tests::SyntheticRun alone{.steps = {{"50.1"}}, .off_s = 1.0, .sensor_hum = 0.1};
  for (const tests::SyntheticRun* run : {&others, &alone}) {
    for (const std::size_t in_background : {0U, 2U}) {
      std::vector<StepResult> all_first;
      const EvaluationOutput output =
          evaluate(*run, run->measurement(), {.evaluations_at_once = in_background}, &all_first);
      ASSERT_EQ(output.settled.size(), 1U);
      const StepResult& settled = output.settled.front();
      const StepResult& first = all_first.at(run->steps.size() / 2);
      EXPECT_TRUE(first.provisional);
      EXPECT_THAT(sentences_of(first.flags),
                  testing::Contains("dau/acceleration_z: hum at 50 Hz cannot be told from the "
                                    "excitation"));
      EXPECT_FALSE(settled.provisional);
      if (run == &others) {
        EXPECT_THAT(sentences_of(settled.flags), testing::IsEmpty());
      } else {                               // the amplifier may hum while it drives
        EXPECT_EQ(settled.flags.size(), 4U); // of each channel
        EXPECT_THAT(sentences_of(settled.flags), testing::Each(HasSubstr("cannot be told")));
      }
      EXPECT_EQ(settled.step, first.step);
      EXPECT_EQ(settled.magnitude, first.magnitude);
      const double u_hum = u_hum_of_sensor(settled);
      const double of_two = run == &others ? std::sqrt(1.75) : 1.0; // background_power.hpp
      EXPECT_NEAR(u_hum, of_two * 0.1 / 9.5 / std::numbers::sqrt2, 0.1 * u_hum);
      EXPECT_NEAR(settled.u_phase_rad, std::hypot(first.u_phase_rad, u_hum),
                  0.01 * settled.u_phase_rad);
      EXPECT_LT(std::abs(settled.magnitude - 0.95), 2.0 * settled.u_magnitude);
      ASSERT_FALSE(output.transfer_functions.empty());
      const auto& points = output.transfer_functions.front().points;
      EXPECT_NEAR(points.at(points.size() / 2).mean.phase.u, settled.u_phase_rad,
                  0.02 * settled.u_phase_rad);
    }
  }
}

TEST(RunEvaluator, IsTheSameBesideTheMainsHoweverTheStreamWasCut) {
  tests::SyntheticRun run{.steps = {{"40"}, {"50.1"}, {"60.2"}}, .sensor_hum = 0.02};
  const EvaluationOutput coarse = evaluate(run);
  run.block_samples = 7;
  const EvaluationOutput fine = evaluate(run);
  ASSERT_EQ(coarse.settled.size(), 2U);
  ASSERT_EQ(fine.settled.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(message_of(coarse.settled[i]), message_of(fine.settled[i]));
  }
}

TEST(RunEvaluator, AsksNobodyToWaitForAStepFarFromAnyLine) {
  const EvaluationOutput output = evaluate(tests::SyntheticRun{});
  EXPECT_TRUE(output.settled.empty());
  for (const StepResult& result : output.results) {
    EXPECT_FALSE(result.provisional);
  }
}

TEST(RunEvaluator, TakesTheResponseOfTheReferenceOut) {
  const tests::SyntheticRun run;
  for (const bool is_analogue : {false, true}) {
    wire::Measurement measurement = is_analogue ? analogue(run.measurement()) : run.measurement();
    const EvaluationOutput plain = evaluate(run, measurement);
    wire::ReferenceContribution drift;
    drift.name("drift");
    drift.u_magnitude_rel(0.01);
    drift.u_phase_rad(0.02);
    drift.degrees_of_freedom(5.0);
    for (const double hz : {40.0, 80.0}) {
      wire::ReferenceCalibrationPoint point;
      point.frequency_hz(hz);
      point.magnitude(1.02);
      point.phase_rad(-1e-3 * hz);
      point.contributions().push_back(drift);
      measurement.reference_calibration().push_back(point);
    }
    const EvaluationOutput corrected = evaluate(run, measurement);
    ASSERT_EQ(corrected.results.size(), plain.results.size());
    ASSERT_FALSE(plain.results.empty());
    for (std::size_t i = 0; i < plain.results.size(); ++i) {
      const StepResult& result = corrected.results[i];
      EXPECT_NEAR(result.magnitude, 1.02 * plain.results[i].magnitude, 1e-9);
      EXPECT_NEAR(
          std::remainder(result.phase_rad - plain.results[i].phase_rad + 1e-3 * result.frequency_hz,
                         2.0 * std::numbers::pi),
          0.0, 1e-9);
      EXPECT_GT(result.u_magnitude, 0.01 * result.magnitude);
      EXPECT_GT(result.u_phase_rad, 0.02);
      const auto named = [](const analysis::Contribution& row) {
        return row.name() == "reference drift" && row.degrees_of_freedom == 5.0;
      };
      EXPECT_EQ(std::count_if(result.budget.begin(), result.budget.end(), named), 1);
    }
  }
}

TEST(RunEvaluator, FindsMagnitudeAndPhaseOfEveryStepAcrossUnrelatedClocks) {
  const tests::SyntheticRun run;
  const EvaluationOutput output = evaluate(run);
  ASSERT_EQ(output.results.size(), 2U);
  for (const StepResult& result : output.results) {
    ASSERT_TRUE(result.valid) << result.problem;
    EXPECT_EQ(result.channel, "dau/acceleration_z");
    EXPECT_NEAR(result.magnitude, run.magnitude, 4.0 * result.u_magnitude);
    EXPECT_NEAR(result.phase_rad, -2.0 * std::numbers::pi * result.frequency_hz * run.delay_s,
                4.0 * result.u_phase_rad);
    EXPECT_LT(result.u_magnitude, 1e-3);
    EXPECT_LT(result.u_phase_rad, 1e-3);
    EXPECT_EQ(result.unit, R"(\one)");
    EXPECT_EQ(result.lost, 0U);
    EXPECT_TRUE(result.flags.empty());
  }
  ASSERT_EQ(output.transfer_functions.size(), 1U);
  EXPECT_EQ(output.transfer_functions.front().points.size(), 2U);
  ASSERT_EQ(output.clock_reports.size(), 1U);
  EXPECT_NEAR(output.clock_reports.front().clock.mean_interval_s, 997e-6, 1e-9);
}

TEST(RunEvaluator, ComparesChannelsOfOneSystemByTheAnalogueMethod) {
  const tests::SyntheticRun run;
  const EvaluationOutput output = evaluate(run, analogue(run.measurement()));
  ASSERT_EQ(output.results.size(), 2U);
  for (const StepResult& result : output.results) {
    ASSERT_TRUE(result.valid) << result.problem;
    EXPECT_NEAR(result.magnitude, 0.1,
                4.0 * result.u_magnitude); // sync is a tenth of the reference
    EXPECT_NEAR(result.phase_rad, 0.0, 4.0 * result.u_phase_rad);
    EXPECT_EQ(result.fits.size(), 2U);
    EXPECT_EQ(result.samples.size(), 1U);
    EXPECT_TRUE(result.flags.empty()) << result.flags.front().sentence;
  }
  EXPECT_EQ(output.transfer_functions.size(), 1U);
  EXPECT_TRUE(output.clock_reports.empty());
}

TEST(RunEvaluator, TakesTheFrequencyFromSyncInTheAnalogueMethod) {
  const tests::SyntheticRun run{.is_in_acs = true};
  wire::Measurement measurement = analogue(run.measurement());
  measurement.dut() = {"acs/sensor"};
  measurement.monte_carlo_trials(20'000);
  const EvaluationOutput without = evaluate(run, measurement);
  measurement.sync_acs("acs/sync");
  const EvaluationOutput with = evaluate(run, measurement);
  ASSERT_EQ(with.results.size(), 2U);
  ASSERT_EQ(without.results.size(), 2U);
  for (std::size_t i = 0; i < with.results.size(); ++i) {
    const StepResult &one = with.results[i], &other = without.results[i];
    ASSERT_TRUE(one.valid && other.valid) << one.problem;
    EXPECT_NEAR(one.magnitude, run.magnitude, 4.0 * one.u_magnitude);
    EXPECT_NEAR(one.magnitude, other.magnitude, 0.1 * other.u_magnitude);
    EXPECT_NEAR(one.phase_rad, other.phase_rad, 0.1 * other.u_phase_rad);
    ASSERT_EQ(other.fits.size(), 2U);
    ASSERT_EQ(one.fits.size(), 3U);
    EXPECT_EQ(one.fits[0].channel, "acs/reference");
    EXPECT_EQ(one.fits[1].channel, "acs/sync");
    EXPECT_EQ(one.fits[2].channel, "acs/sensor");
    EXPECT_EQ(one.fits[0].frequency.hz(), one.fits[1].frequency.hz());
    EXPECT_NE(one.fits[0].frequency.hz(), other.fits[0].frequency.hz());
    EXPECT_TRUE(one.flags.empty()) << one.flags.front().sentence;
    EXPECT_TRUE(one.monte_carlo);
  }
}

TEST(RunEvaluator, LeavesOutWhatTheDataShowToBeSettling) {
  tests::SyntheticRun run;
  run.settling_time_constant_s = 0.05;
  wire::Measurement measurement = run.measurement();
  measurement.settling_from_data(true);
  for (wire::PlannedStep& step : measurement.steps()) {
    step.settling_s(0.7);
    step.duration_s(0.6);
  }
  const EvaluationOutput output = evaluate(run, measurement);
  ASSERT_EQ(output.results.size(), 2U);
  for (const StepResult& result : output.results) {
    ASSERT_TRUE(result.valid) << result.problem;
    EXPECT_TRUE(result.flags.empty()) << result.flags.front().sentence;
    EXPECT_NEAR(result.magnitude, run.magnitude, 4.0 * result.u_magnitude);
    // 0.05 s ln(0.1 / 1e-4) = 0.35 s after the beginning, whole blocks of periods and the window's
    // edge beside it.
    const double begin_s = run.off_s + (result.step - 1) * (run.on_s + run.off_s);
    EXPECT_NEAR(static_cast<double>(result.samples[0].first_stamp_ns) * 1e-9 - begin_s, 0.4, 0.15);
    EXPECT_NEAR(
        static_cast<double>(result.samples[0].last_stamp_ns - result.samples[0].first_stamp_ns) *
            1e-9,
        0.6, 0.001);
  }
}

TEST(RunEvaluator, SaysSoWhenSettlingTakesLongerThanPlanned) {
  tests::SyntheticRun run;
  run.settling_time_constant_s = 0.05;
  wire::Measurement measurement = run.measurement();
  measurement.settling_from_data(true);
  for (wire::PlannedStep& step : measurement.steps()) {
    step.settling_s(0.05);
    step.duration_s(1.2);
  }
  const EvaluationOutput output = evaluate(run, measurement);
  ASSERT_EQ(output.results.size(), 2U);
  for (const StepResult& result : output.results) {
    ASSERT_EQ(result.flags.size(), 1U);
    EXPECT_THAT(result.flags.front().sentence, HasSubstr("settles for"));
  }
}

TEST(RunEvaluator, ChecksTheBudgetByDrawingWhenTheRecipeAsksForIt) {
  const tests::SyntheticRun run;
  wire::Measurement measurement = run.measurement();
  measurement.monte_carlo_trials(50'000);
  measurement.reference_delay_s(2e-6);
  tests::expect_drawing_agrees(evaluate(run, measurement).results, 2);
  tests::expect_drawing_agrees(evaluate(run, analogue(measurement)).results, 2);
}

TEST(RunEvaluator, GivesTheSameBitsHoweverTheStreamsWereCut) {
  tests::SyntheticRun run;
  const EvaluationOutput coarse = evaluate(run);
  run.block_samples = 13;
  const EvaluationOutput fine = evaluate(run);
  ASSERT_EQ(coarse.results.size(), fine.results.size());
  for (std::size_t i = 0; i < coarse.results.size(); ++i) {
    EXPECT_EQ(coarse.results[i].magnitude, fine.results[i].magnitude);
    EXPECT_EQ(coarse.results[i].phase_rad, fine.results[i].phase_rad);
    EXPECT_EQ(coarse.results[i].u_phase_rad, fine.results[i].u_phase_rad);
    EXPECT_EQ(coarse.results[i].data_sha256, fine.results[i].data_sha256);
  }
}

TEST(RunEvaluator, GivesTheSameResultsFromThreadsOfTheirOwn) {
  tests::SyntheticRun run;
  run.lost_block = 22;
  const EvaluationOutput here = evaluate(run, run.measurement());
  for (const std::size_t at_once : {1U, 3U}) {
    const EvaluationOutput elsewhere =
        evaluate(run, run.measurement(), {.evaluations_at_once = at_once});
    ASSERT_EQ(elsewhere.results.size(), here.results.size());
    for (std::size_t i = 0; i < here.results.size(); ++i) {
      EXPECT_TRUE(message_of(elsewhere.results[i]) == message_of(here.results[i]))
          << "result " << i;
    }
    ASSERT_EQ(here.transfer_functions.size(), 1U);
    ASSERT_EQ(elsewhere.transfer_functions.size(), 1U);
    EXPECT_TRUE(message_of(elsewhere.transfer_functions[0]) ==
                message_of(here.transfer_functions[0]));
    ASSERT_EQ(here.clock_reports.size(), 1U);
    ASSERT_EQ(elsewhere.clock_reports.size(), 1U);
    // Nothing states the rate of the DAU's own clock, and NaN is not equal to itself.
    ClockReport other = elsewhere.clock_reports[0];
    ClockReport own = here.clock_reports[0];
    for (ClockReport* report : {&other, &own}) {
      EXPECT_TRUE(std::isnan(report->clock.u_mean_interval_s));
      report->clock.u_mean_interval_s = 0.0;
    }
    EXPECT_TRUE(message_of(other) == message_of(own));
  }
}

// What was recorded after the last step of the recipe belongs to the sample clock alone.
TEST(RunEvaluator, CountsStepsForWhoeverShowsThemAndGivesTheSameBits) {
  const tests::SyntheticRun run{.steps = {{"40"}, {"50.1"}, {"80"}}, .sensor_hum = 0.1};
  const auto count = std::make_shared<WorkCount>("reading");
  const EvaluationOutput alone = evaluate(run, run.measurement());
  const EvaluationOutput counted =
      evaluate(run, run.measurement(), {.evaluations_at_once = 2, .count = count});
  ASSERT_EQ(counted.results.size(), alone.results.size());
  ASSERT_FALSE(alone.results.empty());
  for (std::size_t i = 0; i < alone.results.size(); ++i) {
    EXPECT_EQ(message_of(counted.results[i]), message_of(alone.results[i]));
  }
  ASSERT_FALSE(counted.settled.empty());
  EXPECT_EQ(count->state().what, "settling");
  EXPECT_EQ(count->state().total, counted.settled.size());
  EXPECT_EQ(count->state().done, count->state().total);
}

TEST(RunEvaluator, FollowsTheSampleClockToTheEndOfARecordWhenAsked) {
  tests::SyntheticRun run;
  const wire::Measurement measurement = run.measurement();
  run.steps = {{"40", 10.0}, {"80", 10.0}, {"100", 10.0}, {"125", 10.0}};
  run.lost_block = 150; // of 50 samples in the third step
  const EvaluationOutput to_the_last_step = evaluate(run, measurement);
  for (const std::size_t at_once : {0U, 2U}) {
    const EvaluationOutput to_the_end =
        evaluate(run, measurement, {.evaluations_at_once = at_once, .clock_to_the_end = true});
    ASSERT_EQ(to_the_end.results.size(), 2U);
    ASSERT_EQ(to_the_last_step.results.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_TRUE(message_of(to_the_end.results[i]) == message_of(to_the_last_step.results[i]));
    }
    ASSERT_EQ(to_the_end.clock_reports.size(), 1U);
    ASSERT_EQ(to_the_last_step.clock_reports.size(), 1U);
    const ClockReport& whole = to_the_end.clock_reports[0];
    const ClockReport& part = to_the_last_step.clock_reports[0];
    std::uint64_t sent = 0;
    for (const wire::SampleBlock& block : run.dau_blocks()) {
      sent += block.sample_count();
    }
    EXPECT_EQ(whole.clock.intervals, sent - 2); // two stretches
    EXPECT_LT(part.clock.intervals, whole.clock.intervals * 2 / 3);
    EXPECT_EQ(whole.clock.lost, 50U);
    EXPECT_EQ(part.clock.lost, 0U);
    EXPECT_THAT(sentences_of(whole.flags), testing::Contains("samples lost"));
  }
}

TEST(RunEvaluator, CountsLostSamplesInTheResultOfTheStepTheyBelongTo) {
  tests::SyntheticRun run;
  run.lost_block = 22; // about 1.1 s into the run, in the evaluated part of the first step
  const EvaluationOutput output = evaluate(run);
  ASSERT_EQ(output.results.size(), 2U);
  EXPECT_EQ(output.results[0].lost, 50U);
  EXPECT_THAT(sentences_of(output.results[0].flags), testing::Contains("dau: samples lost"));
  EXPECT_EQ(output.results[1].lost, 0U);
  EXPECT_NEAR(output.results[0].magnitude, run.magnitude, 4.0 * output.results[0].u_magnitude);
}

TEST(RunEvaluator, SaysWhichSyncIsMissingForAStepThatWasNotExcited) {
  tests::SyntheticRun run;
  run.steps = {{"40", 10.0}, {"63", 0.0}, {"80", 10.0}};
  const EvaluationOutput output = evaluate(run);
  ASSERT_EQ(output.results.size(), 3U);
  EXPECT_TRUE(output.results[0].valid);
  EXPECT_FALSE(output.results[1].valid);
  EXPECT_THAT(output.results[1].problem,
              HasSubstr("no steady sine of 63 Hz was found in acs/sync"));
  EXPECT_TRUE(std::isnan(output.results[1].magnitude));
  EXPECT_TRUE(output.results[2].valid);
}

TEST(RunEvaluator, RefusesASourceWithoutTheChannelAndListsThoseItHas) {
  const tests::SyntheticRun run;
  wire::Measurement measurement = run.measurement();
  measurement.sync_dau("dau/synch");
  RunEvaluator evaluator(*parse_recipe(measurement));
  const auto described = tests::describe(evaluator, run.dau_description());
  ASSERT_FALSE(described);
  EXPECT_EQ(described.error().message,
            "source 'dau' has no channel 'synch'; it has: acceleration_z, temperature, sync");
}

TEST(RunEvaluator, RefusesExchangedRolesAndSaysWhich) {
  const tests::SyntheticRun run;
  wire::Measurement measurement = run.measurement();
  measurement.reference("acs/sync");
  measurement.sync_acs("acs/reference");
  RunEvaluator evaluator(*parse_recipe(measurement));
  EXPECT_TRUE(tests::describe(evaluator, run.dau_description()));
  const auto described = tests::describe(evaluator, run.acs_description());
  ASSERT_FALSE(described);
  EXPECT_EQ(described.error().code, ErrorCode::no_source);
  EXPECT_THAT(described.error().message,
              HasSubstr("reference names \"acs/sync\", in V: a voltage"));
  EXPECT_THAT(described.error().message, HasSubstr("exchange reference and sync_acs"));
}

TEST(RunEvaluator, SaysWhichSourceTurnsOutToBeTooSlow) {
  const tests::SyntheticRun run{.steps = {{"40"}, {"507"}}};
  RunEvaluator evaluator(*parse_recipe(run.measurement()));
  ASSERT_TRUE(tests::describe(evaluator, run.acs_description()));
  wire::SourceDescription dau = run.dau_description();
  dau.nominal_rate_hz(0.0);
  ASSERT_TRUE(tests::describe(evaluator, dau));
  for (const wire::SampleBlock& block : run.dau_blocks()) {
    tests::feed(evaluator, block);
  }
  ASSERT_TRUE(evaluator.too_slow_source());
  EXPECT_THAT(*evaluator.too_slow_source(),
              HasSubstr("step 2 has 507 Hz, but the samples of source 'dau' come at 1003 Hz"));
}

TEST(RunEvaluator, RefusesAFrequencyThatTheSourceCannotShow) {
  const tests::SyntheticRun run{.steps = {{"40"}, {"501.5"}}};
  RunEvaluator evaluator(*parse_recipe(run.measurement()));
  wire::SourceDescription dau = run.dau_description();
  dau.nominal_rate_hz(1003.0);
  const auto described = tests::describe(evaluator, dau);
  ASSERT_FALSE(described);
  EXPECT_THAT(described.error().message,
              HasSubstr("step 2 has 501.5 Hz, but source 'dau' takes 1003 samples a second"));
  dau.nominal_rate_hz(1003.1);
  EXPECT_TRUE(tests::describe(evaluator, dau));
}

TEST(RunEvaluator, FlagsASensorThatAnswersBeforeItsExcitation) {
  const auto flags_of = [](double delay_s) {
    const EvaluationOutput output =
        evaluate({.steps = steps_that_tell_the_delay, .delay_s = delay_s});
    EXPECT_EQ(output.transfer_functions.size(), 1U);
    return sentences_of(output.transfer_functions.front().flags);
  };
  const auto answers_before = testing::Contains(HasSubstr("answers before its excitation"));
  EXPECT_THAT(flags_of(-1.5e-3), answers_before);
  EXPECT_THAT(flags_of(1.5e-3), testing::IsEmpty());
  EXPECT_THAT(flags_of(0.0), testing::IsEmpty());
}

TEST(RunEvaluator, FlagsALevelThatIsOffThePlan) {
  const EvaluationOutput output =
      evaluate({.steps = {{"40", 10.9}, {"63", 11.1}, {"80", 8.9}, {"100", 9.1}}});
  ASSERT_EQ(output.results.size(), 4U);
  EXPECT_THAT(sentences_of(output.results[0].flags), testing::IsEmpty());
  EXPECT_THAT(sentences_of(output.results[1].flags),
              testing::ElementsAre("level off plan: 11.1 m/s^2 in place of 10 m/s^2"));
  EXPECT_THAT(sentences_of(output.results[2].flags),
              testing::ElementsAre("level off plan: 8.9 m/s^2 in place of 10 m/s^2"));
  EXPECT_THAT(sentences_of(output.results[3].flags), testing::IsEmpty());
}

// Clipped at 0.95 of its amplitude a sine loses 1.7 % of it, which no uncertainty covers.
TEST(RunEvaluator, RefusesTheValueOfASensorAtItsEndStops) {
  for (const bool range_is_stated : {true, false}) {
    const EvaluationOutput output = evaluate(
        {.steps = {{"40", 10.0}}, .sensor_range = 9.0, .range_is_stated = range_is_stated});
    ASSERT_EQ(output.results.size(), 1U);
    const StepResult& result = output.results.front();
    EXPECT_FALSE(result.valid);
    EXPECT_TRUE(std::isnan(result.magnitude));
    EXPECT_THAT(result.problem, HasSubstr("dau/acceleration_z is over its range"));
    EXPECT_THAT(sentences_of(result.flags),
                testing::Contains(HasSubstr("dau/acceleration_z: over range")));
    EXPECT_TRUE(output.transfer_functions.empty());
  }
}

TEST(RunEvaluator, TakesASensorJustWithinItsRange) {
  const EvaluationOutput output = evaluate({.steps = {{"40", 10.0}}, .sensor_range = 10.0});
  ASSERT_EQ(output.results.size(), 1U);
  EXPECT_TRUE(output.results.front().valid) << output.results.front().problem;
  EXPECT_THAT(sentences_of(output.results.front().flags), testing::IsEmpty());
}

TEST(RunEvaluator, EndsAnAbortedRunWithTheStepsThatWereAnnounced) {
  const tests::SyntheticRun run;
  RunEvaluator evaluator(*parse_recipe(run.measurement()));
  ASSERT_TRUE(tests::describe(evaluator, run.acs_description()));
  ASSERT_TRUE(tests::describe(evaluator, run.dau_description()));
  for (const wire::SampleBlock& block : run.acs_blocks()) {
    tests::feed(evaluator, block);
  }
  for (const wire::SampleBlock& block : run.dau_blocks()) {
    tests::feed(evaluator, block);
  }
  evaluator.announce({.step = 1, .state = StepAnnouncement::State::aborted});
  evaluator.end_of_excitation(true);
  const EvaluationOutput output = evaluator.take_output();
  EXPECT_TRUE(evaluator.finished());
  ASSERT_EQ(output.results.size(), 1U);
  EXPECT_TRUE(output.results.front().valid);
  EXPECT_THAT(sentences_of(output.results.front().flags),
              testing::Contains("excitation broken off"));
}

} // namespace
} // namespace dyncal::inline evaluation
