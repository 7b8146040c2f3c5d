#include "services/programs/virtual_bench/evaluating_acs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include <fmt/core.h>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::inline programs::virtual_bench {
namespace {

namespace device = drivers::virtual_bench;

constexpr double coverage = 2.0;
constexpr double degrees = 180.0 / std::numbers::pi;

bool is_same(const device::Drive& a, const device::Drive& b) {
  return a.on == b.on && a.frequency_hz == b.frequency_hz && a.amplitude_v == b.amplitude_v;
}

} // namespace

Expected<EvaluatingAcs> EvaluatingAcs::open(const device::AcsInstrument& acs,
                                            const std::filesystem::path& table) {
  std::ofstream(table, std::ios::binary)
      << "loop;frequency;ex_amp;ex_amp_std;phase;phase_std\n\n#Number;Hz;m/s^2;m/s^2;deg;deg\n";
  std::ofstream file(table, std::ios::binary | std::ios::app); // whoever else writes into it
  if (!file || std::filesystem::file_size(table) == 0) {
    return fail(ErrorCode::bad_file, table.string() + ": the table cannot be written");
  }
  return EvaluatingAcs(acs, std::move(file));
}

void EvaluatingAcs::take(const device::AcsSamples& samples, const device::Drive& drive) {
  if (!is_same(drive, drive_)) {
    write_row();
    stamps_ns_.clear();
    reference_.clear();
    sync_.clear();
    drive_ = drive;
  }
  for (std::size_t i = 0; i < samples.samples() && drive.on; ++i) {
    const std::uint64_t sample = samples.first_sample + i;
    if (sample >= next_sample_) {
      stamps_ns_.push_back(acs_.stamp_ns(sample));
      reference_.push_back(samples.counts[samples.channels * i] * acs_.reference_scale());
      sync_.push_back(samples.counts[samples.channels * i + 1] * acs_.sync_scale());
    }
  }
  next_sample_ = std::max(next_sample_, samples.first_sample + samples.samples());
}

void EvaluatingAcs::write_row() {
  const auto steady = std::ranges::find_if(stamps_ns_, [&](std::int64_t stamp_ns) {
    return static_cast<double>(stamp_ns - stamps_ns_.front()) >= 1e9 * settling_s;
  });
  const auto left_out = static_cast<std::size_t>(steady - stamps_ns_.begin());
  const auto frequency = analysis::Frequency::parse(fmt::format("{:.9g}", drive_.frequency_hz));
  if (!drive_.lines.empty() || steady == stamps_ns_.end() || !frequency ||
      static_cast<double>(stamps_ns_.back() - *steady) < 1e9 * least_s) {
    return;
  }
  const std::array channels{std::span<const double>(reference_).subspan(left_out),
                            std::span<const double>(sync_).subspan(left_out)};
  const auto fits =
      analysis::fit_sine(*frequency, *steady, std::span(stamps_ns_).subspan(left_out), channels);
  if (!fits) {
    return; // no row is what such a system shows, too
  }
  if (!frequencies_hz_.insert(drive_.frequency_hz).second) {
    frequencies_hz_ = {drive_.frequency_hz};
    ++loop_;
  }
  const analysis::SineFit& reference = fits->front();
  const analysis::SineFit& sync = fits->back();
  table_ << fmt::format(
      "{};{};{:.9g};{:.3g};{:.9g};{:.3g}\n", loop_, drive_.frequency_hz, reference.amplitude(),
      coverage * reference.u_amplitude(),
      std::remainder(sync.phase_rad() - reference.phase_rad(), 2.0 * std::numbers::pi) * degrees,
      coverage * std::hypot(reference.u_phase_rad(), sync.u_phase_rad()) * degrees);
  table_.flush();
}

} // namespace dyncal::inline programs::virtual_bench
