// What a document states of a stored value, as text: U with two significant digits, the value
// rounded to the same decimal place (GUM 7.2.6), k with two decimals. Report and certificate take
// their digits from here, and `dyncal verify` compares with them.
//
// U = k u is taken from the doubles of the result file, then rounded once; rounding to two
// significant digits moves U by at most 5 % (EA-4/02 M, 6.3 asks for rounding up beyond that).
// Phase is lead, within (-pi, pi], and in degrees rounded by U in degrees. Plain functions, any
// thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/views/language/language.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct StatedValue {
  std::string value;
  std::string expanded; // U
  std::string k;
};

[[nodiscard]] StatedValue stated_magnitude(const StoredValue& value);
[[nodiscard]] StatedValue stated_phase_rad(const StoredValue& value);
[[nodiscard]] StatedValue stated_phase_deg(const StoredValue& value);
// A derived number, as a group delay or a rate: "8.100 ms, U = 0.012 ms (k = 2.00)".
[[nodiscard]] std::string stated_text(double value, const analysis::CombinedUncertainty& of_value,
                                      const std::string& unit,
                                      Language language = Language::english);
// Value and U are finite, and U and k are above 0: without these there is nothing to state.
[[nodiscard]] bool can_be_stated(const StoredValue& value);

// That of expanded_uncertainty.hpp, for the largest k of the values; empty where none is large.
[[nodiscard]] std::string advice_on_repetitions(const std::vector<StoredValue>& values,
                                                Language language = Language::english);

// What the sensor measured of its own temperature, in degrees Celsius, and the reference of the
// excitation, in m/s^2: "27.3 to 28.9"; empty where nothing is known.
[[nodiscard]] std::string temperature_range(const std::vector<StoredPoint>& points,
                                            Language language);
[[nodiscard]] std::string level_range(const std::vector<StoredPoint>& points, Language language);
// What the reference measured of it at a value, the mean of the repetitions; NaN: not known.
[[nodiscard]] double measured_level_m_s2(const StoredResult& result, const StoredValue& value);

// Channels that respond to the excitation.
[[nodiscard]] std::vector<std::string> responding_channels(const StoredResult& result);
// As the source of a channel described itself to the run; nothing: it did not.
[[nodiscard]] std::optional<drivers::SourceDescription>
described_source(const StoredResult& result, const std::string& channel);
// The first of many texts, and how many others there are.
[[nodiscard]] std::vector<std::string> first_of(std::vector<std::string> texts, std::size_t most);

// "95.45 %"
[[nodiscard]] std::string coverage_percent(double probability, Language language);

// How a method links the sensor to the reference; the name itself for one that is not known.
[[nodiscard]] std::string method_description(const std::string& method, Language language);
// What the whole run was excited with: "17 frequencies from 10 Hz to 200 Hz".
[[nodiscard]] std::string frequency_range(const std::vector<StoredValue>& values,
                                          Language language);

} // namespace dyncal::inline views
