#include "drivers/files/adjusted_reader.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::drivers::files {

Expected<std::unique_ptr<SampleReader>> AdjustedReader::open(std::unique_ptr<SampleReader> reader,
                                                             const FileSettings& settings) {
  if (settings.scale.empty() && settings.time_offset_ns == 0) {
    return reader;
  }
  std::unique_ptr<AdjustedReader> adjusted(new AdjustedReader(std::move(reader), settings));
  DYNCAL_TRY(adjusted->find_channels());
  return adjusted;
}

Expected<void> AdjustedReader::find_channels() {
  for (const auto& [name, factor] : settings_.scale) {
    auto& channels = description_.channels;
    const auto found =
        std::find_if(channels.begin(), channels.end(),
                     [&, &wanted = name](const auto& one) { return one.name == wanted; });
    if (found == channels.end()) {
      return fail(ErrorCode::not_found,
                  settings_.path.string() + ": no channel '" + name + "' to scale");
    }
    if (!found->unit.empty() && !settings_.units.contains(name)) {
      return fail(ErrorCode::invalid_setting,
                  settings_.path.string() + ": channel '" + name + "' is scaled, but by the file " +
                      "its unit is " + found->unit + "; state in units what it is once scaled");
    }
    found->quantity.clear(); // that of the values in the file
    found->minimum *= factor;
    found->maximum *= factor;
    if (factor < 0.0) {
      std::swap(found->minimum, found->maximum);
    }
    found->resolution *= std::abs(factor);
    factors_.emplace_back(static_cast<std::size_t>(found - channels.begin()), factor);
  }
  return {};
}

bool AdjustedReader::move(std::int64_t& stamp_ns) const {
  return !__builtin_add_overflow(stamp_ns, settings_.time_offset_ns, &stamp_ns);
}

Expected<SampleBlock> AdjustedReader::read(std::size_t samples) {
  DYNCAL_TRY(auto block, reader_->read(samples));
  for (const auto& [channel, factor] : factors_) {
    const auto begin = block.values.begin() + static_cast<std::ptrdiff_t>(channel * block.samples);
    std::transform(begin, begin + static_cast<std::ptrdiff_t>(block.samples), begin,
                   [by = factor](double value) { return value * by; });
  }
  bool moved = !block.clock || move(block.clock->origin_ns);
  for (std::int64_t& stamp_ns : block.stamps_ns) {
    moved = move(stamp_ns) && moved;
  }
  if (!moved) {
    return fail(ErrorCode::malformed, settings_.path.string() + ": with time_offset_s sample " +
                                          std::to_string(block.first_sample) +
                                          " has a time that nanoseconds since 1970 cannot hold");
  }
  return block;
}

} // namespace dyncal::drivers::files
