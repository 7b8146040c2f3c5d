#include "services/views/signals/settled_samples.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/base/phasor.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::inline views {
namespace {

constexpr double block_s = 0.05;
constexpr double samples_of_block = 12.0; // a sine has three parameters, and noise is wanted
constexpr double noisy_rel = 0.02;        // a block whose amplitude is known worse is too short
constexpr int longer = 4;                 // times, for such blocks, twice at the most
constexpr int most_times_longer = 16;
constexpr std::size_t least_blocks = 4;
constexpr double least_s = 0.2;
constexpr double amplitude_break_rel = 0.03;
constexpr double phase_break_rad = 0.03;
constexpr double frequency_off_rel = 2e-3;
constexpr double trend_rel = 2e-3;
// A block is lost by noise in 1e-6 of looks.
constexpr double coverage = 5.0;
// The announcement may be heard so much later than the first samples come; pauses are longer.
constexpr std::int64_t announced_late_ns = 250'000'000;
// So much before it is looked at, or a block of one period that reaches there.
constexpr std::int64_t looked_back_ns = 2'000'000'000;
constexpr std::size_t max_samples = std::size_t{1} << 16U;

struct Block {
  std::size_t first = 0; // sample
  std::int64_t begin_ns = 0;
  double amplitude = 0.0;
  double phase_rad = 0.0; // about the newest sample, of the planned frequency
  double u_amplitude = 0.0;
};

// Blocks from the newest sample backwards.
class Blocks {
public:
  Blocks(std::span<const Sample> samples, const analysis::Frequency& frequency)
      : frequency_(frequency), end_(samples.size()) {
    for (const Sample& sample : samples) {
      stamps_ns_.push_back(sample.stamp_ns);
      values_.push_back(sample.value);
    }
    const auto count = static_cast<std::int64_t>(samples.size());
    slack_ns_ = 3 * (stamps_ns_.back() - stamps_ns_.front()) / (2 * (count - 1));
  }

  // At the newest sample again.
  void begin(double periods) {
    length_ns_ = std::llround(1e9 * periods / frequency_.hz());
    end_ = values_.size();
    number_ = 0;
    is_at_end_ = false;
  }
  [[nodiscard]] std::int64_t slack_ns() const { return slack_ns_; }
  [[nodiscard]] double length_s() const { return 1e-9 * static_cast<double>(length_ns_); }
  // The next older one; nothing: the samples are at their end, or show no sine.
  [[nodiscard]] std::optional<Block> next() {
    const std::int64_t newest_ns = stamps_ns_.back();
    const auto done = static_cast<std::int64_t>(number_);
    const std::int64_t begin_ns = newest_ns - (done + 1) * length_ns_;
    if (begin_ns + slack_ns_ < stamps_ns_.front()) {
      is_at_end_ = true;
      return std::nullopt;
    }
    const auto first = static_cast<std::size_t>(
        std::upper_bound(stamps_ns_.begin(), stamps_ns_.end(), begin_ns) - stamps_ns_.begin());
    const std::vector<std::span<const double>> channels{
        std::span(values_).subspan(first, end_ - first)};
    const auto fits = analysis::fit_sine(
        frequency_, newest_ns, std::span(stamps_ns_).subspan(first, end_ - first), channels);
    end_ = first;
    ++number_;
    if (!fits) {
      return std::nullopt;
    }
    const analysis::SineFit& fit = fits->front();
    return Block{first, begin_ns, fit.amplitude(), fit.phase_rad(), fit.u_amplitude()};
  }
  [[nodiscard]] bool is_at_end() const { return is_at_end_; }

private:
  const analysis::Frequency& frequency_;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<double> values_;
  std::int64_t length_ns_ = 0;
  std::int64_t slack_ns_ = 0; // a record of two periods ends one interval before they do
  std::size_t end_;
  std::size_t number_ = 0;
  bool is_at_end_ = false;
};

// In periods of a block: long enough for samples and noise.
double choose_length(std::span<const Sample> samples, const analysis::Frequency& frequency,
                     bool is_triggered, Blocks& blocks) {
  const double span_s =
      1e-9 * static_cast<double>(samples.back().stamp_ns - samples.front().stamp_ns);
  const double rate_hz = static_cast<double>(samples.size() - 1) / span_s;
  const double wanted_s = std::max(is_triggered ? 0.0 : block_s, samples_of_block / rate_hz);
  double periods = std::max(1.0, std::ceil(wanted_s * frequency.hz()));
  for (int times = 1; !is_triggered && times < most_times_longer; times *= longer) {
    blocks.begin(periods);
    const auto newest = blocks.next();
    if (newest && newest->u_amplitude <= noisy_rel * newest->amplitude) {
      break;
    }
    periods *= longer;
  }
  return periods;
}

// Whether an older block continues the newer ones.
bool goes_on(const std::vector<Block>& newer, const Block& older, double periods) {
  const Block& last = newer.back();
  const double noise = coverage * std::hypot(last.u_amplitude, older.u_amplitude);
  double mean = 0.0;
  for (const Block& block : newer) {
    mean += block.amplitude / static_cast<double>(newer.size());
  }
  if (std::abs(older.amplitude - mean) > amplitude_break_rel * mean + noise) {
    return false;
  }
  const double turned = analysis::wrap_phase(older.phase_rad - last.phase_rad);
  const double most = 2.0 * std::numbers::pi * frequency_off_rel * periods + noise / mean;
  if (std::abs(turned) > most) {
    return false;
  }
  if (newer.size() < 2) {
    return true;
  }
  const double before = analysis::wrap_phase(last.phase_rad - newer[newer.size() - 2].phase_rad);
  return std::abs(analysis::wrap_phase(turned - before)) <= phase_break_rad + 2.0 * noise / mean;
}

struct Amplitudes {
  double mean = 0.0;
  double u = 0.0;       // of one, by noise
  double scatter = 0.0; // beyond that
};

Amplitudes amplitudes_of(std::span<const Block> blocks) {
  const auto count = static_cast<double>(blocks.size());
  double mean = 0.0;
  double variance = 0.0; // of one, by noise
  for (const Block& block : blocks) {
    mean += block.amplitude / count;
    variance += block.u_amplitude * block.u_amplitude / count;
  }
  double squares = 0.0;
  for (const Block& block : blocks) {
    squares += (block.amplitude - mean) * (block.amplitude - mean);
  }
  const double beyond = blocks.size() < 2 ? 0.0 : squares / (count - 1.0) - variance;
  return {mean, std::sqrt(variance), std::sqrt(std::max(0.0, beyond))};
}

// How far the newer half is from the older one, and how far noise takes them.
struct Trend {
  double change = 0.0;
  double noise = 0.0;
};

Trend trend_of(std::span<const Block> blocks) {
  const std::size_t half = blocks.size() / 2;
  const Amplitudes newer = amplitudes_of(blocks.first(half));
  const Amplitudes older = amplitudes_of(blocks.subspan(half));
  return {std::abs(newer.mean - older.mean),
          std::max(newer.u, older.u) / std::sqrt(static_cast<double>(half))};
}

bool is_settled(std::span<const Block> blocks) {
  const Trend trend = trend_of(blocks);
  return trend.change <= trend_rel * blocks.front().amplitude + coverage * trend.noise;
}

// By the phases of the blocks, which a frequency that is off turns.
double frequency_offset_hz(std::span<const Block> blocks, double length_s) {
  double phase = 0.0;
  double sum = 0.0;
  double weights = 0.0;
  const double middle = 0.5 * static_cast<double>(blocks.size() - 1);
  for (std::size_t i = 1; i < blocks.size(); ++i) {
    phase += analysis::wrap_phase(blocks[i].phase_rad - blocks[i - 1].phase_rad);
    sum += (static_cast<double>(i) - middle) * phase;
  }
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    weights += (static_cast<double>(i) - middle) * (static_cast<double>(i) - middle);
  }
  return weights > 0.0 ? -sum / weights / (2.0 * std::numbers::pi * length_s) : 0.0;
}

// The blocks that belong together and are of what came since, newest first.
std::vector<Block> blocks_since(std::int64_t begin_ns, double periods, Blocks& blocks) {
  std::vector<Block> together;
  for (auto block = blocks.next(); block && block->begin_ns >= begin_ns; block = blocks.next()) {
    if (!together.empty() && !goes_on(together, *block, periods)) {
      break;
    }
    together.push_back(*block);
  }
  return together;
}

// Of what came since the step was steady; empty where it goes on to before the step was announced,
// or may.
std::vector<Block> blocks_of_step(const StepWindow& window, double periods, Blocks& blocks) {
  std::vector<Block> together;
  std::size_t counting = 0;
  while (const auto block = blocks.next()) {
    if (!together.empty() && !goes_on(together, *block, periods)) {
      break;
    }
    if (block->begin_ns < window.announced_ns - announced_late_ns) {
      return {};
    }
    together.push_back(*block);
    counting += block->begin_ns >= window.steady_ns ? 1 : 0;
  }
  together.resize(blocks.is_at_end() ? 0 : counting);
  return together;
}

// Without older ones until the rest is settled; empty: it is not.
std::span<const Block> settled_part(std::span<const Block> blocks, const StepWindow& window,
                                    double length_s) {
  const std::size_t fewest =
      window.is_triggered
          ? 2
          : std::max(least_blocks, static_cast<std::size_t>(std::ceil(least_s / length_s)));
  while (blocks.size() >= fewest && !is_settled(blocks)) {
    blocks = blocks.first(blocks.size() * 3 / 4);
  }
  return blocks.size() >= fewest ? blocks : std::span<const Block>{};
}

} // namespace

std::optional<StepWindow> step_window(const ChannelRing& ring, ChannelRing::Instant announced,
                                      ChannelRing::Instant steady, bool is_triggered) {
  const auto announced_ns = ring.first_stamp_since(announced);
  const auto steady_ns = ring.first_stamp_since(steady);
  if (!announced_ns || !steady_ns) {
    return std::nullopt;
  }
  return StepWindow{*announced_ns, *steady_ns, ring.first_stamp_since(steady + max_lag),
                    is_triggered};
}

std::vector<Sample> samples_around(const ChannelRing& ring, const StepWindow& window) {
  const auto& samples = ring.samples();
  const auto newest =
      samples.end() - static_cast<std::ptrdiff_t>(std::min(samples.size(), max_samples));
  const std::int64_t begin_ns = window.announced_ns - looked_back_ns;
  return {std::lower_bound(newest, samples.end(), begin_ns,
                           [](const Sample& sample, std::int64_t stamp_ns) {
                             return sample.stamp_ns < stamp_ns;
                           }),
          samples.end()};
}

std::optional<SettledSamples> find_settled(std::span<const Sample> samples,
                                           const StepWindow& window,
                                           const analysis::Frequency& frequency) {
  if (samples.size() < 2 * static_cast<std::size_t>(samples_of_block)) {
    return std::nullopt;
  }
  Blocks blocks(samples, frequency);
  const double periods = choose_length(samples, frequency, window.is_triggered, blocks);
  const auto settled = [&](const std::vector<Block>& together) -> std::optional<SettledSamples> {
    const std::size_t looked_at = window.is_triggered ? 0 : 1;
    const std::span<const Block> part =
        together.size() <= looked_at
            ? std::span<const Block>{}
            : settled_part(std::span(together).subspan(looked_at), window, blocks.length_s());
    if (part.empty()) {
      return std::nullopt;
    }
    const std::size_t end = looked_at == 0 ? samples.size() : together[looked_at - 1].first;
    const std::size_t first = part.back().first;
    return SettledSamples{samples.subspan(first, end - first),
                          frequency.shifted_by_hz(frequency_offset_hz(part, blocks.length_s())),
                          std::max(amplitudes_of(part).scatter, trend_of(part).change)};
  };
  if (const auto certain_ns = window.is_triggered
                                  ? std::optional(samples.front().stamp_ns - blocks.slack_ns())
                                  : window.certain_ns) {
    blocks.begin(periods);
    if (auto found = settled(blocks_since(*certain_ns, periods, blocks))) {
      return found;
    }
  }
  blocks.begin(periods);
  return settled(blocks_of_step(window, periods, blocks));
}

} // namespace dyncal::inline views
