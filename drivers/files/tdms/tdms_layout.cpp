#include "drivers/files/tdms/tdms_layout.hpp"

#include <optional>
#include <utility>

#include "drivers/files/tdms/tdms_raw_data.hpp"

namespace dyncal::drivers::files {
namespace {

constexpr std::size_t lead_in_bytes = 28;
constexpr std::uint64_t never_closed = ~std::uint64_t{0};
constexpr std::uint32_t no_data = 0xFFFFFFFF;
constexpr std::uint32_t as_before = 0;

enum Contents : std::uint32_t { // of a segment
  metadata = 1U << 1U,
  new_objects = 1U << 2U,
  raw_data = 1U << 3U,
  interleaved = 1U << 5U,
  big_endian = 1U << 6U
};

using Outcome = tl::expected<void, std::string>;
using Problem = tl::unexpected<std::string>;

struct LeadIn {
  std::uint32_t contents = 0;
  std::size_t data = 0; // place of the raw data
  std::size_t end = 0;  // of the segment
  bool closed = true;
  bool has_metadata = true; // it was written to its end
};

// The names in "/'group'/'channel'", at most two; nothing where it is no such path.
std::optional<std::vector<std::string>> names_in(std::string_view path) {
  std::vector<std::string> names;
  if (path == "/") {
    return names;
  }
  while (!path.empty()) {
    if (!path.starts_with("/'") || names.size() == 2) {
      return std::nullopt;
    }
    std::string name;
    std::size_t i = 2;
    for (; i < path.size(); ++i) {
      if (path[i] == '\'' && !path.substr(i + 1).starts_with('\'')) {
        break;
      }
      i += path[i] == '\'' ? 1 : 0; // doubled
      name += path[i];
    }
    if (i >= path.size()) {
      return std::nullopt;
    }
    names.push_back(std::move(name));
    path.remove_prefix(i + 1);
  }
  return names.empty() ? std::nullopt : std::optional(names);
}

class LayoutReader {
public:
  explicit LayoutReader(std::string_view file) : file_(file) {}

  tl::expected<TdmsLayout, std::string> read() {
    if (!file_.starts_with("TDSm")) {
      return Problem("is not a TDMS file");
    }
    for (std::size_t place = 0; place < file_.size();) {
      segment_ = "the segment at byte " + std::to_string(place);
      const auto lead_in = read_lead_in(place);
      if (!lead_in) {
        return Problem(lead_in.error());
      }
      if (!lead_in->has_metadata) {
        break; // its program died while it wrote them, and no values came
      }
      if (auto done = read_segment(place + lead_in_bytes, *lead_in); !done) {
        return Problem(done.error());
      }
      place = lead_in->end;
    }
    return std::move(layout_);
  }

private:
  [[nodiscard]] Problem wrong(const std::string& what) const {
    return Problem(segment_ + " " + what);
  }

  [[nodiscard]] tl::expected<LeadIn, std::string> read_lead_in(std::size_t place) const {
    const std::string_view rest = file_.substr(place);
    if (rest.size() < lead_in_bytes) {
      return wrong("is cut within its lead-in; the file is incomplete");
    }
    if (!rest.starts_with("TDSm")) {
      return wrong("does not begin with \"TDSm\"; the file is damaged");
    }
    LeadIn lead_in;
    lead_in.contents = tdms_number_at<std::uint32_t>(rest.data() + 4, false);
    const bool big = (lead_in.contents & big_endian) != 0;
    const auto next = tdms_number_at<std::uint64_t>(rest.data() + 12, big);
    const auto data = tdms_number_at<std::uint64_t>(rest.data() + 20, big);
    const std::size_t left = rest.size() - lead_in_bytes;
    lead_in.closed = next != never_closed;
    if (lead_in.closed && next > left) {
      return wrong("has " + std::to_string(next) + " bytes, but the file ends after " +
                   std::to_string(left) + " of them; it is incomplete");
    }
    if (lead_in.closed && data > next) {
      return wrong("has raw data that begin behind its end; the file is damaged");
    }
    lead_in.has_metadata = data <= left;
    lead_in.end = lead_in.closed ? place + lead_in_bytes + next : file_.size();
    lead_in.data = lead_in.has_metadata ? place + lead_in_bytes + data : file_.size();
    return lead_in;
  }

  Outcome read_segment(std::size_t place, const LeadIn& lead_in) {
    if ((lead_in.contents & metadata) != 0) {
      if ((lead_in.contents & new_objects) != 0) {
        active_.clear();
        place_of_active_.clear();
      }
      TdmsCursor cursor(file_, place, lead_in.data, (lead_in.contents & big_endian) != 0);
      for (auto left = cursor.number<std::uint32_t>(); left > 0 && !cursor.failed(); --left) {
        if (auto done = read_object(cursor); !done) {
          return done;
        }
      }
      if (cursor.failed()) {
        return wrong("has metadata that do not end before its raw data; the file is damaged");
      }
    }
    return (lead_in.contents & raw_data) == 0 ? Outcome() : place_raw_data(lead_in);
  }

  Outcome read_object(TdmsCursor& cursor) {
    const std::string path = cursor.text();
    if (cursor.failed()) {
      return {};
    }
    const auto names = names_in(path);
    if (!names) {
      return wrong("has an object \"" + path + "\", which is no path of a TDMS file");
    }
    std::optional<std::size_t> channel;
    if (names->size() == 2) {
      channel = channel_of(path, *names);
    }
    if (auto done = read_data_index(cursor, path, channel); !done) {
      return done;
    }
    return read_properties(cursor, *names, channel);
  }

  std::size_t channel_of(const std::string& path, const std::vector<std::string>& names) {
    const auto [found, is_new] = place_of_channel_.emplace(path, layout_.channels.size());
    if (is_new) {
      layout_.channels.push_back({.group = names[0], .name = names[1]});
      last_index_.emplace_back();
    }
    return found->second;
  }

  // Which channels have data in this segment, in their order, is kept for the next.
  Outcome read_data_index(TdmsCursor& cursor, const std::string& path,
                          std::optional<std::size_t> channel) {
    const auto header = cursor.number<std::uint32_t>();
    if (cursor.failed() || (!channel && header == no_data)) {
      return {};
    }
    if (!channel) {
      return wrong("has raw data of \"" + path + "\", which is no channel");
    }
    const auto [found, is_new] = place_of_active_.emplace(*channel, active_.size());
    if (is_new) {
      active_.push_back({*channel, false});
    }
    bool& has_data = active_[found->second].second;
    has_data = header != no_data;
    std::optional<TdmsIndex>& index = last_index_[*channel];
    if (header != no_data && header != as_before) {
      auto read = read_tdms_index(cursor, header);
      if (!read) {
        return wrong("and its channel \"" + path + "\": it " + read.error());
      }
      TdmsType& type = layout_.channels[*channel].type;
      if (type != TdmsType::none && type != read->type) {
        return wrong("changes the type of the values of \"" + path + "\"");
      }
      type = read->type;
      index = std::move(*read);
    }
    return has_data && !index
               ? wrong("has data of \"" + path + "\" as before, but none came before")
               : Outcome();
  }

  Outcome read_properties(TdmsCursor& cursor, const std::vector<std::string>& names,
                          std::optional<std::size_t> channel) {
    TdmsProperties& properties = names.empty()       ? layout_.properties
                                 : names.size() == 1 ? layout_.groups[names[0]]
                                                     : layout_.channels[*channel].properties;
    for (auto left = cursor.number<std::uint32_t>(); left > 0 && !cursor.failed(); --left) {
      const std::string name = cursor.text();
      const auto type = cursor.number<std::uint32_t>();
      if (cursor.failed()) {
        return {};
      }
      auto value = read_tdms_value(cursor, static_cast<TdmsType>(type));
      if (!value) {
        return wrong("has a property \"" + name + "\" of type " + std::to_string(type) +
                     " that cannot be read");
      }
      const auto* start = name == "wf_start_time" ? std::get_if<TdmsTime>(&*value) : nullptr;
      if (channel && start != nullptr && layout_.channels[*channel].values > 0) {
        // That of the first values stays; the reader holds this one against it.
        layout_.restarts.push_back({*channel, layout_.channels[*channel].values, start->unix_ns});
      } else {
        properties[name] = std::move(*value);
      }
    }
    return {};
  }

  Outcome place_raw_data(const LeadIn& lead_in) {
    std::vector<TdmsPlacedChannel> channels;
    for (const auto& [channel, has_data] : active_) {
      if (has_data) {
        channels.push_back({&layout_.channels[channel], &*last_index_[channel]});
      }
    }
    const auto placed =
        place_tdms_data(channels, {.place = lead_in.data,
                                   .bytes = lead_in.end - lead_in.data,
                                   .big_endian = (lead_in.contents & big_endian) != 0,
                                   .interleaved = (lead_in.contents & interleaved) != 0,
                                   .closed = lead_in.closed});
    return placed ? Outcome() : wrong(placed.error());
  }

  std::string_view file_;
  std::string segment_; // which one, for messages
  TdmsLayout layout_;
  std::map<std::string, std::size_t> place_of_channel_;
  std::vector<std::optional<TdmsIndex>> last_index_; // of every channel
  std::vector<std::pair<std::size_t, bool>> active_; // channels of the segment: have they data?
  std::map<std::size_t, std::size_t> place_of_active_;
};

} // namespace

tl::expected<TdmsLayout, std::string> TdmsLayout::of(std::string_view file) {
  return LayoutReader(file).read();
}

} // namespace dyncal::drivers::files
