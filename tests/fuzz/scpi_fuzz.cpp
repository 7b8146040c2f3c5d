// Whatever an instrument answers: no crash, no hang, no memory beyond what was allowed, and never a
// block of another length than announced.
//
// The input is what the instrument sends, byte by byte; the conversation asks as the oscilloscope
// driver does.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>

#include "drivers/dso/waveform.hpp"
#include "drivers/link/scpi_answer.hpp"
#include "drivers/link/scpi_connection.hpp"
#include "drivers/tss/series.hpp"

namespace {

using namespace dyncal::drivers;
using dyncal::fail;

class Recording : public ScpiTransport {
public:
  explicit Recording(std::string_view bytes) : bytes_(bytes) {}

  Expected<void> send(std::string_view, std::chrono::milliseconds) override { return {}; }
  Expected<std::string> read_line(std::size_t longest, std::chrono::milliseconds) override {
    const std::size_t end = bytes_.find('\n');
    if (end == std::string_view::npos || end > longest) {
      return fail(ErrorCode::timeout, "recording: nothing more");
    }
    std::string line(bytes_.substr(0, end));
    bytes_.remove_prefix(end + 1);
    return line;
  }
  Expected<void> read_exactly(std::span<char> wanted, std::chrono::milliseconds) override {
    if (bytes_.size() < wanted.size()) {
      return fail(ErrorCode::timeout, "recording: nothing more");
    }
    std::copy_n(bytes_.begin(), wanted.size(), wanted.begin());
    bytes_.remove_prefix(wanted.size());
    return {};
  }
  bool has_unread() override { return false; } // everything is there from the beginning

private:
  std::string_view bytes_;
};

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void converse(std::string_view bytes) {
  constexpr std::size_t longest = 100'000;
  ScpiConnection connection("oscilloscope", "recording", std::chrono::milliseconds(1),
                            std::make_unique<Recording>(bytes));
  while (!connection.lost()) {
    static_cast<void>(connection.command(":SINGle"));
    const auto preamble = connection.query(":WAVeform:PREamble?");
    const auto block = connection.query_block(":WAVeform:DATA?", longest);
    require(!block || block->size() <= longest);
    if (preamble && block) {
      if (const auto parsed = dso::parse_preamble(*preamble)) {
        std::vector<double> volts;
        dso::append_volts(*parsed, dso::VoltageRule::rigol, *block, volts);
        require(volts.size() == block->size());
      }
    }
    static_cast<void>(connection.query_number("*OPC?"));
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  converse(bytes);
  if (const auto header = tss::parse_series_header(bytes); header && header->bytes() <= size) {
    static_cast<void>(tss::decode_series(*header, std::span(bytes).first(header->bytes())));
  }
  static_cast<void>(tss::parse_series_csv(bytes));
  return 0;
}
