#include "drivers/can/dbc/dbc.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include "drivers/can/dbc/dbc_parser.hpp"
#include "drivers/can/dbc/text_encoding.hpp"

namespace dyncal::drivers::can {

namespace {

constexpr std::uintmax_t max_file = std::uintmax_t{64} << 20U;

} // namespace

const DbcSignal* DbcMessage::signal(std::string_view signal_name) const {
  const auto found = std::find_if(signals.begin(), signals.end(), [&](const DbcSignal& signal) {
    return signal.name == signal_name;
  });
  return found == signals.end() ? nullptr : &*found;
}

const DbcMessage* DbcFile::message(std::string_view name) const {
  const auto found = std::find_if(messages.begin(), messages.end(),
                                  [&](const DbcMessage& message) { return message.name == name; });
  return found == messages.end() ? nullptr : &*found;
}

Expected<DbcFile> read_dbc_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) {
    return fail(ErrorCode::not_found,
                path.string() + ": the DBC file cannot be read (" + error.message() + ")");
  }
  if (size > max_file) {
    return fail(ErrorCode::malformed, path.string() + ": larger than 64 MiB, which no DBC file is");
  }
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad() || !stream.is_open()) {
    return fail(ErrorCode::refused,
                path.string() + ": the DBC file cannot be read; may this user read it?");
  }
  return parse_dbc(text, path);
}

Expected<DbcFile> parse_dbc(std::string_view text, const std::filesystem::path& path) {
  const std::string utf8 = to_utf8(text);
  return DbcParser(utf8, path).parse();
}

} // namespace dyncal::drivers::can
