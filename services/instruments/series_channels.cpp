#include "services/instruments/series_channels.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dyncal::inline instruments {

Expected<drivers::tss::Series> select_channels(drivers::tss::Series series,
                                               const std::map<std::string, std::string>& our_names,
                                               const std::vector<std::string>& wanted) {
  std::vector<std::string> names;
  for (drivers::ChannelDescription& channel : series.channels) {
    const auto ours = our_names.find(channel.name);
    channel.name = ours == our_names.end() ? channel.name : ours->second;
    names.push_back(channel.name);
  }
  std::vector<drivers::ChannelDescription> channels;
  std::vector<double> values;
  values.reserve(wanted.size() * series.samples);
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      return fail(ErrorCode::device,
                  fmt::format("the sensor's series has no channel '{}'; it has: {}", name,
                              fmt::join(names, ", ")));
    }
    const auto place = found - names.begin();
    channels.push_back(series.channels[static_cast<std::size_t>(place)]);
    const auto first = series.values.begin() + place * static_cast<std::ptrdiff_t>(series.samples);
    values.insert(values.end(), first, first + static_cast<std::ptrdiff_t>(series.samples));
  }
  series.channels = std::move(channels);
  series.values = std::move(values);
  return series;
}

} // namespace dyncal::inline instruments
