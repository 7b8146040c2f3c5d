// A CAN FD adapter on USB with hardware stamps (gs_usb), played by a test: the kernel's own driver
// makes CAN interfaces of it, and the test says what happens on the bus and in the adapter.
//
// All channels are on one bus, with other devices that acknowledge and that send what the test puts
// on it. Each frame lasts as long as its bits; the adapter stamps its start or its end with a clock
// of its own (1 us, 32 bits, off by `clock_ppm`), and the host gets it after a latency drawn anew
// for every frame (USB keeps the order). A channel that runs at another bit rate than the bus hears
// errors in place of frames, counts them and becomes error passive. Times are CLOCK_REALTIME, ns.
// The adapter has a thread of its own; all functions from any other. Throws std::runtime_error
// where the kernel has no virtual USB controller or no gs_usb.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "drivers/can/stream_settings.hpp"
#include "drivers/can/time/frame_duration.hpp"
#include "drivers/link/file_descriptor.hpp"
#include "tests/can/gs_usb_protocol.hpp"
#include "tests/can/usbip_device.hpp"

namespace dyncal::tests {

struct GsUsbSettings {
  drivers::can::BitRates bus = {1e6, 5e6}; // of the other devices
  bool stamps = true;
  drivers::can::StampPoint stamp_point = drivers::can::StampPoint::end_of_frame;
  double clock_ppm = 0.0;
  std::uint32_t clock_start_us = 5'000'000; // when it is plugged in
  double min_latency_s = 100e-6;            // from the end of a frame to the host
  double max_latency_s = 2e-3;
  std::uint32_t seed = 1;
};

class GsUsbAdapter : private UsbFirmware {
public:
  static constexpr std::size_t channels = 2;

  // Plugged in, interfaces there but down.
  explicit GsUsbAdapter(const GsUsbSettings& settings);
  ~GsUsbAdapter() override;
  GsUsbAdapter(const GsUsbAdapter&) = delete;
  GsUsbAdapter& operator=(const GsUsbAdapter&) = delete;

  [[nodiscard]] const std::string& name(std::size_t channel) const { return names_.at(channel); }
  // "bitrate 500000", "bitrate 1000000 dbitrate 5000000 fd on".
  void set_up(std::size_t channel, const std::string& bit_timing) const;

  void unplug();
  void plug_in();

  // Another device's frame begins at `start_ns`, or when the bus is idle then. Nobody hears it
  // while the adapter is out.
  void put(const drivers::can::CanFrame& frame, std::int64_t start_ns);
  // An error frame of the controller, at once (linux/can/error.h).
  void say_error(std::size_t channel, std::uint32_t classes,
                 const std::array<std::uint8_t, 8>& data);
  // The controller leaves the bus; the firmware brings it back.
  void bus_off(std::size_t channel);
  void recover(std::size_t channel);
  // The next frames from the bus find no room in the adapter; the one after them tells of it.
  void overrun(std::size_t frames);

  [[nodiscard]] std::uint32_t clock_us(std::int64_t at_ns) const;
  // Bit rates that the host has set.
  [[nodiscard]] drivers::can::BitRates rates(std::size_t channel) const;

private:
  struct Channel {
    bool started = false;
    bool bus_off = false;
    drivers::can::BitRates rates;
    unsigned receive_errors = 0;
  };
  struct OnBus {
    gs_usb::HostFrame said;
    std::optional<std::size_t> sender; // nothing: another device
    std::int64_t start_ns = 0;
  };
  struct ToHost {
    std::vector<std::uint8_t> transfer;
    std::int64_t due_ns = 0;
    std::uint8_t channel = 0;
  };

  std::optional<std::vector<std::uint8_t>> control(const ControlRequest& request,
                                                   std::span<const std::uint8_t> sent) override;
  void bulk_out(std::span<const std::uint8_t> sent) override;
  std::optional<std::vector<std::uint8_t>> vendor_request(const ControlRequest& request,
                                                          std::span<const std::uint8_t> sent);

  void run(const std::stop_token& stop);
  void wake_up() const;
  // These with the lock held.
  std::int64_t do_what_is_due();
  void queue(const OnBus& next);
  void transmit(const OnBus& sent);
  void mishear(std::size_t channel, std::int64_t end_ns);
  void tell_host(gs_usb::HostFrame said, std::int64_t stamped_ns, std::int64_t end_ns);
  [[nodiscard]] bool at_the_bus_rate(const Channel& channel,
                                     const drivers::can::CanFrame& frame) const;
  void find_interfaces();

  GsUsbSettings settings_;
  std::vector<std::string> names_;
  drivers::FileDescriptor wake_up_;
  mutable std::mutex mutex_;
  std::array<Channel, channels> channels_;
  std::deque<OnBus> to_bus_;
  std::deque<ToHost> to_host_;
  std::int64_t bus_idle_ns_ = 0;
  std::int64_t plugged_in_ns_ = 0;
  bool plugged_in_ = false;
  std::size_t overrun_ = 0;
  bool tell_of_overrun_ = false;
  std::mt19937 random_;
  std::unique_ptr<UsbipDevice> device_; // used by the thread alone while it runs
  std::jthread thread_;
};

} // namespace dyncal::tests
