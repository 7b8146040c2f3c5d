// Shots that were recorded earlier, for `dyncal analyse`: one CSV file a shot and instrument
// (drivers/tss/README.md), named "step-2-shot-5.csv" by the step of the plan and the number of the
// shot, in the folder `path` of the oscilloscope's source and in that of the sensor's. The
// oscilloscope's files have its sample rate as nominal_rate_hz and the time of their first sample
// after the trigger as first_sample_s (negative before it).
//
// Fails (bad_file), naming folder or file: no path, not readable, malformed, a channel of the
// recipe missing, more than ShotRecord holds.
#pragma once

#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/contract/triggered_record.hpp"

namespace dyncal::inline records {

struct ShotFiles {
  drivers::SourceDescription description;
  std::vector<TriggeredRecord> records;
};

// Of the source `name`: the oscilloscope's, or the sensor's, by its role in [method].
[[nodiscard]] Expected<ShotFiles> read_shot_files(const BenchFile& bench, const std::string& name);

} // namespace dyncal::inline records
