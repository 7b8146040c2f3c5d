#include "drivers/files/joined_reader.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "drivers/files/file_channels.hpp"
#include "drivers/files/file_formats.hpp"

namespace dyncal::drivers::files {
namespace {

std::string text_of(const FileChannel& channel) {
  return channel.path.string() + ":" + channel.name;
}

// Modulo 2^64: stamps of a file may be anything.
std::int64_t difference_ns(std::int64_t later, std::int64_t earlier) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(later) -
                                   static_cast<std::uint64_t>(earlier));
}

bool selects_channels_itself(const FileChannel& channel) {
  return channel.path.extension() == ".tdms" || channel.path.extension() == ".TDMS";
}

template <class Value>
void copy_part(const std::vector<Value>& from, std::size_t first, std::size_t samples,
               std::vector<Value>& to) {
  if (!from.empty()) {
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
    to.assign(begin, begin + static_cast<std::ptrdiff_t>(samples));
  }
}

} // namespace

std::int64_t JoinedReader::Part::stamp_ns(std::size_t ahead) const {
  return block.clock ? block.clock->stamp_ns(sample() + ahead) : block.stamps_ns[used + ahead];
}

Expected<std::unique_ptr<SampleReader>> JoinedReader::open(const FileSettings& settings) {
  std::unique_ptr<JoinedReader> reader(new JoinedReader(settings));
  for (const FileChannel& channel : settings.single) {
    DYNCAL_TRY(auto part, reader->open_part(channel));
    reader->parts_.push_back(std::move(part));
  }
  DYNCAL_TRY(reader->describe());
  return reader;
}

Expected<JoinedReader::Part> JoinedReader::open_part(const FileChannel& channel) const {
  FileSettings own = settings_;
  own.single.clear();
  own.channels.clear();
  own.units.clear();
  own.path = channel.path;
  own.channel = channel.name;
  std::string name = channel.name;
  const bool selects = selects_channels_itself(channel);
  if (const std::size_t slash = name.rfind('/'); !selects && slash != std::string::npos) {
    own.group = name.substr(0, slash);
    name.erase(0, slash + 1);
  }
  DYNCAL_TRY(auto reader, open_file(own));
  Part part{.reader = std::move(reader), .channel = channel};
  const auto& channels = part.reader->description().channels;
  std::string known;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (selects || channels[i].name == name) {
      part.columns.push_back(i);
    }
    known += (known.empty() ? "" : ", ") + channels[i].name;
  }
  if (part.columns.empty()) {
    return fail(ErrorCode::not_found,
                channel.path.string() + ": no channel '" + name + "'; the file has: " + known);
  }
  return part;
}

Expected<void> JoinedReader::describe() {
  std::vector<std::pair<const Part*, ChannelDescription>> all;
  for (const Part& part : parts_) {
    for (const std::size_t column : part.columns) {
      all.emplace_back(&part, part.reader->description().channels[column]);
    }
  }
  std::vector<std::string> names;
  for (const auto& [part, channel] : all) {
    const bool is_unique =
        std::count_if(all.begin(), all.end(), [&, &name = channel.name](const auto& other) {
          return other.second.name == name;
        }) == 1;
    names.push_back(is_unique ? channel.name : part->channel.name);
  }
  DYNCAL_TRY(auto described, describe_file_channels(settings_, names));
  description_ = parts_.front().reader->description();
  for (std::size_t i = 0; i < all.size(); ++i) {
    ChannelDescription& channel = all[i].second;
    channel.name = described.channels[i].name;
    if (const std::string& unit = described.channels[i].unit; !unit.empty()) {
      channel.quantity =
          channel.unit.empty() || channel.unit == unit ? channel.quantity : channel.unit;
      channel.unit = unit;
    }
    described.channels[i] = channel;
  }
  description_.channels = std::move(described.channels);
  return {};
}

// The next block of every part that has none left.
Expected<void> JoinedReader::fill(std::size_t samples) {
  for (Part& part : parts_) {
    if (part.left() == 0) {
      DYNCAL_TRY(part.block, part.reader->read(samples));
      part.used = 0;
    }
  }
  return {};
}

const JoinedReader::Part& JoinedReader::timed() const {
  const auto found =
      std::find_if(parts_.begin(), parts_.end(), [](const Part& part) { return part.is_timed(); });
  return found == parts_.end() ? parts_.front() : *found;
}

Expected<void> JoinedReader::compare(const Part& one, const Part& other,
                                     std::size_t samples) const {
  const auto differ = [&](const std::string& how) {
    return fail(ErrorCode::malformed, text_of(one.channel) + " and " + text_of(other.channel) +
                                          " do not belong together: " + how);
  };
  if (one.left() == 0 || other.left() == 0) {
    const Part& shorter = one.left() == 0 ? one : other;
    return differ(text_of(shorter.channel) + " ends before the other does");
  }
  if (one.sample() != other.sample()) {
    return differ("sample " + std::to_string(one.sample()) + " stands where the other has " +
                  std::to_string(other.sample()));
  }
  const bool both_regular = one.block.clock && other.block.clock;
  const std::size_t step = both_regular ? std::max<std::size_t>(samples - 1, 1) : 1;
  // Without times of its own it is only held against the interval.
  const std::int64_t apart_ns =
      one.is_timed() && other.is_timed() ? 0 : difference_ns(other.stamp_ns(0), one.stamp_ns(0));
  for (std::size_t i = 0; i < samples; i += step) {
    const std::int64_t ns =
        difference_ns(difference_ns(other.stamp_ns(i), one.stamp_ns(i)), apart_ns);
    if (ns != 0) {
      return differ("their times of sample " + std::to_string(one.sample() + i) + " differ by " +
                    std::to_string(ns) + " ns");
    }
  }
  return {};
}

Expected<SampleBlock> JoinedReader::read(std::size_t samples) {
  DYNCAL_TRY(fill(samples));
  SampleBlock block;
  const bool at_end =
      std::all_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.left() == 0; });
  if (at_end) {
    return block;
  }
  block.samples = samples;
  for (const Part& part : parts_) {
    block.samples = std::min(block.samples, part.left());
  }
  const Part& time = timed();
  for (const Part& part : parts_) {
    if (&part != &time) {
      DYNCAL_TRY(compare(time, part, block.samples));
    }
  }
  block.first_sample = time.sample();
  block.clock = time.block.clock;
  copy_part(time.block.stamps_ns, time.used, block.samples, block.stamps_ns);
  copy_part(time.block.stamp_uncertainty_ns, time.used, block.samples, block.stamp_uncertainty_ns);
  copy_part(time.block.flags, time.used, block.samples, block.flags);
  block.values.reserve(block.samples * description_.channels.size());
  for (Part& part : parts_) {
    for (const std::size_t column : part.columns) {
      const auto begin = part.block.values.begin() +
                         static_cast<std::ptrdiff_t>(column * part.block.samples + part.used);
      block.values.insert(block.values.end(), begin,
                          begin + static_cast<std::ptrdiff_t>(block.samples));
    }
    part.used += block.samples;
  }
  return block;
}

} // namespace dyncal::drivers::files
