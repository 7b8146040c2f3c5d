#include "drivers/can/bus/socketcan_source.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <system_error>
#include <utility>

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <poll.h>
#include <sys/socket.h>

#include "drivers/can/bus/error_frame.hpp"
#include "drivers/can/bus/link_transition.hpp"

namespace dyncal::drivers::can {

namespace {

constexpr std::size_t batch = 64;
constexpr std::size_t control_bytes = 256;
constexpr int max_errors = 4; // of an interface that goes, in one read: down, and gone

std::string system_text(int error) {
  return std::generic_category().message(error);
}

std::int64_t to_ns(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

} // namespace

// The memory that recvmmsg fills. The addresses in it never change.
struct SocketCanSource::Buffers {
  std::array<mmsghdr, batch> messages{};
  std::array<iovec, batch> parts{};
  std::array<canfd_frame, batch> frames{};
  alignas(cmsghdr) std::array<std::array<std::uint8_t, control_bytes>, batch> control{};

  void prepare() {
    for (std::size_t i = 0; i < batch; ++i) {
      parts[i] = {&frames[i], sizeof frames[i]};
      messages[i] = {};
      messages[i].msg_hdr.msg_iov = &parts[i];
      messages[i].msg_hdr.msg_iovlen = 1;
      messages[i].msg_hdr.msg_control = control[i].data();
      messages[i].msg_hdr.msg_controllen = control[i].size();
    }
  }
};

SocketCanSource::SocketCanSource(SocketCanSettings settings)
    : settings_(std::move(settings)), buffers_(std::make_unique<Buffers>()) {}

SocketCanSource::~SocketCanSource() = default;

Expected<void> SocketCanSource::check_link(const LinkState& link) const {
  const std::string& name = settings_.interface_name;
  if (!link.present) {
    return fail(ErrorCode::not_found, "there is no interface '" + name +
                                          "'; 'ip link' lists the interfaces of this machine");
  }
  if (!link.up) {
    return fail(ErrorCode::refused,
                "interface '" + name + "' is down; 'ip link set " + name + " up" +
                    (link.kind == "can" ? " type can bitrate 500000' sets it up at 500 kbit/s"
                                        : "' sets it up"));
  }
  const auto disagrees = [&](const char* what, std::uint32_t wanted, std::uint32_t is) {
    return fail(ErrorCode::invalid_setting, "interface '" + name + "' runs at a " + what + " of " +
                                                std::to_string(is) +
                                                " bit/s, the bench file says " +
                                                std::to_string(wanted) + "; change one of them");
  };
  if (settings_.bit_rate_per_s != 0 && link.bit_rate_per_s != 0 &&
      link.bit_rate_per_s != settings_.bit_rate_per_s) {
    return disagrees("bit rate", settings_.bit_rate_per_s, link.bit_rate_per_s);
  }
  if (settings_.data_bit_rate_per_s != 0 && link.data_bit_rate_per_s != 0 &&
      link.data_bit_rate_per_s != settings_.data_bit_rate_per_s) {
    return disagrees("data bit rate", settings_.data_bit_rate_per_s, link.data_bit_rate_per_s);
  }
  return {};
}

Expected<LinkState> SocketCanSource::open(const std::vector<FrameFilter>& filters) {
  filters_ = filters;
  // Before the interface is looked for: a kernel without CAN has no CAN interface either, and this
  // is the reason.
  if (const FileDescriptor probe(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
      !probe.is_open()) {
    if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
      return fail(ErrorCode::refused, settings_.interface_name +
                                          ": this kernel has no CAN sockets; 'modprobe "
                                          "can-raw', or a kernel with CONFIG_CAN_RAW");
    }
    return fail(ErrorCode::refused,
                settings_.interface_name + ": a CAN socket cannot be opened (" +
                    system_text(errno) +
                    "); does the program run where raw sockets of CAN are allowed?");
  }
  DYNCAL_TRY(auto monitor, LinkMonitor::open(settings_.interface_name));
  monitor_.emplace(std::move(monitor));
  DYNCAL_TRY(check_link(monitor_->state()));
  link_ = monitor_->state();
  DYNCAL_TRY(open_socket());
  return link_;
}

Expected<void> SocketCanSource::set_options(int socket) const {
  std::vector<can_filter> kernel_filters;
  for (const FrameFilter& filter : filters_) {
    kernel_filters.push_back({filter.id | (filter.extended ? CAN_EFF_FLAG : 0U),
                              filter.mask | CAN_EFF_FLAG | CAN_RTR_FLAG});
  }
  const auto set = [&](int level, int option, const void* value, std::size_t size) {
    return ::setsockopt(socket, level, option, value, static_cast<socklen_t>(size)) == 0;
  };
  const int on = 1;
  const can_err_mask_t errors = CAN_ERR_MASK;
  const int stamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE |
                     SOF_TIMESTAMPING_RX_HARDWARE | SOF_TIMESTAMPING_RAW_HARDWARE;
  if (!set(SOL_CAN_RAW, CAN_RAW_FILTER, kernel_filters.data(),
           kernel_filters.size() * sizeof(can_filter))) {
    return fail(ErrorCode::refused, settings_.interface_name +
                                        ": the kernel does not take the filters of " +
                                        std::to_string(filters_.size()) + " messages (" +
                                        system_text(errno) + "); name fewer messages");
  }
  if (!set(SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on) ||
      !set(SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) ||
      !set(SOL_SOCKET, SO_TIMESTAMPING, &stamps, sizeof stamps) ||
      !set(SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on)) {
    return fail(ErrorCode::refused,
                settings_.interface_name +
                    ": the kernel is too old for what is needed of its CAN sockets (" +
                    system_text(errno) + ")");
  }
  // Beyond the system's limit only the superuser may go; others get what the limit allows.
  if (!set(SOL_SOCKET, SO_RCVBUFFORCE, &settings_.receive_buffer_bytes, sizeof(int))) {
    set(SOL_SOCKET, SO_RCVBUF, &settings_.receive_buffer_bytes, sizeof(int));
  }
  return {};
}

Expected<void> SocketCanSource::open_socket() {
  FileDescriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW));
  if (!socket.is_open()) {
    return fail(ErrorCode::refused, settings_.interface_name + ": no CAN socket can be opened (" +
                                        system_text(errno) + ")");
  }
  DYNCAL_TRY(set_options(socket.number()));
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = monitor_->interface_index();
  if (::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return fail(errno == ENODEV ? ErrorCode::not_found : ErrorCode::refused,
                "interface '" + settings_.interface_name +
                    "' is not a CAN interface or has gone (" + system_text(errno) + ")");
  }
  socket_ = std::move(socket);
  bound_index_ = monitor_->interface_index();
  dropped_ = 0;
  return {};
}

Expected<ReadState> SocketCanSource::read(std::vector<BusEvent>& events,
                                          std::chrono::milliseconds limit) {
  std::array<pollfd, 3> waited = {pollfd{stop_.descriptor(), POLLIN, 0},
                                  pollfd{monitor_->descriptor(), POLLIN, 0},
                                  pollfd{socket_.number(), POLLIN, 0}};
  const bool some =
      ::poll(waited.data(), socket_.is_open() ? 3 : 2, static_cast<int>(limit.count())) > 0;
  if (some && waited[0].revents != 0) {
    return ReadState::stopped;
  }
  // Frames before announcements: what came before a change stands before it.
  const std::size_t first = events.size();
  const bool went_down = some && socket_.is_open() && waited[2].revents != 0 && receive(events);
  if (went_down || (some && waited[1].revents != 0)) {
    DYNCAL_TRY(const auto changes, monitor_->update());
    // Down and up again since the last read: which of the frames came before it nobody can tell,
    // and an adapter's clock has jumped.
    const bool back = std::any_of(changes.begin(), changes.end(),
                                  [](const auto& announced) { return announced.state.up; });
    if (went_down && back && events.size() > first) {
      events.insert(
          events.begin() + static_cast<std::ptrdiff_t>(first),
          LinkChange{link_, true,
                     "interface '" + link_.name + "' was down while frames waited to be read"});
    }
    for (const LinkMonitor::Change& announced : changes) {
      follow_link(announced, events);
    }
  }
  restart_after_bus_off(events);
  return ReadState::more;
}

// ENETDOWN comes once when the interface goes down, before the frames that are still to be read,
// and the socket lives on; ENODEV when it has gone. Both are announced by the monitor too; a socket
// whose interface has gone is dropped here already, so that it does not wake us again and again,
// but not before it has been read out.
bool SocketCanSource::receive(std::vector<BusEvent>& events) {
  bool went_down = false;
  bool gone = false;
  for (int errors = 0; errors < max_errors;) {
    buffers_->prepare();
    const int got =
        ::recvmmsg(socket_.number(), buffers_->messages.data(), batch, MSG_DONTWAIT, nullptr);
    for (int i = 0; i < got; ++i) {
      take(static_cast<std::size_t>(i), events);
    }
    const bool down = got < 0 && errno == ENETDOWN;
    const bool no_device = got < 0 && (errno == ENODEV || errno == ENXIO);
    went_down = went_down || down || no_device;
    gone = gone || no_device;
    errors += down || no_device ? 1 : 0;
    if (!down && !no_device && (!went_down || got < static_cast<int>(batch))) {
      break;
    }
  }
  if (gone) {
    socket_.reset();
  }
  return went_down;
}

void SocketCanSource::take(std::size_t message, std::vector<BusEvent>& events) {
  const mmsghdr& received = buffers_->messages[message];
  const canfd_frame& raw = buffers_->frames[message];
  CanFrame frame;
  std::uint32_t dropped = dropped_;
  msghdr header = received.msg_hdr;
  for (const cmsghdr* control = CMSG_FIRSTHDR(&header); control != nullptr;
       control = CMSG_NXTHDR(&header, const_cast<cmsghdr*>(control))) {
    if (control->cmsg_level != SOL_SOCKET) {
      continue;
    }
    if (control->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&dropped, CMSG_DATA(control), sizeof dropped);
    } else if (control->cmsg_type == SO_TIMESTAMPING) {
      scm_timestamping stamps{};
      std::memcpy(&stamps, CMSG_DATA(control), sizeof stamps);
      frame.kernel_ns = to_ns(stamps.ts[0]);
      frame.hardware_ns = to_ns(stamps.ts[2]);
    }
  }
  if (dropped != dropped_) {
    events.emplace_back(FramesLost{std::uint32_t{dropped - dropped_}}); // modulo 2^32
  }
  dropped_ = dropped;
  // Classic or FD is told by the size of what was read, never by the length in it.
  frame.fd = received.msg_len == CANFD_MTU;
  if ((!frame.fd && received.msg_len != CAN_MTU) ||
      raw.len > (frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN)) {
    return;
  }
  if ((raw.can_id & CAN_ERR_FLAG) != 0) {
    const BusFault fault =
        bus_fault(raw.can_id & CAN_ERR_MASK, std::span<const std::uint8_t, 8>(raw.data, 8));
    note_fault(fault);
    events.emplace_back(fault);
    return;
  }
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.bit_rate_switch = frame.fd && (raw.flags & CANFD_BRS) != 0;
  frame.error_state_indicator = frame.fd && (raw.flags & CANFD_ESI) != 0;
  frame.sent_here = (received.msg_hdr.msg_flags & MSG_DONTROUTE) != 0;
  frame.length = raw.len;
  std::memcpy(frame.data.data(), raw.data, raw.len);
  events.emplace_back(frame);
}

void SocketCanSource::note_fault(const BusFault& fault) {
  if (fault.state == BusState::bus_off && !bus_off_since_) {
    bus_off_since_ = Clock::now();
  } else if (fault.state != BusState::unknown && fault.state != BusState::bus_off) {
    bus_off_since_.reset();
  }
}

// Once the socket's interface is another one, or none, it hears nothing more. A refused one is
// tried again with the next announcement.
Binding SocketCanSource::follow_interface(int index) {
  if (index == bound_index_) {
    return Binding::kept;
  }
  socket_.reset();
  if (!link_.present) {
    bound_index_ = 0;
    return Binding::kept;
  }
  return open_socket() ? Binding::renewed : Binding::refused;
}

void SocketCanSource::follow_link(const LinkMonitor::Change& announced,
                                  std::vector<BusEvent>& events) {
  const LinkState before = std::exchange(link_, announced.state);
  const Binding binding = follow_interface(announced.interface_index);
  const LinkTransition transition = transition_between(before, link_, binding);
  if (link_.bus == BusState::bus_off && !bus_off_since_) {
    bus_off_since_ = Clock::now();
  } else if (link_.bus == BusState::error_active || !link_.up) {
    bus_off_since_.reset();
  }
  if (transition != LinkTransition::none || !(link_ == before)) {
    events.emplace_back(
        LinkChange{link_, interrupts(transition), describe(transition, before, link_)});
  }
}

void SocketCanSource::restart_after_bus_off(std::vector<BusEvent>& events) {
  if (!bus_off_since_ || !settings_.restart_after_bus_off ||
      Clock::now() - *bus_off_since_ < *settings_.restart_after_bus_off) {
    return;
  }
  bus_off_since_ = Clock::now(); // again after the same time, should this not help
  auto restarted = monitor_->restart_controller();
  std::string how = "controller restarted after bus-off";
  if (!restarted) {
    restarted = monitor_->set_up(false).and_then([this] { return monitor_->set_up(true); });
    how = "interface set down and up after bus-off";
  }
  if (restarted) {
    bus_off_since_.reset();
  }
  events.emplace_back(LinkChange{link_, true, restarted ? how : restarted.error().message});
}

} // namespace dyncal::drivers::can
