// VXI-11 (TCP/IP instrument protocol, VXIbus consortium 1995) through liblxi. A device_read of
// liblxi collects the whole answer up to its END mark, so an answer longer than the buffer cannot
// be read in parts: the buffer holds the longest that any driver asks for.
#include "drivers/link/scpi_transport.hpp"

#include <algorithm>
#include <mutex>
#include <vector>

#include <lxi.h>

namespace dyncal::drivers {
namespace {

constexpr std::string_view scheme = "vxi11:";
constexpr std::size_t max_answer = std::size_t{4} << 20U;

class Vxi11Transport : public ScpiTransport {
public:
  Vxi11Transport(int device, std::string address) : device_(device), address_(std::move(address)) {}
  ~Vxi11Transport() override { lxi_disconnect(device_); }
  Vxi11Transport(const Vxi11Transport&) = delete;
  Vxi11Transport& operator=(const Vxi11Transport&) = delete;

  Expected<void> send(std::string_view message, std::chrono::milliseconds limit) override {
    const int size = static_cast<int>(message.size());
    if (lxi_send(device_, message.data(), size, static_cast<int>(limit.count())) != size) {
      return fail(ErrorCode::disconnected,
                  address_ + ": the instrument does not take what is sent to it");
    }
    return {};
  }

  Expected<std::string> read_line(std::size_t max_bytes, std::chrono::milliseconds limit) override {
    const auto deadline = Clock::now() + limit;
    for (;;) {
      const auto end =
          std::find(received_.begin() + static_cast<std::ptrdiff_t>(taken_), received_.end(), '\n');
      const std::size_t size = static_cast<std::size_t>(end - received_.begin()) - taken_;
      if (size > max_bytes) {
        return fail(ErrorCode::malformed, address_ + ": a line without an end after " +
                                              std::to_string(max_bytes) + " bytes");
      }
      if (end != received_.end()) {
        std::string line(received_.data() + taken_, size);
        taken_ += size + 1;
        if (line.ends_with('\r')) {
          line.pop_back();
        }
        return line;
      }
      DYNCAL_TRY(receive(deadline));
    }
  }

  Expected<void> read_exactly(std::span<char> bytes, std::chrono::milliseconds limit) override {
    const auto deadline = Clock::now() + limit;
    while (received_.size() - taken_ < bytes.size()) {
      DYNCAL_TRY(receive(deadline));
    }
    std::copy_n(received_.data() + taken_, bytes.size(), bytes.begin());
    taken_ += bytes.size();
    return {};
  }

  bool has_unread() override { return taken_ < received_.size(); }

private:
  using Clock = std::chrono::steady_clock;

  // Appends one whole answer of the instrument.
  Expected<void> receive(Clock::time_point deadline) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) {
      return fail(ErrorCode::timeout, address_ + ": the instrument does not answer");
    }
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(taken_));
    taken_ = 0;
    const std::size_t held = received_.size();
    received_.resize(held + max_answer);
    const int count = lxi_receive(device_, received_.data() + held, static_cast<int>(max_answer),
                                  static_cast<int>(left));
    received_.resize(held + static_cast<std::size_t>(std::max(count, 0)));
    if (count <= 0) {
      return fail(ErrorCode::timeout, address_ + ": the instrument does not answer");
    }
    return {};
  }

  int device_;
  std::string address_;
  std::vector<char> received_;
  std::size_t taken_ = 0; // of received_
};

} // namespace

Expected<std::unique_ptr<ScpiTransport>> connect_vxi11_transport(const std::string& address,
                                                                 std::chrono::milliseconds limit) {
  std::string host = address.starts_with(scheme) ? address.substr(scheme.size()) : std::string();
  std::string device = "inst0";
  if (const std::size_t slash = host.find('/'); slash != std::string::npos) {
    device = host.substr(slash + 1);
    host.resize(slash);
  }
  if (host.empty() || device.empty()) {
    return fail(ErrorCode::malformed,
                "\"" + address +
                    "\" is not a VXI-11 address: write vxi11:HOST or vxi11:HOST/inst0");
  }
  static std::once_flag once;
  std::call_once(once, [] { lxi_init(); });
  const int number =
      lxi_connect(host.c_str(), 0, device.c_str(), static_cast<int>(limit.count()), VXI11);
  if (number < 0) {
    return fail(
        ErrorCode::refused,
        address +
            ": no VXI-11 instrument answers; is it switched on, and does it offer VXI-11 (LXI)?");
  }
  return std::make_unique<Vxi11Transport>(number, address);
}

} // namespace dyncal::drivers
