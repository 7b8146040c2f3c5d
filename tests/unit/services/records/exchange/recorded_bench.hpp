// A small recording with everything that exports must not lose: gaps, two sessions, channels that
// change, NaN and -0.0, regular clocks and stamps with uncertainties and flags, records of shots, a
// block that came twice and one whose sizes contradict each other. One thread.
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/services/records/mcap/example_recording.hpp"

namespace dyncal::inline records {

inline wire::SourceDescription example_description(const std::string& source, std::uint64_t session,
                                                   const std::vector<std::string>& channels,
                                                   wire::TimeBase time_base) {
  wire::SourceDescription description;
  description.bench("b");
  description.source(source);
  description.session(session);
  description.device("a sensor");
  description.time_base(time_base);
  for (const std::string& name : channels) {
    wire::ChannelDescription channel;
    channel.name(name);
    channel.quantity("of " + name);
    channel.unit(name.starts_with("acc") ? "\\metre\\second\\tothe{-2}" : "\\volt");
    channel.minimum(-10.0);
    channel.maximum(10.0);
    channel.resolution(0.125);
    description.channels().push_back(channel);
  }
  return description;
}

struct ExampleBlock {
  std::string source = "dau";
  std::uint64_t session = 1;
  std::uint64_t number = 0;
  std::uint64_t first_sample = 0;
  std::uint32_t samples = 3;
  std::uint32_t channels = 2;
  bool stamped = true;
};

inline wire::SampleBlock example_block(const ExampleBlock& wanted) {
  wire::SampleBlock block;
  block.bench("b");
  block.source(wanted.source);
  block.session(wanted.session);
  block.block(wanted.number);
  block.first_sample(wanted.first_sample);
  block.sample_count(wanted.samples);
  block.channel_count(wanted.channels);
  block.acknowledged_run(wanted.number == 0 ? "R1" : "");
  block.received_utc_ns(example_utc_ns + static_cast<std::int64_t>(wanted.number));
  for (std::uint32_t i = 0; wanted.stamped && i < wanted.samples; ++i) {
    block.stamps_ns().push_back(example_utc_ns +
                                static_cast<std::int64_t>(wanted.first_sample + i) * 1'000'003);
    block.stamp_uncertainty_ns().push_back(40 + i);
    block.stamp_flags().push_back(i == 1 ? 16 : 0);
  }
  if (!wanted.stamped) {
    block.origin_ns(-5);
    block.interval_numerator_ns(1'000'000'000);
    block.interval_denominator(3);
  }
  for (std::uint32_t i = 0; i < wanted.samples * wanted.channels; ++i) {
    block.values().push_back(0.1 * static_cast<double>(wanted.first_sample + i) / 3.0);
  }
  block.values()[0] = -0.0;
  block.values()[1] = std::numeric_limits<double>::quiet_NaN();
  return block;
}

inline wire::TriggeredRecord example_record(std::uint64_t shot) {
  wire::TriggeredRecord record;
  record.bench("b");
  record.source("dso");
  record.session(9);
  record.shot(shot);
  record.run("R1");
  record.step(2);
  record.attempt(1);
  record.sample_count(4);
  record.channel_count(1);
  record.trigger_utc_ns(example_utc_ns);
  record.first_sample_s(-1.5e-6);
  record.interval_s(1e-7 / 3.0);
  record.values() = {1.0 / 3.0, 2.0, -0.0, static_cast<double>(shot)};
  record.received_utc_ns(example_utc_ns + 5);
  return record;
}

// 11 samples of dau in two sessions with 4 lost between them, 3 of dau_2, 6 of acs, 8 of dso.
inline void write_recorded_bench(const std::filesystem::path& path) {
  ExampleRecording recording(path);
  EXPECT_TRUE(recording.writer.add_metadata({"dyncal.recording", {{"bench", "b"}}}));
  EXPECT_TRUE(recording.writer.add_attachment({5, "recipe.toml", "application/toml", "x = 1\n"}));
  wire::Measurement plan;
  plan.bench("b");
  plan.run("R1");
  plan.sync_dso("dso/sync");
  recording.add("Measurement", plan);
  const auto dau = [](std::uint64_t session) {
    return example_description("dau", session, {"acceleration_x", "acceleration_y"},
                               wire::TIME_BASE_UTC);
  };
  recording.add("SourceDescription", dau(1));
  recording.add("SourceDescription",
                example_description("acs", 4, {"reference"}, wire::TIME_BASE_LOCAL));
  recording.add("DauSamples", example_block({.number = 0, .first_sample = 0}));
  recording.add("DauSamples", example_block({.number = 2, .first_sample = 10}));
  recording.add("AcsSamples",
                example_block({.source = "acs", .session = 4, .channels = 1, .stamped = false}));
  recording.add("DauSamples", example_block({.number = 1, .first_sample = 3})); // given again
  recording.add("DauSamples", example_block({.number = 1, .first_sample = 3}));
  auto contradicting = example_block({.number = 3, .first_sample = 13});
  contradicting.values().pop_back();
  recording.add("DauSamples", contradicting);
  wire::Excitation steady;
  steady.bench("b");
  steady.run("R1");
  steady.step(2);
  steady.frequency_text_hz("12.5");
  steady.window_begin_utc_ns(example_utc_ns);
  recording.add("Excitation", steady);
  recording.add("SourceDescription", dau(2));
  auto restarted = example_block({.session = 2, .samples = 2});
  restarted.received_utc_ns(example_utc_ns + 100);
  recording.add("DauSamples", restarted);
  recording.add("SourceDescription",
                example_description("dau", 3, {"acceleration_x", "sync", "temperature"},
                                    wire::TIME_BASE_UTC));
  auto wider = example_block({.session = 3, .channels = 3});
  wider.received_utc_ns(example_utc_ns + 200);
  recording.add("DauSamples", wider);
  recording.add("AcsSamples", example_block({.source = "acs",
                                             .session = 4,
                                             .number = 1,
                                             .first_sample = 3,
                                             .channels = 1,
                                             .stamped = false}));
  recording.add("DsoRecord", example_record(1));
  recording.add("DsoRecord", example_record(2));
  EXPECT_TRUE(recording.writer.add_metadata({"dyncal.losses", {{"dau.missing", "4"}}}));
  EXPECT_TRUE(recording.writer.close());
}

} // namespace dyncal::inline records
