#ifdef DYNCAL_HAVE_HDF5

#include "services/records/exchange/hdf5_samples.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <set>

#include "services/base/version.hpp"
#include "services/contract/source_block.hpp"

namespace dyncal::inline records {
namespace {

constexpr std::size_t max_buffered = 65536; // columns

// "acceleration_x" and "voltage_1" without what tells them apart, with a capital.
std::string quantity_name(const std::string& channel) {
  std::string name = channel;
  const std::size_t mark = name.rfind('_');
  const std::string behind = mark == std::string::npos ? "" : name.substr(mark + 1);
  const bool is_axis = behind == "x" || behind == "y" || behind == "z";
  const bool is_number = !behind.empty() && behind.size() <= 2 &&
                         std::all_of(behind.begin(), behind.end(),
                                     [](unsigned char c) { return std::isdigit(c) != 0; });
  if ((is_axis || is_number) && mark > 0) {
    name.resize(mark);
  }
  std::replace(name.begin(), name.end(), '/', '_');
  if (name.empty() || name == ".") {
    name = "Channel";
  }
  name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
  return name;
}

template <class T>
void append(std::vector<T>& to, std::span<const T> values, std::size_t count) {
  const std::size_t end = to.size() + count;
  to.insert(to.end(), values.begin(), values.end());
  to.resize(end);
}

} // namespace

std::vector<Hdf5Quantity> quantities_of(const std::vector<drivers::ChannelDescription>& channels) {
  std::set<std::string> taken{"Absolutetime",  "Absolutetime_uncertainty",
                              "Sample_number", "Session",
                              "Stamp_flags",   "Time_ticks"};
  std::vector<Hdf5Quantity> quantities;
  std::vector<std::pair<std::string, std::string>> kinds; // stem and unit
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const std::pair kind(quantity_name(channels[i].name), channels[i].unit);
    const auto known = std::find(kinds.begin(), kinds.end(), kind);
    if (known != kinds.end()) {
      quantities[static_cast<std::size_t>(known - kinds.begin())].channels.push_back(i);
      continue;
    }
    std::string name = kind.first;
    for (int number = 2; !taken.insert(name).second; ++number) {
      name = kind.first + "_" + std::to_string(number);
    }
    kinds.push_back(kind);
    quantities.push_back({name, {i}});
  }
  return quantities;
}

std::uint32_t RunNumbers::operator()(const std::string& name) {
  if (name.empty()) {
    return 0;
  }
  auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) {
    found = names_.insert(names_.end(), name);
  }
  return static_cast<std::uint32_t>(found - names_.begin()) + 1;
}

Hdf5Samples::Hdf5Samples(const ExportedSource& source, hid_t place)
    : group_(make_group(place, source.name)), quantities_(quantities_of(source.channels)),
      triggered_(source.recorded->triggered), channels_waiting_(source.channels.size()) {
  const hid_t group = group_.id();
  if (triggered_) {
    shots_ = Hdf5List::create(group, "Shots", hdf5_type<Hdf5Shot>());
  } else {
    const bool is_local =
        source.description && source.description->time_base() == wire::TIME_BASE_LOCAL;
    stamps_ = Hdf5Matrix::create(
        group, "Absolutetime", is_local ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT64, 1, source.samples);
    uncertainties_ =
        Hdf5Matrix::create(group, "Absolutetime_uncertainty", H5T_NATIVE_UINT32, 1, source.samples);
    numbers_ = Hdf5Matrix::create(group, "Sample_number", H5T_NATIVE_UINT64, 1, source.samples);
    flags_ = Hdf5Matrix::create(group, "Stamp_flags", H5T_NATIVE_UINT8, 1, source.samples);
    sessions_ = Hdf5Matrix::create(group, "Session", H5T_NATIVE_UINT64, 1, source.samples);
  }
  open_ = group_.is_open() && shots_.is_open() == triggered_ && add_quantities(source) &&
          describe(source);
}

bool Hdf5Samples::describe(const ExportedSource& source) const {
  const hid_t group = group_.id();
  bool written = write_text(group, "Bench", source.bench) &&
                 write_text(group, "Source", source.source) &&
                 write_count(group, "Data_point_number", source.samples) &&
                 write_count(group, "Lost_samples", source.lost);
  if (written && source.description) {
    const wire::SourceDescription& description = *source.description;
    const bool is_utc = description.time_base() == wire::TIME_BASE_UTC;
    const double rate_hz = description.nominal_rate_hz();
    written = write_text(group, "Name", description.device()) &&
              write_text(group, "Serial", description.serial()) &&
              write_text(group, "Firmware", description.firmware()) &&
              write_text(group, "Time_base", is_utc ? "utc" : "local") &&
              write_numbers(group, "Nominal_rate", {&rate_hz, 1});
  }
  if (triggered_ || !written) {
    return written;
  }
  const double standard = 1.0;
  return stamps_.is_open() && uncertainties_.is_open() && numbers_.is_open() &&
         sessions_.is_open() && flags_.is_open() &&
         write_text(stamps_.id(), "Unit", "\\nano\\second") &&
         write_text(uncertainties_.id(), "Unit", "\\nano\\second") &&
         write_numbers(uncertainties_.id(), "Coverage_factor", {&standard, 1}) &&
         write_text(numbers_.id(), "Unit", "\\one") &&
         write_text(sessions_.id(), "Unit", "\\one") && write_text(flags_.id(), "Unit", "\\one");
}

bool Hdf5Samples::add_quantities(const ExportedSource& source) {
  for (const Hdf5Quantity& quantity : quantities_) {
    values_.push_back(Hdf5Matrix::create(group_.id(), quantity.name, H5T_NATIVE_DOUBLE,
                                         quantity.channels.size(), source.samples));
    std::vector<std::string> names;
    std::vector<std::string> physical;
    std::vector<double> steps;
    std::vector<double> minima;
    std::vector<double> maxima;
    std::vector<double> numbers; // in the blocks, from 1
    for (const std::size_t i : quantity.channels) {
      const drivers::ChannelDescription& channel = source.channels[i];
      const double range = channel.maximum - channel.minimum;
      names.push_back(channel.name);
      physical.push_back(channel.quantity.empty() ? channel.name : channel.quantity);
      steps.push_back(channel.resolution > 0.0 ? std::round(range / channel.resolution) : 0.0);
      minima.push_back(channel.minimum);
      maxima.push_back(channel.maximum);
      numbers.push_back(static_cast<double>(i + 1));
    }
    const hid_t dataset = values_.back().id();
    if (!values_.back().is_open() ||
        !write_text(dataset, "Unit", source.channels[quantity.channels.front()].unit) ||
        !write_texts(dataset, "Channel", names) ||
        !write_numbers(dataset, "Channel_number", numbers) ||
        !write_texts(dataset, "Physical_quantity", physical) ||
        !write_numbers(dataset, "Resolution", steps) ||
        !write_numbers(dataset, "Min_scale", minima) ||
        !write_numbers(dataset, "Max_scale", maxima)) {
      return false;
    }
  }
  return true;
}

void Hdf5Samples::add_values(std::span<const double> values, std::size_t samples) {
  for (std::size_t channel = 0; channel < channels_waiting_.size(); ++channel) {
    append(channels_waiting_[channel], values.subspan(channel * samples, samples), samples);
  }
  columns_ += samples;
  buffered_ += samples;
}

bool Hdf5Samples::add(const InOrder<wire::SampleBlock>& one) {
  const SourceBlock block = view_block(one.message);
  append(stamps_waiting_, block.stamps_ns, block.stamps_ns.size());
  for (std::size_t i = block.stamps_ns.size(); i < block.samples; ++i) {
    stamps_waiting_.push_back(block.clock.stamp_ns(block.first_sample + i));
  }
  append(uncertainties_waiting_, block.stamp_uncertainty_ns, block.samples);
  append(flags_waiting_, block.flags, block.samples);
  const std::size_t first = numbers_waiting_.size();
  numbers_waiting_.resize(first + block.samples);
  std::iota(numbers_waiting_.begin() + static_cast<std::ptrdiff_t>(first), numbers_waiting_.end(),
            block.first_sample);
  sessions_waiting_.resize(first + block.samples, one.session + 1); // as rows count them
  add_values(block.values, block.samples);
  return flush_if_full();
}

bool Hdf5Samples::add(const InOrder<wire::TriggeredRecord>& one, RunNumbers& runs) {
  const wire::TriggeredRecord& record = one.message;
  Hdf5Shot row;
  row.session = record.session();
  row.shot = record.shot();
  row.first_column = columns_;
  row.trigger_utc_ns = record.trigger_utc_ns();
  row.received_utc_ns = record.received_utc_ns();
  row.first_sample_s = record.first_sample_s();
  row.interval_s = record.interval_s();
  row.sample_count = record.sample_count();
  row.step = record.step();
  row.attempt = record.attempt();
  row.run = runs(record.run());
  row.acknowledged_run = runs(record.acknowledged_run());
  row.end_of_stream = record.end_of_stream() ? 1 : 0;
  shots_waiting_.push_back(row);
  add_values(record.values(), record.sample_count());
  return flush_if_full();
}

bool Hdf5Samples::flush_if_full() {
  return buffered_ < max_buffered || flush();
}

bool Hdf5Samples::flush() {
  if (buffered_ == 0) {
    return true;
  }
  bool written = triggered_ ? shots_.append(shots_waiting_.data(), shots_waiting_.size())
                            : stamps_.append(stamps_waiting_.data(), buffered_) &&
                                  uncertainties_.append(uncertainties_waiting_.data(), buffered_) &&
                                  numbers_.append(numbers_waiting_.data(), buffered_) &&
                                  sessions_.append(sessions_waiting_.data(), buffered_) &&
                                  flags_.append(flags_waiting_.data(), buffered_);
  for (std::size_t i = 0; written && i < quantities_.size(); ++i) {
    std::vector<double> rows;
    for (const std::size_t channel : quantities_[i].channels) {
      rows.insert(rows.end(), channels_waiting_[channel].begin(), channels_waiting_[channel].end());
    }
    written = values_[i].append(rows.data(), buffered_);
  }
  buffered_ = 0;
  stamps_waiting_.clear();
  uncertainties_waiting_.clear();
  numbers_waiting_.clear();
  sessions_waiting_.clear();
  flags_waiting_.clear();
  for (auto& channel : channels_waiting_) {
    channel.clear();
  }
  shots_waiting_.clear();
  return written;
}

} // namespace dyncal::inline records

#endif
