// SG_ and SIG_VALTYPE_: where a signal is in its frame, and what its bits mean.
#include "drivers/can/dbc/dbc_parser.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace dyncal::drivers::can {

namespace {

constexpr unsigned max_frame_bits = 64 * 8;

} // namespace

void DbcParser::signal() {
  const std::size_t line = scanner_.line();
  DbcSignal signal;
  signal.line = line;
  const auto name = scanner_.name();
  if (!name || (pending_messages_.empty() && !in_pseudo_message_)) {
    refuse(line, name ? "signal '" + *name + "' belongs to no message" : "SG_ without a name");
    return;
  }
  signal.name = *name;
  std::optional<std::uint64_t> condition;
  if (!scanner_.next_is(':')) {
    multiplex_mark(scanner_.name().value_or(""), signal, condition);
  }
  if (!problem_ && !scanner_.character(':')) {
    refuse(line, "signal '" + *name + "': expected ':' but found " + scanner_.next_text());
  }
  if (!problem_) {
    layout(signal);
  }
  if (!problem_) {
    scaling(signal);
  }
  // The receivers: names with commas, which may go on in the next line behind a comma.
  for (bool comma = false; comma || scanner_.same_line();) {
    if (!scanner_.same_line() && scanner_.next_begins_statement()) {
      break;
    }
    const bool receiver = scanner_.name().has_value();
    comma = scanner_.character(',');
    if (!receiver && !comma) {
      break;
    }
  }
  if (problem_ || in_pseudo_message_) {
    return;
  }
  check(signal);
  PendingMessage& pending = pending_messages_.back();
  if (signal.start_bit >= max_frame_bits || signal.length_bits == 0) {
    warn(line, "signal '" + *name + "' stands in no frame and is left out");
    return;
  }
  if (signal_index(pending, *name)) {
    refuse(line, "message '" + pending.message.name + "' has two signals named '" + *name + "'");
    return;
  }
  pending.short_names.push_back(*name);
  pending.simple_conditions.push_back(condition);
  pending.message.signals.push_back(std::move(signal));
}

// "M": a switch; "m3": there when the switch is 3; "m3M": both.
void DbcParser::multiplex_mark(const std::string& mark, DbcSignal& signal,
                               std::optional<std::uint64_t>& condition) {
  std::string_view rest = mark;
  if (rest.starts_with('m')) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), value);
    if (error == std::errc()) {
      condition = value;
      rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    }
  }
  if (rest == "M") {
    signal.is_switch = true;
    rest = {};
  }
  if (!rest.empty() || mark.empty()) {
    refuse(signal.line, "signal '" + signal.name + "' has '" + mark +
                            "' where a multiplex mark (M, m0, m0M) or ':' must stand");
  }
}

void DbcParser::layout(DbcSignal& signal) {
  const auto start = scanner_.unsigned_integer();
  const bool bar = start && scanner_.character('|');
  const auto length = bar ? scanner_.unsigned_integer() : std::nullopt;
  const bool at = length && scanner_.character('@');
  const auto order = at ? scanner_.unsigned_integer() : std::nullopt;
  const bool is_signed = order && scanner_.character('-');
  if (!order || *order > 1 || (!is_signed && !scanner_.character('+'))) {
    refuse(
        scanner_.line(),
        "signal '" + signal.name +
            "' must have 'start|length@order sign' with order 0 or 1 and sign + or -, but found " +
            scanner_.next_text());
    return;
  }
  constexpr std::uint64_t farthest = 1785U * 8U;
  if (*start >= farthest || *length > farthest) {
    refuse(signal.line, "signal '" + signal.name + "' lies outside of any message");
    return;
  }
  signal.start_bit = static_cast<unsigned>(*start);
  signal.length_bits = static_cast<unsigned>(*length);
  signal.order = *order == 1 ? ByteOrder::intel : ByteOrder::motorola;
  signal.type = is_signed ? RawType::signed_integer : RawType::unsigned_integer;
}

void DbcParser::scaling(DbcSignal& signal) {
  const bool open = scanner_.character('(');
  const auto factor = open ? scanner_.number() : std::nullopt;
  const bool comma = factor && scanner_.character(',');
  const auto offset = comma ? scanner_.number() : std::nullopt;
  const bool closed = offset && scanner_.character(')') && scanner_.character('[');
  const auto minimum = closed ? scanner_.limit() : std::nullopt;
  const bool bar = minimum && scanner_.character('|');
  const auto maximum = bar ? scanner_.limit() : std::nullopt;
  const auto unit = maximum && scanner_.character(']') ? scanner_.string() : std::nullopt;
  if (!unit) {
    refuse(scanner_.line(),
           "signal '" + signal.name +
               "' must have '(factor,offset) [minimum|maximum] \"unit\"', but found " +
               scanner_.next_text());
    return;
  }
  signal.factor = *factor;
  signal.offset = *offset;
  if (std::isfinite(*minimum) && std::isfinite(*maximum)) {
    signal.minimum = *minimum;
    signal.maximum = *maximum;
  }
  signal.unit = *unit;
}

void DbcParser::check(const DbcSignal& signal) {
  if (signal.length_bits > 64) {
    warn(signal.line, "signal '" + signal.name + "' has more than 64 bits and gives no value");
  }
  if (signal.factor == 0.0) {
    warn(signal.line,
         "signal '" + signal.name + "' has factor 0: its value does not depend on the frame");
  }
}

void DbcParser::value_type() {
  const std::size_t line = scanner_.line();
  const auto id = scanner_.unsigned_integer();
  const auto name = id ? scanner_.name() : std::nullopt;
  if (name) {
    scanner_.character(':');
  }
  const auto type = name ? scanner_.unsigned_integer() : std::nullopt;
  if (!type || *type > 2) {
    refuse(line, "SIG_VALTYPE_ must read 'SIG_VALTYPE_ id signal : 0, 1 or 2;', but found " +
                     scanner_.next_text());
    return;
  }
  scanner_.character(';');
  PendingMessage* message = pending_message(*id);
  const auto index = message ? signal_index(*message, *name) : std::nullopt;
  if (!index) {
    if (*id != unused_signals_id) {
      warn(line, "SIG_VALTYPE_ names the signal '" + *name + "', which message " +
                     std::to_string(*id) + " does not have");
    }
    return;
  }
  DbcSignal& signal = message->message.signals[*index];
  if (*type == 0) {
    return;
  }
  if (signal.length_bits != (*type == 1 ? 32U : 64U)) {
    refuse(line, "signal '" + *name + "' is declared as a float of " + (*type == 1 ? "32" : "64") +
                     " bits but has " + std::to_string(signal.length_bits));
    return;
  }
  signal.type = *type == 1 ? RawType::float32 : RawType::float64;
}

} // namespace dyncal::drivers::can
