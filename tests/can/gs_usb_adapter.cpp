#include "tests/can/gs_usb_adapter.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <stdexcept>

#include <glob.h>
#include <linux/can/error.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "drivers/can/time/frame_duration.hpp"
#include "tests/can/kernel_can.hpp"

#ifndef CAN_ERR_CNT
#define CAN_ERR_CNT 0x200U
#endif

namespace dyncal::tests {

using drivers::can::BitRates;
using drivers::can::StampPoint;

namespace {

constexpr const char* interfaces_glob = "/sys/devices/platform/vhci_hcd.0/usb*/*-*/*:1.0/net/can*";

// USB descriptors of a full candleLight FD device: one interface with a bulk endpoint in each
// direction.
std::optional<std::vector<std::uint8_t>> descriptor(std::uint16_t value) {
  const auto text = [](const std::string& said) {
    std::vector<std::uint8_t> bytes = {static_cast<std::uint8_t>(2 + 2 * said.size()), 3};
    for (const char letter : said) {
      bytes.push_back(static_cast<std::uint8_t>(letter));
      bytes.push_back(0);
    }
    return bytes;
  };
  switch (value >> 8U) {
  case 1: // USB 2.0, vendor 1209, product 2323
    return std::vector<std::uint8_t>{18,   1,    0,    2, 0, 0, 0, 64, 0x09,
                                     0x12, 0x23, 0x23, 0, 1, 1, 2, 3,  1};
  case 2:
    return std::vector<std::uint8_t>{9, 2, 32, 0,    1,    1,    0, 0x80, 50, 9,    4,
                                     0, 0, 2,  0xFF, 0xFF, 0xFF, 0, 7,    5,  0x81, 2,
                                     0, 2, 0,  7,    5,    0x02, 2, 0,    2,  0};
  case 3:
    switch (value & 0xFFU) {
    case 0:
      return std::vector<std::uint8_t>{4, 3, 9, 4}; // English
    case 1:
      return text("dyncal");
    case 2:
      return text("played CAN FD adapter");
    default:
      return text("1");
    }
  default:
    return std::nullopt;
  }
}

double bit_rate_per_s(std::span<const std::uint8_t> timing) {
  const std::uint32_t quanta =
      1 + gs_usb::get_32(timing, 0) + gs_usb::get_32(timing, 4) + gs_usb::get_32(timing, 8);
  return double{gs_usb::controller_clock_hz} /
         (static_cast<double>(quanta) * gs_usb::get_32(timing, 16));
}

} // namespace

GsUsbAdapter::GsUsbAdapter(const GsUsbSettings& settings)
    : settings_(settings), wake_up_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      random_(settings.seed) {
  plug_in();
}

GsUsbAdapter::~GsUsbAdapter() {
  unplug();
}

void GsUsbAdapter::plug_in() {
  plugged_in_ns_ =
      now_ns() / 1'000'000 * 1'000'000; // its clock steps with the bench's milliseconds
  plugged_in_ = true;
  UsbFirmware& firmware = *this;
  device_ = std::make_unique<UsbipDevice>(firmware);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  find_interfaces();
}

void GsUsbAdapter::unplug() {
  thread_.request_stop();
  wake_up();
  thread_ = {};
  device_.reset();
  const std::scoped_lock lock(mutex_);
  plugged_in_ = false;
  to_bus_.clear();
  to_host_.clear();
  channels_ = {};
}

void GsUsbAdapter::find_interfaces() {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  do {
    glob_t found{};
    names_.clear();
    if (::glob(interfaces_glob, 0, nullptr, &found) == 0) {
      for (std::size_t i = 0; i < found.gl_pathc; ++i) {
        names_.push_back(
            std::string(found.gl_pathv[i]).substr(std::string(found.gl_pathv[i]).rfind('/') + 1));
      }
    }
    ::globfree(&found);
    if (names_.size() == channels) {
      return;
    }
    const timespec pause{0, 10'000'000}; // between two looks at the condition
    ::nanosleep(&pause, nullptr);
  } while (std::chrono::steady_clock::now() < deadline);
  throw std::runtime_error("the kernel makes no interfaces of the adapter; has it gs_usb?");
}

void GsUsbAdapter::set_up(std::size_t channel, const std::string& bit_timing) const {
  ip("set " + name(channel) + " type can " + bit_timing);
  ip("set " + name(channel) + " up");
}

void GsUsbAdapter::wake_up() const {
  const std::uint64_t one = 1;
  // Fails only when it is signalled already.
  static_cast<void>(::write(wake_up_.number(), &one, sizeof one) < 0);
}

std::uint32_t GsUsbAdapter::clock_us(std::int64_t at_ns) const {
  const double passed_us =
      static_cast<double>(at_ns - plugged_in_ns_) * (1.0 + settings_.clock_ppm * 1e-6) * 1e-3;
  return settings_.clock_start_us +
         static_cast<std::uint32_t>(static_cast<std::uint64_t>(passed_us)); // modulo 2^32
}

BitRates GsUsbAdapter::rates(std::size_t channel) const {
  const std::scoped_lock lock(mutex_);
  return channels_.at(channel).rates;
}

void GsUsbAdapter::put(const drivers::can::CanFrame& frame, std::int64_t start_ns) {
  {
    const std::scoped_lock lock(mutex_);
    if (!plugged_in_) {
      return;
    }
    OnBus next;
    next.said.frame = frame;
    next.start_ns = start_ns;
    queue(next);
  }
  wake_up();
}

void GsUsbAdapter::queue(const OnBus& next) {
  const auto behind = std::upper_bound(
      to_bus_.begin(), to_bus_.end(), next.start_ns,
      [](std::int64_t start_ns, const OnBus& other) { return start_ns < other.start_ns; });
  to_bus_.insert(behind, next);
}

void GsUsbAdapter::say_error(std::size_t channel, std::uint32_t classes,
                             const std::array<std::uint8_t, 8>& data) {
  {
    const std::scoped_lock lock(mutex_);
    gs_usb::HostFrame said;
    said.channel = static_cast<std::uint8_t>(channel);
    said.error = classes;
    said.frame.length = 8;
    std::copy(data.begin(), data.end(), said.frame.data.begin());
    const std::int64_t at_ns = now_ns();
    tell_host(said, at_ns, at_ns);
  }
  wake_up();
}

void GsUsbAdapter::bus_off(std::size_t channel) {
  {
    const std::scoped_lock lock(mutex_);
    channels_.at(channel).bus_off = true;
  }
  say_error(channel, CAN_ERR_BUSOFF | CAN_ERR_CNT, {0, 0, 0, 0, 0, 0, 255, 0});
}

void GsUsbAdapter::recover(std::size_t channel) {
  {
    const std::scoped_lock lock(mutex_);
    channels_.at(channel).bus_off = false;
  }
  say_error(channel, CAN_ERR_RESTARTED | CAN_ERR_CNT, {});
}

void GsUsbAdapter::overrun(std::size_t frames) {
  const std::scoped_lock lock(mutex_);
  overrun_ = frames;
}

void GsUsbAdapter::run(const std::stop_token& stop) {
  ::prctl(PR_SET_TIMERSLACK, 1UL); // ns: an adapter does not wait for others to wake up with it
  for (bool attached = true; attached && !stop.stop_requested();) {
    std::int64_t due_ns = 0;
    {
      const std::scoped_lock lock(mutex_);
      due_ns = do_what_is_due();
    }
    const std::int64_t wait_ns = std::max<std::int64_t>(0, due_ns - now_ns());
    const timespec limit{wait_ns / second_ns, wait_ns % second_ns};
    std::array<pollfd, 2> waited = {pollfd{device_->descriptor(), POLLIN, 0},
                                    pollfd{wake_up_.number(), POLLIN, 0}};
    if (::ppoll(waited.data(), waited.size(),
                due_ns == std::numeric_limits<std::int64_t>::max() ? nullptr : &limit,
                nullptr) < 0) {
      continue;
    }
    if (waited[0].revents != 0) {
      const std::scoped_lock lock(mutex_);
      attached = device_->serve();
    }
    std::uint64_t signalled = 0;
    if (waited[1].revents != 0) {
      static_cast<void>(::read(wake_up_.number(), &signalled, sizeof signalled) < 0);
    }
  }
}

// When there is more to do.
std::int64_t GsUsbAdapter::do_what_is_due() {
  const std::int64_t at_ns = now_ns();
  while (!to_bus_.empty() && std::max(to_bus_.front().start_ns, bus_idle_ns_) <= at_ns) {
    const OnBus next = to_bus_.front();
    to_bus_.pop_front();
    transmit(next);
  }
  while (!to_host_.empty() && to_host_.front().due_ns <= at_ns) {
    device_->bulk_in(std::move(to_host_.front().transfer));
    to_host_.pop_front();
  }
  std::int64_t due_ns = std::numeric_limits<std::int64_t>::max();
  if (!to_bus_.empty()) {
    due_ns = std::max(to_bus_.front().start_ns, bus_idle_ns_);
  }
  if (!to_host_.empty()) {
    due_ns = std::min(due_ns, to_host_.front().due_ns);
  }
  return due_ns;
}

bool GsUsbAdapter::at_the_bus_rate(const Channel& channel,
                                   const drivers::can::CanFrame& frame) const {
  const auto agree = [](double a, double b) { return std::abs(a - b) < 0.005 * b; };
  return agree(channel.rates.nominal_per_s, settings_.bus.nominal_per_s) &&
         (!frame.bit_rate_switch || agree(channel.rates.data_per_s, settings_.bus.data_per_s));
}

void GsUsbAdapter::transmit(const OnBus& sent) {
  const drivers::can::CanFrame& frame = sent.said.frame;
  const std::int64_t start_ns = std::max(sent.start_ns, bus_idle_ns_);
  const std::int64_t end_ns =
      start_ns + std::llround(drivers::can::frame_duration_s(frame, settings_.bus) * 1e9);
  bus_idle_ns_ = end_ns;
  const std::int64_t stamped_ns =
      settings_.stamp_point == StampPoint::start_of_frame ? start_ns : end_ns;
  if (sent.sender) {
    tell_host(sent.said, stamped_ns, end_ns);
  }
  for (std::size_t channel = 0; channel < channels; ++channel) {
    Channel& hearer = channels_[channel];
    if (!hearer.started || hearer.bus_off || sent.sender == channel) {
      continue;
    }
    if (!at_the_bus_rate(hearer, frame)) {
      mishear(channel, end_ns);
      continue;
    }
    if (overrun_ > 0) {
      --overrun_;
      tell_of_overrun_ = true;
      continue;
    }
    gs_usb::HostFrame heard;
    heard.frame = frame;
    heard.channel = static_cast<std::uint8_t>(channel);
    heard.overflow = std::exchange(tell_of_overrun_, false);
    tell_host(heard, stamped_ns, end_ns);
  }
}

// ISO 11898-1: a receiver's counter goes up with every error, to no more than error passive.
void GsUsbAdapter::mishear(std::size_t channel, std::int64_t end_ns) {
  constexpr unsigned step = 8;
  constexpr unsigned warning = 96;
  constexpr unsigned passive = 128;
  unsigned& errors = channels_[channel].receive_errors;
  const unsigned before = errors;
  errors = std::min(errors + step, passive + step - 1);
  gs_usb::HostFrame said;
  said.channel = static_cast<std::uint8_t>(channel);
  said.error = CAN_ERR_PROT | CAN_ERR_BUSERROR | CAN_ERR_CNT;
  said.frame.length = 8;
  said.frame.data = {0,
                     0,
                     CAN_ERR_PROT_STUFF,
                     CAN_ERR_PROT_LOC_UNSPEC,
                     0,
                     0,
                     0,
                     static_cast<std::uint8_t>(errors)};
  if (before < passive && errors >= warning && (before < warning || errors >= passive)) {
    said.error |= CAN_ERR_CRTL;
    said.frame.data[1] = errors >= passive ? CAN_ERR_CRTL_RX_PASSIVE : CAN_ERR_CRTL_RX_WARNING;
  }
  tell_host(said, end_ns, end_ns);
}

void GsUsbAdapter::tell_host(gs_usb::HostFrame said, std::int64_t stamped_ns, std::int64_t end_ns) {
  std::uniform_real_distribution<double> latency_s(settings_.min_latency_s,
                                                   settings_.max_latency_s);
  std::int64_t due_ns = end_ns + std::llround(latency_s(random_) * 1e9);
  if (!to_host_.empty()) {
    due_ns = std::max(due_ns, to_host_.back().due_ns);
  }
  said.stamp_us = clock_us(stamped_ns);
  to_host_.push_back({gs_usb::pack(said, settings_.stamps), due_ns, said.channel});
}

void GsUsbAdapter::bulk_out(std::span<const std::uint8_t> sent) {
  const auto said = gs_usb::unpack(sent);
  if (!said || said->channel >= channels || !channels_[said->channel].started ||
      channels_[said->channel].bus_off) {
    return;
  }
  OnBus next;
  next.said = *said;
  next.sender = said->channel;
  next.start_ns = now_ns();
  queue(next);
}

std::optional<std::vector<std::uint8_t>> GsUsbAdapter::control(const ControlRequest& request,
                                                               std::span<const std::uint8_t> sent) {
  constexpr std::uint8_t get_status = 0;
  constexpr std::uint8_t get_descriptor = 6;
  if (!request.standard()) {
    return vendor_request(request, sent);
  }
  if (request.request == get_descriptor) {
    return descriptor(request.value);
  }
  if (request.request == get_status) {
    return std::vector<std::uint8_t>{0, 0};
  }
  return std::vector<std::uint8_t>{}; // address, configuration, interface
}

std::optional<std::vector<std::uint8_t>>
GsUsbAdapter::vendor_request(const ControlRequest& request, std::span<const std::uint8_t> sent) {
  std::vector<std::uint8_t> said;
  const auto say = [&](std::initializer_list<std::uint32_t> values) {
    for (const std::uint32_t value : values) {
      gs_usb::put_32(said, value);
    }
  };
  Channel* channel = request.value < channels ? &channels_[request.value] : nullptr;
  const std::uint32_t features = gs_usb::feature_fd | gs_usb::feature_extended_limits |
                                 (settings_.stamps ? gs_usb::feature_hardware_stamps : 0U);
  switch (static_cast<gs_usb::Request>(request.request)) {
  case gs_usb::Request::host_format:
    return said;
  case gs_usb::Request::device_config:
    say({(channels - 1) << 24U, 2, 1});
    return said;
  case gs_usb::Request::bit_timing_limits:
  case gs_usb::Request::extended_bit_timing_limits:
    // Segments and jump width in quanta, prescaler and its step: nominal, then data.
    say({features, gs_usb::controller_clock_hz, 1, 256, 1, 128, 128, 1, 512, 1});
    if (request.request == static_cast<std::uint8_t>(gs_usb::Request::extended_bit_timing_limits)) {
      say({1, 32, 1, 16, 16, 1, 32, 1});
    }
    return said;
  case gs_usb::Request::timestamp:
    say({clock_us(now_ns())});
    return said;
  case gs_usb::Request::bit_timing:
  case gs_usb::Request::data_bit_timing: {
    if (channel == nullptr || sent.size() < 20) {
      return std::nullopt;
    }
    const bool nominal = request.request == static_cast<std::uint8_t>(gs_usb::Request::bit_timing);
    (nominal ? channel->rates.nominal_per_s : channel->rates.data_per_s) = bit_rate_per_s(sent);
    return said;
  }
  case gs_usb::Request::mode:
    if (channel == nullptr || sent.size() < 8) {
      return std::nullopt;
    }
    channel->started = gs_usb::get_32(sent, 0) == gs_usb::mode_start;
    channel->bus_off = false;
    channel->receive_errors = 0;
    std::erase_if(to_host_, [&](const ToHost& other) {
      return other.channel == request.value;
    }); // nothing of before comes after
    return said;
  }
  return std::nullopt;
}

} // namespace dyncal::tests
