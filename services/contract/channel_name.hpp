// The name of a channel on a bench, "source/channel", as roles in the bench file and results on the
// bus give it. Plain data; any thread.
#pragma once

#include <optional>
#include <string>

namespace dyncal::inline contract {

struct ChannelName {
  std::string source;
  std::string channel;

  [[nodiscard]] std::string text() const { return source + "/" + channel; }
  friend bool operator==(const ChannelName&, const ChannelName&) = default;
};

// Splits "source/channel"; nothing when it is not of that form.
[[nodiscard]] std::optional<ChannelName> parse_channel_name(const std::string& text);

} // namespace dyncal::inline contract
