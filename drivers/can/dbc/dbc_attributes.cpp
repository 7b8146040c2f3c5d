// The attributes of a DBC file that change how its frames are read: BA_DEF_, BA_DEF_DEF_, BA_.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "drivers/can/dbc/dbc_parser.hpp"

namespace dyncal::drivers::can {

namespace {

constexpr std::string_view format_attribute = "VFrameFormat";

// The numbers that the makers of the format gave the frame formats, for files that do not list the
// names.
constexpr std::array<std::pair<int, FrameFormat>, 5> standard_formats = {
    {{0, FrameFormat::standard},
     {1, FrameFormat::extended},
     {3, FrameFormat::j1939},
     {14, FrameFormat::standard_fd},
     {15, FrameFormat::extended_fd}}};

std::optional<FrameFormat> format_of_name(std::string_view name) {
  if (name == "StandardCAN") {
    return FrameFormat::standard;
  }
  if (name == "ExtendedCAN") {
    return FrameFormat::extended;
  }
  if (name == "J1939PG") {
    return FrameFormat::j1939;
  }
  if (name == "StandardCAN_FD") {
    return FrameFormat::standard_fd;
  }
  if (name == "ExtendedCAN_FD") {
    return FrameFormat::extended_fd;
  }
  return std::nullopt;
}

} // namespace

void DbcParser::attribute_definition() {
  const std::size_t line = scanner_.line();
  auto name = scanner_.string();
  if (!name) {
    scanner_.name(); // BU_, BO_, SG_, EV_
    name = scanner_.string();
  }
  if (name == format_attribute) {
    format_names_.clear();
    if (scanner_.name() == "ENUM") {
      while (const auto value = scanner_.string()) {
        format_names_.push_back(*value);
        if (!scanner_.character(',')) {
          break;
        }
      }
    }
  } else if (!name) {
    warn(line, "passed over an attribute definition without a name");
  }
  skip_rest("BA_DEF_", line);
}

std::optional<std::pair<std::string, bool>> DbcParser::attribute_value() {
  if (!scanner_.same_line() && scanner_.next_begins_statement()) {
    return std::nullopt;
  }
  if (auto text = scanner_.string()) {
    return std::pair(std::move(*text), true);
  }
  if (auto word = scanner_.name()) {
    return std::pair(std::move(*word), false);
  }
  return std::nullopt;
}

void DbcParser::attribute_default() {
  const std::size_t line = scanner_.line();
  const auto name = scanner_.string();
  auto value = name ? attribute_value() : std::nullopt;
  if (name == format_attribute && value) {
    default_format_ = Attribute{*name, "", 0, "", std::move(value->first), value->second};
  }
  skip_rest("BA_DEF_DEF_", line);
}

void DbcParser::attribute() {
  const std::size_t line = scanner_.line();
  Attribute attribute;
  const auto name = scanner_.string();
  attribute.name = name.value_or("");
  const auto before = scanner_.place();
  const auto object = scanner_.name();
  if (object == "BO_" || object == "SG_") {
    attribute.object = *object;
    const auto id = scanner_.unsigned_integer();
    attribute.id = id.value_or(0);
    if (object == "SG_") {
      attribute.signal = scanner_.name().value_or("");
    }
  } else if (object == "BU_" || object == "EV_") {
    skip_rest("BA_", line);
    return;
  } else {
    scanner_.go_back(before);
  }
  auto value = attribute_value();
  if (!name || !value) {
    warn(line, "passed over an attribute that has no " + std::string(name ? "value" : "name"));
  } else if (!attribute.object.empty()) {
    attribute.value = std::move(value->first);
    attribute.is_text = value->second;
    attributes_.push_back(std::move(attribute));
  }
  skip_rest("BA_", line);
}

std::optional<FrameFormat> DbcParser::frame_format(const Attribute& attribute) const {
  if (attribute.is_text) {
    return format_of_name(attribute.value);
  }
  int number = -1;
  std::from_chars(attribute.value.data(), attribute.value.data() + attribute.value.size(), number);
  if (!format_names_.empty()) {
    return number >= 0 && static_cast<std::size_t>(number) < format_names_.size()
               ? format_of_name(format_names_[static_cast<std::size_t>(number)])
               : std::nullopt;
  }
  const auto* const found =
      std::find_if(standard_formats.begin(), standard_formats.end(),
                   [number](const auto& entry) { return entry.first == number; });
  return found == standard_formats.end() ? std::nullopt : std::optional(found->second);
}

void DbcParser::apply(const Attribute& attribute) {
  PendingMessage* found = pending_message(attribute.id);
  if (found == nullptr) {
    return;
  }
  DbcMessage& message = found->message;
  if (attribute.name == format_attribute) {
    if (const auto format = frame_format(attribute)) {
      message.format = *format;
      format_given_[static_cast<std::size_t>(found - pending_messages_.data())] = true;
    } else {
      warn(message.line, "message '" + message.name + "' has the unknown frame format " +
                             attribute.value + "; taken for an ordinary frame");
    }
  } else if (attribute.name == "GenMsgCycleTime" && attribute.object == "BO_") {
    double milliseconds = 0.0;
    std::from_chars(attribute.value.data(), attribute.value.data() + attribute.value.size(),
                    milliseconds);
    if (std::isfinite(milliseconds) && milliseconds > 0.0) {
      message.cycle_time_s = milliseconds * 1e-3;
    }
  } else if (attribute.name == "SystemMessageLongSymbol" && attribute.object == "BO_" &&
             !attribute.value.empty()) {
    message.name = attribute.value;
  } else if (attribute.name == "SystemSignalLongSymbol" && attribute.object == "SG_" &&
             !attribute.value.empty()) {
    if (const auto index = signal_index(*found, attribute.signal)) {
      message.signals[*index].name = attribute.value;
    }
  }
}

// A default counts for messages that say nothing themselves; only J1939 and FD tell more than the
// id does.
void DbcParser::apply_default_format() {
  const auto format = default_format_ ? frame_format(*default_format_) : std::nullopt;
  for (std::size_t i = 0; i < pending_messages_.size(); ++i) {
    DbcMessage& message = pending_messages_[i].message;
    if (format && !format_given_[i]) {
      message.format = *format;
    }
    // The id decides between 11 and 29 bits, whatever the attribute says.
    if (message.extended && message.format == FrameFormat::standard) {
      message.format = FrameFormat::extended;
    }
    if (message.extended && message.format == FrameFormat::standard_fd) {
      message.format = FrameFormat::extended_fd;
    }
    if (!message.extended &&
        (message.format == FrameFormat::extended || message.format == FrameFormat::j1939)) {
      message.format = FrameFormat::standard;
    }
    if (!message.extended && message.format == FrameFormat::extended_fd) {
      message.format = FrameFormat::standard_fd;
    }
  }
}

} // namespace dyncal::drivers::can
