// A step from the first setting to the last, at every limit and on every way out: the output is off
// afterwards. No real time passes.
#include "services/run/level_meter.hpp"
#include "services/run/step_excitation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/run/level_settling.hpp"
#include "services/run/run_plan.hpp"
#include "tests/unit/services/run/played_generator.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

constexpr double settling_s = 0.5;
constexpr double duration_s = 2.0;
constexpr double margin_s = 0.4; // at 40 Hz: four frames of 0.1 s
constexpr double off_s = 0.3;

class StepExcitationTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant participant_ = network_.join("runner");
  bus::Participant sources_ = network_.join("sources");
  tests::PlayedInstrument instrument_{clock_};
  BenchFile bench_ = bench();
  std::vector<wire::ExcitationState> announced_;
  std::vector<std::string> phases_;
  std::function<Expected<void>()> keep_alive_ = [] { return Expected<void>{}; };
  std::stop_source stop_;
  bool fault_may_pass_ = false;

  static BenchFile bench() {
    BenchFile bench;
    bench.bench = "b";
    bench.excitation.frequencies_hz = {"40"};
    bench.excitation.levels_m_s2 = {10.0};
    bench.excitation.settling_s = settling_s;
    bench.excitation.duration_s = duration_s;
    bench.generator.driver = GeneratorDriver::scpi;
    bench.generator.level_per_volt = 5.0;
    bench.method.reference = {"acs", "reference"};
    return bench;
  }
  [[nodiscard]] wire::Measurement measurement() const {
    return to_message(plan_recipe(bench_, "r1", {}).value());
  }
  Expected<std::unique_ptr<StepExcitation>> open() {
    return StepExcitation::open(
        {participant_, clock_, tests::connect_to(instrument_)}, bench_, measurement(),
        std::make_shared<bus::WakeUp>(),
        {.announce = [this](const wire::PlannedStep&, std::uint32_t,
                            wire::ExcitationState state) { announced_.push_back(state); },
         .show = [this](const std::string& phase) { phases_.push_back(phase); },
         .wait = {.ask = [](const std::string&) {},
                  .look = [] {},
                  .hold = [] {},
                  .keep_alive = [this] { return keep_alive_(); }}});
  }
  // One step, from connecting to the end of the object.
  Expected<void> excite() {
    DYNCAL_TRY(auto excitation, open());
    DYNCAL_TRY(excitation->begin());
    auto excited = excitation->excite(measurement().steps()[0], 1, stop_.get_token());
    EXPECT_FALSE(instrument_.on && instrument_.failing_call != "set_output(false)");
    fault_may_pass_ = excitation->fault_may_pass();
    excitation->end();
    return excited;
  }
};

TEST_F(StepExcitationTest, HoldsTheOutputOnForSettlingDurationAndMargin) {
  double on_for_s = 0.0;
  clock_.every(1ms, [&] { on_for_s += instrument_.on ? 1e-3 : 0.0; });
  ASSERT_TRUE(excite());
  EXPECT_THAT(instrument_.settings, ElementsAre("40 Hz", "2.0 V", "on", "off"));
  EXPECT_THAT(announced_, ElementsAre(wire::EXCITATION_SETTLING, wire::EXCITATION_STEADY,
                                      wire::EXCITATION_DONE));
  EXPECT_NEAR(on_for_s, settling_s + duration_s + margin_s, 2e-3);
  EXPECT_NEAR(instrument_.now_s(), settling_s + duration_s + margin_s + off_s, 1e-6);
  EXPECT_FALSE(instrument_.on);
  EXPECT_FALSE(instrument_.connected);
}

TEST_F(StepExcitationTest, RefusesALevelAboveALimitBeforeItConnects) {
  bench_.generator.maximum_voltage_v = 1.5;
  const auto refused = excite();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::bad_argument);
  EXPECT_THAT(refused.error().message, HasSubstr("step 1, 40 Hz: "));
  EXPECT_TRUE(instrument_.settings.empty());
  EXPECT_FALSE(instrument_.connected);
}

TEST_F(StepExcitationTest, PassesOnThatThereIsNoGenerator) {
  const auto excitation =
      StepExcitation::open({participant_, clock_,
                            [](const GeneratorSettings&, const AskOperator&) {
                              return Expected<GeneratorConnection>(
                                  fail(ErrorCode::device, "nobody answers at 10.0.0.9:5025"));
                            }},
                           bench_, measurement(), std::make_shared<bus::WakeUp>(), {});
  ASSERT_FALSE(excitation);
  EXPECT_EQ(excitation.error().code, ErrorCode::device);
  EXPECT_EQ(excitation.error().message, "nobody answers at 10.0.0.9:5025");
}

struct FailingCall {
  const char* call;
  int from; // which of its calls is the first to fail
};

class StepExcitationFailure : public StepExcitationTest,
                              public testing::WithParamInterface<FailingCall> {};

INSTANTIATE_TEST_SUITE_P(
    EveryCall, StepExcitationFailure,
    testing::Values(FailingCall{"set_frequency", 1}, FailingCall{"set_amplitude_v", 1},
                    FailingCall{"set_output(true)", 1}, FailingCall{"set_output(false)", 1},
                    FailingCall{"wait_for_effect", 1}, FailingCall{"wait_for_effect", 2},
                    FailingCall{"clock_now_s", 1}, FailingCall{"clock_now_s", 2},
                    FailingCall{"clock_now_s", 3}, FailingCall{"clock_now_s", 4},
                    FailingCall{"wait_until_s", 1}, FailingCall{"wait_until_s", 2},
                    FailingCall{"wait_until_s", 4}, FailingCall{"wait_until_s", 5}));

TEST_P(StepExcitationFailure, LeavesTheOutputOffAndPassesTheErrorOn) {
  instrument_.failing_call = GetParam().call;
  instrument_.failing_from = GetParam().from;
  const auto excited = excite();
  ASSERT_FALSE(excited);
  EXPECT_EQ(excited.error().code, ErrorCode::device);
  EXPECT_THAT(excited.error().message, EndsWith(std::string(GetParam().call) + " was refused"));
  EXPECT_FALSE(instrument_.on);
  EXPECT_FALSE(instrument_.connected);
}

// A link that is down while the output is to be switched off, and comes back later.
TEST_F(StepExcitationTest, KnowsThatTheOutputMayBeOnUntilItIsConfirmedToBeOff) {
  instrument_.failing_call = "set_output(false)";
  const auto excitation = open().value();
  EXPECT_FALSE(excitation->output_may_be_on());
  ASSERT_TRUE(excitation->begin());
  stop_.request_stop(); // an interruption is not a failure, and must not hide this
  EXPECT_TRUE(excitation->excite(measurement().steps()[0], 1, stop_.get_token()));
  EXPECT_TRUE(instrument_.on);
  EXPECT_TRUE(excitation->output_may_be_on());
  EXPECT_FALSE(excitation->switch_off());
  EXPECT_TRUE(excitation->output_may_be_on());
  instrument_.failing_call = "";
  EXPECT_TRUE(excitation->switch_off().value());
  EXPECT_FALSE(instrument_.on);
  EXPECT_FALSE(excitation->output_may_be_on());
}

TEST_F(StepExcitationTest, KnowsThatTheOutputMayBeOnUntilTheOperatorHasConfirmedThatItIsOff) {
  bench_.generator.driver = GeneratorDriver::by_hand;
  const auto excitation = open().value();
  ASSERT_TRUE(excitation->begin());
  clock_.at(1s, [this] {
    instrument_.confirmed = false; // from now on what is asked for
    stop_.request_stop();
  });
  EXPECT_TRUE(excitation->excite(measurement().steps()[0], 1, stop_.get_token()));
  EXPECT_TRUE(excitation->output_may_be_on());
  EXPECT_FALSE(excitation->switch_off().value());
  EXPECT_TRUE(excitation->output_may_be_on());
  instrument_.confirmed = true;
  EXPECT_TRUE(excitation->switch_off().value());
  EXPECT_FALSE(excitation->output_may_be_on());
}

class StepExcitationStop : public StepExcitationTest,
                           public testing::WithParamInterface<std::chrono::milliseconds> {};

INSTANTIATE_TEST_SUITE_P(EveryPhase, StepExcitationStop,
                         testing::Values(1ms, 400ms, 600ms, 2500ms, 2899ms));

TEST_P(StepExcitationStop, IsNotAFailureAndLeavesTheOutputOff) {
  clock_.at(GetParam(), [this] { stop_.request_stop(); });
  EXPECT_TRUE(excite());
  EXPECT_FALSE(instrument_.on);
  EXPECT_EQ(instrument_.settings.back(), "off");
  EXPECT_EQ(announced_.back(), wire::EXCITATION_ABORTED);
  EXPECT_LE(clock_.elapsed(), GetParam() + 50ms);
}

TEST_P(StepExcitationStop, IsWhatALostAnalysisMakesAFailure) {
  keep_alive_ = [this]() -> Expected<void> {
    if (clock_.elapsed() > GetParam()) {
      return fail(ErrorCode::no_analysis, "the analysis service has gone silent");
    }
    return {};
  };
  const auto excited = excite();
  ASSERT_FALSE(excited);
  EXPECT_EQ(excited.error().code, ErrorCode::no_analysis);
  EXPECT_FALSE(instrument_.on);
  EXPECT_EQ(announced_.back(), wire::EXCITATION_ABORTED);
  EXPECT_LE(clock_.elapsed(), GetParam() + 1s); // it is asked every second of bench time
}

TEST_F(StepExcitationTest, WaitsForTheOperatorForeverAndKeepsTheRunAlive) {
  instrument_.confirmed = false;
  int looks = 0;
  keep_alive_ = [&]() -> Expected<void> {
    ++looks;
    return {};
  };
  clock_.at(600s, [this] { instrument_.confirmed = true; });
  ASSERT_TRUE(excite());
  EXPECT_GT(looks, 600);
  EXPECT_NEAR(instrument_.now_s(), 600 + settling_s + duration_s + margin_s + off_s, 0.2);
}

// The reference shows the level of whatever is set, through a response that the bench file does not
// know: `gain` m/s^2 a volt.
class LevelTest : public StepExcitationTest {
protected:
  static constexpr double rate_hz = 2000.0;
  double gain_ = 4.0;
  bool level_moves_ = false; // the exciter never comes to rest
  double hum_m_s2_ = 0.0;    // at the frequency, whether the output is on or not
  double hum_turns_ = 0.5;   // against the motion: it hides what there is
  double range_m_s2_ = 0.0;  // of the reference, as it states; 0: it states none and has none
  std::uint64_t block_ = 0;
  std::uint64_t sample_ = 0;
  bus::Writer<wire::SourceDescription> descriptions_ =
      sources_
          .writer<wire::SourceDescription>(bus::topics::source_description, bus::Profile::state,
                                           "b")
          .value();
  bus::Writer<wire::SampleBlock> blocks_ =
      sources_.writer<wire::SampleBlock>(bus::topics::acs_samples, bus::Profile::samples, "b")
          .value();

  LevelTest() { bench_.generator.level_tolerance_rel = 0.01; }

  void describe() {
    wire::SourceDescription description;
    description.bench("b");
    description.source("acs");
    description.session(1);
    description.kind(wire::SOURCE_ACS);
    description.channels().resize(1);
    description.channels()[0].name("reference");
    description.channels()[0].unit(R"(\metre\second\tothe{-2})");
    description.channels()[0].minimum(-range_m_s2_);
    description.channels()[0].maximum(range_m_s2_);
    descriptions_.write(description);
  }
  void send_block() {
    constexpr std::size_t samples = 100; // 50 ms
    wire::SampleBlock block;
    block.bench("b");
    block.source("acs");
    block.session(1);
    block.block(block_++);
    block.first_sample(sample_);
    block.sample_count(samples);
    block.channel_count(1);
    block.interval_numerator_ns(500'000);
    block.interval_denominator(1);
    for (std::size_t i = 0; i < samples; ++i, ++sample_) {
      const double t_s = static_cast<double>(sample_) / rate_hz;
      const double drift = level_moves_ ? 1.0 + 0.5 * t_s : 1.0;
      const double level = instrument_.on ? instrument_.amplitude_v * gain_ * drift : 0.0;
      const double value = level * std::sin(2.0 * std::numbers::pi * 40.0 * t_s) +
                           hum_m_s2_ * std::sin(2.0 * std::numbers::pi * (40.0 * t_s + hum_turns_));
      block.values().push_back(range_m_s2_ > 0.0 ? std::clamp(value, -range_m_s2_, range_m_s2_)
                                                 : value);
    }
    blocks_.write(block, 0s);
  }
  void play_reference() {
    describe();
    clock_.every(50ms, [this] { send_block(); });
  }
};

TEST_F(LevelTest, IsBroughtToTheWantedOneBeforeTheStepIsSteady) {
  play_reference();
  ASSERT_TRUE(excite());
  EXPECT_EQ(instrument_.settings[1], "1.0 V"); // half of what should do
  EXPECT_NEAR(instrument_.amplitude_v * gain_, 10.0, 0.1);
  EXPECT_THAT(phases_, testing::Contains("setting the level"));
  EXPECT_EQ(phases_.front(), "listening for hum");
  EXPECT_THAT(announced_, ElementsAre(wire::EXCITATION_SETTLING, wire::EXCITATION_STEADY,
                                      wire::EXCITATION_DONE));
}

TEST_F(LevelTest, NothingIsDrivenWhileTheReferenceIsNotHeard) {
  const auto excited = excite(); // no source sends
  ASSERT_FALSE(excited);
  EXPECT_EQ(excited.error().code, ErrorCode::device);
  EXPECT_THAT(excited.error().message,
              HasSubstr("step 1, 40 Hz: of acs/reference no whole window of samples came while "
                        "the output was off"));
  EXPECT_TRUE(fault_may_pass_);
  EXPECT_THAT(instrument_.settings, testing::Not(testing::Contains("on")));
  EXPECT_GT(instrument_.now_s(), listening_s({"40"}) + 9.0);
  EXPECT_LE(instrument_.now_s(), listening_s({"40"}) + 10.5);
}

// The reader finds its writer late on a busy network: hum that was not heard is not absent.
TEST_F(LevelTest, HumIsHeardHoweverLateTheSamplesCome) {
  hum_m_s2_ = 6.0;
  std::mt19937 random(17);
  const int late_ms = std::uniform_int_distribution(100, 9000)(random);
  clock_.at(std::chrono::milliseconds(late_ms), [this] { play_reference(); });
  const auto excited = excite();
  ASSERT_FALSE(excited) << late_ms << " ms late";
  EXPECT_THAT(excited.error().message, HasSubstr("shows 6 m/s^2 at this frequency"));
  EXPECT_THAT(instrument_.settings, testing::Not(testing::Contains("on")));
}

TEST_F(LevelTest, FailsWhenTheLevelNeverComesToRest) {
  level_moves_ = true;
  play_reference();
  const auto excited = excite();
  ASSERT_FALSE(excited);
  EXPECT_THAT(excited.error().message, HasSubstr("step 1, 40 Hz: "));
  EXPECT_FALSE(instrument_.on);
}

TEST_F(LevelTest, IsFoundWithASourceThatComesLate) {
  gain_ = 10.0; // half of the voltage is enough at once
  clock_.at(9s, [this] { play_reference(); });
  const auto excited = excite();
  ASSERT_TRUE(excited) << excited.error().message;
  EXPECT_THAT(instrument_.settings, ElementsAre("40 Hz", "1.0 V", "on", "off"));
}

TEST_F(LevelTest, SwitchesOffWhenTheReferenceShowsMoreThanTheHighestLevel) {
  gain_ = 40.0;
  bench_.generator.maximum_level_m_s2 = 20.0;
  play_reference();
  const auto excited = excite();
  ASSERT_FALSE(excited);
  EXPECT_EQ(excited.error().code, ErrorCode::device);
  EXPECT_FALSE(fault_may_pass_);
  EXPECT_FALSE(instrument_.on);
  EXPECT_LT(instrument_.now_s(), planned_settling_s(bench_, 40.0, 1));
}

TEST_F(LevelTest, IsNotTakenFromAReferenceThatEndsAtItsRange) {
  gain_ = 5.0;
  range_m_s2_ = 4.0; // half of the level is beyond it
  play_reference();
  const auto excited = excite();
  ASSERT_FALSE(excited);
  EXPECT_THAT(excited.error().message, HasSubstr("acs/reference is at an end of its range"));
  EXPECT_THAT(instrument_.settings, ElementsAre("40 Hz", "1.0 V", "on", "off"));
}

TEST_F(LevelTest, IsReachedWithinTheRangeOfTheReference) {
  gain_ = 5.0;
  range_m_s2_ = 10.5;
  play_reference();
  ASSERT_TRUE(excite());
  EXPECT_NEAR(instrument_.amplitude_v * gain_, 10.0, 0.1);
}

TEST_F(LevelTest, IsNotSetByAReferenceThatHumsAtTheFrequency) {
  hum_m_s2_ = 6.0;
  play_reference();
  const auto excited = excite();
  ASSERT_FALSE(excited);
  EXPECT_THAT(excited.error().message, HasSubstr("acs/reference shows 6 m/s^2 at this frequency "
                                                 "while the output is off, and 10 are planned"));
  EXPECT_TRUE(fault_may_pass_);
  EXPECT_THAT(instrument_.settings, testing::Not(testing::Contains("on")));
}

TEST_F(LevelTest, IsSetBesideHumThatIsSmall) {
  hum_m_s2_ = 0.5;
  play_reference();
  const auto excited = excite();
  ASSERT_TRUE(excited) << excited.error().message;
  EXPECT_NEAR(instrument_.amplitude_v * gain_, 10.5, 0.15);
}

TEST_F(LevelTest, HoldsNoSourceUpBetweenSteps) {
  auto excitation = open().value();
  EXPECT_EQ(blocks_.matched_readers(), 0);
  ASSERT_TRUE(excitation->begin());
  EXPECT_EQ(blocks_.matched_readers(), 1);
  excitation->end();
  EXPECT_EQ(blocks_.matched_readers(), 0);
}

class ShotsTest : public StepExcitationTest {
protected:
  static constexpr auto excited_for = 2900ms; // settling, duration and margin
  bus::Writer<wire::TriggeredRecord> traces_ = writer(bus::topics::dso_record);
  bus::Writer<wire::TriggeredRecord> series_ = writer(bus::topics::tss_record);
  std::uint64_t shot_ = 0;

  ShotsTest() {
    bench_.method.kind = EvaluationMethod::series_timestamping;
    bench_.method.dut = {{"tss", "acceleration_z"}};
    bench_.method.shots = 3;
  }
  bus::Writer<wire::TriggeredRecord> writer(const char* topic) {
    return sources_.writer<wire::TriggeredRecord>(topic, bus::Profile::samples, "b").value();
  }
  void shoot(const std::string& run, std::uint32_t step, bool both = true) {
    wire::TriggeredRecord record;
    record.bench("b");
    record.session(1);
    record.shot(++shot_);
    record.run(run);
    record.step(step);
    record.sample_count(1);
    record.source("dso");
    traces_.write(record);
    if (both) {
      record.source("tss");
      series_.write(record);
    }
  }
};

TEST_F(ShotsTest, EndTheStepAtOnceWhenAllAreThere) {
  clock_.at(600ms, [this] {
    for (int i = 0; i < 3; ++i) {
      shoot("r1", 1);
    }
  });
  ASSERT_TRUE(excite());
  EXPECT_LT(clock_.elapsed(), excited_for + 400ms);
}

TEST_F(ShotsTest, ExtendTheStepUntilTheLastIsThere) {
  clock_.every(10s, [this] { shoot("r1", 1); });
  ASSERT_TRUE(excite());
  EXPECT_GT(clock_.elapsed(), 30s);
  EXPECT_LT(clock_.elapsed(), 31s);
}

TEST_F(ShotsTest, CountOnlyPairsOfThisStepOfThisRun) {
  clock_.at(600ms, [this] {
    shoot("r1", 1);
    shoot("r1", 1);
    shoot("r1", 2);
    shoot("r0", 1);
    shoot("r1", 1, false);
  });
  clock_.at(20s, [this] { shoot("r1", 1); });
  ASSERT_TRUE(excite());
  EXPECT_GT(clock_.elapsed(), 20s);
  EXPECT_LT(clock_.elapsed(), 21s);
}

TEST_F(ShotsTest, EndTheStepAfterAMinuteWithThoseThereAre) {
  clock_.at(600ms, [this] { shoot("r1", 1); });
  ASSERT_TRUE(excite());
  EXPECT_GE(clock_.elapsed(), excited_for + 60s);
  EXPECT_LT(clock_.elapsed(), excited_for + 61s);
  EXPECT_EQ(announced_.back(), wire::EXCITATION_DONE);
}

TEST_F(ShotsTest, EndWhenAStopIsRequestedWhileSomeAreMissing) {
  clock_.at(20s, [this] { stop_.request_stop(); });
  ASSERT_TRUE(excite());
  EXPECT_LE(clock_.elapsed(), 20s + 50ms);
  EXPECT_EQ(announced_.back(), wire::EXCITATION_ABORTED);
}

TEST_F(ShotsTest, EndWithAFailureWhenTheAnalysisIsLostMeanwhile) {
  keep_alive_ = [this]() -> Expected<void> {
    if (clock_.elapsed() > 20s) {
      return fail(ErrorCode::no_analysis, "the analysis service has gone silent");
    }
    return {};
  };
  const auto excited = excite();
  ASSERT_FALSE(excited);
  EXPECT_EQ(excited.error().code, ErrorCode::no_analysis);
  EXPECT_FALSE(instrument_.on);
}

} // namespace
} // namespace dyncal::inline run
