// Whatever an instrument answers: no crash, no hang, no memory beyond what was allowed, and never a block of another length than announced.
//
// The input is what the instrument sends, octet by octet; the conversation asks as the oscilloscope driver does.
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

class Recording : public ScpiTransport {
public:
  explicit Recording(std::string_view octets) : octets_(octets) {}

  Expected<void> send(std::string_view, std::chrono::milliseconds) override { return {}; }
  Expected<std::string> read_line(std::size_t longest, std::chrono::milliseconds) override {
    const std::size_t end = octets_.find('\n');
    if (end == std::string_view::npos || end > longest) {
      return tl::unexpected(Error{ErrorCode::timeout, "recording: nothing more"});
    }
    std::string line(octets_.substr(0, end));
    octets_.remove_prefix(end + 1);
    return line;
  }
  Expected<void> read_exactly(std::span<char> wanted, std::chrono::milliseconds) override {
    if (octets_.size() < wanted.size()) {
      return tl::unexpected(Error{ErrorCode::timeout, "recording: nothing more"});
    }
    std::copy_n(octets_.begin(), wanted.size(), wanted.begin());
    octets_.remove_prefix(wanted.size());
    return {};
  }
  bool has_unread() override { return false; } // everything is there from the beginning

private:
  std::string_view octets_;
};

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void converse(std::string_view octets) {
  constexpr std::size_t longest = 100'000;
  ScpiConnection connection("oscilloscope", "recording", std::chrono::milliseconds(1), std::make_unique<Recording>(octets));
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
  const std::string octets(reinterpret_cast<const char*>(data), size);
  converse(octets);
  if (const auto header = tss::parse_series_header(octets); header && header->octets() <= size) {
    static_cast<void>(tss::decode_series(*header, std::span(octets).first(header->octets())));
  }
  static_cast<void>(tss::parse_series_csv(octets));
  return 0;
}
