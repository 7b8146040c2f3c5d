#include "services/evaluation/record/step_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct TrueStep { // in true time
  double begin_s;
  double end_s;
  double frequency_hz;
  double level_m_s2 = 10.0;
  double sync_v = 1.0;
  double phase_rad = 0.0; // of sync at true time 0
};

struct Clock {
  double offset_s = 0.0;
  double rate_rel = 0.0;
  [[nodiscard]] std::int64_t at(double true_s) const {
    return std::llround(1e9 * (offset_s + (1.0 + rate_rel) * true_s));
  }
};

constexpr Clock acs_clock{5.0, 3e-6};
constexpr Clock dau_clock{1.7e9, -2e-5};

// What a search makes of a step: frames on a grid of the record's own clock.
FoundExcitation found(const TrueStep& step, const Clock& clock, bool has_level) {
  const double frame_s = std::max(1.0 / step.frequency_hz, std::min(0.1, 50.0 / step.frequency_hz));
  FoundExcitation one{.frame_ns = std::llround(1e9 * frame_s)};
  const auto frames = [&](double true_s, std::int64_t more) {
    return (clock.at(true_s) / one.frame_ns + more) * one.frame_ns;
  };
  one.window.excited_begin_ns = frames(step.begin_s, 0);
  one.window.off_ns = frames(step.end_s, 1);
  one.window.begin_ns = frames(step.begin_s, 1);
  one.window.end_ns = frames(step.end_s, 0);
  one.window.amplitude = step.sync_v;
  one.window.frequency_hz = step.frequency_hz / (1.0 + clock.rate_rel);
  one.window.u_frequency_rel = 1e-6;
  const double middle_s = 0.5 * (step.begin_s + step.end_s);
  one.window.middle_ns = clock.at(middle_s);
  one.window.phase_rad =
      std::remainder(step.phase_rad + 2.0 * std::numbers::pi * step.frequency_hz * middle_s,
                     2.0 * std::numbers::pi);
  one.window.u_phase_rad = 1e-3;
  if (has_level) {
    one.level_m_s2 = step.level_m_s2;
  }
  return one;
}

class StepAlignment : public testing::Test {
protected:
  // Steps of 1.5 s, 0.5 s apart, with phases that nobody chose.
  void plan(const std::vector<double>& frequencies_hz, const std::vector<double>& levels = {}) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    for (std::size_t i = 0; i < frequencies_hz.size(); ++i) {
      RecipeStep step{.frequency_text_hz = std::to_string(static_cast<int>(frequencies_hz[i])),
                      .frequency = analysis::Frequency::from_hz(frequencies_hz[i])};
      step.step = static_cast<std::uint32_t>(i + 1);
      step.repetition = 1;
      step.level_m_s2 = levels.empty() ? 10.0 : levels[i];
      step.settling_s = 0.3;
      step.duration_s = 1.0;
      steps_.push_back(step);
      const double begin_s = 1.0 + 2.0 * static_cast<double>(i);
      run_.push_back(
          {begin_s, begin_s + 1.5, frequencies_hz[i], step.level_m_s2, 1.0, phase(random)});
    }
    end_s_ = 2.0 * static_cast<double>(frequencies_hz.size()) + 1.0;
  }

  [[nodiscard]] RecordedExcitations record(const char* source, const Clock& clock,
                                           const std::vector<std::size_t>& lacks) const {
    RecordedExcitations record{.channel = std::string(source) + "/sync", .source = source};
    record.recorded = {clock.at(0.0), clock.at(end_s_)};
    for (std::size_t i = 0; i < run_.size(); ++i) {
      if (std::find(lacks.begin(), lacks.end(), i) == lacks.end()) {
        record.found.push_back(found(run_[i], clock, clock.offset_s == acs_clock.offset_s));
        continue;
      }
      const TimeInterval hole{clock.at(run_[i].begin_s - 0.2), clock.at(run_[i].end_s + 0.2)};
      if (record.found.empty()) {
        record.recorded.begin_ns = hole.end_ns;
      }
      record.holes.push_back(hole);
    }
    if (!lacks.empty() && lacks.back() + 1 == run_.size()) {
      for (std::size_t i = run_.size(); i-- > 0 && std::count(lacks.begin(), lacks.end(), i) > 0;) {
        record.recorded.end_ns = clock.at(run_[i].begin_s - 0.2);
      }
    }
    record.length_s = 1e-9 * static_cast<double>(record.recorded.end_ns - record.recorded.begin_ns);
    return record;
  }

  void align(const std::vector<std::size_t>& acs_lacks, const std::vector<std::size_t>& dau_lacks) {
    align({record("acs", acs_clock, acs_lacks), record("dau", dau_clock, dau_lacks)});
  }
  void align(const std::vector<RecordedExcitations>& records) {
    std::vector<const RecipeStep*> plan;
    for (const RecipeStep& step : steps_) {
      plan.push_back(&step);
    }
    schedule_ = align_steps(plan, records);
  }

  // By step of the plan, the step of the run (from 0) that a record has for it; -1: none.
  [[nodiscard]] std::vector<int> places(std::size_t record, const Clock& clock) const {
    std::vector<int> places;
    for (const auto& step : schedule_.records.at(record)) {
      places.push_back(-1);
      for (std::size_t i = 0; step && i < run_.size(); ++i) {
        const std::int64_t middle_ns = clock.at(0.5 * (run_[i].begin_s + run_[i].end_s));
        if (step->excited.begin_ns < middle_ns && middle_ns < step->excited.end_ns) {
          places.back() = static_cast<int>(i);
        }
      }
    }
    return places;
  }
  [[nodiscard]] std::vector<int> of_acs() const { return places(0, acs_clock); }
  [[nodiscard]] std::vector<int> of_dau() const { return places(1, dau_clock); }

  std::vector<RecipeStep> steps_;
  std::vector<TrueStep> run_;
  double end_s_ = 0.0;
  RunSchedule schedule_;
};

TEST_F(StepAlignment, WholeRecordsAreInTheOrderOfThePlan) {
  plan({80.0, 80.0, 80.0});
  align({}, {});
  EXPECT_THAT(of_acs(), ElementsAre(0, 1, 2));
  EXPECT_THAT(of_dau(), ElementsAre(0, 1, 2));
  EXPECT_THAT(schedule_.problems, Each(IsEmpty()));
  EXPECT_THAT(schedule_.uncertain, Each(false));
}

TEST_F(StepAlignment, FrequenciesTellWhichStepsARecordHas) {
  plan({40.0, 63.0, 125.0, 40.0, 63.0, 125.0});
  align({1}, {0, 4});
  EXPECT_THAT(of_acs(), ElementsAre(0, -1, 2, 3, 4, 5));
  EXPECT_THAT(of_dau(), ElementsAre(-1, 1, 2, 3, -1, 5));
  EXPECT_EQ(schedule_.problems[0],
            "no steady sine of 40 Hz was found in dau/sync, where acs/sync shows one: the record "
            "of 'dau' begins after it");
  EXPECT_EQ(schedule_.problems[1],
            "no steady sine of 63 Hz was found in acs/sync, where dau/sync shows one: the record "
            "of 'acs' has no samples there");
  EXPECT_THAT(schedule_.problems[2], IsEmpty());
}

TEST_F(StepAlignment, PhasesTellWhichRepetitionsARecordHas) {
  plan({40.0, 63.0, 40.0, 63.0, 40.0, 63.0});
  align({}, {0, 1});
  EXPECT_THAT(of_acs(), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(of_dau(), ElementsAre(-1, -1, 2, 3, 4, 5));
}

TEST_F(StepAlignment, PhasesTellEqualStepsApart) {
  plan({80.0, 80.0, 80.0, 80.0, 80.0});
  align({}, {0});
  EXPECT_THAT(of_dau(), ElementsAre(-1, 1, 2, 3, 4));
  align({4}, {0});
  EXPECT_THAT(of_acs(), ElementsAre(0, 1, 2, 3, -1));
  EXPECT_THAT(of_dau(), ElementsAre(-1, 1, 2, 3, 4));
  EXPECT_THAT(schedule_.problems[4], HasSubstr("the record of 'acs' ends before it"));
  EXPECT_THAT(schedule_.uncertain, Each(false));
}

// A generator that is never switched off in phase, and steps that a program has timed: any of them
// might be any other one.
TEST_F(StepAlignment, EqualStepsInEqualPhaseAreRefusedWhereOneRecordLacksSome) {
  plan({80.0, 80.0, 80.0, 80.0});
  for (TrueStep& step : run_) {
    step.phase_rad = 0.0;
  }
  align({}, {3});
  EXPECT_THAT(of_acs(), Each(-1));
  EXPECT_THAT(of_dau(), Each(-1));
  EXPECT_THAT(schedule_.problems,
              Each(HasSubstr("acs/sync shows 4 steps and dau/sync shows 3, and nothing tells")));
}

TEST_F(StepAlignment, UnequalTimesBetweenThemTellEqualStepsApart) {
  plan({80.0, 80.0, 80.0, 80.0});
  double later_s = 0.0;
  for (TrueStep& step : run_) {
    step.phase_rad = 0.0;
    step.begin_s += later_s;
    step.end_s += later_s;
    later_s = 1.5 * later_s + 0.5;
  }
  end_s_ += later_s;
  align({}, {0});
  EXPECT_THAT(of_dau(), ElementsAre(-1, 1, 2, 3));
  EXPECT_THAT(of_acs(), ElementsAre(0, 1, 2, 3));
}

TEST_F(StepAlignment, LevelsOfSyncTellStepsOfOneFrequencyApart) {
  plan({80.0, 80.0, 80.0, 80.0}, {2.0, 5.0, 10.0, 20.0});
  for (TrueStep& step : run_) {
    step.phase_rad = 0.0;
    step.sync_v = step.level_m_s2;
  }
  align({}, {0});
  EXPECT_THAT(of_dau(), ElementsAre(-1, 1, 2, 3));
}

TEST_F(StepAlignment, LevelsOfTheReferenceTellWhichStepsOfThePlanAreThere) {
  plan({80.0, 80.0, 80.0, 80.0}, {2.0, 5.0, 10.0, 20.0});
  align({0}, {0});
  EXPECT_THAT(of_acs(), ElementsAre(-1, 1, 2, 3));
  EXPECT_THAT(of_dau(), ElementsAre(-1, 1, 2, 3));
  EXPECT_THAT(schedule_.problems[0],
              HasSubstr("nor in dau/sync: the first that was there is step 2"));
  align({2}, {2});
  EXPECT_THAT(of_acs(), ElementsAre(0, 1, -1, 3));
}

TEST_F(StepAlignment, TimesTellWhichOfEqualStepsBothRecordsLack) {
  plan({80.0, 80.0, 80.0, 80.0, 80.0});
  align({2}, {2});
  EXPECT_THAT(of_acs(), ElementsAre(0, 1, -1, 3, 4));
  EXPECT_THAT(of_dau(), ElementsAre(0, 1, -1, 3, 4));
  EXPECT_THAT(schedule_.problems[2], HasSubstr("none was there between step 2"));
  EXPECT_THAT(schedule_.uncertain, Each(false));
}

TEST_F(StepAlignment, ARunThatWasBrokenOffHasItsFirstSteps) {
  plan({80.0, 80.0, 80.0, 80.0, 80.0});
  for (TrueStep& step : run_) {
    step.phase_rad = 0.0;
  }
  align({3, 4}, {3, 4});
  EXPECT_THAT(of_acs(), ElementsAre(0, 1, 2, -1, -1));
  EXPECT_THAT(of_dau(), ElementsAre(0, 1, 2, -1, -1));
  EXPECT_THAT(schedule_.problems[3], HasSubstr("the last that was there is step 3"));
  EXPECT_THAT(schedule_.uncertain, ElementsAre(true, true, true, false, false));
}

// Their frequencies are the same, and so are the times between them; their phases are not.
TEST_F(StepAlignment, ARecordThatEndsBeforeTheOtherBeginsHasNoStepOfIt) {
  plan({40.0, 50.2, 125.0, 40.0, 50.2, 125.0});
  align({3, 4, 5}, {0, 1, 2});
  EXPECT_THAT(of_acs(), Each(-1));
  EXPECT_THAT(of_dau(), Each(-1));
  EXPECT_THAT(schedule_.problems, Each(HasSubstr("nothing tells")));
}

TEST_F(StepAlignment, ASweepOfTwoThatWasBrokenOffHasItsSteps) {
  plan({40.0, 50.2, 125.0, 40.0, 50.2, 125.0});
  align({3, 4, 5}, {3, 4, 5});
  EXPECT_THAT(of_acs(), ElementsAre(0, 1, 2, -1, -1, -1));
  EXPECT_THAT(of_dau(), ElementsAre(0, 1, 2, -1, -1, -1));
}

TEST_F(StepAlignment, AnExcitationThatOneRecordHasBeyondThePlanShiftsNothing) {
  plan({80.0, 80.0, 80.0, 80.0, 80.0});
  steps_.pop_back(); // the first that was excited was a trial
  align({}, {0});
  EXPECT_THAT(of_acs(), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(of_dau(), ElementsAre(1, 2, 3, 4));
}

// One clock is set back in mid-run: instants tell nothing, and frequencies all.
TEST_F(StepAlignment, AClockThatIsSetBackCostsNoStepWhoseFrequencyTells) {
  plan({40.0, 63.0, 125.0, 40.0, 63.0, 125.0});
  auto dau = record("dau", dau_clock, {2});
  for (std::size_t i = 3; i < dau.found.size(); ++i) {
    auto& window = dau.found[i].window;
    for (std::int64_t* instant : {&window.excited_begin_ns, &window.off_ns, &window.begin_ns,
                                  &window.end_ns, &window.middle_ns}) {
      *instant += 700'000'000'000;
    }
  }
  align({record("acs", acs_clock, {}), dau});
  EXPECT_THAT(of_acs(), ElementsAre(0, 1, 2, 3, 4, 5));
  std::vector<bool> has;
  for (const auto& step : schedule_.records[1]) {
    has.push_back(step.has_value());
  }
  EXPECT_THAT(has, ElementsAre(true, true, false, true, true, true));
}

// The offset between the clocks is free: any of one record could be any of the other one.
TEST_F(StepAlignment, OneOfSeveralEqualStepsIsRefusedWhereTheRecordsMayShowAnother) {
  plan({80.0, 80.0, 80.0, 80.0});
  align({1, 2, 3}, {0, 1, 2});
  EXPECT_THAT(of_acs(), Each(-1));
  EXPECT_THAT(of_dau(), Each(-1));
  EXPECT_THAT(schedule_.problems, Each(HasSubstr("nothing tells")));
  align({}, {0, 1, 2});
  EXPECT_THAT(of_dau(), Each(-1));
}

// A record that begins or ends within a pause may have the first repetition or the second one.
TEST_F(StepAlignment, WhichRepetitionIsMissingIsNotMadeUp) {
  plan({31.5, 80.0, 125.0, 31.5, 80.0, 125.0});
  align({record("acs", acs_clock, {0, 1, 2, 3})});
  EXPECT_EQ(std::count(schedule_.uncertain.begin(), schedule_.uncertain.end(), true), 2);
  align({record("acs", acs_clock, {0, 1})}); // 125 Hz comes first: the others are of the second
  EXPECT_THAT(of_acs(), ElementsAre(-1, -1, 2, 3, 4, 5));
  EXPECT_THAT(schedule_.uncertain, Each(false));
}

TEST_F(StepAlignment, OneRecordAloneFindsItsPlaceByFrequencyAndLevel) {
  plan({80.0, 80.0, 125.0, 80.0}, {2.0, 5.0, 10.0, 20.0});
  align({record("acs", acs_clock, {0})});
  EXPECT_THAT(of_acs(), ElementsAre(-1, 1, 2, 3));
  EXPECT_THAT(schedule_.problems[0], Not(HasSubstr("nor in")));
}

TEST_F(StepAlignment, ARecordWithoutAnyStepHasNone) {
  plan({40.0, 63.0});
  align({}, {0, 1});
  EXPECT_THAT(of_acs(), ElementsAre(0, 1));
  EXPECT_THAT(of_dau(), Each(-1));
  EXPECT_THAT(schedule_.problems, Each(HasSubstr("'dau' shows no step that both have")));
  RecordedExcitations whole = record("dau", dau_clock, {0, 1});
  whole.length_s = end_s_; // as long as the other record, so that it lacks no samples
  align({record("acs", acs_clock, {}), whole});
  EXPECT_THAT(schedule_.problems, Each(HasSubstr("is the sync signal connected?")));
  align({0, 1}, {0, 1});
  EXPECT_THAT(schedule_.problems, Each(IsEmpty())) << "other causes are likelier";
}

// One record ends within a step of which the other one lacks the begin: no end of it is in both.
TEST_F(StepAlignment, AStepOfWhichEachRecordHasAnotherEndShiftsNothing) {
  plan({40, 50, 125, 40, 50, 125});
  std::size_t joined = 0;
  for (std::size_t step = 1; step < run_.size(); ++step) {
    for (const auto& [ends_s, begins_s] :
         {std::pair(1.2, 0.4), std::pair(0.5, 0.5), std::pair(0.4, 1.1)}) {
      auto acs = record("acs", acs_clock, {});
      acs.found.resize(step + 1);
      acs.found.back().window.off_ns = acs_clock.at(run_[step].begin_s + ends_s);
      acs.found.back().end_is_cut = true;
      acs.recorded.end_ns = acs.found.back().end_ns();
      acs.length_s = 1e-9 * static_cast<double>(acs.recorded.end_ns - acs.recorded.begin_ns);
      auto dau = record("dau", dau_clock, {});
      FoundExcitation& rest = dau.found[step];
      rest.window.excited_begin_ns = dau_clock.at(run_[step].begin_s + begins_s);
      rest.begin_is_cut = true;
      dau.holes.push_back({dau_clock.at(run_[step].begin_s - 0.2), rest.begin_ns()});
      align({acs, dau});
      for (std::size_t i = 0; i < run_.size(); ++i) {
        const bool is_shown = schedule_.records[0][i] && schedule_.records[1][i];
        joined += is_shown ? 1 : 0;
        if (is_shown && i != step) {
          EXPECT_EQ(of_acs()[i], static_cast<int>(i)) << step << ", " << ends_s;
          EXPECT_EQ(of_dau()[i], static_cast<int>(i)) << step << ", " << ends_s;
        }
      }
    }
  }
  EXPECT_GE(joined, 30U); // of 75 that both records show
}

// Any whole steps from either record: what both have is joined with itself, or with nothing.
TEST_F(StepAlignment, NoStepIsEverJoinedWithAnother) {
  std::mt19937 random(11);
  std::size_t joined = 0, there = 0;
  for (int draw = 0; draw < 300; ++draw) {
    steps_.clear();
    run_.clear();
    plan(draw % 2 == 0
             ? std::vector<double>{31.0, 80.0, 125.0, 31.0, 80.0, 125.0, 31.0, 80.0, 125.0}
             : std::vector<double>(7, 80.0));
    for (TrueStep& step : run_) {
      step.phase_rad = std::uniform_real_distribution<double>(0.0, 6.28)(random);
    }
    std::vector<std::size_t> lacks[2];
    for (auto& of_record : lacks) {
      for (std::size_t i = 0; i < run_.size(); ++i) {
        if (std::uniform_int_distribution<int>(0, 5)(random) == 0) {
          of_record.push_back(i);
        }
      }
    }
    align(lacks[0], lacks[1]);
    const auto acs = of_acs();
    const auto dau = of_dau();
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (acs[i] >= 0 && dau[i] >= 0) {
        EXPECT_EQ(acs[i], dau[i]) << "draw " << draw << ", step " << i;
        ++joined;
      }
      there += static_cast<std::size_t>(std::count(lacks[0].begin(), lacks[0].end(), i) == 0 &&
                                        std::count(lacks[1].begin(), lacks[1].end(), i) == 0);
    }
  }
  EXPECT_GT(joined, there * 95 / 100);
}

} // namespace
} // namespace dyncal::inline evaluation
