// A conducted run whose ACS dies and comes back as a new session some steps later: what it shows
// then is of the steps of then, and no step has ever the value of another one.
#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;
using State = StepAnnouncement::State;

constexpr double block_s = 0.05;       // of both
constexpr double silence_s = 2.0;      // with a source so long silent, announcements wait
constexpr double repeated_s = 0.5;     // an announcement is so often
constexpr double beside_step_s = 0.25; // what the search may need of the pauses

// DYNCAL_SEED and DYNCAL_DRAWS give others, and more.
std::uint64_t number_of(const char* variable, std::uint64_t usual) {
  const char* text = std::getenv(variable);
  return text ? std::strtoull(text, nullptr, 10) : usual;
}

struct Absence {
  double from_s;
  double to_s;
  bool clock_begins_anew;
  double late_s = 0.0;          // what it sends first when it is back, comes so late, all at once
  bool times_are_known = false; // when blocks were sent, and when all was heard
};

class LateSource : public testing::TestWithParam<bool> {
protected:
  // 2 s each: 1.5 s excited, behind 0.5 s of pause. Levels tell wrong pairs by their magnitude.
  tests::SyntheticRun run_{.steps = {{"40", 8.0},
                                     {"80", 9.0},
                                     {"40", 10.0},
                                     {"80", 11.0},
                                     {"40", 12.0},
                                     {"80", 13.0},
                                     {"80", 14.0},
                                     {"80", 15.0}}};
  std::vector<wire::SampleBlock> acs_ = run_.acs_blocks();
  std::vector<wire::SampleBlock> dau_ = run_.dau_blocks();

  [[nodiscard]] double begin_s(std::size_t step) const {
    return run_.off_s + static_cast<double>(step) * (run_.on_s + run_.off_s);
  }
  [[nodiscard]] double end_s(std::size_t step) const { return begin_s(step) + run_.on_s; }

  // Hands over what the analysis service would: what is announced waits while a source is silent.
  std::vector<StepResult> play(const Absence& absence) {
    RunEvaluator evaluator(*parse_recipe(run_.measurement()), {.ahead = GetParam()});
    EXPECT_TRUE(tests::describe(evaluator, run_.acs_description()));
    EXPECT_TRUE(tests::describe(evaluator, run_.dau_description()));
    std::vector<StepResult> results;
    std::vector<std::pair<StepAnnouncement, std::optional<std::int64_t>>> waiting;
    std::vector<std::pair<wire::SampleBlock, double>> under_way; // and when it was sent
    double repeated_at_s = 0.0;
    std::size_t settling = 0, done = 0;
    std::uint64_t first_back = 0;
    double heard_s = 0.0;
    for (std::size_t i = 0; i < std::min(acs_.size(), dau_.size()); ++i) {
      const double now_s = block_s * static_cast<double>(i);
      const auto announce = [&](std::size_t step, State state) {
        waiting.emplace_back(
            StepAnnouncement{.step = static_cast<std::uint32_t>(step + 1), .state = state},
            absence.times_are_known ? std::optional(to_ns(now_s)) : std::nullopt);
        repeated_at_s = now_s;
      };
      if (settling < run_.steps.size() && begin_s(settling) - 0.05 <= now_s) {
        announce(settling++, State::excited);
      } else if (done < settling && end_s(done) + 0.05 <= now_s) {
        announce(done++, State::done);
      } else if (done < settling && now_s - repeated_at_s > repeated_s) {
        announce(settling - 1, State::excited);
      }
      const auto hand_over = [&](const wire::SampleBlock& block, double sent_s) {
        // The clock of a source's host is its own.
        const BlockTimes times{to_ns(sent_s) + 3'600'000'000'000, to_ns(now_s) + 2'000'000};
        evaluator.add(block.source().to_string(), view_block(block),
                      absence.times_are_known ? std::optional(times) : std::nullopt);
      };
      if (now_s < absence.from_s) {
        under_way.emplace_back(acs_[i], now_s);
      } else if (now_s >= absence.to_s) {
        under_way.emplace_back(of_new_session(i, first_back, absence), now_s);
      }
      if (now_s < absence.to_s || now_s >= absence.to_s + absence.late_s) {
        for (const auto& [block, sent_s] : std::exchange(under_way, {})) {
          hand_over(block, sent_s);
          heard_s = now_s;
        }
      }
      hand_over(dau_[i], now_s);
      if (now_s - heard_s < silence_s) {
        for (const auto& [announcement, announced_ns] : std::exchange(waiting, {})) {
          evaluator.announce(announcement, announced_ns);
        }
      }
      take(evaluator, results);
    }
    evaluator.end_of_excitation(false);
    take(evaluator, results);
    evaluator.finish_now();
    take(evaluator, results);
    return results;
  }
  wire::SampleBlock of_new_session(std::size_t i, std::uint64_t& first, const Absence& absence) {
    wire::SampleBlock block = acs_[i];
    first = first == 0 ? i : first;
    block.session(block.session() + 1);
    block.block(i - first);
    block.first_sample(block.first_sample() - acs_[first].first_sample());
    if (!absence.clock_begins_anew) {
      block.origin_ns(static_cast<std::int64_t>(acs_[first].first_sample()) *
                      block.interval_numerator_ns());
    }
    acs_began_ns_ =
        absence.clock_begins_anew
            ? static_cast<std::int64_t>(acs_[first].first_sample()) * block.interval_numerator_ns()
            : 0;
    return block;
  }
  static std::int64_t to_ns(double time_s) { return std::llround(1e9 * time_s); }
  static void take(RunEvaluator& evaluator, std::vector<StepResult>& results) {
    for (bool any = true; any;) {
      EvaluationOutput output = evaluator.take_output();
      any = !output.results.empty();
      std::move(output.results.begin(), output.results.end(), std::back_inserter(results));
    }
  }
  [[nodiscard]] bool is_whole(std::size_t step, const Absence& absence) const {
    return end_s(step) + beside_step_s < absence.from_s ||
           absence.to_s < begin_s(step) - beside_step_s;
  }
  void expect_of_its_step(const StepResult& one) const {
    const std::size_t step = one.step - 1;
    for (const SourceSamples& of : one.samples) {
      const bool is_dau = of.source == "dau";
      const bool is_back = !is_dau && one.step > 1 && acs_began_ns_ > 0 &&
                           1e-9 * static_cast<double>(of.first_stamp_ns) < begin_s(step) - 0.1;
      const std::int64_t epoch_ns = is_dau    ? 1'700'000'000'123'456'789
                                    : is_back ? -acs_began_ns_
                                              : 0;
      const double first_s = 1e-9 * static_cast<double>(of.first_stamp_ns - epoch_ns);
      const double last_s = 1e-9 * static_cast<double>(of.last_stamp_ns - epoch_ns);
      EXPECT_GT(first_s, begin_s(step) - 1e-3) << of.source;
      EXPECT_LT(last_s, end_s(step) + 1e-3) << of.source;
    }
    EXPECT_NEAR(one.magnitude, run_.magnitude, 5.0 * one.u_magnitude);
  }

  void expect_of_draws(bool come_late) {
    const std::uint64_t seed = number_of("DYNCAL_SEED", 31);
    const std::uint64_t draws = number_of("DYNCAL_DRAWS", 8);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> begin(1.0, 8.0), length(0.3, 8.0), late(0.0, 3.0);
    std::size_t valid = 0, without = 0;
    for (std::uint64_t draw = 0; draw < draws; ++draw) {
      const double from_s = begin(random);
      Absence absence{from_s, from_s + length(random), random() % 2 == 0};
      if (come_late) {
        absence.late_s = late(random);
        absence.times_are_known = true;
      }
      SCOPED_TRACE(fmt::format("seed {}, draw {}: away from {:.2f} to {:.2f} s, clock {}", seed,
                               draw, absence.from_s, absence.to_s,
                               absence.clock_begins_anew ? "anew" : "goes on"));
      const auto results = play(absence);
      ASSERT_EQ(results.size(), run_.steps.size());
      for (const StepResult& one : results) {
        SCOPED_TRACE(fmt::format("step {}", one.step));
        if (one.valid) {
          ++valid;
          expect_of_its_step(one);
          continue;
        }
        ++without;
        EXPECT_FALSE(is_whole(one.step - 1, absence)) << one.problem;
        EXPECT_THAT(one.problem, HasSubstr("source 'acs' restarted during the run"));
      }
    }
    EXPECT_GT(valid, draws * 3U);
    EXPECT_GT(without, draws);
  }

  std::int64_t acs_began_ns_ = 0; // of its new clock in that of the samples
};

INSTANTIATE_TEST_SUITE_P(AheadOfTheEndOrNot, LateSource, testing::Bool());

TEST_P(LateSource, GivesNoStepTheValueOfAnotherAndWholeStepsTheirOwn) {
  expect_of_draws(false);
}

// The newest stamps that have come would not tell.
TEST_P(LateSource, NorWhereItsSamplesComeLate) {
  expect_of_draws(true);
}

} // namespace
} // namespace dyncal::inline evaluation
