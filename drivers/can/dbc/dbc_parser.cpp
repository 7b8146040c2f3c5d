#include "drivers/can/dbc/dbc_parser.hpp"

#include <algorithm>
#include <string_view>

#include "drivers/can/dbc/dbc_keywords.hpp"

namespace dyncal::drivers::can {

namespace {

constexpr std::uint64_t extended_mark = 0x80000000;

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
  constexpr std::size_t max_warnings =
      100; // a file that is not a DBC file at all must not fill the log
  if (file_.warnings.size() < max_warnings) {
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
    if (const auto broken = scanner_.broken_string()) {
      refuse(*broken, "a quotation mark is missing: the string that begins here " +
                          std::string(scanner_.at_end() ? "does not end"
                                                        : "takes other statements with it"));
    }
  }
  if (!problem_ && pending_messages_.empty() && !file_.warnings.empty()) {
    refuse(1, "this is not a DBC file: it has no messages, and statements that do not belong to "
              "the format");
  }
  format_given_.assign(pending_messages_.size(), false);
  for (const auto& attribute : attributes_) {
    apply(attribute);
  }
  apply_default_format();
  warn_about_repeated_ids();
  for (PendingMessage& pending : pending_messages_) {
    resolve_simple_multiplexing(pending);
    refuse_cycles(pending);
    file_.messages.push_back(std::move(pending.message));
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
    skip_rest(keyword, line);
  }
}

// What is passed over of a statement must not take the next one with it.
void DbcParser::skip_rest(const std::string& keyword, std::size_t line) {
  if (scanner_.skip_statement() == DbcScanner::StatementEnd::next_statement) {
    warn(line, "the statement '" + keyword.substr(0, 40) + "' does not end with ';'");
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

// The names themselves are not used. Some writers give each a line of its own.
void DbcParser::nodes() {
  scanner_.character(':');
  auto line_begin = scanner_.place();
  bool begins_line = false;
  while (!scanner_.at_end()) {
    if (!scanner_.same_line()) {
      if (scanner_.next_begins_statement()) {
        return;
      }
      line_begin = scanner_.place();
      begins_line = true;
    }
    if (!scanner_.name()) {
      if (begins_line) { // an unknown statement, not a list of nodes
        scanner_.go_back(line_begin);
      }
      return;
    }
  }
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
  PendingMessage pending;
  pending.file_id = *id;
  pending.message.extended = (*id & extended_mark) != 0;
  pending.message.id =
      static_cast<std::uint32_t>(*id & (pending.message.extended ? 0x1FFFFFFFU : 0x7FFFFFFFU));
  constexpr std::uint64_t longest = 1785; // of a J1939 transport
  if (*id > 0xFFFFFFFF || (!pending.message.extended && pending.message.id > 0x7FF) ||
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
  pending.message.format = pending.message.extended ? FrameFormat::extended : FrameFormat::standard;
  pending.message.name = *name;
  pending.message.length_bytes = static_cast<unsigned>(*length);
  pending.message.line = line;
  pending_of_id_.emplace(*id, pending_messages_.size());
  pending_messages_.push_back(std::move(pending));
}

DbcParser::PendingMessage* DbcParser::pending_message(std::uint64_t file_id) {
  const auto found = pending_of_id_.find(file_id);
  return found == pending_of_id_.end() ? nullptr : &pending_messages_[found->second];
}

std::optional<std::size_t> DbcParser::signal_index(const PendingMessage& pending,
                                                   const std::string& short_name) {
  const auto found = std::find(pending.short_names.begin(), pending.short_names.end(), short_name);
  if (found == pending.short_names.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - pending.short_names.begin());
}

void DbcParser::warn_about_repeated_ids() {
  for (std::size_t i = 0; i < pending_messages_.size(); ++i) {
    const std::size_t first = pending_of_id_[pending_messages_[i].file_id];
    if (first != i) {
      warn(pending_messages_[i].message.line,
           "message '" + pending_messages_[i].message.name + "' has the id of '" +
               pending_messages_[first].message.name + "'; frames are taken for the latter");
    }
  }
}

} // namespace dyncal::drivers::can
