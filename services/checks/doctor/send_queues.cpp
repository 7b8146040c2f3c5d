#include "services/checks/doctor/send_queues.hpp"

#include <linux/gen_stats.h>
#include <linux/pkt_sched.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr std::size_t answer_bytes = 65536; // of one part of the kernel's list

// Calls `take` with the type, the bytes and the length of every attribute.
template <class Take>
void for_each_attribute(const char* bytes, std::size_t size, const Take& take) {
  rtattr head{};
  while (size >= sizeof(head)) {
    std::memcpy(&head, bytes, sizeof(head));
    if (head.rta_len < sizeof(head) || head.rta_len > size) {
      return;
    }
    take(head.rta_type & NLA_TYPE_MASK, bytes + sizeof(head), head.rta_len - sizeof(head));
    const std::size_t step = std::min<std::size_t>(RTA_ALIGN(head.rta_len), size);
    bytes += step;
    size -= step;
  }
}

template <class T>
T read_as(const char* bytes, std::size_t size) {
  T value{};
  std::memcpy(&value, bytes, std::min(size, sizeof(value)));
  return value;
}

SendQueue queue_of(const char* attributes, std::size_t size) {
  SendQueue queue;
  for_each_attribute(attributes, size, [&](int type, const char* nested, std::size_t length) {
    if (type != TCA_STATS2) {
      return;
    }
    for_each_attribute(nested, length, [&](int kind, const char* bytes, std::size_t count) {
      if (kind == TCA_STATS_BASIC) {
        queue.sent = read_as<gnet_stats_basic>(bytes, count).packets;
      } else if (kind == TCA_STATS_QUEUE) {
        queue.dropped = read_as<gnet_stats_queue>(bytes, count).drops;
      }
    });
  });
  return queue;
}

// Returns whether more parts follow.
bool take_part(const std::vector<char>& bytes, std::size_t size,
               std::map<std::string, SendQueue>& queues) {
  std::size_t at = 0;
  while (size - at >= sizeof(nlmsghdr)) {
    const auto head = read_as<nlmsghdr>(bytes.data() + at, sizeof(nlmsghdr));
    if (head.nlmsg_len < sizeof(nlmsghdr) || head.nlmsg_len > size - at ||
        head.nlmsg_type == NLMSG_DONE || head.nlmsg_type == NLMSG_ERROR) {
      return false;
    }
    constexpr std::size_t fixed = NLMSG_LENGTH(sizeof(tcmsg));
    if (head.nlmsg_type == RTM_NEWQDISC && head.nlmsg_len >= fixed) {
      const auto qdisc = read_as<tcmsg>(bytes.data() + at + NLMSG_HDRLEN, sizeof(tcmsg));
      std::array<char, IF_NAMESIZE> name{};
      if (qdisc.tcm_parent == TC_H_ROOT &&
          if_indextoname(static_cast<unsigned>(qdisc.tcm_ifindex), name.data()) != nullptr) {
        queues[name.data()] = queue_of(bytes.data() + at + fixed, head.nlmsg_len - fixed);
      }
    }
    at += std::min<std::size_t>(NLMSG_ALIGN(head.nlmsg_len), size - at);
  }
  return true;
}

} // namespace

std::map<std::string, SendQueue> send_queues() {
  struct {
    nlmsghdr head;
    tcmsg qdisc;
  } request{};
  request.head.nlmsg_len = sizeof(request);
  request.head.nlmsg_type = RTM_GETQDISC;
  request.head.nlmsg_flags = NLM_F_REQUEST | NLM_F_DUMP;
  request.qdisc.tcm_family = AF_UNSPEC;

  std::map<std::string, SendQueue> queues;
  const drivers::FileDescriptor kernel(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (kernel.number() < 0 || send(kernel.number(), &request, sizeof(request), 0) !=
                                 static_cast<ssize_t>(sizeof(request))) {
    return queues;
  }
  std::vector<char> bytes(answer_bytes);
  for (bool more = true; more;) {
    const ssize_t count = recv(kernel.number(), bytes.data(), bytes.size(), 0);
    more = count > 0 && take_part(bytes, static_cast<std::size_t>(count), queues);
  }
  return queues;
}

} // namespace dyncal::inline checks::doctor
