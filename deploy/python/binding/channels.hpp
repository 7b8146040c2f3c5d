// A recorded channel as Python gives it, and the spans of it that an evaluation takes.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "analysis/method/transfer_point.hpp"
#include "arrays.hpp"

namespace dyncal::python {

struct Channel {
  std::string name;
  Array<double> values;
  double resolution = 0.0;
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  std::vector<double> mains_hz;

  // Lives as long as this channel, unmoved.
  [[nodiscard]] analysis::ChannelSamples samples() {
    analysis::ChannelSamples taken;
    taken.name = name;
    taken.values = values.span("values of '" + name + "'");
    taken.resolution = resolution;
    taken.expected = {minimum, maximum, resolution};
    taken.mains_hz = mains_hz;
    return taken;
  }
};

// Of several; the channels are kept where they are.
[[nodiscard]] inline std::vector<analysis::ChannelSamples>
samples_of(std::vector<Channel>& channels) {
  std::vector<analysis::ChannelSamples> taken;
  for (Channel& channel : channels) {
    taken.push_back(channel.samples());
  }
  return taken;
}

} // namespace dyncal::python
