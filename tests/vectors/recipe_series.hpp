// Series by recipe: make_sine_vectors.py has the same recipes, and both make the same doubles.
// Stamps come from integers only; values are rounded to a quantum far above what the sine of either
// side is wrong by.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

using Json = nlohmann::json;

inline std::uint64_t splitmix64(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}

inline double number(const Json& text) {
  return std::stod(text.get<std::string>());
}

inline std::vector<std::int64_t> stamps_of(const Json& recipe) {
  const auto samples = recipe["samples"].get<std::int64_t>();
  const auto jitter_ns = recipe["jitter_ns"].get<std::int64_t>();
  const auto seed = recipe["seed"].get<std::uint64_t>();
  std::vector<std::int64_t> stamps;
  for (std::int64_t i = 0; i < samples; ++i) {
    const std::uint64_t hash = splitmix64(seed * 1'000'003 + static_cast<std::uint64_t>(i));
    const auto shift =
        static_cast<std::int64_t>(hash % static_cast<std::uint64_t>(2 * jitter_ns + 1)) - jitter_ns;
    const std::int64_t gap = i >= samples / 3 ? recipe.value("gap_ns", std::int64_t{0}) : 0;
    stamps.push_back(recipe["first_ns"].get<std::int64_t>() +
                     i * recipe["interval_ns"].get<std::int64_t>() + shift + gap);
  }
  return stamps;
}

inline double sine(const Json& frequency_hz, const Json& amplitude, const Json& phase,
                   std::int64_t dt_ns) {
  const double turns = Frequency::parse(frequency_hz.get<std::string>())->reduced_turns(dt_ns);
  return number(amplitude) * std::sin(2.0 * std::numbers::pi * turns + number(phase));
}

inline std::vector<double> values_of(const Json& recipe, const Json& channel,
                                     const std::vector<std::int64_t>& stamps) {
  const double quantum = number(channel["quantum"]);
  const std::int64_t middle_ns = stamps.front() + (stamps.back() - stamps.front()) / 2;
  const auto reference_ns = recipe["t_ref_ns"].get<std::int64_t>();
  std::vector<double> values;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    double y = number(channel["offset"]) + sine(recipe["frequency_hz"], channel["amplitude"],
                                                channel["phase_rad"], stamps[i] - reference_ns);
    if (channel.contains("lines")) {
      for (const Json& line : channel["lines"]) {
        y += sine(line[0], line[1], line[2], stamps[i] - reference_ns);
      }
    }
    if (channel.contains("drift_per_s")) {
      double power = 1.0;
      for (const Json& drift : channel["drift_per_s"]) {
        y += number(drift) * (power *= static_cast<double>(stamps[i] - middle_ns) * 1e-9);
      }
    }
    const std::uint64_t hash = splitmix64(channel["seed"].get<std::uint64_t>() * 1'000'003 + i);
    y += number(channel["noise"]) * (static_cast<double>(hash >> 11) * 0x1p-52 - 1.0);
    values.push_back(std::nearbyint(y / quantum) * quantum);
  }
  return values;
}

} // namespace dyncal::analysis
