#include "drivers/can/bus/link_monitor.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <poll.h>
#include <sys/socket.h>

namespace dyncal::drivers::can {

namespace {

std::string system_text(int error) {
  return std::generic_category().message(error);
}

// Attributes one after the other; `visit(type, data, length)`.
template <class Visit>
void each_attribute(const std::uint8_t* data, std::size_t length, Visit visit) {
  while (length >= sizeof(rtattr)) {
    rtattr attribute{};
    std::memcpy(&attribute, data, sizeof attribute);
    if (attribute.rta_len < sizeof attribute || attribute.rta_len > length) {
      return;
    }
    visit(attribute.rta_type & NLA_TYPE_MASK, data + sizeof attribute,
          attribute.rta_len - sizeof attribute);
    const std::size_t step = RTA_ALIGN(attribute.rta_len);
    if (step >= length) {
      return;
    }
    data += step;
    length -= step;
  }
}

template <class T>
T read_as(const std::uint8_t* data, std::size_t length) {
  T value{};
  std::memcpy(&value, data, std::min(length, sizeof value));
  return value;
}

std::string read_text(const std::uint8_t* data, std::size_t length) {
  std::string text(length, '\0');
  std::memcpy(text.data(), data, length);
  return text.substr(0, text.find('\0'));
}

BusState bus_state(std::uint32_t state) {
  switch (state) {
  case CAN_STATE_ERROR_ACTIVE:
    return BusState::error_active;
  case CAN_STATE_ERROR_WARNING:
    return BusState::error_warning;
  case CAN_STATE_ERROR_PASSIVE:
    return BusState::error_passive;
  case CAN_STATE_BUS_OFF:
    return BusState::bus_off;
  case CAN_STATE_STOPPED:
    return BusState::stopped;
  case CAN_STATE_SLEEPING:
    return BusState::sleeping;
  default:
    return BusState::unknown;
  }
}

void read_controller(const std::uint8_t* data, std::size_t length, LinkState& state) {
  each_attribute(data, length, [&](int type, const std::uint8_t* value, std::size_t size) {
    if (type == IFLA_CAN_STATE) {
      state.bus = bus_state(read_as<std::uint32_t>(value, size));
    } else if (type == IFLA_CAN_BERR_COUNTER) {
      const auto counter = read_as<can_berr_counter>(value, size);
      state.transmit_errors = counter.txerr;
      state.receive_errors = counter.rxerr;
    } else if (type == IFLA_CAN_BITTIMING) {
      const auto timing = read_as<can_bittiming>(value, size);
      state.bit_rate_per_s = timing.bitrate;
      state.sample_point = timing.sample_point / 1000.0;
    } else if (type == IFLA_CAN_DATA_BITTIMING) {
      state.data_bit_rate_per_s = read_as<can_bittiming>(value, size).bitrate;
    } else if (type == IFLA_CAN_CTRLMODE) {
      const auto mode = read_as<can_ctrlmode>(value, size);
      state.listen_only = (mode.flags & CAN_CTRLMODE_LISTENONLY) != 0;
    }
  });
}

struct LinkRequest {
  nlmsghdr header{};
  ifinfomsg link{};
  std::array<std::uint8_t, 64> attributes{};

  explicit LinkRequest(std::uint16_t type, std::uint16_t flags, int index = 0) {
    header.nlmsg_len = NLMSG_LENGTH(sizeof link);
    header.nlmsg_type = type;
    header.nlmsg_flags = static_cast<std::uint16_t>(NLM_F_REQUEST | flags);
    link.ifi_family = AF_UNSPEC;
    link.ifi_index = index;
  }
  // Appends an attribute; returns where it begins, so that one that holds others can be given its
  // length afterwards.
  std::size_t append(std::uint16_t type, const void* data, std::size_t size) {
    const std::size_t at = header.nlmsg_len - NLMSG_LENGTH(sizeof link);
    const rtattr attribute{static_cast<std::uint16_t>(sizeof(rtattr) + size), type};
    std::memcpy(attributes.data() + at, &attribute, sizeof attribute);
    if (size > 0) {
      std::memcpy(attributes.data() + at + sizeof attribute, data, size);
    }
    header.nlmsg_len += RTA_ALIGN(attribute.rta_len);
    return at;
  }
  void close(std::size_t at) {
    const auto length =
        static_cast<std::uint16_t>(header.nlmsg_len - NLMSG_LENGTH(sizeof link) - at);
    std::memcpy(attributes.data() + at, &length, sizeof length);
  }
};

} // namespace

Expected<LinkMonitor> LinkMonitor::open(const std::string& interface_name) {
  FileDescriptor socket(
      ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE));
  sockaddr_nl address{};
  address.nl_family = AF_NETLINK;
  address.nl_groups = RTMGRP_LINK;
  if (!socket.is_open() ||
      ::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return fail(ErrorCode::refused, "the kernel denies access to the state of its interfaces (" +
                                        system_text(errno) + ")");
  }
  LinkMonitor monitor(interface_name, std::move(socket));
  DYNCAL_TRY(monitor.ask());
  monitor.changes_.clear();
  return monitor;
}

Expected<void> LinkMonitor::request_links() {
  LinkRequest request(RTM_GETLINK, NLM_F_DUMP);
  if (::send(socket_.number(), &request, request.header.nlmsg_len, 0) < 0) {
    return fail(ErrorCode::refused,
                "the kernel does not answer about its interfaces (" + system_text(errno) + ")");
  }
  return {};
}

Expected<void> LinkMonitor::ask() {
  const LinkState before = state_;
  const int index_before = index_;
  state_ = {};
  state_.name = before.name;
  index_ = 0;
  DYNCAL_TRY(request_links());
  DYNCAL_TRY(read_messages(true));
  if (!state_.present) {
    state_.name = wanted_name_;
  }
  if (!(state_ == before) || index_ != index_before) {
    changes_.push_back({state_, index_});
  }
  return {};
}

Expected<std::vector<LinkMonitor::Change>> LinkMonitor::update() {
  DYNCAL_TRY(read_messages(false));
  return std::exchange(changes_, {});
}

Expected<void> LinkMonitor::read_messages(bool wait_for_answer) {
  alignas(nlmsghdr) std::array<std::uint8_t, 32768> buffer{};
  for (bool done = false; !done;) {
    const ssize_t got =
        ::recv(socket_.number(), buffer.data(), buffer.size(), wait_for_answer ? 0 : MSG_DONTWAIT);
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got < 0 && errno == EAGAIN) {
      if (!wait_for_answer) {
        break;
      }
      pollfd waiting{socket_.number(), POLLIN, 0}; // the answer to a dump is there at once, but
      ::poll(&waiting, 1, -1);                     // on a loaded machine
      continue;
    }
    if (got < 0 && errno == ENOBUFS) { // announcements were lost: ask for everything
      if (wait_for_answer) {
        continue;
      }
      return ask();
    }
    if (got <= 0) {
      return fail(ErrorCode::disconnected,
                  "the kernel no longer reports its interfaces (" + system_text(errno) + ")");
    }
    std::size_t left = static_cast<std::size_t>(got);
    for (std::size_t at = 0; left >= sizeof(nlmsghdr);) {
      nlmsghdr header{};
      std::memcpy(&header, buffer.data() + at, sizeof header);
      if (header.nlmsg_len < sizeof header || header.nlmsg_len > left) {
        break;
      }
      done = done || (wait_for_answer &&
                      (header.nlmsg_type == NLMSG_DONE || header.nlmsg_type == NLMSG_ERROR));
      const LinkState before = state_;
      const int index_before = index_;
      take_message(buffer.data() + at);
      if (!wait_for_answer && (!(state_ == before) || index_ != index_before)) {
        changes_.push_back({state_, index_});
      }
      const std::size_t step = std::min<std::size_t>(NLMSG_ALIGN(header.nlmsg_len), left);
      at += step;
      left -= step;
    }
  }
  return {};
}

void LinkMonitor::take_message(const void* message) {
  const auto* bytes = static_cast<const std::uint8_t*>(message);
  nlmsghdr header{};
  ifinfomsg link{};
  std::memcpy(&header, bytes, sizeof header);
  const bool about_a_link = header.nlmsg_type == RTM_NEWLINK || header.nlmsg_type == RTM_DELLINK;
  if (!about_a_link || header.nlmsg_len < NLMSG_LENGTH(sizeof link)) {
    return;
  }
  std::memcpy(&link, bytes + NLMSG_HDRLEN, sizeof link);
  if (link.ifi_family != AF_UNSPEC) {
    return; // bridges and the like speak of the same interfaces
  }
  const std::uint8_t* attributes = bytes + NLMSG_LENGTH(sizeof link);
  const std::size_t length = header.nlmsg_len - NLMSG_LENGTH(sizeof link);
  LinkState state;
  each_attribute(attributes, length, [&](int type, const std::uint8_t* value, std::size_t size) {
    if (type == IFLA_IFNAME) {
      state.name = read_text(value, size);
    } else if (type == IFLA_MTU) {
      state.fd = read_as<std::uint32_t>(value, size) >= 72; // CANFD_MTU
    } else if (type == IFLA_PARENT_DEV_BUS_NAME) {
      state.device_bus = read_text(value, size);
    } else if (type == IFLA_LINKINFO) {
      each_attribute(value, size, [&](int inner, const std::uint8_t* data, std::size_t bytes_left) {
        if (inner == IFLA_INFO_KIND) {
          state.kind = read_text(data, bytes_left);
        } else if (inner == IFLA_INFO_XSTATS) {
          state.restarts = read_as<can_device_stats>(data, bytes_left).restarts;
        } else if (inner == IFLA_INFO_DATA) {
          read_controller(data, bytes_left, state);
        }
      });
    }
  });
  if (link.ifi_index != index_ && (index_ != 0 || state.name != wanted_name_)) {
    return;
  }
  if (header.nlmsg_type == RTM_DELLINK) {
    state_ = {};
    state_.name = wanted_name_;
    index_ = 0;
    return;
  }
  state.present = true;
  state.up = (link.ifi_flags & IFF_UP) != 0;
  state.carrier = (link.ifi_flags & IFF_LOWER_UP) != 0;
  index_ = link.ifi_index;
  state_ = std::move(state);
}

Expected<void> LinkMonitor::change(const void* request, const std::string& what) {
  // A socket of its own, so that its answer does not stand among the announcements.
  const FileDescriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  nlmsghdr header{};
  std::memcpy(&header, request, sizeof header);
  std::array<std::uint8_t, 1024> answer{};
  int error = 0;
  if (!socket.is_open() || ::send(socket.number(), request, header.nlmsg_len, 0) < 0) {
    error = errno;
  } else if (const ssize_t got = ::recv(socket.number(), answer.data(), answer.size(), 0);
             got >= static_cast<ssize_t>(NLMSG_LENGTH(sizeof(int)))) {
    std::memcpy(&error, answer.data() + NLMSG_HDRLEN, sizeof error);
    error = -error;
  } else {
    error = EIO;
  }
  if (error == 0) {
    return {};
  }
  const std::string advice = error == EPERM ? "; it needs CAP_NET_ADMIN" : "";
  return fail(ErrorCode::refused, state_.name + ": the kernel does not " + what + " (" +
                                      system_text(error) + ")" + advice);
}

Expected<void> LinkMonitor::restart_controller() {
  LinkRequest request(RTM_NEWLINK, NLM_F_ACK, index_);
  const std::size_t info = request.append(IFLA_LINKINFO, nullptr, 0);
  request.append(IFLA_INFO_KIND, "can", 3);
  const std::size_t data = request.append(IFLA_INFO_DATA, nullptr, 0);
  const std::uint32_t restart = 1;
  request.append(IFLA_CAN_RESTART, &restart, sizeof restart);
  request.close(data);
  request.close(info);
  return change(&request, "restart the controller");
}

Expected<void> LinkMonitor::set_up(bool up) {
  LinkRequest request(RTM_NEWLINK, NLM_F_ACK, index_);
  request.link.ifi_change = IFF_UP;
  request.link.ifi_flags = up ? unsigned{IFF_UP} : 0U;
  return change(&request, up ? "set the interface up" : "set the interface down");
}

} // namespace dyncal::drivers::can
