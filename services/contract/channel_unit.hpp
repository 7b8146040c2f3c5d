// The unit that people write for the values of a channel, where these must be converted before they
// are published in D-SI:
//
//   "g", "mm/s^2", "kPa"          the values are in it:      published = factor * value
//   "16384 LSB/g", "100 mV/g",    a scale factor:            published = value / 16384, in g, and
//   "10.2 mV/(m/s^2)"                                        from there to D-SI
//
// g is the standard acceleration of free fall, 9.80665 m/s^2 (ISO 80000-3). A scale factor in mV
// holds as well where the instrument says that its values are in V: they are brought to mV first;
// otherwise the values are taken to be in what stands before the slash. Scale factors of counts
// ("LSB", "digit", "count") and of voltages are known.
//
// Fails (bad_argument) for what is neither D-SI, nor a known short form, nor a scale factor of
// them; the sentence completes "gives channel 'x' the unit "dB", which ". Plain functions, any
// thread.
#pragma once

#include <string>

#include "services/base/error.hpp"

namespace dyncal::inline contract {

struct ChannelUnit {
  std::string written; // "100 mV/g"
  std::string d_si;    // of what is published: \metre\second\tothe{-2}
  double factor = 1.0; // what is published, over the value
  double from_v = 0.0; // what one unit of the values is in V, of a scale factor of voltages; else 0
  double named = 1.0;  // one of the unit, or of that after the slash, in d_si

  [[nodiscard]] bool is_conversion() const { return factor != 1.0 || from_v != 0.0; }
  // For values that the instrument says to be in `own`.
  [[nodiscard]] double factor_from(const std::string& own) const;

  friend bool operator==(const ChannelUnit&, const ChannelUnit&) = default;
};

[[nodiscard]] Expected<ChannelUnit> parse_channel_unit(const std::string& written);

} // namespace dyncal::inline contract
