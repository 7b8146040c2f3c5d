#include "drivers/files/tdms_reader.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/files/file_channels.hpp"
#include "drivers/files/tdms/tdms_clock.hpp"

namespace dyncal::drivers::files {
namespace {

std::string full_name(const TdmsChannel& channel) {
  return channel.group + "/" + channel.name;
}

std::string names_of(const TdmsLayout& layout) {
  std::string names;
  for (const TdmsChannel& channel : layout.channels) {
    names += (names.empty() ? "" : ", ") + full_name(channel);
  }
  return names.empty() ? "none" : names;
}

bool is_asked_for(const TdmsChannel& channel, const FileSettings& settings) {
  if (!settings.channel.empty()) {
    return settings.channel == full_name(channel) || settings.channel == channel.name;
  }
  return (settings.group.empty() || settings.group == channel.group) && channel.values > 0 &&
         is_number(channel.type);
}

} // namespace

Expected<std::unique_ptr<TdmsReader>> TdmsReader::open(const FileSettings& settings) {
  DYNCAL_TRY(auto file, MappedFile::open(settings.path));
  std::unique_ptr<TdmsReader> reader(new TdmsReader(settings, std::move(file)));
  auto layout = TdmsLayout::of(reader->file_.text());
  if (!layout) {
    return reader->malformed(layout.error());
  }
  reader->layout_ = std::move(*layout);
  DYNCAL_TRY(reader->choose_channels());
  DYNCAL_TRY(reader->find_clock());
  DYNCAL_TRY(reader->check_restarts());
  DYNCAL_TRY(reader->add_columns());
  return reader;
}

tl::unexpected<Error> TdmsReader::malformed(const std::string& problem) const {
  return fail(ErrorCode::malformed, settings_.path.string() + ": " + problem);
}

tl::unexpected<Error> TdmsReader::not_equal(const std::string& what, std::size_t chosen) const {
  return malformed("channels " + full_name(channel(0)) + " and " + full_name(channel(chosen)) +
                   " do not have " + what +
                   "; name the group whose channels belong together (group), or single channels "
                   "(path = \"FILE:GROUP/CHANNEL\")");
}

Expected<void> TdmsReader::choose_channels() {
  for (std::size_t i = 0; i < layout_.channels.size(); ++i) {
    if (is_asked_for(layout_.channels[i], settings_)) {
      chosen_.push_back(i);
    }
  }
  const std::string asked = !settings_.channel.empty() ? "channel '" + settings_.channel + "'"
                            : !settings_.group.empty()
                                ? "channel with numbers in the group '" + settings_.group + "'"
                                : "channel with numbers";
  if (chosen_.empty()) {
    return fail(ErrorCode::not_found,
                settings_.path.string() + ": no " + asked + "; the file has: " + names_of(layout_));
  }
  if (!settings_.channel.empty() && chosen_.size() > 1) {
    return fail(ErrorCode::invalid_setting, settings_.path.string() + ": several groups have a " +
                                                asked + "; name the group before it, as in " +
                                                full_name(channel(0)));
  }
  samples_ = channel(0).values;
  if (!is_number(channel(0).type) || samples_ == 0) { // only where it is named
    return malformed("channel " + full_name(channel(0)) + " holds no numbers");
  }
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    if (channel(i).values != samples_) {
      return not_equal("as many values (" + std::to_string(samples_) + " and " +
                           std::to_string(channel(i).values) + ")",
                       i);
    }
  }
  return {};
}

Expected<void> TdmsReader::find_clock() {
  std::optional<double> increment_s;
  std::optional<std::int64_t> start_ns;
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const TdmsProperties& properties = channel(i).properties;
    const auto own_increment_s = number_in(properties, "wf_increment");
    const auto own_start_ns = tdms_start_ns(properties);
    if (increment_s && own_increment_s && *own_increment_s != *increment_s &&
        !settings_.sample_rate) {
      return not_equal("one interval (wf_increment)", i);
    }
    if (start_ns && own_start_ns && *own_start_ns != *start_ns) {
      return not_equal("one start (wf_start_time, wf_start_offset)", i);
    }
    increment_s = increment_s ? increment_s : own_increment_s;
    start_ns = start_ns ? start_ns : own_start_ns;
  }
  if (settings_.sample_rate) {
    clock_ = settings_.sample_rate->clock(0);
  } else if (!increment_s) {
    return fail(ErrorCode::invalid_setting,
                settings_.path.string() +
                    ": its channels state no interval (wf_increment), and no sample rate is given "
                    "(sample_rate_hz of the source in a bench file, --nominal-rate of a command)");
  } else if (const auto interval = tdms_interval(*increment_s)) {
    clock_ = *interval;
  } else {
    return malformed("channel " + full_name(channel(0)) + " states an interval of " +
                     std::to_string(*increment_s) + " s (wf_increment)");
  }
  clock_.origin_ns = start_ns.value_or(0);
  return holds_stamps(clock_, samples_)
             ? Expected<void>()
             : malformed("its last values have times beyond the year 2262");
}

Expected<void> TdmsReader::check_restarts() const {
  for (const TdmsRestart& restart : layout_.restarts) {
    if (std::find(chosen_.begin(), chosen_.end(), restart.channel) == chosen_.end()) {
      continue;
    }
    const TdmsProperties& properties = layout_.channels[restart.channel].properties;
    const auto first = properties.find("wf_start_time");
    const auto* first_time =
        first == properties.end() ? nullptr : std::get_if<TdmsTime>(&first->second);
    const std::int64_t first_ns = first_time == nullptr ? 0 : first_time->unix_ns;
    const double since_s =
        1e-9 * (static_cast<double>(restart.unix_ns) - static_cast<double>(first_ns));
    const double interval_s = 1e-9 * static_cast<double>(clock_.interval_numerator_ns) /
                              static_cast<double>(clock_.interval_denominator);
    const bool is_as_counted =
        std::abs(since_s - static_cast<double>(restart.values) * interval_s) <= 0.5 * interval_s;
    if (first_time == nullptr || (restart.unix_ns != first_ns && !is_as_counted)) {
      return malformed("channel " + full_name(layout_.channels[restart.channel]) +
                       " states another start before value " + std::to_string(restart.values) +
                       ", " + std::to_string(since_s) +
                       " s after the first: a second recording was appended; give each a file of "
                       "its own");
    }
  }
  return {};
}

// Two of a channel of complex numbers, one otherwise.
Expected<std::vector<std::vector<ValueStretch>>>
TdmsReader::stretches_of(const TdmsChannel& channel, const TdmsScaling& scaling) const {
  const auto found = channel.data.find(scaling.scaler());
  if (found == channel.data.end()) {
    return malformed("channel " + full_name(channel) +
                     (scaling.scaler() == tdms_raw_input
                          ? " has raw data of DAQmx without a scaling; let LabVIEW write it"
                          : " is scaled of raw data of DAQmx that it does not have"));
  }
  std::uint64_t values = 0;
  for (const ValueStretch& stretch : found->second) {
    values += stretch.values * stretch.chunks;
  }
  if (values != samples_) {
    return malformed("channel " + full_name(channel) + " is scaled of raw data that has " +
                     std::to_string(values) + " of its " + std::to_string(samples_) + " values");
  }
  if (!is_complex(channel.type)) {
    return std::vector<std::vector<ValueStretch>>{found->second};
  }
  if (!scaling.is_none()) {
    return malformed("channel " + full_name(channel) +
                     " has a scaling for complex numbers, which is not known here");
  }
  std::vector<std::vector<ValueStretch>> both(2, found->second);
  for (std::size_t part = 0; part < both.size(); ++part) {
    for (ValueStretch& stretch : both[part]) {
      const bool is_single = stretch.type == TdmsType::complex_f32;
      stretch.type = is_single ? TdmsType::f32 : TdmsType::f64;
      stretch.place += part * *size_of(stretch.type);
    }
  }
  return both;
}

Expected<void> TdmsReader::add_columns() {
  std::vector<std::string> names;
  std::vector<std::string> units;
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const TdmsChannel& one = channel(i);
    auto scaling = TdmsScaling::of(one.properties, layout_.groups[one.group], layout_.properties);
    if (!scaling) {
      return malformed("channel " + full_name(one) + " " + scaling.error());
    }
    DYNCAL_TRY(auto parts, stretches_of(one, *scaling));
    const bool is_unique = std::count_if(chosen_.begin(), chosen_.end(), [&](std::size_t other) {
                             return layout_.channels[other].name == one.name;
                           }) == 1;
    const std::string name = is_unique ? one.name : full_name(one);
    for (std::size_t part = 0; part < parts.size(); ++part) {
      const std::string ending = parts.size() == 1 ? "" : part == 0 ? "_i" : "_q";
      names.push_back(name + ending);
      units.push_back(text_in(one.properties, "unit_string"));
      columns_.push_back({StridedValues(file_.text(), std::move(parts[part])), *scaling});
    }
  }
  DYNCAL_TRY(description_, describe_file_channels(settings_, names));
  for (std::size_t i = 0; i < units.size(); ++i) {
    ChannelDescription& described = description_.channels[i];
    if (described.unit.empty()) {
      described.unit = units[i];
    } else if (!units[i].empty() && described.unit != units[i]) {
      described.quantity = units[i];
    }
  }
  description_.nominal_rate_hz = 1e9 * static_cast<double>(clock_.interval_denominator) /
                                 static_cast<double>(clock_.interval_numerator_ns);
  return {};
}

double TdmsReader::share_read() const {
  return static_cast<double>(next_sample_) / static_cast<double>(samples_);
}

Expected<SampleBlock> TdmsReader::read(std::size_t samples) {
  SampleBlock block;
  block.first_sample = next_sample_;
  block.samples =
      static_cast<std::size_t>(std::min<std::uint64_t>(samples, samples_ - next_sample_));
  block.clock = clock_;
  block.values.resize(block.samples * columns_.size());
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::span<double> values(block.values.data() + i * block.samples, block.samples);
    columns_[i].values.read(values);
    columns_[i].scaling.apply(values);
  }
  next_sample_ += block.samples;
  return block;
}

} // namespace dyncal::drivers::files
