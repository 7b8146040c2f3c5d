#include "services/contract/excitation_quantity.hpp"

#include <algorithm>

#include "services/contract/unit.hpp"

namespace dyncal::inline contract {

const drivers::QuadratureSignals* quadrature_signals_of(const drivers::SourceDescription& source,
                                                        const std::string& channel) {
  const auto found =
      std::ranges::find(source.quadrature_signals, channel, &drivers::QuadratureSignals::channel);
  return found == source.quadrature_signals.end() ? nullptr : &*found;
}

std::string excitation_unit(const drivers::SourceDescription& source, const std::string& channel) {
  if (quadrature_signals_of(source, channel) != nullptr) {
    return R"(\metre\second\tothe{-2})";
  }
  const auto found =
      std::ranges::find(source.channels, channel, &drivers::ChannelDescription::name);
  return found == source.channels.end() ? std::string() : found->unit;
}

std::optional<double> acceleration_factor(const drivers::SourceDescription& source,
                                          const std::string& channel, double angular_hz) {
  if (quadrature_signals_of(source, channel) != nullptr) {
    return angular_hz * angular_hz;
  }
  return is_acceleration(excitation_unit(source, channel)) ? std::optional(1.0) : std::nullopt;
}

} // namespace dyncal::inline contract
