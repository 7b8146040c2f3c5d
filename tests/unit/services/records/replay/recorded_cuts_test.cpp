// Recordings of a run that lack blocks of one source, or of both: begin or end, whole steps, blocks
// in the middle. The announced steps tell which step is which: none has ever a value of another
// one, and none is refused that is whole.
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <set>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/records/replay/recorded_run.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"
#include "tests/unit/services/records/mcap/example_recording.hpp"

namespace dyncal::inline records {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double block_s = 0.05;
constexpr double beside_step_s = 0.15; // the frames of the search
constexpr double equal = 1e-12;
constexpr double equal_with_hum_u = 0.01; // a bound of hum is of the whole record

// DYNCAL_SEED and DYNCAL_DRAWS give others, and more.
std::uint64_t number_of(const char* variable, std::uint64_t usual) {
  const char* text = std::getenv(variable);
  return text ? std::strtoull(text, nullptr, 10) : usual;
}

struct Cut {
  std::string source; // empty: nothing is cut; "acs dau": both
  double from_s = 0.0;
  double to_s = 0.0;

  [[nodiscard]] bool has(const std::string& of, double begin_s) const {
    return source.find(of) != std::string::npos && from_s <= begin_s && begin_s < to_s;
  }
  [[nodiscard]] std::string text() const {
    return fmt::format("'{}' lacks {:.2f} to {:.2f} s", source, from_s, to_s);
  }
};

using Results = std::map<std::uint32_t, StepResult>;

class RecordedCuts : public testing::Test {
protected:
  tests::SyntheticRun run_{
      .steps = {
          {"40", 10.0}, {"80", 10.0}, {"40", 10.0}, {"80", 10.0}, {"40", 10.0}, {"80", 10.0}}};
  std::vector<wire::SampleBlock> acs_ = run_.acs_blocks();
  std::vector<wire::SampleBlock> dau_ = run_.dau_blocks();
  const std::int64_t dau_epoch_ns_ = dau_.front().stamps_ns().front();

  void SetUp() override {
    for (auto* blocks : {&acs_, &dau_}) {
      blocks->front().acknowledged_run(run_.measurement().run().to_string());
    }
  }
  [[nodiscard]] double begin_s(std::size_t step) const {
    return run_.off_s + static_cast<double>(step) * (run_.on_s + run_.off_s);
  }
  [[nodiscard]] double end_s(std::size_t step) const { return begin_s(step) + run_.on_s; }

  void announce(ExampleRecording& recording, std::size_t step, wire::ExcitationState state) const {
    wire::Excitation excitation;
    excitation.bench(dau_.front().bench());
    excitation.run(run_.measurement().run());
    excitation.step(static_cast<std::uint32_t>(step + 1));
    excitation.state(state);
    recording.add("Excitation", excitation);
  }
  static void add_block(ExampleRecording& recording, const char* topic, wire::SampleBlock block) {
    block.received_utc_ns(example_utc_ns + std::int64_t{recording.sequence} * 1'000'000);
    recording.add(topic, block);
  }
  void record(ExampleRecording& recording, const Cut& cut) const {
    wire::PlannedSource planned;
    planned.source("dau");
    wire::Measurement measurement = run_.measurement();
    measurement.sources().push_back(planned);
    measurement.state(wire::MEASUREMENT_RUNNING);
    recording.add("Measurement", measurement);
    recording.add("SourceDescription", run_.acs_description());
    recording.add("SourceDescription", run_.dau_description());
    std::size_t settling = 0, done = 0;
    const std::uint32_t begin = recording.sequence;
    for (std::size_t i = 0; i < std::max(acs_.size(), dau_.size()); ++i) {
      // A message a millisecond: a block comes when its samples are there.
      recording.sequence =
          begin + static_cast<std::uint32_t>(1e3 * block_s) * static_cast<std::uint32_t>(i + 1);
      const double now_s = block_s * static_cast<double>(i);
      if (settling < run_.steps.size() && begin_s(settling) <= now_s) {
        announce(recording, settling++, wire::EXCITATION_SETTLING);
      }
      if (i < acs_.size() && !cut.has("acs", now_s)) {
        add_block(recording, "AcsSamples", acs_[i]);
      }
      if (i < dau_.size() && !cut.has("dau", now_s)) {
        add_block(recording, "DauSamples", dau_[i]);
      }
      if (done < run_.steps.size() && end_s(done) < now_s - block_s) {
        announce(recording, done++, wire::EXCITATION_DONE);
      }
    }
    while (done < run_.steps.size()) {
      announce(recording, done++, wire::EXCITATION_DONE);
    }
    measurement.state(wire::MEASUREMENT_DONE);
    recording.add("Measurement", measurement);
  }
  Results evaluated(const Cut& cut) const {
    const tests::TemporaryFolder folder;
    const auto path = folder.path() / "run.mcap";
    ExampleRecording recording(path);
    record(recording, cut);
    EXPECT_TRUE(recording.writer.close());
    auto reader = recording::RecordingReader::open(path);
    const RecordedRunOutcome recorded = evaluate_recording(*reader, {}, {}).value();
    Results results;
    for (const StepResult& one : recorded.outcome.results) {
      EXPECT_TRUE(results.emplace(one.step, one).second) << cut.text();
    }
    return results;
  }
  // A begin, an end, one or two steps with the pauses at their sides, or up to 1.5 s anywhere.
  Cut draw(std::mt19937_64& random) const {
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    const double whole_s = end_s(run_.steps.size() - 1) + run_.off_s;
    static const std::array<std::string, 3> sources{"acs", "dau", "acs dau"};
    Cut cut{sources[random() % 3]};
    const auto kind = random() % 4;
    if (kind == 0) {
      cut.to_s = uniform(0.0, 0.7) * whole_s;
    } else if (kind == 1) {
      const std::size_t first = random() % (run_.steps.size() - 1);
      cut.from_s = begin_s(first) - 0.2;
      cut.to_s = end_s(first + random() % 2) + 0.2;
    } else if (kind == 2) {
      cut.from_s = uniform(0.0, whole_s - 1.5);
      cut.to_s = cut.from_s + uniform(block_s, 1.5);
    } else {
      cut.from_s = uniform(0.3, 1.0) * whole_s;
      cut.to_s = whole_s;
    }
    return cut;
  }
  // All samples that a result rests on are of its step.
  void expect_of_its_step(const StepResult& one, const Cut& cut) const {
    const std::size_t step = one.step - 1;
    EXPECT_EQ(one.frequency_text_hz, run_.steps[step].frequency_hz) << cut.text();
    EXPECT_GE(one.samples.size(), 2U);
    for (const SourceSamples& of : one.samples) {
      const std::int64_t epoch_ns = of.source == "dau" ? dau_epoch_ns_ : 0;
      const double first_s = 1e-9 * static_cast<double>(of.first_stamp_ns - epoch_ns);
      const double last_s = 1e-9 * static_cast<double>(of.last_stamp_ns - epoch_ns);
      EXPECT_GT(first_s, begin_s(step) - 1e-3) << "step " << one.step << ": " << cut.text();
      EXPECT_LT(last_s, end_s(step) + 1e-3) << "step " << one.step << ": " << cut.text();
    }
    EXPECT_NEAR(one.magnitude, run_.magnitude, 5.0 * one.u_magnitude)
        << "step " << one.step << ": " << cut.text();
  }
  [[nodiscard]] bool is_touched(std::size_t step, const Cut& cut) const {
    return cut.from_s < end_s(step) + beside_step_s + block_s &&
           begin_s(step) - beside_step_s - block_s < cut.to_s;
  }
};

TEST_F(RecordedCuts, GiveNoStepTheValueOfAnother) {
  const Results whole = evaluated({});
  ASSERT_EQ(whole.size(), run_.steps.size());
  for (const auto& [number, one] : whole) {
    ASSERT_TRUE(one.valid) << one.problem;
    expect_of_its_step(one, {});
  }
  std::mt19937_64 random(number_of("DYNCAL_SEED", 31));
  const std::uint64_t draws = number_of("DYNCAL_DRAWS", 32);
  std::uint64_t untouched = 0, refused = 0, cut_steps = 0;
  for (std::uint64_t i = 0; i < draws; ++i) {
    const Cut cut = draw(random);
    const Results results = evaluated(cut);
    ASSERT_EQ(results.size(), run_.steps.size()) << cut.text();
    for (const auto& [number, one] : results) {
      const bool touched = is_touched(number - 1, cut);
      if (!one.valid) {
        EXPECT_TRUE(touched) << "step " << number << ": " << cut.text() << ": " << one.problem;
        EXPECT_FALSE(one.problem.empty());
        EXPECT_THAT(one.problem, Not(HasSubstr("sync signal connected")))
            << "step " << number << ": " << cut.text();
        ++refused;
        continue;
      }
      expect_of_its_step(one, cut);
      ++(touched ? cut_steps : untouched);
      const StepResult& before = whole.at(number);
      if (!touched) {
        EXPECT_NEAR(one.magnitude, before.magnitude,
                    std::max(equal, equal_with_hum_u * before.u_magnitude))
            << "step " << number << ": " << cut.text();
        EXPECT_NEAR(one.phase_rad, before.phase_rad,
                    std::max(equal, equal_with_hum_u * before.u_phase_rad))
            << "step " << number << ": " << cut.text();
      }
    }
  }
  EXPECT_GT(untouched, 2 * draws);
  EXPECT_GT(refused, draws / 4);
  EXPECT_GT(cut_steps, draws / 6);
}

} // namespace
} // namespace dyncal::inline records
