#include "services/evaluation/closures/closures.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "services/base/per_enumerator.hpp"
#include "tests/unit/services/evaluation/closures/drawn_run.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double pi = std::numbers::pi;
constexpr auto kinds_of_closures = static_cast<std::size_t>(last_closure_kind) + 1;
using Fault = std::function<void(DrawnRun&, std::mt19937&)>;

struct Case {
  std::string name;
  ClosureKind kind;
  Fault fault;
  std::size_t channels = 1;
  EvaluationMethod method = EvaluationMethod::sample_timestamping;
  std::uint32_t repetitions = 3;
};

std::ostream& operator<<(std::ostream& out, const Case& one) {
  return out << one.name;
}

StepResult& any_step(DrawnRun& run, std::mt19937& random) {
  return run.results[random() % run.results.size()];
}

double sign(std::mt19937& random) {
  return random() % 2 == 0 ? 1.0 : -1.0;
}

void change_sync(StepResult& result, double rel) {
  for (std::size_t i : {2U, 3U}) {
    result.fits[i].frequency =
        analysis::Frequency::from_hz(result.fits[i].frequency.hz() * (1.0 + rel));
  }
}

const std::vector<Case>& cases_of_instruments() {
  static const std::vector<Case> all{
      {"clock off by 4590 ppm", ClosureKind::clock_rate,
       [](DrawnRun& run, std::mt19937& random) {
         const double rel = 4590e-6 * sign(random);
         for (StepResult& result : run.results) {
           change_sync(result, rel);
         }
       }},
      {"one step by another clock", ClosureKind::clock_ratio,
       [](DrawnRun& run, std::mt19937& random) {
         change_sync(any_step(run, random), 5e-6 * sign(random));
       }},
      {"the sensor's clock 2 us late", ClosureKind::clock_links,
       [](DrawnRun& run, std::mt19937& random) {
         const double late_s = 2e-6 * sign(random);
         for (StepResult& result : run.results) {
           result.clock_link->offset_s += late_s;
         }
       }},
      {"generator off by 1000 ppm", ClosureKind::excitation_frequency,
       [](DrawnRun& run, std::mt19937& random) {
         StepResult& result = any_step(run, random);
         for (analysis::ChannelFit& fit : result.fits) {
           fit.frequency = analysis::Frequency::from_hz(fit.frequency.hz() * 1.001);
         }
       }},
      {"level 15 % off", ClosureKind::level,
       [](DrawnRun& run, std::mt19937& random) {
         any_step(run, random).fits.front().fit.sine *= 1.0 + 0.15 * sign(random);
       }},
      {"own oscillator 8 % off", ClosureKind::clock_rate,
       [](DrawnRun& run, std::mt19937& random) {
         const double rel = 0.08 * sign(random);
         for (StepResult& result : run.results) {
           result.series->sample_rate_hz *= 1.0 + rel;
         }
       },
       1, EvaluationMethod::series_timestamping},
      {"one axis follows another signal", ClosureKind::channel_clocks,
       [](DrawnRun& run, std::mt19937& random) {
         any_step(run, random).series->sample_rate_hz *= 1.0 + 1e-5 * sign(random);
       },
       2, EvaluationMethod::series_timestamping},
      {"samples lost without a trace", ClosureKind::samples_counted,
       [](DrawnRun& run, std::mt19937& random) {
         any_step(run, random).samples.front().used -= 5 + random() % 50;
       }},
  };
  return all;
}

const std::vector<Case>& cases_of_sensors() {
  static const std::vector<Case> all{
      {"one repetition inverted", ClosureKind::repetitions,
       [](DrawnRun& run, std::mt19937& random) {
         StepResult& result = any_step(run, random);
         result.phase_rad = std::remainder(result.phase_rad + pi, 2.0 * pi);
       }},
      {"one repetition turned by 90 degrees", ClosureKind::repetitions,
       [](DrawnRun& run, std::mt19937& random) {
         StepResult& result = any_step(run, random);
         result.phase_rad = std::remainder(result.phase_rad + 0.5 * pi * sign(random), 2.0 * pi);
       }},
      {"one repetition at half the sensor's level", ClosureKind::repetitions,
       [](DrawnRun& run, std::mt19937& random) { any_step(run, random).magnitude *= 0.5; }},
      {"all of a repetition at half the sensor's level", ClosureKind::repetitions,
       [](DrawnRun& run, std::mt19937& random) {
         const unsigned long half = random() % 3 + 1;
         for (StepResult& result : run.results) {
           result.magnitude *= result.repetition == half ? 0.5 : 1.0;
         }
       }},
      {"sensor drifts by 20 %", ClosureKind::first_repeated,
       [](DrawnRun& run, std::mt19937& random) {
         run.results.back().magnitude *= 1.0 + 0.2 * sign(random);
       }},
      {"sensor drifts by 2 % in one sweep", ClosureKind::first_repeated,
       [](DrawnRun& run, std::mt19937& random) {
         const double drift = 0.02 * sign(random);
         for (StepResult& result : run.results) {
           result.magnitude *= 1.0 + drift * result.step / run.results.back().step;
         }
       },
       1, EvaluationMethod::analogue, 1},
      {"resonance", ClosureKind::delay_fit,
       [](DrawnRun& run, std::mt19937& random) {
         const double at_hz = 60.0 + 20.0 * static_cast<double>(random() % 4);
         for (StepResult& result : run.results) {
           const double x = result.frequency_hz / at_hz;
           result.phase_rad =
               std::remainder(result.phase_rad - std::atan2(0.2 * x, 1.0 - x * x), 2.0 * pi);
         }
       }},
      {"high-pass in the sensor's amplifier", ClosureKind::phase_at_zero,
       [](DrawnRun& run, std::mt19937&) {
         for (StepResult& result : run.results) {
           result.phase_rad = std::remainder(result.phase_rad + 0.3, 2.0 * pi);
         }
       }},
      {"one axis a sample late", ClosureKind::channel_delays,
       [](DrawnRun& run, std::mt19937& random) {
         const double late_s = (600 + static_cast<double>(random() % 900)) * 1e-6;
         for (StepResult& result : run.results) {
           if (result.channel == "dau/y") {
             result.phase_rad = std::remainder(
                 result.phase_rad - 2.0 * pi * result.frequency_hz * late_s, 2.0 * pi);
           }
         }
       },
       2},
  };
  return all;
}

std::vector<ClosureKind> open_of(const DrawnRun& run) {
  std::vector<ClosureKind> open;
  for (const Closure& closure : run.closures()) {
    if (is_open(closure)) {
      open.push_back(closure.kind);
    }
  }
  return open;
}

class OpenClosure : public testing::TestWithParam<Case> {};

TEST_P(OpenClosure, IsFoundInNearlyEveryDraw) {
  const Case& one = GetParam();
  constexpr int draws = 60;
  int found = 0;
  for (unsigned seed = 1; seed <= draws; ++seed) {
    std::mt19937 random(seed + 10'000);
    DrawnRun run = draw_run(
        seed, {.channels = one.channels, .method = one.method, .repetitions = one.repetitions});
    one.fault(run, random);
    const auto open = open_of(run);
    found += std::find(open.begin(), open.end(), one.kind) != open.end() ? 1 : 0;
  }
  EXPECT_GE(found, draws - 1);
}

INSTANTIATE_TEST_SUITE_P(OfInstruments, OpenClosure, testing::ValuesIn(cases_of_instruments()));
INSTANTIATE_TEST_SUITE_P(OfSensors, OpenClosure, testing::ValuesIn(cases_of_sensors()));

TEST(Closures, CloseInCleanRunsOfEveryMethod) {
  constexpr unsigned draws = 300;
  std::vector<std::string> open;
  std::set<ClosureKind> closing;
  for (const auto method :
       {EvaluationMethod::analogue, EvaluationMethod::sample_timestamping,
        EvaluationMethod::series_timestamping, EvaluationMethod::absolute_time}) {
    for (unsigned seed = 1; seed <= draws; ++seed) {
      for (const Closure& closure : draw_run(seed + 1000 * static_cast<unsigned>(method) + 50'000,
                                             {.channels = 2,
                                             .method = method,
                                             .repetitions = seed % 5 + 1,
                                             .points = seed % 3 == 0 ? seed % 2 + 1 : 6})
                                        .closures()) {
        if (is_open(closure)) {
          open.push_back(to_string(method) + (": " + closure.sentence));
        }
        if (closure.verdict == Verdict::closes) {
          closing.insert(closure.kind);
        }
        EXPECT_FALSE(closure.sentence.empty());
      }
    }
  }
  EXPECT_LE(open.size(), 1U) << testing::PrintToString(open);
  EXPECT_EQ(closing.size(), kinds_of_closures);
}

// As the bench file states the polarity, or another model.
TEST(Closures, OfThePhaseAreHeldAgainstWhatTheBenchFileSays) {
  const auto verdict = [](DutPhase stated, ClosureKind kind, bool inverted) {
    DrawnRun run = draw_run(11, {.channels = 2});
    run.recipe.dut_phase = stated;
    for (StepResult& result : run.results) {
      result.phase_rad = std::remainder(result.phase_rad + (inverted ? pi : 0.0), 2.0 * pi);
    }
    const auto all = run.closures();
    return std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.kind == kind; })
        ->verdict;
  };
  constexpr auto at_zero = ClosureKind::phase_at_zero;
  EXPECT_EQ(verdict(DutPhase::delay, at_zero, false), Verdict::closes);
  EXPECT_EQ(verdict(DutPhase::delay, at_zero, true), Verdict::closes);
  EXPECT_EQ(verdict(DutPhase::delay_from_0, at_zero, false), Verdict::closes);
  EXPECT_EQ(verdict(DutPhase::delay_from_0, at_zero, true), Verdict::open);
  EXPECT_EQ(verdict(DutPhase::delay_from_180, at_zero, false), Verdict::open);
  EXPECT_EQ(verdict(DutPhase::delay_from_180, at_zero, true), Verdict::closes);
  for (const auto kind : {at_zero, ClosureKind::delay_fit, ClosureKind::channel_delays}) {
    EXPECT_EQ(verdict(DutPhase::any, kind, false), Verdict::not_possible);
    EXPECT_EQ(verdict(DutPhase::delay, kind, false), Verdict::closes);
  }
}

// The u of a mean has the scatter of its repetitions, so this is open where a program is wrong.
TEST(Closures, AreOpenWhereTheMeansAreKnownWorseThanIsStated) {
  constexpr unsigned draws = 60;
  std::size_t found = 0;
  for (unsigned seed = 1; seed <= draws; ++seed) {
    const auto all = draw_run(seed + 20'000).closures_after([](TransferFunction& function) {
      for (FrequencyPoint& point : function.points) {
        point.mean.independent_magnitude_rel.u /= 5.0;
        point.mean.independent_phase.u /= 5.0;
      }
    });
    found += static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [](const auto& one) {
      return one.kind == ClosureKind::repetition_scatter && is_open(one);
    }));
  }
  EXPECT_GE(found, draws - 1);
}

TEST(Closures, TheRepetitionThatIsOffIsFlaggedInItsOwnRow) {
  DrawnRun run = draw_run(7);
  StepResult& wrong = run.results[8];
  wrong.phase_rad = std::remainder(wrong.phase_rad + pi, 2.0 * pi);
  const auto flagged = run.flagged();
  ASSERT_EQ(flagged.size(), 1U);
  EXPECT_EQ(flagged.front().step, wrong.step);
  EXPECT_EQ(flagged.front().flags.back().kind, ResultFlag::closure_open);
  EXPECT_TRUE(draw_run(7).flagged().empty());
}

// Within the time that is evaluated, or at its ends, where the evaluated part is shorter by them.
TEST(Closures, CountSamplesThatWereLeftOutForAReason) {
  std::mt19937 random(29);
  for (const auto part : {&SourceSamples::lost, &SourceSamples::not_trusted,
                          &SourceSamples::not_measured, &SourceSamples::cut_out}) {
    for (const bool at_end : {false, true}) {
      DrawnRun run = draw_run(13);
      SourceSamples& samples = any_step(run, random).samples.front();
      const std::uint64_t left_out = 5 + random() % 500;
      samples.*part += left_out;
      samples.used -= left_out;
      samples.last_stamp_ns -= at_end ? static_cast<std::int64_t>(left_out) * 1'000'000 : 0;
      EXPECT_TRUE(open_of(run).empty());
      if (!at_end) {
        samples.used -= 5;
        EXPECT_EQ(open_of(run), std::vector{ClosureKind::samples_counted});
      }
    }
  }
}

TEST(Closures, OfAChannelThatHardlyMovesAreNotPossible) {
  DrawnRun run = draw_run(3);
  for (StepResult& result : run.results) {
    result.magnitude *= 1e-3;
    result.u_magnitude = result.magnitude;
    result.u_phase_rad = 1.0;
    result.budget.front().u_magnitude_rel = result.budget.front().u_phase_rad = 1.0;
  }
  for (const Closure& closure : run.closures()) {
    if (closure.kind >= ClosureKind::repetitions && closure.kind != ClosureKind::clock_links) {
      EXPECT_EQ(closure.verdict, Verdict::not_possible) << closure.sentence;
    }
    EXPECT_NE(closure.verdict, Verdict::open) << closure.sentence;
  }
}

// As of an ideal record: no noise at all, or nothing of the signal.
TEST(Closures, OfValuesWithoutNoiseOrLengthCloseOrAreNotPossible) {
  for (const double magnitude : {1.0, 0.0}) {
    DrawnRun run = draw_run(5);
    for (StepResult& result : run.results) {
      result.magnitude = magnitude;
      result.u_magnitude = result.u_phase_rad = 0.0;
      result.phase_rad = 0.0;
      result.budget.front().u_magnitude_rel = result.budget.front().u_phase_rad = 0.0;
    }
    const auto closures = run.closures();
    EXPECT_FALSE(closures.empty());
    for (const Closure& closure : closures) {
      EXPECT_NE(closure.verdict, Verdict::open) << closure.sentence;
    }
  }
  DrawnRun run = draw_run(5);
  run.results[8].magnitude = 0.0; // one repetition alone
  const auto open = open_of(run);
  EXPECT_NE(std::find(open.begin(), open.end(), ClosureKind::repetitions), open.end());
}

TEST(Closures, KindsHaveNamesThatAreReadBack) {
  for (std::size_t i = 0; i < kinds_of_closures; ++i) {
    const auto kind = static_cast<ClosureKind>(i);
    EXPECT_EQ(parse_enumerator<ClosureKind>(to_string(kind)), kind);
    EXPECT_FALSE(title_of(kind).empty());
  }
  EXPECT_FALSE(parse_enumerator<ClosureKind>("of a later version").has_value());
}

} // namespace
} // namespace dyncal::inline evaluation
