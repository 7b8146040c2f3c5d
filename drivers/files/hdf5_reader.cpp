#include "drivers/files/hdf5_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "drivers/files/file_channels.hpp"
#include "drivers/files/receiver_channels.hpp"
#include "drivers/files/regular_stamps.hpp"

namespace dyncal::drivers::files {
namespace {

constexpr std::size_t max_channels = 1024; // of a dataset
constexpr std::size_t max_samples = 65536; // at once
constexpr std::uint64_t numbers_of_unit = std::uint64_t{1} << 32U;

bool is_of_time(const std::string& name) {
  static const std::set<std::string> names{"Absolutetime", "Absolutetime_uncertainty",
                                           "Sample_number", "Stamp_flags", "Time_ticks"};
  return names.contains(name);
}

// An attribute of as many numbers as the dataset has channels, or of one for all.
std::vector<double> numbers_of(hid_t object, const char* name, std::size_t channels) {
  std::vector<double> numbers;
  if (H5Aexists(object, name) > 0) {
    const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
    const H5T_class_t kind = H5Tget_class(type.id());
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    if ((kind == H5T_FLOAT || kind == H5T_INTEGER) &&
        (count == 1 || count == static_cast<hssize_t>(channels))) {
      numbers.resize(static_cast<std::size_t>(count));
      if (H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, numbers.data()) < 0) {
        numbers.clear();
      }
    }
  }
  numbers.resize(channels, numbers.size() == 1 ? numbers.front() : 0.0);
  for (double& number : numbers) {
    number = std::isfinite(number) ? number : 0.0;
  }
  return numbers;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

} // namespace

Expected<std::unique_ptr<Hdf5Reader>> Hdf5Reader::open(const FileSettings& settings) {
  std::unique_ptr<Hdf5Reader> reader(new Hdf5Reader(settings));
  const auto opened = [&]() -> Expected<void> {
    const Hdf5Lock lock;
    return reader->open_file()
        .and_then([&] { return reader->open_quantities(); })
        .and_then([&] { return reader->describe(); })
        .and_then([&] { return reader->find_end(); });
  }();
  DYNCAL_TRY(opened);
  return reader;
}

Hdf5Reader::~Hdf5Reader() {
  const Hdf5Lock lock;
  quantities_.clear();
  flags_.reset();
  for (Hdf5Handle* handle :
       {&numbers_.dataset, &uncertainties_.dataset, &stamps_.dataset, &group_, &file_}) {
    handle->close();
  }
}

tl::unexpected<Error> Hdf5Reader::malformed(const std::string& problem) const {
  return fail(ErrorCode::malformed,
              settings_.path.string() + ": " + (place_.empty() ? "" : place_ + ": ") + problem);
}

Expected<std::string> Hdf5Reader::group_name() const {
  const auto groups = hdf5_members(file_.id(), "RAWDATA");
  if (groups.empty()) {
    return malformed("has no group RAWDATA with sensors in it, as the SmartUp receiver writes it");
  }
  if (settings_.group.empty() && groups.size() > 1) {
    return fail(ErrorCode::invalid_setting, settings_.path.string() +
                                                ": has several sensors; name one with the key "
                                                "group: " +
                                                listed(groups));
  }
  const std::string name = settings_.group.empty() ? groups.front() : settings_.group;
  if (std::find(groups.begin(), groups.end(), name) == groups.end()) {
    return fail(ErrorCode::not_found, settings_.path.string() + ": no sensor '" + name +
                                          "' in RAWDATA; it has: " + listed(groups));
  }
  return name;
}

Expected<void> Hdf5Reader::open_file() {
  DYNCAL_TRY(file_, open_hdf5(settings_.path));
  DYNCAL_TRY(const auto name, group_name());
  place_ = "RAWDATA/" + name;
  group_ = Hdf5Handle(H5Gopen2(file_.id(), place_.c_str(), H5P_DEFAULT), H5Gclose);
  return group_.is_open() ? Expected<void>{} : malformed("is not a group");
}

Expected<Hdf5Reader::Quantity> Hdf5Reader::open_dataset(const std::string& name) const {
  Quantity quantity;
  quantity.name = name;
  if (H5Lexists(group_.id(), name.c_str(), H5P_DEFAULT) > 0) {
    quantity.dataset = Hdf5Handle(H5Dopen2(group_.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
  }
  if (!quantity.dataset.is_open()) {
    return malformed("has no dataset " + name);
  }
  if (const std::string filter = hdf5_missing_filter(quantity.dataset.id()); !filter.empty()) {
    return fail(
        ErrorCode::invalid_setting,
        settings_.path.string() + ": " + place_ + ": " + name + " is stored with the HDF5 filter " +
            filter +
            ", which this HDF5 library does not have; write it again with gzip, as 'h5repack "
            "-f GZIP=4' does where the filter is known");
  }
  const Hdf5Handle type(H5Dget_type(quantity.dataset.id()), H5Tclose);
  const Hdf5Handle space(H5Dget_space(quantity.dataset.id()), H5Sclose);
  const H5T_class_t kind = H5Tget_class(type.id());
  const int dimensions = H5Sget_simple_extent_ndims(space.id());
  std::array<hsize_t, 2> size{1, 1};
  if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || dimensions < 1 || dimensions > 2 ||
      H5Sget_simple_extent_dims(space.id(), size.data() + (dimensions == 1 ? 1 : 0), nullptr) < 0) {
    return malformed(name + " is not a matrix of numbers, channels x samples");
  }
  if (size[0] < 1 || size[0] > max_channels) {
    return malformed(name + " has " + std::to_string(size[0]) + " channels");
  }
  if (columns_ != 0 && size[1] != columns_) {
    return malformed(name + " has " + std::to_string(size[1]) + " samples and Absolutetime " +
                     std::to_string(columns_));
  }
  quantity.rows = size[0];
  quantity.is_list = dimensions == 1;
  return quantity;
}

Expected<void> Hdf5Reader::open_quantities() {
  for (const auto& [name, quantity] :
       {std::pair("Absolutetime", &stamps_), std::pair("Absolutetime_uncertainty", &uncertainties_),
        std::pair("Sample_number", &numbers_)}) {
    DYNCAL_TRY(auto opened, open_dataset(name));
    *quantity = std::move(opened);
    const Hdf5Handle space(H5Dget_space(quantity->dataset.id()), H5Sclose);
    const hssize_t points = H5Sget_simple_extent_npoints(space.id());
    if (quantity->rows != 1 || points <= 0) {
      return malformed(std::string(name) + " must be one row with at least one sample");
    }
    columns_ = static_cast<std::uint64_t>(points);
  }
  has_standard_uncertainties_ =
      numbers_of(uncertainties_.dataset.id(), "Coverage_factor", 1).front() == 1.0;
  for (const std::string& name : hdf5_members(group_.id(), ".")) {
    if (is_of_time(name) && name != "Stamp_flags") {
      continue;
    }
    DYNCAL_TRY(auto opened, open_dataset(name));
    if (name == "Stamp_flags") {
      flags_ = std::move(opened);
    } else {
      quantities_.push_back(std::move(opened));
    }
  }
  return flags_ && flags_->rows != 1 ? Expected<void>(malformed("Stamp_flags must be one row"))
                                     : Expected<void>{};
}

Expected<void> Hdf5Reader::describe() {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities_) {
    for (std::size_t i = 0; i < quantity.rows; ++i) {
      names.push_back(receiver_channel(quantity.name, i, quantity.rows));
    }
  }
  if (names.empty()) {
    return malformed("has no dataset with channels");
  }
  DYNCAL_TRY(description_, describe_file_channels(settings_, names));
  description_.device = hdf5_text(group_.id(), "Name");
  description_.serial = hdf5_text(group_.id(), "Serial");
  description_.stamp_instant = StampInstant::data_ready_edge;
  std::size_t channel = 0;
  for (const Quantity& quantity : quantities_) {
    const hid_t dataset = quantity.dataset.id();
    const std::string unit = hdf5_text(dataset, "Unit");
    const auto steps = numbers_of(dataset, "Resolution", quantity.rows);
    const auto minima = numbers_of(dataset, "Min_scale", quantity.rows);
    const auto maxima = numbers_of(dataset, "Max_scale", quantity.rows);
    for (std::size_t i = 0; i < quantity.rows; ++i) {
      ChannelDescription& one = description_.channels[channel++];
      one.quantity = !one.unit.empty() && one.unit != unit ? unit : one.quantity;
      one.unit = one.unit.empty() ? unit : one.unit;
      one.minimum = minima[i];
      one.maximum = maxima[i];
      one.resolution = steps[i] > 0.0 ? (maxima[i] - minima[i]) / steps[i] : 0.0;
    }
  }
  return {};
}

template <class Number>
Expected<std::vector<Number>> Hdf5Reader::numbers(const Quantity& quantity, hid_t type,
                                                  std::uint64_t first, std::size_t samples) const {
  std::vector<Number> numbers(quantity.rows * samples);
  const std::array<hsize_t, 2> start{0, first};
  const std::array<hsize_t, 2> size{quantity.rows, samples};
  const int skipped = quantity.is_list ? 1 : 0;
  const Hdf5Handle space(H5Dget_space(quantity.dataset.id()), H5Sclose);
  const Hdf5Handle memory(H5Screate_simple(2 - skipped, size.data() + skipped, nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data() + skipped, nullptr,
                          size.data() + skipped, nullptr) < 0 ||
      H5Dread(quantity.dataset.id(), type, memory.id(), space.id(), H5P_DEFAULT, numbers.data()) <
          0) {
    return malformed(quantity.name + " is damaged between samples " + std::to_string(first + 1) +
                     " and " + std::to_string(first + samples));
  }
  return numbers;
}

Expected<void> Hdf5Reader::find_end() {
  for (end_ = columns_; end_ > 0;) {
    const auto samples = static_cast<std::size_t>(std::min<std::uint64_t>(end_, max_samples));
    DYNCAL_TRY(const auto times,
               numbers<std::uint64_t>(stamps_, H5T_NATIVE_UINT64, end_ - samples, samples));
    const auto last =
        std::find_if(times.rbegin(), times.rend(), [](auto time) { return time != 0; });
    end_ -= static_cast<std::uint64_t>(last - times.rbegin());
    if (last != times.rend()) {
      return {};
    }
  }
  return malformed("holds no samples: all times are 0");
}

Expected<void> Hdf5Reader::number(SampleBlock& block) {
  DYNCAL_TRY(auto sent, numbers<std::uint64_t>(numbers_, H5T_NATIVE_UINT64, row_, block.samples));
  for (std::size_t i = 0; i < block.samples; ++i) {
    std::uint64_t sample = sent[i];
    if (last_sample_) {
      // The 32 bits of the unit, counted on.
      const std::uint64_t turns = *last_sample_ / numbers_of_unit;
      const bool wrapped =
          *last_sample_ % numbers_of_unit > numbers_of_unit / 4 * 3 && sample < numbers_of_unit / 4;
      sample += sample < numbers_of_unit ? (turns + (wrapped ? 1 : 0)) * numbers_of_unit : 0;
      if (sample <= *last_sample_) {
        return malformed("sample " + std::to_string(row_ + i + 1) + ": " +
                         not_rising(sample, *last_sample_));
      }
      if (i > 0 && sample != *last_sample_ + 1) {
        block.samples = i;
        return {};
      }
    }
    if (i == 0) {
      block.first_sample = sample;
    }
    last_sample_ = sample;
  }
  return {};
}

double Hdf5Reader::share_read() const {
  return static_cast<double>(row_) / static_cast<double>(end_);
}

Expected<SampleBlock> Hdf5Reader::read(std::size_t samples) {
  SampleBlock block;
  block.samples =
      static_cast<std::size_t>(std::min<std::uint64_t>({samples, max_samples, end_ - row_}));
  if (block.samples == 0) {
    return block;
  }
  const Hdf5Lock lock;
  DYNCAL_TRY(number(block));
  auto stamps = numbers<std::int64_t>(stamps_, H5T_NATIVE_INT64, row_, block.samples);
  auto u = numbers<std::uint32_t>(uncertainties_, H5T_NATIVE_UINT32, row_, block.samples);
  if (!stamps || !u) {
    return fail(stamps ? u.error() : stamps.error());
  }
  block.stamps_ns = std::move(*stamps);
  block.stamp_uncertainty_ns = std::move(*u);
  if (!has_standard_uncertainties_) {
    std::transform(block.stamp_uncertainty_ns.begin(), block.stamp_uncertainty_ns.end(),
                   block.stamp_uncertainty_ns.begin(), receiver_uncertainty_ns);
  }
  for (const Quantity& quantity : quantities_) {
    DYNCAL_TRY(const auto values,
               numbers<double>(quantity, H5T_NATIVE_DOUBLE, row_, block.samples));
    block.values.insert(block.values.end(), values.begin(), values.end());
  }
  order_.check(block);
  if (flags_) {
    DYNCAL_TRY(const auto flags,
               numbers<std::uint8_t>(*flags_, H5T_NATIVE_UINT8, row_, block.samples));
    if (std::any_of(flags.begin(), flags.end(), [](auto flag) { return flag != 0; })) {
      block.flags.resize(block.samples);
      std::transform(
          flags.begin(), flags.end(), block.flags.begin(), block.flags.begin(),
          [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a | b); });
    }
  } else {
    flag_receiver_stamps(block);
  }
  row_ += block.samples;
  make_regular(block);
  return block;
}

} // namespace dyncal::drivers::files
