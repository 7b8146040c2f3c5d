// In which quantity a channel shows the excitation of a step, and what of it levels and responses
// are stated in.
//
// A displacement that its source makes of quadrature signals (drivers/quadrature_signals.hpp)
// stands for an acceleration: levels are planned in m/s^2, and responses are per m/s^2. Any other
// channel stands for itself. Plain functions, any thread.
#pragma once

#include <optional>
#include <string>

#include "drivers/sample_block.hpp"

namespace dyncal::inline contract {

// nullptr: the channel is none that is made of such.
[[nodiscard]] const drivers::QuadratureSignals*
quadrature_signals_of(const drivers::SourceDescription& source, const std::string& channel);

// The unit that a response with the channel as reference is per; empty where it is not known.
[[nodiscard]] std::string excitation_unit(const drivers::SourceDescription& source,
                                          const std::string& channel);

// What an amplitude of the channel is multiplied by for one in m/s^2; nothing where it shows no
// acceleration.
[[nodiscard]] std::optional<double> acceleration_factor(const drivers::SourceDescription& source,
                                                        const std::string& channel,
                                                        double angular_hz);

} // namespace dyncal::inline contract
