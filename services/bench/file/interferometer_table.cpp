#include "services/bench/file/interferometer_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/core.h>
#include <toml++/toml.h>

#include "analysis/interferometer/air_wavelength.hpp"
#include "analysis/interferometer/interferometer_budget.hpp"
#include "analysis/interferometer/quadrature_phase.hpp"
#include "services/base/whole_file.hpp"
#include "services/bench/file/bench_name.hpp"
#include "services/bench/file/toml_text.hpp"

namespace dyncal::inline bench {
namespace {

using analysis::Air;
using analysis::AirUncertainty;
using drivers::interferometer::InterferometerSettings;
using drivers::interferometer::StatedEllipse;

constexpr std::uintmax_t max_ellipse_bytes = 64U << 10U;
constexpr double nm = 1e-9;
constexpr double helium_neon_nm = analysis::helium_neon_vacuum_wavelength_m / nm;
constexpr double same_laser_rel = 1e-5;
constexpr int most_passes = 8;
constexpr double largest_u_wavelength_rel = 1e-2;
constexpr double largest_skew_s = 1e-3;

bool is_between(TomlTable& table, const char* key, double value, double low, double high,
                const char* hint) {
  const bool fits = value >= low && value <= high;
  if (!fits) {
    table.refuse(key, fmt::format("= {:g} must be from {:g} to {:g}{}", value, low, high, hint));
  }
  return fits;
}

struct Limits {
  double low;
  double high;
  const char* unit;
  const char* hint = "";
};

double between(TomlTable& table, const char* key, double otherwise, const Limits& limits) {
  const double value = table.number(key, otherwise, limits.unit);
  return is_between(table, key, value, limits.low, limits.high, limits.hint) ? value : otherwise;
}

std::optional<double> optional_between(TomlTable& table, const char* key, const Limits& limits) {
  const auto value = table.optional_number(key, limits.unit);
  return value && is_between(table, key, *value, limits.low, limits.high, limits.hint)
             ? value
             : std::nullopt;
}

struct StatedAir {
  Air air;
  AirUncertainty u;
};

StatedAir read_air(TomlTable table) {
  StatedAir stated;
  Air& air = stated.air;
  AirUncertainty& u = stated.u;
  air.temperature_c = between(table, "temperature_degc", air.temperature_c, {0.0, 50.0, "°C"});
  air.pressure_pa = between(table, "pressure_pa", air.pressure_pa,
                            {60'000.0, 120'000.0, "Pa", ": 1013.25 hPa are 101325 Pa"});
  air.relative_humidity =
      between(table, "humidity_rel", air.relative_humidity, {0.0, 1.0, "", ": 50 % are 0.5"});
  u.u_temperature_k = between(table, "u_temperature_k", u.u_temperature_k, {0.0, 20.0, "K"});
  u.u_pressure_pa = between(table, "u_pressure_pa", u.u_pressure_pa, {0.0, 20'000.0, "Pa"});
  u.u_relative_humidity = between(table, "u_humidity_rel", u.u_relative_humidity, {0.0, 0.5, ""});
  table.finish();
  return stated;
}

// What has no default must be there: a rounded wavelength is wrong by 3e-5.
double u_wavelength(TomlTable& table, bool has_default) {
  const auto stated = optional_between(table, "u_wavelength_rel",
                                       {0.0, largest_u_wavelength_rel, "of the wavelength"});
  if (!stated && !has_default && !table.refused("u_wavelength_rel")) {
    table.refuse("u_wavelength_rel",
                 "is missing: the standard uncertainty of the wavelength that is stated; only that "
                 "of a free-running He-Ne laser of 633 nm in vacuum is known");
  }
  return stated.value_or(analysis::helium_neon_u_rel);
}

analysis::AirWavelength read_wavelength(TomlTable& table) {
  const auto in_air_nm = optional_between(table, "wavelength_nm", {200.0, 20'000.0, "nm"});
  const auto vacuum_nm = optional_between(table, "wavelength_vacuum_nm", {350.0, 1600.0, "nm"});
  StatedAir stated;
  if (auto air = table.table("air")) {
    stated = read_air(std::move(*air));
  }
  if (table.has("wavelength_nm")) {
    for (const char* other : {"wavelength_vacuum_nm", "air"}) {
      if (table.has(other)) {
        table.refuse(other, "is given, and wavelength_nm, the wavelength in air, too: leave one of "
                            "them out");
      }
    }
    return {in_air_nm.value_or(helium_neon_nm) * nm, u_wavelength(table, false)};
  }
  const double vacuum_m = vacuum_nm.value_or(helium_neon_nm) * nm;
  const bool is_helium_neon =
      std::abs(vacuum_m / analysis::helium_neon_vacuum_wavelength_m - 1.0) < same_laser_rel;
  const double u_rel = u_wavelength(table, is_helium_neon);
  const auto wavelength = analysis::wavelength_in_air(vacuum_m, u_rel, stated.air, stated.u);
  return wavelength.value_or(analysis::AirWavelength{vacuum_m, u_rel}); // all was refused
}

double required_number(TomlTable& table, const char* key, const char* unit) {
  const auto value = table.optional_number(key, unit);
  if (!value && !table.refused(key)) {
    table.refuse(key, "is missing");
  }
  return value.value_or(1.0);
}

double standard_uncertainty(TomlTable& table, const char* key, const char* unit) {
  const double u = required_number(table, key, unit);
  if (!(u >= 0.0)) {
    table.refuse(key, "is a standard uncertainty and must not be negative");
  }
  return u;
}

void read_parameters(TomlTable& table, analysis::Ellipse& ellipse) {
  ellipse.p = required_number(table, "p", "the unit of u1");
  ellipse.q = required_number(table, "q", "the unit of u2");
  ellipse.radius = required_number(table, "R", "the unit of u1");
  if (!(ellipse.radius > 0.0)) {
    table.refuse("R", "must be positive: the amplitude of u1");
  }
  ellipse.r = required_number(table, "r", "");
  if (!(ellipse.r >= 0.2 && ellipse.r <= 5.0)) {
    table.refuse("r", "must be from 0.2 to 5: the amplitude of u1 over that of u2");
  }
  ellipse.alpha_rad = required_number(table, "alpha_rad", "rad");
  if (!(std::abs(ellipse.alpha_rad) <= std::numbers::pi / 4.0)) {
    table.refuse("alpha_rad", "must be within pi / 4 of 0; is it given in degrees?");
  }
}

void read_periodic_errors(TomlTable& table, StatedEllipse& stated) {
  if (!table.has("periodic_error_rad")) {
    return;
  }
  const std::vector<double> errors = table.numbers("periodic_error_rad", "rad");
  const bool possible = std::ranges::all_of(errors, [](double e) { return e >= 0.0 && e < 1.0; });
  if (errors.size() != analysis::radius_orders || !possible) {
    table.refuse("periodic_error_rad", "must be four amplitudes below 1, in rad: of the errors of "
                                       "the phase that repeat once to four times a turn");
    return;
  }
  stated.periodic_error_rad.emplace();
  std::ranges::copy(errors, stated.periodic_error_rad->begin());
}

std::optional<StatedEllipse> read_ellipse(TomlTable& table, NamedFiles& files) {
  const std::string name = table.text("ellipse", "auto");
  if (name == "auto") {
    return std::nullopt;
  }
  const std::filesystem::path path = files.resolve(name);
  const auto text = read_whole_file(path, max_ellipse_bytes);
  auto stated =
      text.and_then([&](const std::string& all) { return parse_ellipse_file(all, path); });
  if (!stated) {
    table.refuse("ellipse", fmt::format("is neither \"auto\" nor the file of an ellipse: {}",
                                        stated.error().message));
    return std::nullopt;
  }
  if (stated->from.empty()) {
    stated->from = name;
  }
  return std::move(*stated);
}

void read_signals(TomlTable& table, InterferometerSettings& settings) {
  settings.u1 = table.required_text("u1");
  settings.u2 = table.required_text("u2");
  settings.channel = table.text("channel", settings.channel);
  if (settings.u1 == settings.u2 && !settings.u1.empty()) {
    table.refuse("u2", "names the channel of u1: quadrature needs two signals");
  }
  if (settings.channel == settings.u1 || settings.channel == settings.u2) {
    table.refuse("channel", "is one of the raw signals: give the displacement a name of its own");
  }
  check_name(table, "channel", settings.channel);
}

void read_detectors(TomlTable& table, InterferometerSettings& settings) {
  settings.detector_bandwidth_hz =
      optional_between(table, "detector_bandwidth_hz", {1.0, 1e12, "Hz"});
  settings.u_skew_s = between(table, "u_skew_s", 0.0, {0.0, largest_skew_s, "seconds"});
  settings.output_rate_hz = optional_between(table, "output_rate_hz", {1.0, 1e9, "Hz"});
}

InterferometerSettings read_settings(TomlTable& table, NamedFiles& files) {
  InterferometerSettings settings;
  read_signals(table, settings);
  const int direction = table.whole_number("direction", 1, -1);
  if (direction != 1 && direction != -1) {
    table.refuse("direction", "must be 1 or -1: which way of the mirror counts as positive");
  }
  const int passes = table.whole_number("passes", 1, 1);
  if (passes > most_passes) {
    table.refuse("passes", fmt::format("must be from 1 to {}: 1 is a Michelson interferometer with "
                                       "a mirror, 2 a double path",
                                       most_passes));
  }
  const analysis::AirWavelength wavelength = read_wavelength(table);
  settings.displacement_per_turn_m =
      direction * analysis::displacement_per_turn_m(wavelength.wavelength_m, passes);
  settings.u_wavelength_rel = wavelength.u_rel;
  settings.ellipse = read_ellipse(table, files);
  read_detectors(table, settings);
  const std::string record = table.text("record");
  if (!record.empty()) {
    settings.record = files.output(record);
  }
  return settings;
}

std::optional<analysis::SignalRange> take_range(const std::string& channel,
                                                SourceSettings& source) {
  auto& ranges = source.identity.ranges;
  const auto found = ranges.find(channel);
  if (found == ranges.end()) {
    return std::nullopt;
  }
  const analysis::SignalRange range{found->second.minimum, found->second.maximum};
  ranges.erase(found);
  return range;
}

} // namespace

void read_interferometer(TomlTable& source_table, NamedFiles& files, SourceSettings& source) {
  auto table = source_table.table("interferometer");
  if (!table) {
    return;
  }
  InterferometerSettings settings = read_settings(*table, files);
  settings.range_u1 = take_range(settings.u1, source);
  settings.range_u2 = take_range(settings.u2, source);
  if (source.nominal_rate_hz) {
    const auto factor = drivers::interferometer::factor_of(*source.nominal_rate_hz, settings);
    if (!factor) {
      table->refuse("output_rate_hz",
                    fmt::format("= {:g} must be the sample rate, {:g}, divided by a whole number "
                                "up to {}",
                                *settings.output_rate_hz, *source.nominal_rate_hz,
                                drivers::interferometer::largest_factor));
    }
    *source.nominal_rate_hz /= static_cast<double>(factor.value_or(1)); // that is published
  }
  table->finish();
  source.interferometer = std::move(settings);
}

Expected<StatedEllipse> parse_ellipse_file(std::string_view text,
                                           const std::filesystem::path& path) {
  const auto parsed = parse_toml(text, path);
  if (!parsed) {
    return fail(ErrorCode::bad_file, parsed.error().text());
  }
  BenchProblems problems;
  TomlTable table(*parsed, "", path.string(), problems);
  StatedEllipse stated;
  read_parameters(table, stated.ellipse);
  analysis::EllipseFit fit{.ellipse = stated.ellipse};
  const std::array<std::pair<const char*, const char*>, 4> keys{
      {{"u_p", "the unit of u1"}, {"u_q", "the unit of u2"}, {"u_r", ""}, {"u_alpha_rad", "rad"}}};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    fit.covariance[i][i] = std::pow(standard_uncertainty(table, keys[i].first, keys[i].second), 2);
  }
  read_periodic_errors(table, stated);
  stated.turns_covered = table.number("turns_covered", 0.0, "turns");
  stated.from = table.text("from");
  table.finish();
  if (!problems.empty()) {
    return fail(ErrorCode::bad_file, problems.front().text());
  }
  stated.u_rad = analysis::ellipse_errors(fit);
  return stated;
}

} // namespace dyncal::inline bench
