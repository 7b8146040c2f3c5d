// Any bytes as a DBC file: it is read or refused with a sentence, and whatever was read decodes any
// frame without reading beyond it.
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "drivers/can/dbc/dbc.hpp"
#include "drivers/can/dbc/signal_decoder.hpp"
#include "drivers/can/message_index.hpp"

using namespace dyncal::drivers::can;

namespace {

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file =
      parse_dbc(std::string_view(reinterpret_cast<const char*>(data), size), "fuzzed.dbc");
  if (!file) {
    require(file.error().message.starts_with("fuzzed.dbc:"));
    return 0;
  }
  std::vector<const DbcMessage*> messages;
  std::vector<DecodedSignal> decoded;
  for (const DbcMessage& message : file->messages) {
    messages.push_back(&message);
    for (const DbcSignal& signal : message.signals) {
      require(!signal.multiplexing || signal.multiplexing->switch_signal < message.signals.size());
    }
    const std::vector<std::uint8_t> payload(
        message.length_bytes % 65,
        0xA5); // exactly as long as the frame: the sanitizer sees what is beyond
    decode_message(message, payload, decoded);
    require(decoded.size() == message.signals.size());
  }
  const MessageIndex index(messages);
  require(index.filters().size() <= messages.size());
  return 0;
}
