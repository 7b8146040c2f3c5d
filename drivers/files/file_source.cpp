#include "drivers/files/file_source.hpp"

#include <algorithm>
#include <utility>

#include "drivers/files/adjusted_reader.hpp"
#include "drivers/files/file_formats.hpp"
#include "drivers/files/joined_reader.hpp"
#include "drivers/utc_clock.hpp"

namespace dyncal::drivers::files {
namespace {

constexpr std::size_t max_block = 4096; // samples
constexpr double paced_block_s = 0.05;

std::int64_t stamp_of(const SampleBlock& block, std::size_t i) {
  return block.clock ? block.clock->stamp_ns(block.first_sample + i) : block.stamps_ns[i];
}

} // namespace

Expected<SourceDescription> FileSource::describe() {
  DYNCAL_TRY(auto reader,
             settings_.single.empty() ? open_file(settings_) : JoinedReader::open(settings_));
  DYNCAL_TRY(reader_, AdjustedReader::open(std::move(reader), settings_));
  // Two samples tell the pace, and a file that is wrong from its first row on is refused before
  // anything is announced.
  DYNCAL_TRY(auto first, reader_->read(2));
  if (first.samples == 0) {
    return fail(ErrorCode::malformed,
                settings_.path.string() + ": no samples below the names of the columns");
  }
  first_ = std::move(first);
  return description();
}

SourceDescription FileSource::description() const {
  SourceDescription description = reader_->description();
  if (settings_.u_stamp_s > 0.0) {
    description.stamp_uncertainty_s = settings_.u_stamp_s;
  }
  return description;
}

std::size_t FileSource::block_samples() const {
  const auto interval_ns = first_.samples < 2 ? 0 : stamp_of(first_, 1) - stamp_of(first_, 0);
  if (settings_.speed <= 0.0 || interval_ns <= 0) {
    return max_block;
  }
  const double samples = paced_block_s * 1e9 * settings_.speed / static_cast<double>(interval_ns);
  return static_cast<std::size_t>(std::clamp(samples, 1.0, static_cast<double>(max_block)));
}

bool FileSource::wait_for_due_time(const SampleBlock& block,
                                   std::chrono::steady_clock::time_point started) const {
  if (settings_.speed <= 0.0) {
    return !stop_.raised();
  }
  const std::int64_t played_ns = stamp_of(block, block.samples - 1) - stamp_of(first_, 0);
  const auto due = started + std::chrono::nanoseconds(static_cast<std::int64_t>(
                                 static_cast<double>(played_ns) / settings_.speed));
  return !stop_.wait_for(std::max(due - std::chrono::steady_clock::now(),
                                  std::chrono::steady_clock::duration::zero()));
}

Expected<void> FileSource::run(SampleSink& sink) {
  const auto started = std::chrono::steady_clock::now();
  const std::size_t samples = block_samples();
  sink.begin_session();
  sink.describe(description());
  SampleCounts counts;
  std::optional<std::uint64_t> next_sample;
  SampleBlock block = first_;
  while (block.samples > 0 && wait_for_due_time(block, started)) {
    block.received_utc_ns = utc_now_ns();
    counts.add(block, next_sample);
    counts.stamps_not_trusted += static_cast<std::uint64_t>(std::count_if(
        block.flags.begin(), block.flags.end(), [](auto flags) { return flags != 0; }));
    sink.take(std::move(block));
    sink.count(counts);
    DYNCAL_TRY(block, reader_->read(samples));
  }
  return {};
}

} // namespace dyncal::drivers::files
