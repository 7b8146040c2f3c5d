#include "drivers/tables/table_phasor.hpp"

#include <numbers>

#include <fmt/core.h>

namespace dyncal::drivers::tables {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

struct Deviation {
  const char* of;  // "the amplitude"
  const char* key; // that states u in its place
  std::optional<double> value;
};

Expected<double> u_of(const Deviation& deviation, const TableSettings& settings,
                      const ReferenceTableRow& row, const std::string& file) {
  if (!deviation.value || !(*deviation.value > 0.0)) {
    return fail(ErrorCode::invalid_setting,
                fmt::format("{}: line {}: the table states no uncertainty of {}; state it with "
                            "the source's key '{}'",
                            file, row.line, deviation.of, deviation.key));
  }
  if (!settings.coverage) {
    return fail(ErrorCode::invalid_setting,
                fmt::format("{}: line {}: the table has a deviation of {}, but nothing says how "
                            "many standard uncertainties it is; state it with the source's key "
                            "'coverage' (2 for twice the standard uncertainty), or '{}'",
                            file, row.line, deviation.of, deviation.key));
  }
  return *deviation.value / *settings.coverage;
}

} // namespace

Expected<TablePhasor> phasor_of(const ReferenceTableRow& row, const TableSettings& settings,
                                const std::string& file) {
  TablePhasor phasor;
  const double peak = settings.amplitude == TableAmplitude::rms ? std::numbers::sqrt2 : 1.0;
  phasor.amplitude_m_s2 = peak * row.amplitude_m_s2;
  const double sign = settings.phase == TablePhase::sync_minus_reference ? 1.0 : -1.0;
  phasor.phase_rad = degree * (sign * row.phase_deg + settings.phase_offset_deg);
  if (settings.u_amplitude_rel) {
    phasor.u_amplitude_m_s2 = *settings.u_amplitude_rel * phasor.amplitude_m_s2;
  } else {
    DYNCAL_TRY(const double u,
               u_of({"the amplitude", "u_amplitude_rel", row.amplitude_deviation_m_s2}, settings,
                    row, file));
    phasor.u_amplitude_m_s2 = peak * u;
  }
  if (settings.u_phase_deg) {
    phasor.u_phase_rad = degree * *settings.u_phase_deg;
  } else {
    DYNCAL_TRY(const double u,
               u_of({"the phase", "u_phase_deg", row.phase_deviation_deg}, settings, row, file));
    phasor.u_phase_rad = degree * u;
  }
  const bool of_table = !settings.u_amplitude_rel || !settings.u_phase_deg;
  phasor.coverage = of_table ? settings.coverage.value_or(1.0) : 1.0;
  return phasor;
}

} // namespace dyncal::drivers::tables
