// A CAN database (DBC file): which frames a device sends, and where in them its signals are.
//
// Reads BU_, BO_, SG_ (simple and extended multiplexing), SIG_VALTYPE_, SG_MUL_VAL_ and of BA_ the
// attributes VFrameFormat, GenMsgCycleTime, SystemMessageLongSymbol and SystemSignalLongSymbol;
// knows and skips the other statements of the format, and comments behind //. A statement is
// skipped up to its ';'; where that is missing, up to the line in which the next one begins, with a
// warning, as is an unknown statement. Text that is not UTF-8 is taken for Windows-1252.
//
// Bits are numbered byte * 8 + bit, bit 0 the least significant of its byte; Intel signals start at
// their least significant bit, Motorola signals at their most significant one.
//
//   value = raw * factor + offset
//
// Fails: not_found, refused (the file cannot be read), malformed: one sentence that begins
// "FILE:LINE:", where a statement that decides the decoding (BO_, SG_, SIG_VALTYPE_, SG_MUL_VAL_)
// cannot be understood, or a quotation mark is missing. Plain data and pure functions; any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/error.hpp"

namespace dyncal::drivers::can {

enum class ByteOrder { intel, motorola };
enum class RawType { unsigned_integer, signed_integer, float32, float64 };

// The signal is in a frame only when the raw bits of another signal of it, the switch, are in one
// of these ranges (both ends included).
struct Multiplexing {
  std::size_t switch_signal = 0; // index into DbcMessage::signals
  std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges;
};

struct DbcSignal {
  std::string name; // the long one where the file gives it
  unsigned start_bit = 0;
  unsigned length_bits = 0; // 1 ... 64
  ByteOrder order = ByteOrder::intel;
  RawType type = RawType::unsigned_integer;
  double factor = 1.0;
  double offset = 0.0;
  double minimum = 0.0; // of the value; not below `maximum`: the file gives none
  double maximum = 0.0;
  std::string unit; // as the file writes it, in UTF-8
  bool is_switch = false;
  std::optional<Multiplexing> multiplexing;
  std::size_t line = 0;
};

enum class FrameFormat { standard, extended, j1939, standard_fd, extended_fd };

struct DbcMessage {
  std::string name;
  std::uint32_t id = 0; // 11 or 29 bits
  bool extended = false;
  FrameFormat format = FrameFormat::standard;
  unsigned length_bytes = 0;
  std::optional<double> cycle_time_s; // GenMsgCycleTime
  std::vector<DbcSignal> signals;
  std::size_t line = 0;

  [[nodiscard]] const DbcSignal* signal(std::string_view signal_name) const;
};

struct DbcFile {
  std::filesystem::path path;
  std::vector<DbcMessage> messages;  // without the pseudo message of unused signals
  std::vector<std::string> warnings; // "FILE:LINE: ..."

  [[nodiscard]] const DbcMessage* message(std::string_view name) const;
};

[[nodiscard]] Expected<DbcFile> read_dbc_file(const std::filesystem::path& path);

// The same from text; `path` is for the messages.
[[nodiscard]] Expected<DbcFile> parse_dbc(std::string_view text, const std::filesystem::path& path);

} // namespace dyncal::drivers::can
