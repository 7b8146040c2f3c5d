#ifdef DYNCAL_HAVE_HDF5

#include "services/exchange/hdf5_columns.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/core.h>

#include "services/recording/recorded_topics.hpp"

namespace dyncal::services {
namespace {

using drivers::files::hdf5_members;

constexpr const char* not_readable = "its samples cannot be read";

Hdf5Handle copy_of(hid_t type) {
  return {H5Tcopy(type), H5Tclose};
}

// The number's name; nothing if there is none.
std::optional<std::string> run_name(std::uint32_t number, const std::vector<std::string>& runs) {
  if (number == 0) {
    return std::string();
  }
  return number <= runs.size() ? std::optional(runs[number - 1]) : std::nullopt;
}

bool is_group(hid_t place, const std::string& group, const std::string& name) {
  const auto members = hdf5_members(place, group);
  return std::find(members.begin(), members.end(), name) != members.end();
}

} // namespace

Hdf5Columns::Hdf5Columns(hid_t group, hid_t rows_place, const std::string& rows_name,
                         bool triggered)
    : bench_(hdf5_text(group, "Bench")), source_(hdf5_text(group, "Source")), triggered_(triggered),
      rows_(rows_place, rows_name, triggered ? hdf5_type<Hdf5Shot>() : hdf5_type<Hdf5Block>(),
            triggered ? sizeof(Hdf5Shot) : sizeof(Hdf5Block)) {
  if (!triggered) {
    const Hdf5Handle stamps(H5Dopen2(group, "Absolutetime", H5P_DEFAULT), H5Dclose);
    const Hdf5Handle type(H5Dget_type(stamps.id()), H5Tclose);
    const bool is_signed = H5Tget_sign(type.id()) == H5T_SGN_2;
    // The bits as they are: those of a negative time, too.
    times_.emplace_back(group, "Absolutetime",
                        copy_of(is_signed ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT64), 8);
    times_.emplace_back(group, "Absolutetime_uncertainty", copy_of(H5T_NATIVE_UINT32), 4);
    times_.emplace_back(group, "Stamp_flags", copy_of(H5T_NATIVE_UINT8), 1);
  }
}

Hdf5Columns::Result<void> Hdf5Columns::find_channels(hid_t group) {
  std::map<std::uint64_t, ChannelPlace> places;
  for (const std::string& name : hdf5_members(group, ".")) {
    const Hdf5Handle dataset(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
    const auto numbers = hdf5_numbers(dataset.id(), "Channel_number");
    if (!dataset.is_open() || numbers.empty()) {
      continue;
    }
    Hdf5Window window(group, name, copy_of(H5T_NATIVE_DOUBLE), sizeof(double));
    if (!window.is_open() || window.rows() != numbers.size()) {
      return tl::unexpected(fmt::format("dataset '{}' cannot be read", name));
    }
    for (std::size_t row = 0; row < numbers.size(); ++row) {
      if (!(numbers[row] >= 1.0 && numbers[row] <= 1e6)) {
        return tl::unexpected(fmt::format("dataset '{}' has no channel numbers", name));
      }
      places[static_cast<std::uint64_t>(numbers[row])] = {quantities_.size(), row};
    }
    quantities_.push_back(std::move(window));
  }
  if (places.empty()) {
    return tl::unexpected(std::string("has no channels"));
  }
  for (const auto& [number, place] : places) {
    if (number != channels_.size() + 1) {
      return tl::unexpected(fmt::format("channel {} is missing", channels_.size() + 1));
    }
    channels_.push_back(place);
  }
  return {};
}

Hdf5Columns::Result<Hdf5Columns> Hdf5Columns::open(hid_t file, const std::string& name) {
  const bool triggered = is_group(file, "TRIGGERED", name);
  if (!triggered && !is_group(file, "RAWDATA", name)) {
    return tl::unexpected(std::string("is neither in RAWDATA nor in TRIGGERED"));
  }
  const std::string place = (triggered ? "TRIGGERED/" : "RAWDATA/") + name;
  const Hdf5Handle group(H5Gopen2(file, place.c_str(), H5P_DEFAULT), H5Gclose);
  const Hdf5Handle tables(H5Gopen2(file, "DYNCAL/Blocks", H5P_DEFAULT), H5Gclose);
  if (!group.is_open() || !tables.is_open()) {
    return tl::unexpected(not_readable);
  }
  Hdf5Columns columns(group.id(), triggered ? group.id() : tables.id(), triggered ? "Shots" : name,
                      triggered);
  if (!columns.rows_.is_open()) {
    return tl::unexpected(not_readable);
  }
  if (auto found = columns.find_channels(group.id()); !found) {
    return tl::unexpected(found.error());
  }
  return columns;
}

Hdf5Columns::Result<std::string> Hdf5Columns::message(std::uint64_t row,
                                                      const std::vector<std::string>& runs) {
  return triggered_ ? record(row, runs) : block(row, runs);
}

Hdf5Columns::Result<std::vector<double>> Hdf5Columns::values(std::uint64_t first,
                                                             std::uint64_t count) {
  std::vector<double> values;
  values.reserve(count * channels_.size());
  for (const ChannelPlace& channel : channels_) {
    const auto* const column = quantities_[channel.quantity].at<double>(first, count, channel.row);
    if (column == nullptr) {
      return tl::unexpected(not_readable);
    }
    values.insert(values.end(), column, column + count);
  }
  return values;
}

Hdf5Columns::Result<std::string> Hdf5Columns::block(std::uint64_t row,
                                                    const std::vector<std::string>& runs) {
  const auto* const found = rows_.at<Hdf5Block>(row, 1);
  if (found == nullptr) {
    return tl::unexpected(std::string("its block is not there"));
  }
  const Hdf5Block one = *found;
  const auto run = run_name(one.acknowledged_run, runs);
  const auto* const stamps = times_[0].at<std::int64_t>(one.first_column, one.sample_count);
  const auto* const u = times_[1].at<std::uint32_t>(one.first_column, one.sample_count);
  const auto* const flags = times_[2].at<std::uint8_t>(one.first_column, one.sample_count);
  auto columns = values(one.first_column, one.sample_count);
  if (!columns || !run || stamps == nullptr || u == nullptr || flags == nullptr) {
    return tl::unexpected(not_readable);
  }
  wire::SampleBlock message;
  message.bench(bench_);
  message.source(source_);
  message.session(one.session);
  message.block(one.block);
  message.first_sample(one.first_sample);
  message.sample_count(one.sample_count);
  message.channel_count(static_cast<std::uint32_t>(channels_.size()));
  message.acknowledged_run(*run);
  message.end_of_stream(one.end_of_stream != 0);
  message.origin_ns(one.origin_ns);
  message.interval_numerator_ns(one.interval_numerator_ns);
  message.interval_denominator(one.interval_denominator);
  if (one.has_stamps != 0) {
    message.stamps_ns().assign(stamps, stamps + one.sample_count);
  }
  if (one.has_uncertainty != 0) {
    message.stamp_uncertainty_ns().assign(u, u + one.sample_count);
  }
  if (one.has_flags != 0) {
    message.stamp_flags().assign(flags, flags + one.sample_count);
  }
  message.values(std::move(*columns));
  message.received_utc_ns(one.received_utc_ns);
  return recording::encode(message);
}

Hdf5Columns::Result<std::string> Hdf5Columns::record(std::uint64_t row,
                                                     const std::vector<std::string>& runs) {
  const auto* const found = rows_.at<Hdf5Shot>(row, 1);
  if (found == nullptr) {
    return tl::unexpected(std::string("its record is not there"));
  }
  const Hdf5Shot one = *found;
  const auto run = run_name(one.run, runs);
  const auto acknowledged = run_name(one.acknowledged_run, runs);
  auto columns = values(one.first_column, one.sample_count);
  if (!columns || !run || !acknowledged) {
    return tl::unexpected(not_readable);
  }
  wire::TriggeredRecord message;
  message.bench(bench_);
  message.source(source_);
  message.session(one.session);
  message.shot(one.shot);
  message.run(*run);
  message.step(one.step);
  message.sample_count(one.sample_count);
  message.channel_count(static_cast<std::uint32_t>(channels_.size()));
  message.acknowledged_run(*acknowledged);
  message.end_of_stream(one.end_of_stream != 0);
  message.trigger_utc_ns(one.trigger_utc_ns);
  message.first_sample_s(one.first_sample_s);
  message.interval_s(one.interval_s);
  message.values(std::move(*columns));
  message.received_utc_ns(one.received_utc_ns);
  message.attempt(one.attempt);
  return recording::encode(message);
}

} // namespace dyncal::services

#endif
