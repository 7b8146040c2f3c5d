#include "services/records/replay/series_file.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "drivers/files/file_source.hpp"
#include "services/base/byte_count.hpp"

namespace dyncal::inline records {
namespace {

class Collector : public drivers::SampleSink {
public:
  Collector(const drivers::files::FileSource& file, ByteCount& bytes)
      : file_(file), bytes_(bytes) {}

  void begin_session() override {}
  void count(const drivers::SampleCounts&) override {}
  void warn(const std::string&) override {}
  void describe(const drivers::SourceDescription& description) override {
    for (const drivers::ChannelDescription& channel : description.channels) {
      series_.names.push_back(channel.name);
    }
    series_.columns.resize(series_.names.size());
  }

  void take(drivers::SampleBlock block) override {
    for (std::size_t i = 0; i < block.samples; ++i) {
      series_.stamps_ns.push_back(block.clock ? block.clock->stamp_ns(block.first_sample + i)
                                              : block.stamps_ns[i]);
      series_.flags.push_back(block.flags.empty() ? 0 : block.flags[i]);
      series_.sample_numbers.push_back(block.first_sample + i);
    }
    for (std::size_t channel = 0; channel < series_.columns.size(); ++channel) {
      const auto begin =
          block.values.begin() + static_cast<std::ptrdiff_t>(channel * block.samples);
      series_.columns[channel].insert(series_.columns[channel].end(), begin,
                                      begin + static_cast<std::ptrdiff_t>(block.samples));
    }
    bytes_.set_share_done(file_.share_read());
  }

  SeriesFile&& series() { return std::move(series_); }

private:
  const drivers::files::FileSource& file_;
  ByteCount& bytes_;
  SeriesFile series_;
};

} // namespace

Expected<std::span<const double>> SeriesFile::column(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: there is no column '{}'; the columns are: {}", path.string(), name,
                            fmt::join(names, ", ")));
  }
  return std::span<const double>(columns[static_cast<std::size_t>(found - names.begin())]);
}

std::size_t SeriesFile::leave_out_disorder() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    if (flags[i] != 0) {
      continue;
    }
    stamps_ns[kept] = stamps_ns[i];
    sample_numbers[kept] = sample_numbers[i];
    for (std::vector<double>& column : columns) {
      column[kept] = column[i];
    }
    ++kept;
  }
  const std::size_t left_out = stamps_ns.size() - kept;
  stamps_ns.resize(kept);
  sample_numbers.resize(kept);
  flags.assign(kept, 0);
  for (std::vector<double>& column : columns) {
    column.resize(kept);
  }
  return left_out;
}

Expected<SeriesFile> read_series_file(const std::filesystem::path& path,
                                      const SharedWorkCount& count,
                                      std::optional<double> nominal_rate_hz) {
  drivers::files::FileSettings settings;
  settings.path = path;
  if (nominal_rate_hz) {
    settings.sample_rate = drivers::sample_rate_from_hz(*nominal_rate_hz);
  }
  drivers::files::FileSource source(std::move(settings));
  ByteCount bytes(count, "reading", bytes_of_file(path));
  Collector collector(source, bytes);
  const auto read = source.describe().and_then(
      [&](const drivers::SourceDescription&) { return source.run(collector); });
  if (!read) {
    return fail(ErrorCode::bad_file, read.error().message);
  }
  bytes.set_share_done(source.share_read());
  SeriesFile series = collector.series();
  series.path = path;
  return series;
}

} // namespace dyncal::inline records
