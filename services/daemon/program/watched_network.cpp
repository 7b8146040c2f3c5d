#include "services/daemon/program/watched_network.hpp"

#include <algorithm>
#include <condition_variable>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "services/daemon/program/secured_network.hpp"
#include "services/security/identity_folder.hpp"

namespace dyncal::inline daemon {
namespace {

using Addresses = std::vector<bus::HostAddress>;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds look_interval{500};
// For what a program does at its end, such as closing its files.
constexpr std::chrono::seconds ending_time{2};

// Each look reads all that was discovered; for commands, which end soon, at first more often.
constexpr std::chrono::seconds strangers_interval{5};
constexpr std::size_t first_looks = 10;
constexpr std::chrono::milliseconds strange_for{900};
constexpr std::chrono::seconds said_when_strange_for{10};
constexpr std::size_t max_said = 1000;

// Of the interface that was named, which counts whatever it is; of all where none was.
Addresses addresses_of(const std::string& interface_name) {
  Addresses addresses = bus::host_addresses().value_or(Addresses());
  if (!interface_name.empty()) {
    std::erase_if(addresses,
                  [&](const bus::HostAddress& one) { return one.interface != interface_name; });
    for (bus::HostAddress& one : addresses) {
      one.inner = false;
    }
  }
  return addresses;
}

// `name_or_address` as --interface has it.
std::string interface_called(const std::string& name_or_address) {
  const Addresses addresses = bus::host_addresses().value_or(Addresses());
  const auto found = std::ranges::find(addresses, name_or_address, &bus::HostAddress::address);
  return found == addresses.end() ? name_or_address : found->interface;
}

} // namespace

Expected<std::unique_ptr<WatchedNetwork>>
WatchedNetwork::join(const NetworkOptions& options, const std::string& program,
                     const std::stop_token& asked,
                     std::function<void(const std::string& why)> when_deaf) {
  // First, so that what comes meanwhile is noticed.
  std::string interface_name = interface_called(options.interface_name);
  NetworkChanges changes;
  AddressesAtStart start{addresses_of(interface_name), {}};
  const NetworkUse use{.watch_discovery = true};
  DYNCAL_TRY(auto joined, options.security.empty()
                              ? join_network(options, program, use).map([](auto plain) {
                                  return bus::SecuredParticipant{std::move(plain), {}};
                                })
                              : join_secured_network(options, program, use));
  DYNCAL_TRY(const auto vendor, bus::parse_vendor(options.dds));
  return std::unique_ptr<WatchedNetwork>(
      new WatchedNetwork(std::move(joined), security_files(options.security, vendor).revoked,
                         std::move(interface_name), std::move(changes), std::move(start), asked,
                         std::move(when_deaf)));
}

WatchedNetwork::WatchedNetwork(bus::SecuredParticipant joined, std::filesystem::path revoked,
                               std::string interface_name, NetworkChanges changes,
                               AddressesAtStart start, const std::stop_token& asked,
                               std::function<void(const std::string&)> when_deaf)
    : participant(std::move(joined.participant)), discovered_(std::move(joined.discovered)),
      revoked_(std::move(revoked)), announced_(participant.own_addresses()),
      interface_(std::move(interface_name)), changes_(std::move(changes)), start_(std::move(start)),
      when_deaf_(std::move(when_deaf)), asked_(asked, [this] { stop_.request_stop(); }),
      thread_([this](const std::stop_token& ended) { look(ended); }) {}

void WatchedNetwork::look(const std::stop_token& ended) {
  std::mutex mutex;
  std::condition_variable_any bell;
  std::unique_lock lock(mutex);
  Addresses before = start_.host;
  std::string why_before;
  auto since = Clock::now();
  while (!bell.wait_for(lock, ended, look_interval, [&] { return ended.stop_requested(); })) {
    const Addresses now = changes_.any() ? addresses_of(interface_) : before;
    start_.announced = announced_->get();
    if (const std::string change = difference(before, now); !change.empty()) {
      spdlog::warn("addresses of this host: {}; this program is heard at {}, as it has announced",
                   change, fmt::join(start_.announced, ", "));
    }
    before = now;
    if (discovered_) {
      look_for_strangers();
    }
    const std::string why = what_deafens(start_, now);
    if (why != std::exchange(why_before, why)) {
      since = Clock::now();
    }
    if (!why.empty() && Clock::now() - since >= settling_time) {
      end(why, ended);
      return;
    }
  }
}

void WatchedNetwork::look_for_strangers() {
  const auto now = Clock::now();
  if (now < next_look_for_strangers_) {
    return;
  }
  next_look_for_strangers_ = ++looks_for_strangers_ > first_looks ? now + strangers_interval : now;
  strangers_.look(discovered_(), now);
  {
    const std::lock_guard lock(mutex_);
    strangers_sentence_ = strangers_sentence(strangers_.strangers(strange_for), revoked_);
  }
  const auto all = strangers_.strangers(said_when_strange_for);
  bool is_news = false;
  for (const Stranger& one : all) {
    is_news = (said_.size() < max_said && said_.insert(one.id).second) || is_news;
  }
  if (is_news) {
    spdlog::warn("{}", strangers_sentence(all, revoked_));
  }
}

std::string WatchedNetwork::strangers() const {
  const std::lock_guard lock(mutex_);
  return strangers_sentence_;
}

void WatchedNetwork::end(const std::string& why, const std::stop_token& ended) {
  {
    const std::lock_guard lock(mutex_);
    deaf_because_ = why;
  }
  if (when_deaf_) {
    when_deaf_(why);
  }
  stop_.request_stop();
  std::unique_lock lock(mutex_);
  std::condition_variable_any bell;
  if (!bell.wait_for(lock, ended, ending_time, [&] { return ended.stop_requested(); })) {
    lock.unlock();
    static_cast<void>(outcome({}));
  }
}

Expected<void> WatchedNetwork::outcome(Expected<void> served) const {
  const std::lock_guard lock(mutex_);
  if (!deaf_because_.empty()) {
    std::_Exit(report_error(
        {ErrorCode::network,
         fmt::format("{}: nobody hears this program at the addresses that it has announced, so it "
                     "ends to be started again",
                     deaf_because_)}));
  }
  return served;
}

} // namespace dyncal::inline daemon
