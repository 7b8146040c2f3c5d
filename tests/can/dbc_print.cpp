// Decodes frames with a DBC file, for the comparison with another implementation:
//   dbc_print FILE.dbc < frames
// A line of input is "id(hex) extended(0|1) data(hex)"; a line of output "frame signal state
// raw_bits value", value as its 64 bits in hex.
#include <bit>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "drivers/can/dbc/dbc.hpp"
#include "drivers/can/dbc/signal_decoder.hpp"
#include "drivers/can/message_index.hpp"

using namespace dyncal::drivers::can;

int main(int argc, char** argv) {
  const auto file = read_dbc_file(argc == 2 ? argv[1] : "");
  if (!file) {
    std::fprintf(stderr, "dbc_print: %s\n", file.error().message.c_str());
    return 2;
  }
  std::vector<const DbcMessage*> messages;
  for (const DbcMessage& message : file->messages) {
    messages.push_back(&message);
  }
  const MessageIndex index(messages);
  std::string id;
  std::string extended;
  std::string data;
  std::vector<DecodedSignal> signals;
  for (std::size_t number = 0; std::cin >> id >> extended >> data; ++number) {
    CanFrame frame;
    frame.id = static_cast<std::uint32_t>(std::stoul(id, nullptr, 16));
    frame.extended = extended == "1";
    frame.length = static_cast<std::uint8_t>(data.size() / 2);
    for (std::size_t i = 0; i < frame.length; ++i) {
      frame.data[i] = static_cast<std::uint8_t>(std::stoul(data.substr(2 * i, 2), nullptr, 16));
    }
    const DbcMessage* message = index.find(frame);
    if (message == nullptr) {
      std::printf("%zu - unknown 0 0\n", number);
      continue;
    }
    decode_message(*message, frame.payload(), signals);
    for (std::size_t i = 0; i < signals.size(); ++i) {
      std::printf("%zu %s %d %llu %016llx\n", number, message->signals[i].name.c_str(),
                  static_cast<int>(signals[i].state),
                  static_cast<unsigned long long>(signals[i].raw_bits),
                  static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(signals[i].value)));
    }
  }
  return 0;
}
