#ifdef DYNCAL_HAVE_HDF5

#include "services/records/exchange/hdf5_samples.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>

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

hid_t memory_type(const ColumnValues& values) {
  const std::array types{H5T_NATIVE_INT64, H5T_NATIVE_UINT64, H5T_NATIVE_DOUBLE};
  return types.at(values.index());
}

Hdf5Row row_of(const wire::TriggeredRecord& record, RunNumbers& runs, std::uint64_t first_column) {
  return {{"session", record.session()},
          {"shot", record.shot()},
          {"first_column", first_column},
          {"trigger_utc_ns", record.trigger_utc_ns()},
          {"received_utc_ns", record.received_utc_ns()},
          {"first_sample_s", record.first_sample_s()},
          {"interval_s", record.interval_s()},
          {"sample_count", record.sample_count()},
          {"step", record.step()},
          {"attempt", record.attempt()},
          {"run", runs(record.run())}, // by its place in the attribute Runs, from 1; 0: none
          {"acknowledged_run", runs(record.acknowledged_run())},
          {"end_of_stream", record.end_of_stream() ? 1U : 0U}};
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

Hdf5Samples::Hdf5Samples(const RowTable& table, hid_t place)
    : table_(table), group_(make_group(place, table.source().name)) {
  for (const RowColumn& column : table.columns()) {
    waiting_.push_back(column.none);
  }
  open_ = group_.is_open() && describe();
  if (table.source().recorded->triggered) {
    RunNumbers none({});
    shots_ = Hdf5List::create(group_.id(), "Shots", hdf5_type(row_of({}, none, 0)));
    open_ = open_ && shots_.is_open();
  } else {
    open_ = open_ && add_stamps();
  }
  for (const Hdf5Quantity& quantity : quantities_of(table.source().channels)) {
    open_ = open_ && add_quantity(quantity);
  }
}

bool Hdf5Samples::describe() const {
  const hid_t group = group_.id();
  const ExportedSource& source = table_.source();
  const bool written = write_text(group, "Bench", source.bench) &&
                       write_text(group, "Source", source.source) &&
                       write_count(group, "Data_point_number", source.samples) &&
                       write_count(group, "Lost_samples", source.lost);
  if (!written || !source.description) {
    return written;
  }
  const wire::SourceDescription& description = *source.description;
  const bool is_utc = description.time_base() == wire::TIME_BASE_UTC;
  const double rate_hz = description.nominal_rate_hz();
  return write_text(group, "Name", description.device()) &&
         write_text(group, "Serial", description.serial()) &&
         write_text(group, "Firmware", description.firmware()) &&
         write_text(group, "Time_base", is_utc ? "utc" : "local") &&
         write_numbers(group, "Nominal_rate", {&rate_hz, 1});
}

hid_t Hdf5Samples::add_dataset(const std::string& name, hid_t type,
                               std::vector<std::size_t> columns) {
  auto matrix = Hdf5Matrix::create(group_.id(), name, type, columns.size(), table_.rows());
  datasets_.push_back({std::move(columns), std::move(matrix)});
  return datasets_.back().matrix.id();
}

bool Hdf5Samples::add_stamps() {
  struct Stamps {
    const char* column;
    const char* dataset;
    hid_t type;
    const char* unit;
  };
  const auto& description = table_.source().description;
  const bool is_local = description && description->time_base() == wire::TIME_BASE_LOCAL;
  const Stamps all[] = {
      {"t_ns", "Absolutetime", is_local ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT64, "\\nano\\second"},
      {"stamp_uncertainty_ns", "Absolutetime_uncertainty", H5T_NATIVE_UINT32, "\\nano\\second"},
      {"sample_number", "Sample_number", H5T_NATIVE_UINT64, "\\one"},
      {"stamp_flags", "Stamp_flags", H5T_NATIVE_UINT8, "\\one"},
      {"session", "Session", H5T_NATIVE_UINT64, "\\one"}};
  for (const Stamps& one : all) {
    const auto column = std::ranges::find(table_.columns(), one.column, &RowColumn::name);
    const auto place = static_cast<std::size_t>(column - table_.columns().begin());
    const hid_t dataset = add_dataset(one.dataset, one.type, {place});
    const double standard = 1.0;
    if (!datasets_.back().matrix.is_open() || !write_text(dataset, "Unit", one.unit) ||
        (one.type == H5T_NATIVE_UINT32 &&
         !write_numbers(dataset, "Coverage_factor", {&standard, 1}))) {
      return false;
    }
  }
  return true;
}

bool Hdf5Samples::add_quantity(const Hdf5Quantity& quantity) {
  const auto& described = table_.source().channels;
  const std::size_t first_channel = table_.columns().size() - described.size();
  std::vector<std::size_t> columns;
  std::vector<std::string> names;
  std::vector<std::string> physical;
  std::vector<double> steps;
  std::vector<double> minima;
  std::vector<double> maxima;
  std::vector<double> numbers; // in the blocks, from 1
  for (const std::size_t i : quantity.channels) {
    const drivers::ChannelDescription& channel = described[i];
    const double range = channel.maximum - channel.minimum;
    columns.push_back(first_channel + i);
    names.push_back(channel.name);
    physical.push_back(channel.quantity.empty() ? channel.name : channel.quantity);
    steps.push_back(channel.resolution > 0.0 ? std::round(range / channel.resolution) : 0.0);
    minima.push_back(channel.minimum);
    maxima.push_back(channel.maximum);
    numbers.push_back(static_cast<double>(i + 1));
  }
  const hid_t dataset = add_dataset(quantity.name, H5T_NATIVE_DOUBLE, std::move(columns));
  return datasets_.back().matrix.is_open() &&
         write_text(dataset, "Unit", described[quantity.channels.front()].unit) &&
         write_texts(dataset, "Channel", names) &&
         write_numbers(dataset, "Channel_number", numbers) &&
         write_texts(dataset, "Physical_quantity", physical) &&
         write_numbers(dataset, "Resolution", steps) &&
         write_numbers(dataset, "Min_scale", minima) && write_numbers(dataset, "Max_scale", maxima);
}

void Hdf5Samples::add_shot(const wire::TriggeredRecord& record, RunNumbers& runs) {
  append_row(shots_waiting_, row_of(record, runs, columns_));
  ++shot_count_;
}

bool Hdf5Samples::add(const Rows& rows) {
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    std::visit(
        [&](auto& to) {
          const auto& from = std::get<std::decay_t<decltype(to)>>(rows.columns[i]);
          to.insert(to.end(), from.begin(), from.end());
        },
        waiting_[i]);
  }
  columns_ += rows.count;
  buffered_ += rows.count;
  return buffered_ < max_buffered || flush();
}

bool Hdf5Samples::flush() {
  if (buffered_ == 0) {
    return true;
  }
  bool written = shot_count_ == 0 || shots_.append(shots_waiting_.data(), shot_count_);
  for (Dataset& dataset : datasets_) {
    std::string bytes;
    for (const std::size_t column : dataset.columns) {
      std::visit(
          [&](const auto& values) {
            bytes.append(reinterpret_cast<const char*>(values.data()),
                         values.size() * sizeof(values[0]));
          },
          waiting_[column]);
    }
    const hid_t type = memory_type(waiting_[dataset.columns.front()]);
    written = written && dataset.matrix.append(bytes.data(), type, buffered_);
  }
  for (ColumnValues& values : waiting_) {
    std::visit([](auto& one) { one.clear(); }, values);
  }
  shots_waiting_.clear();
  shot_count_ = 0;
  buffered_ = 0;
  return written;
}

} // namespace dyncal::inline records

#endif
