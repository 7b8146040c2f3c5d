#include "services/records/replay/shot_files.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>

#include <fmt/core.h>

#include "drivers/tss/series.hpp"
#include "services/evaluation/record/shot_record.hpp"
#include "services/instruments/series_channels.hpp"

namespace dyncal::inline records {
namespace {

constexpr std::uint64_t session = 1; // files are one session; nothing depends on its number

using StepAndShot = std::pair<std::uint32_t, std::uint64_t>;

tl::unexpected<Error> bad_file(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorCode::bad_file, fmt::format("{}: {}", path.string(), why));
}

// "step-1-shot-1.csv", numbers of at most six digits.
std::optional<StepAndShot> step_and_shot_of(std::string_view name) {
  const auto text = [&](std::string_view expected) {
    const bool there = name.starts_with(expected);
    name.remove_prefix(there ? expected.size() : 0);
    return there;
  };
  const auto number = [&](auto& value) {
    const auto [end, status] =
        std::from_chars(name.data(), name.data() + std::min<std::size_t>(name.size(), 6), value);
    name.remove_prefix(static_cast<std::size_t>(end - name.data()));
    return status == std::errc{};
  };
  StepAndShot found;
  const bool matches = text("step-") && number(found.first) && text("-shot-") &&
                       number(found.second) && text(".csv") && name.empty();
  return matches ? std::optional(found) : std::nullopt;
}

Expected<std::map<StepAndShot, std::filesystem::path>>
find_files(const std::filesystem::path& folder) {
  std::map<StepAndShot, std::filesystem::path> files;
  std::error_code problem;
  for (std::filesystem::directory_iterator entry(folder, problem), end; !problem && entry != end;
       entry.increment(problem)) {
    if (const auto found = step_and_shot_of(entry->path().filename().string())) {
      files.emplace(*found, entry->path());
    }
  }
  if (problem) {
    return bad_file(folder, "cannot be read: " + problem.message());
  }
  if (files.empty() || files.size() > ShotRecord::capacity) {
    return bad_file(
        folder,
        fmt::format(
            "holds {} files named like step-1-shot-1.csv; between 1 and {} can be evaluated",
            files.size(), ShotRecord::capacity));
  }
  return files;
}

Expected<drivers::tss::Series> read_file(const std::filesystem::path& path,
                                         const SourceSettings& source,
                                         const std::vector<std::string>& wanted) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) {
    return bad_file(path, "cannot be read");
  }
  auto series = drivers::tss::parse_series_csv(text.str());
  if (!series) {
    return bad_file(path, series.error().message);
  }
  auto selected = select_channels(std::move(*series), source.channels, wanted);
  return selected ? std::move(selected) : bad_file(path, selected.error().message);
}

// Empty for a device.
std::filesystem::path folder_of_shots(const SourceSettings& source) {
  if (const auto* oscilloscope = source.as<OscilloscopeSourceSettings>()) {
    return oscilloscope->path;
  }
  const auto* series = source.as<SeriesSourceSettings>();
  return series != nullptr ? series->path : std::filesystem::path();
}

// As the files and `units` of the bench file have it.
drivers::SourceDescription describe(const SourceSettings& source,
                                    const drivers::tss::Series& series) {
  drivers::SourceDescription description;
  description.device = series.device;
  description.serial = series.serial;
  description.firmware = series.firmware;
  description.driver = "files of shots";
  description.nominal_rate_hz = series.nominal_rate_hz;
  for (const drivers::ChannelDescription& one : series.channels) {
    const auto unit = source.units.find(one.name);
    drivers::ChannelDescription channel;
    channel.name = one.name;
    channel.unit = unit == source.units.end() ? one.unit : unit->second;
    channel.quantity = channel.unit == one.unit ? "" : one.unit; // to be held against its role
    description.channels.push_back(std::move(channel));
  }
  return description;
}

TriggeredRecord record_of(const StepAndShot& number, drivers::tss::Series series) {
  return {.session = session,
          // Shots are numbered within their step in files, and within the session in records.
          .shot = (std::uint64_t{number.first} << 32U) | number.second,
          .step = number.first,
          .samples = series.samples,
          .channels = series.channels.size(),
          .trigger_utc_ns = 0,
          .first_sample_s = series.first_sample_s,
          .interval_s = 1.0 / series.nominal_rate_hz,
          .values = std::move(series.values)};
}

} // namespace

Expected<ShotFiles> read_shot_files(const BenchFile& bench, const std::string& name) {
  const SourceSettings& source = *bench.source(name); // a role names it: it was checked
  const bool trace = name == bench.method.sync_dau.source;
  const std::filesystem::path folder = folder_of_shots(source);
  if (folder.empty()) {
    return fail(ErrorCode::bad_file, fmt::format("{}: source '{}' has no path; analyse evaluates "
                                                 "files, use 'dyncal run' for live sources",
                                                 source.where, source.name));
  }
  DYNCAL_TRY(const auto files, find_files(folder));
  std::vector<std::string> wanted;
  for (const ChannelName& channel : trace ? std::vector{bench.method.sync_dau} : bench.method.dut) {
    wanted.push_back(channel.channel);
  }
  ShotFiles result;
  std::vector<double> factors;
  for (const auto& [number, path] : files) {
    DYNCAL_TRY(auto series, read_file(path, source, wanted));
    if (result.records.empty()) {
      const drivers::SourceDescription described = describe(source, series);
      factors = unit_factors(described, source.identity);
      result.description = with_identity(described, source.identity);
    }
    convert(factors, series.samples, series.values);
    result.records.push_back(record_of(number, std::move(series)));
  }
  return result;
}

} // namespace dyncal::inline records
