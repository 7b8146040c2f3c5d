// The folder of a real live run whose recording lacks a part of one source, through `dyncal
// analyse`: steps that are whole have the values of the whole recording, those that are cut or gone
// none of another step, and the reason that is given is the true one.
#include <cmath>
#include <limits>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/contract/source_block.hpp"
#include "services/records/capture/recorded_topics.hpp"
#include "services/records/mcap/recording_reader.hpp"
#include "services/records/mcap/recording_writer.hpp"
#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
namespace recording = dyncal::recording;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr double same_u = 0.01;   // a bound of hum is of the whole record
constexpr double beside_s = 0.25; // a step that a cut comes so near is touched
constexpr std::size_t steps = 6;  // two frequencies, three times
constexpr double to_s = 1e-9;
// Settling counts from the begin of what is left; the next step's samples are 1 s away.
constexpr std::int64_t beside_step_ns = 500'000'000;

struct Interval {
  std::int64_t begin_ns;
  std::int64_t end_ns;
};

class CutRecording : public testing::Test {
protected:
  void SetUp() override {
    const auto folder = fresh_folder("cut-recording");
    LiveBenchSettings settings;
    settings.bench_arguments = {"--speed", "4", "--seed", "12", "--frequencies", "40,80"};
    settings.excitation = "frequencies_hz = [\"40\", \"80\"]\nlevel = 20.0\nrepetitions = 3\n"
                          "settling_s = 0.3\nduration_s = 0.8\n";
    LiveBench bench(folder, settings);
    ProgramRun& run =
        bench.start({"run", bench.bench_file(), "--folder", folder / "runs", "--store", "none"});
    ASSERT_EQ(run.wait(patience), 0) << run.errors();
    whole_ = fs::directory_iterator(folder / "runs" / "live")->path();
    for (const json& point : analysed(whole_)) {
      ASSERT_TRUE(point["valid"].get<bool>()) << point["problem"];
      for (const json& samples : point["source_samples"]) {
        where_[samples["source"]][point["step"]] = {samples["first_stamp_ns"],
                                                    samples["last_stamp_ns"]};
      }
    }
    ASSERT_EQ(where_["acs"].size(), steps);
  }
  static json analysed(const fs::path& folder) {
    const auto place = folder.parent_path();
    const auto file = place / (folder.filename().string() + ".json");
    ProgramRun analyse("dyncal", {"analyse", folder, "--output", file}, place);
    EXPECT_TRUE(analyse.wait(patience)) << analyse.errors();
    return read_json(file)["points"];
  }
  // What `dyncal analyse` gives without the blocks of a source that lie in `cut`.
  json without(const std::string& source, const Interval& cut) {
    const auto folder = fresh_folder("cut-recording-" + source);
    std::size_t left_out = 0;
    auto reader = recording::RecordingReader::open(whole_ / "recording.mcap");
    auto writer = recording::RecordingWriter::create(
        folder / "recording.mcap", {"dyncal test", recording::recorded_schemas(),
                                    recording::recorded_channels(), recording::Compression::none});
    const auto copy = [&](const recording::MessageInFile& one) {
      const std::string& topic = one.channel.topic;
      if (topic == (source == "acs" ? "AcsSamples" : "DauSamples")) {
        const auto block = recording::decode<wire::SampleBlock>(one.message.data);
        const auto view = contract::view_block(*block);
        if (view.samples > 0 && cut.begin_ns <= view.first_stamp_ns() &&
            view.first_stamp_ns() < cut.end_ns) {
          ++left_out;
          return;
        }
      }
      recording::Message message = one.message;
      message.channel_id = recording::channel_of(topic).id;
      recording::Chunk chunk;
      chunk.add(recording::channel_of(topic), message);
      EXPECT_TRUE(writer->add_chunk(chunk));
    };
    EXPECT_TRUE(reader->scan({.message = copy}));
    EXPECT_TRUE(writer->close());
    EXPECT_GT(left_out, 0U);
    return analysed(folder);
  }
  [[nodiscard]] Interval excited(const std::string& source, std::size_t step) {
    return where_[source][step];
  }
  // Steps whose samples end before the cut, or begin behind it, are whole.
  void expect_values_of_their_steps(const std::string& source, const Interval& cut,
                                    const std::string& cause) {
    SCOPED_TRACE(cause);
    const json points = without(source, cut);
    const json whole = analysed(whole_);
    ASSERT_EQ(points.size(), whole.size());
    std::size_t refused = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const json& one = points[i];
      SCOPED_TRACE(
          fmt::format("step {}, {}", one["step"].get<int>(), one["channel"].get<std::string>()));
      const Interval step = excited(source, one["step"]);
      const bool touched = to_s * static_cast<double>(cut.begin_ns - step.end_ns) < beside_s &&
                           to_s * static_cast<double>(step.begin_ns - cut.end_ns) < beside_s + 0.3;
      if (!one["valid"].get<bool>()) {
        ++refused;
        EXPECT_TRUE(touched) << one["problem"];
        EXPECT_THAT(one["problem"], Not(HasSubstr("sync signal connected")));
        EXPECT_THAT(one["problem"], HasSubstr(cause));
        continue;
      }
      for (const json& samples : one["source_samples"]) {
        const Interval own = excited(samples["source"], one["step"]);
        EXPECT_GT(samples["first_stamp_ns"].get<std::int64_t>(), own.begin_ns - beside_step_ns);
        EXPECT_LT(samples["last_stamp_ns"].get<std::int64_t>(), own.end_ns + beside_step_ns);
      }
      if (!touched) {
        for (const char* quantity : {"magnitude", "phase_rad"}) {
          EXPECT_NEAR(one[quantity].get<double>(), whole[i][quantity].get<double>(),
                      same_u * whole[i][std::string("u_") + quantity].get<double>())
              << quantity;
        }
      }
    }
    EXPECT_GE(refused, 3U); // a step of three axes
    EXPECT_LE(refused, 3U * (steps - 2));
  }

  fs::path whole_;
  std::map<std::string, std::map<std::size_t, Interval>> where_; // used samples
};

// One run for all of them.
TEST_F(CutRecording, HasTheValuesOfWholeStepsAndOfNoOther) {
  const Interval third = excited("acs", 3);
  expect_values_of_their_steps("acs", {0, (third.begin_ns + third.end_ns) / 2},
                               "the record of source 'acs' begins after it");
  expect_values_of_their_steps(
      "dau", {excited("dau", 4).end_ns + 300'000'000, std::numeric_limits<std::int64_t>::max()},
      "the record of source 'dau' ends before it");
  expect_values_of_their_steps(
      "acs", {excited("acs", 2).begin_ns - 500'000'000, excited("acs", 2).end_ns + 200'000'000},
      "source 'acs' lost");
}

} // namespace
} // namespace dyncal::tests
