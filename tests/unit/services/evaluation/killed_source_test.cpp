// A source that is killed beside the end of a step, and comes back as a new session: what its
// samples give does not depend on how many of them came at a time. So a run gives live what its own
// recording gives, step by step, and no step is refused whose planned samples have come.
#include <cstdlib>
#include <deque>
#include <random>

#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double interval_s = 997e-6; // of the DAU
constexpr double planned_s = 1.0;     // settling and duration
constexpr double announced_before_s = 0.2;
constexpr double near_s = 0.1;
constexpr double search_s = 0.2; // frames at both ends of an excitation that it does not fill

// DYNCAL_SEED and DYNCAL_DRAWS give others, and more.
std::uint64_t number_of(const char* variable, std::uint64_t usual) {
  const char* text = std::getenv(variable);
  return text ? std::strtoull(text, nullptr, 10) : usual;
}

struct Kill {
  std::size_t step;
  double after_begin_s; // of the excitation
  double away_s;
};

// Hands blocks over as both the analysis service and the reading of a recording do: a new session
// waits until the evaluation is ready for it.
class Player {
public:
  Player(const tests::SyntheticRun& run, const EvaluationLimits& limits)
      : evaluator_(*parse_recipe(run.measurement()), limits) {
    EXPECT_TRUE(tests::describe(evaluator_, run.acs_description()));
    EXPECT_TRUE(tests::describe(evaluator_, run.dau_description()));
  }
  void hand_over(const wire::SampleBlock& block) {
    const bool is_dau = block.source().to_string() == "dau";
    if (is_dau && (!waiting_.empty() || !evaluator_.is_ready_for("dau", block.session()))) {
      waiting_.push_back(block);
    } else {
      tests::feed(evaluator_, block);
    }
  }
  // What is announced waits for the samples it was said about.
  void announce(const StepAnnouncement& announcement) {
    announced_.push_back(announcement);
    hand_over_announced();
  }
  void take() {
    for (EvaluationOutput output = take_once(); !output.results.empty(); output = take_once()) {
    }
    for (; !waiting_.empty() && evaluator_.is_ready_for("dau", waiting_.front().session());
         waiting_.pop_front()) {
      tests::feed(evaluator_, waiting_.front());
    }
    hand_over_announced();
  }
  std::vector<StepResult> finish() {
    take();
    evaluator_.end_of_excitation(false);
    evaluator_.finish_now();
    take();
    return std::move(results_);
  }

private:
  void hand_over_announced() {
    for (; waiting_.empty() && !announced_.empty(); announced_.pop_front()) {
      evaluator_.announce(announced_.front());
    }
  }
  EvaluationOutput take_once() {
    EvaluationOutput output = evaluator_.take_output();
    results_.insert(results_.end(), output.results.begin(), output.results.end());
    return output;
  }

  RunEvaluator evaluator_;
  std::deque<wire::SampleBlock> waiting_;
  std::deque<StepAnnouncement> announced_;
  std::vector<StepResult> results_;
};

class KilledSource : public testing::Test {
protected:
  tests::SyntheticRun run_{.steps = {{"40", 10.0}, {"80", 9.0}, {"40", 8.0}}, .block_samples = 20};
  std::vector<wire::SampleBlock> acs_ = run_.acs_blocks();
  std::vector<wire::SampleBlock> dau_ = run_.dau_blocks();

  [[nodiscard]] double begin_s(std::size_t step) const {
    return run_.off_s + static_cast<double>(step) * (run_.on_s + run_.off_s);
  }
  // What it sends: blocks that were whole when it was killed, and those since it is back.
  [[nodiscard]] std::vector<wire::SampleBlock> sent_by_dau(const Kill& kill) const {
    const double dies_s = begin_s(kill.step) + kill.after_begin_s;
    std::vector<wire::SampleBlock> sent;
    std::uint64_t before = 0; // samples and blocks that the new session does not count
    std::uint64_t blocks_before = 0;
    for (const wire::SampleBlock& block : dau_) {
      const double first_s = static_cast<double>(block.first_sample()) * interval_s;
      const double behind_s = first_s + block.sample_count() * interval_s;
      if (behind_s < dies_s) {
        sent.push_back(block);
      } else if (first_s > dies_s + kill.away_s) {
        before = before > 0 ? before : block.first_sample() - 1;
        blocks_before = blocks_before > 0 ? blocks_before : block.block();
        sent.push_back(block);
        sent.back().session(block.session() + 1);
        sent.back().first_sample(block.first_sample() - before);
        sent.back().block(block.block() - blocks_before);
      }
    }
    return sent;
  }
  // All blocks in the order of their samples; `random`: so many at a time.
  std::vector<StepResult> play(const Kill& kill, const EvaluationLimits& limits,
                               std::mt19937_64* random) {
    const auto dau = sent_by_dau(kill);
    Player player(run_, limits);
    std::uniform_int_distribution<std::size_t> several(1, 9);
    std::size_t together = random ? several(*random) : 1;
    for (std::size_t i = 0, of_acs = 0, begun = 0; i < dau.size(); ++i) {
      const double now_s =
          static_cast<double>(dau[i].stamps_ns().back() - dau_.front().stamps_ns().front()) * 1e-9;
      if (begun < run_.steps.size() && now_s > begin_s(begun) - announced_before_s) {
        player.announce({.step = static_cast<std::uint32_t>(++begun)});
      }
      while (of_acs < acs_.size() &&
             static_cast<double>(acs_[of_acs].first_sample()) * 1e-4 < now_s) {
        player.hand_over(acs_[of_acs++]);
        if (!random) {
          player.take();
        }
      }
      player.hand_over(dau[i]);
      if (--together == 0) {
        player.take();
        together = random ? several(*random) : 1;
      }
    }
    return player.finish();
  }
  void expect_same(const std::vector<StepResult>& live, const std::vector<StepResult>& recorded) {
    ASSERT_EQ(live.size(), run_.steps.size());
    ASSERT_EQ(recorded.size(), run_.steps.size());
    for (std::size_t step = 0; step < live.size(); ++step) {
      EXPECT_EQ(live[step].problem, recorded[step].problem) << "step " << step + 1;
      if (live[step].valid) { // else there are no numbers, which are not equal to themselves
        EXPECT_TRUE(to_message(Recipe{}, live[step]) == to_message(Recipe{}, recorded[step]))
            << "step " << step + 1;
      }
    }
  }
};

TEST_F(KilledSource, GivesLiveWhatItsRecordingGives) {
  const std::uint64_t seed = number_of("DYNCAL_SEED", 1);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> beside(-near_s, near_s);
  std::size_t valid = 0;
  const std::uint64_t draws = number_of("DYNCAL_DRAWS", 40);
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    const double end_s = draw % 2 == 0 ? planned_s + near_s : run_.on_s;
    const Kill kill{random() % run_.steps.size(), end_s + beside(random),
                    0.1 + 1.0 * (beside(random) + near_s) / near_s};
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", draw " << draw << ", step "
                                    << kill.step + 1 << " killed after " << kill.after_begin_s
                                    << " s, away for " << kill.away_s << " s");
    const auto live = play(kill, {.ahead = true}, &random);
    const auto recorded = play(kill, {.evaluations_at_once = 2, .may_begin_late = true}, nullptr);
    expect_same(live, recorded);
    valid += recorded.at(kill.step).valid ? 1 : 0;
    if (kill.after_begin_s > planned_s + search_s) {
      EXPECT_TRUE(live.at(kill.step).valid) << live.at(kill.step).problem;
    }
    if (live.at(kill.step).valid) {
      EXPECT_NEAR(live.at(kill.step).magnitude, run_.magnitude,
                  5.0 * live.at(kill.step).u_magnitude);
    }
  }
  EXPECT_GT(valid, draws / 2);
  EXPECT_LT(valid, draws);
}

} // namespace
} // namespace dyncal::inline evaluation
