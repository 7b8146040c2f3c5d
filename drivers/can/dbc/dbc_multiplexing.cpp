// Which signals of a message are in a frame: mN of SG_, and SG_MUL_VAL_.
#include "drivers/can/dbc/dbc_parser.hpp"

#include <algorithm>
#include <string_view>

namespace dyncal::drivers::can {

void DbcParser::extended_multiplexing() {
  const std::size_t line = scanner_.line();
  const auto id = scanner_.unsigned_integer();
  const auto name = id ? scanner_.name() : std::nullopt;
  const auto switch_name = name ? scanner_.name() : std::nullopt;
  Multiplexing multiplexing;
  bool good = switch_name.has_value();
  while (good) {
    const auto first = scanner_.unsigned_integer();
    const auto last = first && scanner_.character('-') ? scanner_.unsigned_integer() : std::nullopt;
    good = last && *first <= *last;
    if (good) {
      multiplexing.ranges.emplace_back(*first, *last);
    }
    if (!good || !scanner_.character(',')) {
      break;
    }
  }
  if (!good || !scanner_.character(';')) {
    refuse(line,
           "SG_MUL_VAL_ must read 'SG_MUL_VAL_ id signal switch from-to, from-to;', but found " +
               scanner_.next_text());
    return;
  }
  PendingMessage* message = pending_message(*id);
  const auto index = message ? signal_index(*message, *name) : std::nullopt;
  const auto switch_index = message ? signal_index(*message, *switch_name) : std::nullopt;
  if (!index || !switch_index) {
    if (*id != unused_signals_id) {
      refuse(line, "SG_MUL_VAL_ names '" + *name + "' and '" + *switch_name + "', which message " +
                       std::to_string(*id) + " does not have both");
    }
    return;
  }
  multiplexing.switch_signal = *switch_index;
  message->message.signals[*switch_index].is_switch = true;
  message->message.signals[*index].multiplexing = std::move(multiplexing);
}

// mN without SG_MUL_VAL_: the one switch of the message decides.
void DbcParser::resolve_simple_multiplexing(PendingMessage& pending) {
  auto& signals = pending.message.signals;
  const auto is_root = [&](std::size_t i) {
    return signals[i].is_switch && !pending.simple_conditions[i] && !signals[i].multiplexing;
  };
  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    if (is_root(i)) {
      roots.push_back(i);
    }
  }
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const auto condition = pending.simple_conditions[i];
    if (!condition || signals[i].multiplexing) {
      continue;
    }
    if (roots.size() != 1) {
      refuse(signals[i].line,
             "signal '" + signals[i].name + "' is multiplexed, but its message '" +
                 pending.message.name + "' has " +
                 (roots.empty() ? "no switch" : "several switches and no SG_MUL_VAL_ for it"));
      return;
    }
    signals[i].multiplexing = Multiplexing{roots.front(), {{*condition, *condition}}};
  }
}

void DbcParser::refuse_cycles(const PendingMessage& pending) {
  const auto& signals = pending.message.signals;
  // Colours every chain of switches once: linear in the number of signals.
  std::vector<std::size_t> seen_from(signals.size(), signals.size());
  for (std::size_t start = 0; start < signals.size(); ++start) {
    std::size_t at = start;
    while (signals[at].multiplexing && seen_from[at] == signals.size()) {
      seen_from[at] = start;
      at = signals[at].multiplexing->switch_signal;
    }
    if (signals[at].multiplexing && seen_from[at] == start) {
      refuse(signals[at].line, "signal '" + signals[at].name + "' switches itself");
      return;
    }
  }
}

} // namespace dyncal::drivers::can
