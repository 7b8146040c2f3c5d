// A participant of the bus that notices when others can no longer hear it, because the addresses of
// this host have changed (address_change.hpp).
//
// A thread looks at the addresses where the kernel announces a change, within half a second, and
// logs what has changed. Where the program is deaf for `settling_time` on end, it asks for the end
// of the program, which then fails, so that the service manager starts it again with the addresses
// that there are (RestartSec=2 of its unit): it is heard again within ten seconds. A run goes on
// then as after a restart of the program.
//
// The process ends without its participant, since Cyclone DDS waits at its end for a packet that it
// sends to itself, to an address that is gone: in outcome() or the destructor, at the latest two
// seconds after the end was asked for.
//
// Of a secured program it also notices who is in its domain and may not talk to it
// (services/security/strangers.hpp), and logs that once they are there for 10 s.
//
// Any thread; the object outlives those who have its stop token.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <thread>

#include "services/bus/participant_security.hpp"
#include "services/daemon/program/address_change.hpp"
#include "services/daemon/program/network_changes.hpp"
#include "services/daemon/program/program.hpp"
#include "services/security/strangers.hpp"

namespace dyncal::inline daemon {

class WatchedNetwork {
public:
  static constexpr std::chrono::seconds settling_time{3}; // of an address that comes and goes

  // `when_deaf`, which may be empty, is called once, from the thread that looks, before the end is
  // asked for. Fails as join_network() does.
  [[nodiscard]] static Expected<std::unique_ptr<WatchedNetwork>>
  join(const NetworkOptions& options, const std::string& program, const std::stop_token& asked,
       std::function<void(const std::string& why)> when_deaf = {});

  // Does not return where the program is deaf, as outcome().
  ~WatchedNetwork() { static_cast<void>(outcome({})); }
  WatchedNetwork(const WatchedNetwork&) = delete;
  WatchedNetwork& operator=(const WatchedNetwork&) = delete;

  // May be moved from.
  bus::Participant participant;

  // Requested when `asked` is, and when nobody hears the program any more.
  [[nodiscard]] std::stop_token stop() const { return stop_.get_token(); }
  // Who is here that this program may not talk to, as a sentence; empty where nobody is, and where
  // it is not secured.
  [[nodiscard]] std::string strangers() const;
  // `served`, the last word of the program; does not return where it is deaf, but ends the process
  // with a failure and says why.
  [[nodiscard]] Expected<void> outcome(Expected<void> served) const;

private:
  WatchedNetwork(bus::SecuredParticipant joined, std::filesystem::path revoked,
                 std::string interface_name, NetworkChanges changes, AddressesAtStart start,
                 const std::stop_token& asked, std::function<void(const std::string&)> when_deaf);
  void look(const std::stop_token& ended);
  void look_for_strangers();
  void end(const std::string& why, const std::stop_token& ended);

  std::function<bus::Discovery()> discovered_; // empty: not secured
  std::filesystem::path revoked_;
  StrangerWatch strangers_;
  StrangerWatch::Instant next_look_for_strangers_;
  std::size_t looks_for_strangers_ = 0;
  std::set<std::string> said_; // ids
  std::shared_ptr<const bus::OwnAddresses> announced_;
  std::string interface_; // the only one that counts; empty: all
  NetworkChanges changes_;
  AddressesAtStart start_;
  std::function<void(const std::string&)> when_deaf_;
  std::stop_source stop_;
  std::stop_callback<std::function<void()>> asked_;
  mutable std::mutex mutex_;
  std::string deaf_because_;
  std::string strangers_sentence_;
  std::jthread thread_; // the last: it uses the others
};

} // namespace dyncal::inline daemon
