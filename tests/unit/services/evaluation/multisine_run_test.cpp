// A whole run of a multi-sine: found in both records, evaluated at once, one result a line.
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/contract/source_block.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "services/evaluation/step_survey.hpp"
#include "tests/unit/analysis/method/simulated_multisine.hpp"

namespace dyncal::inline evaluation {
namespace {

using analysis::MultisineRecords;
using analysis::SimulatedMultisine;
using testing::HasSubstr;

constexpr std::size_t block_samples = 500;

drivers::SourceDescription described(std::vector<drivers::ChannelDescription> channels) {
  return {.device = "simulated", .serial = "1", .driver = "none", .channels = std::move(channels)};
}

drivers::SourceDescription acs_of(const char* reference_unit) {
  return described({{"reference", "", reference_unit}, {"sync", "", R"(\volt)"}});
}

drivers::SourceDescription dau_of() {
  return described({{"z", "", R"(\metre\second\tothe{-2})"}, {"sync", "", R"(\volt)"}});
}

constexpr const char* acceleration_unit = R"(\metre\second\tothe{-2})";

// Two channels of one clock, block by block.
std::vector<drivers::SampleBlock> blocks_of(const std::vector<std::int64_t>& stamps_ns,
                                            const std::vector<double>& first,
                                            const std::vector<double>& second) {
  std::vector<drivers::SampleBlock> blocks;
  for (std::size_t begin = 0; begin < stamps_ns.size(); begin += block_samples) {
    const auto from = static_cast<std::ptrdiff_t>(begin);
    const auto to = static_cast<std::ptrdiff_t>(std::min(begin + block_samples, stamps_ns.size()));
    drivers::SampleBlock block;
    block.first_sample = begin;
    block.samples = static_cast<std::size_t>(to - from);
    block.stamps_ns.assign(stamps_ns.begin() + from, stamps_ns.begin() + to);
    block.values.assign(first.begin() + from, first.begin() + to);
    block.values.insert(block.values.end(), second.begin() + from, second.begin() + to);
    blocks.push_back(std::move(block));
  }
  return blocks;
}

struct Laboratory {
  SimulatedMultisine bench;
  std::vector<drivers::SampleBlock> acs;
  std::vector<drivers::SampleBlock> dau;
  Recipe recipe;
};

Recipe recipe_of(const SimulatedMultisine& bench, int repetitions) {
  Recipe recipe;
  recipe.bench = "simulated";
  recipe.run = "files";
  recipe.roles = {.method = EvaluationMethod::sample_timestamping,
                  .reference = {"acs", "reference"},
                  .sync_acs = {"acs", "sync"},
                  .sync_sensor = {"dau", "sync"},
                  .dut = {{"dau", "z"}}};
  recipe.u_adc_delay_s = 2e-6;
  recipe.systematic.reference_magnitude_rel = 1e-5;
  recipe.systematic.reference_phase_rad = 1e-5;
  recipe.systematic.acs_delay_s = 1e-9;
  recipe.multisine_period_s = bench.period_s;
  for (int repetition = 1; repetition <= repetitions; ++repetition) {
    for (const std::string& text : bench.lines_hz) {
      recipe.steps.push_back({.step = static_cast<std::uint32_t>(recipe.steps.size() + 1),
                              .repetition = static_cast<std::uint32_t>(repetition),
                              .frequency_text_hz = text,
                              .frequency = *analysis::Frequency::parse(text),
                              .level_m_s2 = 0.0,
                              .settling_s = 2.0,
                              .duration_s = 10.0});
    }
  }
  return recipe;
}

// Of one record after the other, in the clocks of the first.
Laboratory laboratory(SimulatedMultisine bench, int repetitions, unsigned seed) {
  bench.duration_s = 20.0;
  bench.quiet_s = 2.5;
  bench.late_s = 0.0;
  Laboratory made{bench, {}, {}, recipe_of(bench, repetitions)};
  std::vector<std::int64_t> acs_ns, dau_ns;
  std::vector<double> reference, sync_acs, sensor, sync_dau;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const MultisineRecords records = simulate(bench, seed + static_cast<unsigned>(repetition));
    const auto append = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    const std::int64_t shift_ns = 20'000'000'000LL * repetition;
    for (const std::int64_t stamp : records.acs_ns) {
      acs_ns.push_back(stamp + shift_ns);
    }
    for (const std::int64_t stamp : records.dau_ns) {
      dau_ns.push_back(stamp + shift_ns);
    }
    append(reference, records.reference);
    append(sync_acs, records.sync_acs);
    append(sensor, records.sensor);
    append(sync_dau, records.sync_dau);
  }
  made.acs = blocks_of(acs_ns, reference, sync_acs);
  made.dau = blocks_of(dau_ns, sensor, sync_dau);
  return made;
}

// Settled results in place of those that came first.
EvaluationOutput evaluate(const Laboratory& made, const EvaluationLimits& limits = {}) {
  const auto checked = check_recipe(made.recipe);
  EXPECT_TRUE(checked) << checked.error().message;
  RunEvaluator evaluator(made.recipe, limits);
  EXPECT_TRUE(evaluator.describe("acs", acs_of(acceleration_unit)));
  EXPECT_TRUE(evaluator.describe("dau", dau_of()));
  EvaluationOutput all;
  const auto collect = [&] {
    EvaluationOutput output = evaluator.take_output();
    std::ranges::move(output.results, std::back_inserter(all.results));
    for (StepResult& settled : output.settled) {
      *std::ranges::find_if(all.results, [&](const StepResult& one) {
        return one.step == settled.step;
      }) = std::move(settled);
    }
    std::ranges::move(output.transfer_functions, std::back_inserter(all.transfer_functions));
  };
  const std::size_t last = std::max(made.acs.size(), made.dau.size());
  for (std::size_t i = 0; i < last; ++i) {
    const auto feed = [&](const char* source, const std::vector<drivers::SampleBlock>& blocks) {
      if (i < blocks.size()) {
        SourceBlock block = view_block(blocks[i], 1, i);
        block.end_of_stream = i + 1 == blocks.size();
        evaluator.add(source, block);
      }
    };
    feed("acs", made.acs);
    feed("dau", made.dau);
    collect();
  }
  if (!evaluator.finished()) {
    evaluator.end_of_excitation(false);
    evaluator.finish_now();
    collect();
  }
  EXPECT_TRUE(evaluator.finished());
  return all;
}

double largest_z(const StepResult& result, const SimulatedMultisine& bench) {
  const std::complex<double> truth = true_response(bench, result.frequency_hz);
  return std::max(std::abs(result.magnitude - std::abs(truth)) / result.u_magnitude,
                  std::abs(std::arg(std::polar(1.0, result.phase_rad) / truth)) /
                      result.u_phase_rad);
}

TEST(MultisineRun, HasOneResultALineAndRepetition) {
  const Laboratory made = laboratory({}, 2, 21);
  const EvaluationOutput output = evaluate(made);
  ASSERT_EQ(output.results.size(), made.recipe.steps.size());
  for (std::size_t i = 0; i < output.results.size(); ++i) {
    const StepResult& result = output.results[i];
    EXPECT_EQ(result.step, made.recipe.steps[i].step);
    EXPECT_EQ(result.repetition, made.recipe.steps[i].repetition);
    EXPECT_EQ(result.frequency_text_hz, made.recipe.steps[i].frequency_text_hz);
    ASSERT_TRUE(result.valid) << result.problem;
    EXPECT_LT(largest_z(result, made.bench), 4.0) << result.frequency_text_hz;
    EXPECT_EQ(result.unit, R"(\one)");
    ASSERT_EQ(result.fits.size(), 4U);
    EXPECT_GT(result.fits[1].u_frequency_hz, 0.0);
    for (const Flag& flag : result.flags) {
      ADD_FAILURE() << result.frequency_text_hz << " Hz: " << flag.sentence;
    }
  }
  ASSERT_EQ(output.transfer_functions.size(), 1U);
  const TransferFunction& function = output.transfer_functions.front();
  ASSERT_EQ(function.points.size(), made.bench.lines_hz.size());
  EXPECT_EQ(function.points.front().mean.repetitions, 2U);
}

// One window and one link: an error of the link is the same delay at all lines, and so it counts in
// the group delay, however many lines there are.
TEST(MultisineRun, TheLinkOfTheClocksCountsInFullInTheGroupDelay) {
  Laboratory made = laboratory({.corner_hz = 1e9}, 1, 22);
  made.recipe.u_adc_delay_s = 5e-6;
  const EvaluationOutput output = evaluate(made);
  ASSERT_EQ(output.transfer_functions.size(), 1U);
  const auto& delay = output.transfer_functions.front().group_delay;
  ASSERT_TRUE(delay) << output.transfer_functions.front().group_delay_problem;
  EXPECT_GT(delay->u_delay_s(), 4.9e-6);
  EXPECT_LT(delay->u_delay_s(), 6e-6);
  // The simulated lag of the converter is not corrected: sync is late by it, the sensor early.
  EXPECT_NEAR(delay->delay_s, made.bench.delay_s - made.bench.adc_lag_s, 0.5e-6);
}

TEST(MultisineRun, IsTheSameFromOtherThreads) {
  const Laboratory made = laboratory({}, 1, 23);
  const EvaluationOutput here = evaluate(made);
  const EvaluationOutput there = evaluate(made, {.evaluations_at_once = 2});
  ASSERT_EQ(here.results.size(), there.results.size());
  for (std::size_t i = 0; i < here.results.size(); ++i) {
    EXPECT_EQ(here.results[i].magnitude, there.results[i].magnitude);
    EXPECT_EQ(here.results[i].u_phase_rad, there.results[i].u_phase_rad);
  }
}

TEST(MultisineRun, SaysForEveryLineWhatIsMissing) {
  Laboratory made = laboratory({}, 1, 24);
  for (drivers::SampleBlock& block : made.dau) { // sync is not connected
    std::fill(block.values.begin() + static_cast<std::ptrdiff_t>(block.samples), block.values.end(),
              0.0);
  }
  const EvaluationOutput output = evaluate(made);
  ASSERT_EQ(output.results.size(), made.recipe.steps.size());
  for (const StepResult& result : output.results) {
    EXPECT_FALSE(result.valid);
    EXPECT_THAT(result.problem, HasSubstr("dau/sync"));
  }
}

// The first repetition is not in the record of the DAU. One multi-sine looks like the other, so
// that nothing tells which is missing: none stands in for another.
TEST(MultisineRun, ARepetitionThatOneRecordLacksIsNotTakenForAnother) {
  Laboratory made = laboratory({}, 2, 25);
  std::erase_if(made.dau,
                [](const drivers::SampleBlock& block) { return block.first_sample < 20'000; });
  StepSurvey survey(made.recipe);
  for (const auto& [name, blocks] : {std::pair{"acs", &made.acs}, std::pair{"dau", &made.dau}}) {
    survey.describe(name, std::string(name) == "acs" ? acs_of(acceleration_unit) : dau_of());
    for (std::size_t i = 0; i < blocks->size(); ++i) {
      SourceBlock block = view_block((*blocks)[i], 1, i);
      block.end_of_stream = i + 1 == blocks->size();
      survey.add(name, block);
    }
  }
  const EvaluationOutput output = evaluate(made, {.schedule = survey.schedule()});
  ASSERT_EQ(output.results.size(), made.recipe.steps.size());
  for (const StepResult& result : output.results) {
    EXPECT_FALSE(result.valid);
    EXPECT_THAT(result.problem, HasSubstr("nothing tells which of them are the same"));
  }
}

TEST(MultisineRecipe, RefusesWhatAMultisineCannotHave) {
  const Recipe sound = recipe_of({}, 2);
  ASSERT_TRUE(check_recipe(sound));
  EXPECT_EQ(sound.lines_at_once(), 17U);
  EXPECT_EQ(sound.excitations(), 2U);
  const auto refusal = [&](auto&& change) {
    Recipe recipe = sound;
    change(recipe);
    const auto checked = check_recipe(recipe);
    return checked ? std::string() : checked.error().message;
  };
  EXPECT_THAT(refusal([](Recipe& r) {
                r.steps[0].frequency_text_hz = "25.3";
                r.steps[4].frequency_text_hz = "50.6";
              }),
              HasSubstr("2 times 25.3 Hz = 50.6 Hz"));
  EXPECT_THAT(refusal([](Recipe& r) {
                r.roles.dut = {{"sensor", "z"}};
              }),
              HasSubstr("no other method"));
  EXPECT_THAT(refusal([](Recipe& r) { r.monte_carlo_trials = 10'000; }),
              HasSubstr("monte_carlo_trials"));
  EXPECT_THAT(refusal([](Recipe& r) { r.steps.pop_back(); }), HasSubstr("same lines"));
  EXPECT_THAT(refusal([](Recipe& r) { r.steps.back().frequency_text_hz = "251.1"; }),
              HasSubstr("same lines"));
}

} // namespace
} // namespace dyncal::inline evaluation
