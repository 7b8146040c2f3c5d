#include "services/run/level_meter.hpp"

#include <algorithm>
#include <cmath>

#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/record/channel_level.hpp"
#include "services/run/level_settling.hpp"

namespace dyncal::inline run {
namespace {

constexpr double max_drift = 1e-4; // of two clocks
constexpr double min_hum_hz = 4.0; // a second is enough to hear it
constexpr std::size_t max_samples = std::size_t{1} << 22U;

std::int64_t ns(double seconds) {
  return std::llround(seconds * 1e9);
}

std::map<std::string, analysis::Frequency>
listened_to(const std::vector<std::string>& frequencies_hz) {
  std::map<std::string, analysis::Frequency> frequencies;
  for (const std::string& text : frequencies_hz) {
    const analysis::Frequency frequency = *analysis::Frequency::parse(text); // the file was checked
    if (frequency.hz() >= min_hum_hz) {
      frequencies.emplace(text, frequency);
    }
  }
  return frequencies;
}

} // namespace

LevelMeter::LevelMeter(ChannelName reference, bus::Reader<wire::SourceDescription> descriptions,
                       bus::Reader<wire::SampleBlock> samples)
    : reference_(std::move(reference)), descriptions_(std::move(descriptions)),
      samples_(std::move(samples)), record_(reference_.source, max_samples) {}

Expected<LevelMeter> LevelMeter::create(bus::Participant& participant, const std::string& bench,
                                        ChannelName reference,
                                        const std::shared_ptr<bus::WakeUp>& wake_up) {
  DYNCAL_TRY(auto descriptions,
             participant.reader(bus::topics::source_description, bench, wake_up));
  DYNCAL_TRY(auto samples,
             participant.reader<wire::SampleBlock>(bus::topics::acs_samples,
                                                   bus::Profile::live_samples, bench, wake_up));
  return LevelMeter(std::move(reference), std::move(descriptions), std::move(samples));
}

void LevelMeter::take(double bench_time_s, double kept_s) {
  descriptions_.take([&](const wire::SourceDescription& description) {
    if (description.source() == reference_.source) {
      record_.describe(from_message(description));
    }
  });
  samples_.take([&](const wire::SampleBlock& block) {
    if (block.source() == reference_.source) {
      record_.add(view_block(block));
    }
  });
  if (record_.restarts() != restarts_) {
    restarts_ = record_.restarts();
    acs_minus_bench_ns_.reset();
  }
  if (record_.stamps_ns().empty()) {
    return;
  }
  const std::int64_t newest_ns = record_.stamps_ns().back();
  const std::int64_t difference_ns = newest_ns - ns(bench_time_s);
  if (acs_minus_bench_ns_) {
    *acs_minus_bench_ns_ -=
        ns(max_drift * (bench_time_s - taken_s_)); // a slow ACS clock must not make everybody wait
  }
  acs_minus_bench_ns_ = std::max(acs_minus_bench_ns_.value_or(difference_ns), difference_ns);
  taken_s_ = bench_time_s;
  record_.forget_before(newest_ns - ns(kept_s));
}

std::optional<TimeInterval> LevelMeter::window_after(double bench_time_s, double window_s) const {
  const auto stamps = record_.stamps_ns();
  if (stamps.empty() || !acs_minus_bench_ns_ || !record_.described()) {
    return std::nullopt;
  }
  const TimeInterval window{stamps.back() - ns(window_s), stamps.back()};
  const bool is_full =
      window.begin_ns >= ns(bench_time_s) + *acs_minus_bench_ns_ + ns(level_transport_s);
  return is_full && record_.lost_in(window).all() == 0 ? std::optional(window) : std::nullopt;
}

Expected<LevelReading> LevelMeter::level_after(double bench_time_s,
                                               const analysis::Frequency& frequency,
                                               double agreement_rel) const {
  const auto channel = record_.described() ? record_.channel(reference_.channel) : std::nullopt;
  const auto window = window_after(bench_time_s, level_window_s(frequency.hz()));
  if (!channel || !window) {
    return LevelReading{.lacking = "do its samples come, and is settling_s long enough?"};
  }
  return read_level(record_, *channel, *window, frequency, agreement_rel);
}

Expected<std::optional<std::map<std::string, double>>>
LevelMeter::line_levels_after(double bench_time_s, const std::vector<std::string>& frequencies_hz,
                              double period_s) const {
  const auto channel = record_.described() ? record_.channel(reference_.channel) : std::nullopt;
  const auto window = window_after(bench_time_s, period_s);
  if (!channel || !window) {
    return std::nullopt;
  }
  DYNCAL_TRY(check_range(record_, *channel, *window));
  std::map<std::string, double> levels;
  for (const std::string& text : frequencies_hz) {
    const analysis::Frequency frequency = *analysis::Frequency::parse(text); // the file was checked
    const auto level = level_in(record_, *channel, *window, frequency);
    if (!level) {
      return std::nullopt;
    }
    levels[text] = *level;
  }
  return levels;
}

std::optional<std::map<std::string, double>>
LevelMeter::quiet_levels_after(double bench_time_s,
                               const std::vector<std::string>& frequencies_hz) const {
  std::map<std::string, double> levels;
  const auto channel = record_.described() ? record_.channel(reference_.channel) : std::nullopt;
  for (const auto& [text, frequency] : listened_to(frequencies_hz)) {
    const auto window = window_after(bench_time_s, level_window_s(frequency.hz()));
    if (!channel || !window) {
      return std::nullopt;
    }
    levels[text] = level_in(record_, *channel, *window, frequency).value_or(0.0); // noise alone
  }
  return levels;
}

double listening_s(const std::vector<std::string>& frequencies_hz) {
  double window_s = 0.0;
  for (const auto& [text, frequency] : listened_to(frequencies_hz)) {
    window_s = std::max(window_s, level_window_s(frequency.hz()));
  }
  return window_s + level_transport_s + level_slack_s;
}

} // namespace dyncal::inline run
