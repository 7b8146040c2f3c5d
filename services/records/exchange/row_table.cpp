#include "services/records/exchange/row_table.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/contract/source_block.hpp"

namespace dyncal::inline records {
namespace {

const ColumnValues times = std::vector<std::int64_t>{};
const ColumnValues counts = std::vector<std::uint64_t>{};
const ColumnValues measured = std::vector<double>{};

template <class T>
std::vector<T> repeated(std::size_t count, T value) {
  return std::vector<T>(count, value);
}

void add_channels(Rows& rows, const std::vector<std::size_t>& channels,
                  std::span<const double> values) {
  for (const std::size_t channel : channels) {
    const auto column = values.subspan(channel * rows.count, rows.count);
    rows.columns.emplace_back(std::vector<double>(column.begin(), column.end()));
  }
}

} // namespace

RowTable::RowTable(const ExportedRecording& recording, const ExportedSource& source,
                   std::vector<std::size_t> channels)
    : recording_(recording), source_(source), channels_(std::move(channels)) {
  if (source.recorded->triggered) {
    columns_ = {{"t_ns", "ns", times},  {"t_s", "s", measured}, {"session", "", counts},
                {"shot", "", counts},   {"run", "", counts},    {"step", "", counts},
                {"attempt", "", counts}};
  } else {
    columns_ = {{"t_ns", "ns", times},
                {"sample_number", "", counts},
                {"session", "", counts},
                {"lost_before", "", counts},
                {"stamp_uncertainty_ns", "ns", counts},
                {"stamp_flags", "", counts}};
  }
  for (const std::size_t channel : channels_) {
    columns_.push_back(
        {source.channels[channel].name, source.channels[channel].unit, measured, true});
  }
}

Rows RowTable::rows_of(const InOrder<wire::SampleBlock>& one) const {
  const SourceBlock block = view_block(one.message);
  Rows rows;
  rows.count = block.samples;
  rows.session = one.session;
  rows.received_utc_ns = one.message.received_utc_ns();
  std::vector<std::int64_t> stamps(block.stamps_ns.begin(), block.stamps_ns.end());
  for (std::size_t i = stamps.size(); i < rows.count; ++i) {
    stamps.push_back(block.clock.stamp_ns(block.first_sample + i));
  }
  std::vector<std::uint64_t> numbers(rows.count);
  std::iota(numbers.begin(), numbers.end(), block.first_sample);
  auto lost = repeated<std::uint64_t>(rows.count, 0);
  lost.front() = one.lost_before;
  std::vector<std::uint64_t> uncertainties(block.stamp_uncertainty_ns.begin(),
                                           block.stamp_uncertainty_ns.end());
  uncertainties.resize(rows.count);
  std::vector<std::uint64_t> flags(block.flags.begin(), block.flags.end());
  flags.resize(rows.count);
  rows.columns = {std::move(stamps),
                  std::move(numbers),
                  repeated<std::uint64_t>(rows.count, one.session + 1),
                  std::move(lost),
                  std::move(uncertainties),
                  std::move(flags)};
  add_channels(rows, channels_, block.values);
  return rows;
}

Rows RowTable::rows_of(const InOrder<wire::TriggeredRecord>& one) const {
  const wire::TriggeredRecord& record = one.message;
  const auto& runs = recording_.contents().runs;
  const auto run = runs.find(record.run());
  Rows rows;
  rows.count = record.sample_count();
  rows.session = one.session;
  rows.received_utc_ns = record.received_utc_ns();
  std::vector<std::int64_t> stamps(rows.count);
  std::vector<double> times_s(rows.count);
  const std::int64_t trigger_ns =
      record.trigger_utc_ns() != 0 ? record.trigger_utc_ns() : record.received_utc_ns();
  for (std::size_t i = 0; i < rows.count; ++i) {
    times_s[i] = record.first_sample_s() + static_cast<double>(i) * record.interval_s();
    const double after_ns = std::clamp(times_s[i] * 1e9, -1e18, 1e18);
    stamps[i] = trigger_ns + (std::isnan(after_ns) ? 0 : std::llround(after_ns));
  }
  rows.columns = {
      std::move(stamps),
      std::move(times_s),
      repeated<std::uint64_t>(rows.count, one.session + 1),
      repeated<std::uint64_t>(rows.count, record.shot()),
      repeated<std::uint64_t>(
          rows.count,
          run == runs.end() ? 0 : static_cast<std::uint64_t>(std::distance(runs.begin(), run) + 1)),
      repeated<std::uint64_t>(rows.count, record.step()),
      repeated<std::uint64_t>(rows.count, std::max<std::uint64_t>(1, record.attempt()))};
  add_channels(rows, channels_, record.values());
  return rows;
}

Expected<void> RowTable::for_each(const std::function<Expected<void>(const Rows&)>& visit) const {
  if (source_.recorded->triggered) {
    return recording_.for_each<wire::TriggeredRecord>(
        source_, [&](const InOrder<wire::TriggeredRecord>& one) { return visit(rows_of(one)); });
  }
  return recording_.for_each<wire::SampleBlock>(
      source_, [&](const InOrder<wire::SampleBlock>& one) { return visit(rows_of(one)); });
}

Expected<std::vector<RowTable>> row_tables(const ExportedRecording& recording,
                                           const std::vector<std::string>& channels) {
  std::vector<std::string> known;
  std::set<std::string> unknown(channels.begin(), channels.end());
  std::vector<RowTable> tables;
  for (const ExportedSource& source : recording.sources()) {
    std::vector<std::size_t> wanted;
    for (std::size_t i = 0; i < source.channels.size(); ++i) {
      const std::string name = fmt::format("{}/{}", source.name, source.channels[i].name);
      known.push_back(name);
      const bool named = std::find(channels.begin(), channels.end(), name) != channels.end() ||
                         std::find(channels.begin(), channels.end(), source.name) != channels.end();
      if (named || channels.empty()) {
        wanted.push_back(i);
      }
      unknown.erase(name);
    }
    unknown.erase(source.name);
    if (!wanted.empty()) {
      tables.emplace_back(recording, source, std::move(wanted));
    }
  }
  if (!unknown.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("unknown channel '{}'; {} has: {}", *unknown.begin(),
                            recording.reader().path().string(), fmt::join(known, ", ")));
  }
  return tables;
}

} // namespace dyncal::inline records
