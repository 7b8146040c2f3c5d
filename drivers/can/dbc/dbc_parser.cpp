#include "drivers/can/dbc/dbc_parser.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

namespace dyncal::drivers::can {

namespace {

constexpr std::uint64_t extended_mark = 0x80000000;
constexpr std::uint64_t unused_signals_id = 0xC0000000; // VECTOR__INDEPENDENT_SIG_MSG
constexpr unsigned max_frame_bits = 64 * 8;

// Statements that say nothing about how a frame is decoded.
constexpr std::array passed_over = {"VERSION",
                                    "BS_",
                                    "VAL_TABLE_",
                                    "VAL_",
                                    "CM_",
                                    "EV_",
                                    "ENVVAR_DATA_",
                                    "EV_DATA_",
                                    "SGTYPE_",
                                    "SIGTYPE_",
                                    "SIG_TYPE_REF_",
                                    "SIG_GROUP_",
                                    "BO_TX_BU_",
                                    "BA_DEF_REL_",
                                    "BA_REL_",
                                    "BA_DEF_DEF_REL_",
                                    "BU_SG_REL_",
                                    "BU_EV_REL_",
                                    "BU_BO_REL_",
                                    "CAT_DEF_",
                                    "CAT_",
                                    "FILTER",
                                    "SGTYPE_VAL_",
                                    "SIGTYPE_VALTYPE_",
                                    "BA_DEF_SGTYPE_",
                                    "BA_SGTYPE_",
                                    "BA_DEF_DEF_SGTYPE_",
                                    "NS_DESC_"};

bool is_passed_over(const std::string& keyword) {
  return std::find(passed_over.begin(), passed_over.end(), keyword) != passed_over.end();
}

} // namespace

DbcParser::DbcParser(std::string_view text, const std::filesystem::path& path) : scanner_(text) {
  file_.path = path;
}

void DbcParser::refuse(std::size_t line, const std::string& sentence) {
  if (!problem_) {
    problem_ = file_.path.string() + ":" + std::to_string(line) + ": " + sentence;
  }
}

void DbcParser::warn(std::size_t line, const std::string& sentence) {
  constexpr std::size_t most = 100; // a file that is not a DBC file at all must not fill the log
  if (file_.warnings.size() < most) {
    file_.warnings.push_back(file_.path.string() + ":" + std::to_string(line) + ": " + sentence);
  }
}

Expected<DbcFile> DbcParser::parse() {
  while (!problem_ && !scanner_.at_end()) {
    const std::size_t line = scanner_.line();
    if (const auto keyword = scanner_.name()) {
      statement(*keyword);
    } else if (!scanner_.character(';')) {
      warn(line, "passed over " + scanner_.next_text() + ", which begins no statement");
      scanner_.skip_statement();
    }
  }
  if (!problem_ && drafts_.empty() && !file_.warnings.empty()) {
    refuse(1, "this is no DBC file: it has no message and statements that no DBC file has");
  }
  format_given_.assign(drafts_.size(), false);
  for (const auto& attribute : attributes_) {
    apply(attribute);
  }
  apply_default_format();
  warn_about_repeated_ids();
  for (Draft& draft : drafts_) {
    resolve_simple_multiplexing(draft);
    refuse_circles(draft);
    file_.messages.push_back(std::move(draft.message));
  }
  if (problem_) {
    return fail(ErrorCode::malformed, *problem_);
  }
  return std::move(file_);
}

void DbcParser::statement(const std::string& keyword) {
  const std::size_t line = scanner_.line();
  if (keyword == "BO_") {
    message();
  } else if (keyword == "SG_") {
    signal();
  } else if (keyword == "NS_") {
    new_symbols();
  } else if (keyword == "BU_") {
    nodes();
  } else if (keyword == "VERSION" || keyword == "BS_") {
    if (scanner_.same_line() && !scanner_.string()) {
      scanner_.skip_line();
    }
  } else if (keyword == "SIG_VALTYPE_") {
    value_type();
  } else if (keyword == "SG_MUL_VAL_") {
    extended_multiplexing();
  } else if (keyword == "BA_DEF_") {
    attribute_definition();
  } else if (keyword == "BA_DEF_DEF_") {
    attribute_default();
  } else if (keyword == "BA_") {
    attribute();
  } else {
    if (!is_passed_over(keyword)) {
      warn(line, "passed over the unknown statement '" + keyword.substr(0, 40) + "'");
    }
    scanner_.skip_statement();
  }
}

// NS_ lists names of statements without their contents: a name that something follows in its line
// is a statement again.
void DbcParser::new_symbols() {
  scanner_.character(':');
  while (!scanner_.at_end()) {
    const auto before = scanner_.place();
    const auto symbol = scanner_.name();
    if (!symbol || *symbol == "BS_" || *symbol == "BU_" || *symbol == "BO_" ||
        scanner_.same_line()) {
      scanner_.go_back(before);
      return;
    }
  }
}

void DbcParser::nodes() {
  scanner_.character(':');
  while (scanner_.same_line() && scanner_.name())
    ;
}

void DbcParser::message() {
  const std::size_t line = scanner_.line();
  const auto id = scanner_.unsigned_integer();
  const auto name = id ? scanner_.name() : std::nullopt;
  const bool colon = name && scanner_.character(':');
  const auto length = colon ? scanner_.unsigned_integer() : std::nullopt;
  if (!length) {
    refuse(line, "BO_ must read 'BO_ id name: length sender', but found " + scanner_.next_text());
    return;
  }
  if (scanner_.same_line()) {
    scanner_.name(); // the sender
  }
  in_pseudo_message_ = *id == unused_signals_id || *name == "VECTOR__INDEPENDENT_SIG_MSG";
  if (in_pseudo_message_) {
    return;
  }
  Draft draft;
  draft.file_id = *id;
  draft.message.extended = (*id & extended_mark) != 0;
  draft.message.id =
      static_cast<std::uint32_t>(*id & (draft.message.extended ? 0x1FFFFFFFU : 0x7FFFFFFFU));
  constexpr std::uint64_t longest = 1785; // of a J1939 transport
  if (*id > 0xFFFFFFFF || (!draft.message.extended && draft.message.id > 0x7FF) ||
      *length > longest) {
    refuse(line, "message '" + *name + "' has " + (*length > longest ? "a length" : "an id") +
                     " that no frame can have");
    return;
  }
  if (*length > 64) {
    warn(line, "message '" + *name +
                   "' is longer than a frame; of it only signals in the first 64 bytes of a frame "
                   "can be read");
  }
  draft.message.format = draft.message.extended ? FrameFormat::extended : FrameFormat::standard;
  draft.message.name = *name;
  draft.message.length_bytes = static_cast<unsigned>(*length);
  draft.message.line = line;
  draft_of_id_.emplace(*id, drafts_.size());
  drafts_.push_back(std::move(draft));
}

void DbcParser::signal() {
  const std::size_t line = scanner_.line();
  DbcSignal signal;
  signal.line = line;
  const auto name = scanner_.name();
  if (!name || (drafts_.empty() && !in_pseudo_message_)) {
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
  Draft& draft = drafts_.back();
  if (signal.start_bit >= max_frame_bits || signal.length_bits == 0) {
    warn(line, "signal '" + *name + "' stands in no frame and is left out");
    return;
  }
  if (signal_index(draft, *name)) {
    refuse(line, "message '" + draft.message.name + "' has two signals named '" + *name + "'");
    return;
  }
  draft.short_names.push_back(*name);
  draft.simple_conditions.push_back(condition);
  draft.message.signals.push_back(std::move(signal));
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
  const auto minimum = closed ? scanner_.number() : std::nullopt;
  const bool bar = minimum && scanner_.character('|');
  const auto maximum = bar ? scanner_.number() : std::nullopt;
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
  signal.minimum = *minimum;
  signal.maximum = *maximum;
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
  Draft* message = draft(*id);
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
  Draft* message = draft(*id);
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

DbcParser::Draft* DbcParser::draft(std::uint64_t file_id) {
  const auto found = draft_of_id_.find(file_id);
  return found == draft_of_id_.end() ? nullptr : &drafts_[found->second];
}

std::optional<std::size_t> DbcParser::signal_index(const Draft& draft,
                                                   const std::string& short_name) {
  const auto found = std::find(draft.short_names.begin(), draft.short_names.end(), short_name);
  if (found == draft.short_names.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - draft.short_names.begin());
}

// mN without SG_MUL_VAL_: the one switch of the message decides.
void DbcParser::resolve_simple_multiplexing(Draft& draft) {
  auto& signals = draft.message.signals;
  const auto is_root = [&](std::size_t i) {
    return signals[i].is_switch && !draft.simple_conditions[i] && !signals[i].multiplexing;
  };
  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    if (is_root(i)) {
      roots.push_back(i);
    }
  }
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const auto condition = draft.simple_conditions[i];
    if (!condition || signals[i].multiplexing) {
      continue;
    }
    if (roots.size() != 1) {
      refuse(signals[i].line,
             "signal '" + signals[i].name + "' is multiplexed, but its message '" +
                 draft.message.name + "' has " +
                 (roots.empty() ? "no switch" : "several switches and no SG_MUL_VAL_ for it"));
      return;
    }
    signals[i].multiplexing = Multiplexing{roots.front(), {{*condition, *condition}}};
  }
}

void DbcParser::refuse_circles(const Draft& draft) {
  const auto& signals = draft.message.signals;
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

void DbcParser::warn_about_repeated_ids() {
  for (std::size_t i = 0; i < drafts_.size(); ++i) {
    const std::size_t first = draft_of_id_[drafts_[i].file_id];
    if (first != i) {
      warn(drafts_[i].message.line, "message '" + drafts_[i].message.name + "' has the id of '" +
                                        drafts_[first].message.name +
                                        "'; frames are taken for the latter");
    }
  }
}

} // namespace dyncal::drivers::can
