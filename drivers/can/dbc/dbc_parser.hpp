// Turns the statements of a DBC file into messages and signals.
//
// dbc.hpp describes what is read and what is refused. One use: DbcParser(text, path).parse(). One
// thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/can/dbc/dbc.hpp"
#include "drivers/can/dbc/dbc_scanner.hpp"

namespace dyncal::drivers::can {

class DbcParser {
public:
  // VECTOR__INDEPENDENT_SIG_MSG, the pseudo message of signals that are not in any frame.
  static constexpr std::uint64_t unused_signals_id = 0xC0000000;

  DbcParser(std::string_view text, const std::filesystem::path& path);

  [[nodiscard]] Expected<DbcFile> parse();

private:
  // What a message has said besides what DbcMessage keeps, until all statements are known.
  struct PendingMessage {
    std::uint64_t file_id = 0; // with bit 31 as the mark of an extended id
    std::vector<std::string> short_names;
    std::vector<std::optional<std::uint64_t>> simple_conditions; // mN of SG_
    DbcMessage message;
  };
  struct Attribute {
    std::string name;
    std::string object; // "BO_", "SG_", "" ...
    std::uint64_t id = 0;
    std::string signal;
    std::string value; // text of a string or of a number
    bool is_text = false;
  };

  void statement(const std::string& keyword);
  void skip_rest(const std::string& keyword, std::size_t line);
  void new_symbols();
  void nodes();
  void message();
  void signal();
  void multiplex_mark(const std::string& mark, DbcSignal& signal,
                      std::optional<std::uint64_t>& condition);
  void layout(DbcSignal& signal);
  void scaling(DbcSignal& signal);
  void check(const DbcSignal& signal);
  void value_type();
  void extended_multiplexing();
  void attribute_definition();
  void attribute_default();
  void attribute();
  [[nodiscard]] std::optional<std::pair<std::string, bool>> attribute_value();

  void apply(const Attribute& attribute);
  [[nodiscard]] std::optional<FrameFormat> frame_format(const Attribute& attribute) const;
  void apply_default_format();
  void resolve_simple_multiplexing(PendingMessage& pending);
  void refuse_cycles(const PendingMessage& pending);
  void warn_about_repeated_ids();

  [[nodiscard]] PendingMessage* pending_message(std::uint64_t file_id);
  [[nodiscard]] static std::optional<std::size_t> signal_index(const PendingMessage& pending,
                                                               const std::string& short_name);
  void refuse(std::size_t line, const std::string& sentence);
  void warn(std::size_t line, const std::string& sentence);

  DbcScanner scanner_;
  DbcFile file_;
  std::vector<PendingMessage> pending_messages_;
  std::map<std::uint64_t, std::size_t> pending_of_id_; // the first message of each id
  bool in_pseudo_message_ = false;
  std::vector<Attribute> attributes_;
  std::vector<std::string> format_names_; // of VFrameFormat, when the file lists them
  std::optional<Attribute> default_format_;
  std::vector<bool> format_given_;
  std::optional<std::string> problem_;
};

} // namespace dyncal::drivers::can
