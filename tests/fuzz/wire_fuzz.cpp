// Whatever comes from the network: no crash, no hang, and no room made beyond a small multiple of
// its bytes (the test's limit of an allocation). The first byte says what the others are tried as:
// a datagram, or a message of the contract. A message that is read is written again as what was
// read.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "services/bus/fastdds/screen/message_check.hpp"
#include "services/bus/fastdds/screen/rtps_screen.hpp"
#include "services/bus/type_support.hpp"

namespace {

using namespace dyncal;
using namespace dyncal::bus;

using Bytes = std::span<const unsigned char>;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

// A participant hears more than one datagram: the second one meets what the first one left.
void try_datagram(Bytes bytes) {
  SampleStamps stamps;
  ReaderProgress progress;
  RtpsScreen screen(stamps, progress);
  MessageCheck check;
  for (int i = 0; i < 2; ++i) {
    (void)check.accepts(bytes);
    (void)screen.pass(bytes);
    progress.sent(bytes);
  }
}

template <class T>
std::string written(const T& sample) {
  const EncodedMessage bytes = encode(sample);
  require(bytes != nullptr);
  return *bytes;
}

template <class T>
void try_message(Bytes bytes) {
  const std::string payload(bytes.begin(), bytes.end());
  const TypeSupport& type = type_support<T>();
  T sample;
  if (type.deserialize(&sample, payload.data(), payload.size())) {
    const std::string again = written(sample);
    T read_again;
    require(type.deserialize(&read_again, again.data(), again.size()));
    require(written(read_again) == again);
  }
}

constexpr std::array tries{
    &try_datagram,
    &try_message<wire::SourceDescription>,
    &try_message<wire::SourceStatus>,
    &try_message<wire::SampleBlock>,
    &try_message<wire::TriggeredRecord>,
    &try_message<wire::Measurement>,
    &try_message<wire::Excitation>,
    &try_message<wire::CalibrationResult>,
    &try_message<wire::TransferFunction>,
    &try_message<wire::SampleClockReport>,
    &try_message<wire::ServiceStatus>,
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) {
    tries[data[0] % tries.size()](Bytes(data + 1, size - 1));
  }
  return 0;
}
