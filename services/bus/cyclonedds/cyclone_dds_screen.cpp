#include "services/bus/cyclonedds/cyclone_dds_screen.hpp"

#include <algorithm>
#include <atomic>
#include <dds/ddsi/ddsi_tran.h>
#include <map>
#include <mutex>
#include <set>
#include <shared_mutex>

#include "services/bus/cyclonedds/cyclone_dds_connections.h"
#include "services/bus/refused_packets.hpp"
#include "services/bus/rtps/message_check.hpp"

namespace dyncal::bus {
namespace {

// The library's functions take nothing of ours: the connection is all that they know.
struct Screened {
  ddsi_tran_read_fn_t read = nullptr; // the library's
  std::shared_ptr<MessageCheck> check;
  std::shared_ptr<RefusedPackets> refused;
};

class ScreenedConnections {
public:
  void add(ddsi_tran_conn* connection, Screened screened) {
    const std::unique_lock lock(mutex_);
    all_[connection] = std::move(screened);
  }
  void remove(ddsi_tran_conn* connection) {
    const std::unique_lock lock(mutex_);
    all_.erase(connection);
  }
  [[nodiscard]] Screened of(ddsi_tran_conn* connection) const {
    const std::shared_lock lock(mutex_);
    return all_.at(connection);
  }

private:
  mutable std::shared_mutex mutex_;
  std::map<ddsi_tran_conn*, Screened> all_;
};

ScreenedConnections& screened_connections() {
  static auto* const connections = new ScreenedConnections; // threads may read while it ends
  return *connections;
}

extern "C" ssize_t read_and_check(ddsi_tran_conn* connection, unsigned char* buffer,
                                  std::size_t length, bool allow_spurious, ddsi_locator_t* source) {
  const Screened screened = screened_connections().of(connection);
  const ssize_t count = screened.read(connection, buffer, length, allow_spurious, source);
  if (count <= 0 ||
      screened.check->accepts({buffer, std::min(static_cast<std::size_t>(count), length)})) {
    return count;
  }
  screened.refused->add_implausible(source == nullptr ? 0
                                                      : RefusedPackets::sender_in(source->address));
  return 0; // nothing has come
}

} // namespace

class CycloneDdsScreen::Connections {
public:
  explicit Connections(std::shared_ptr<RefusedPackets> refused) : refused_(std::move(refused)) {}
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;
  ~Connections() {
    for (ddsi_tran_conn* connection : mine_) {
      screened_connections().remove(connection);
    }
  }

  void install(const ddsi_domaingv& domain) {
    const std::lock_guard lock(mutex_);
    for (ddsi_tran_conn* connection : cyclone_dds_connections_of(&domain).receiving) {
      if (connection == nullptr || !mine_.insert(connection).second) {
        continue;
      }
      std::atomic_ref<ddsi_tran_read_fn_t> read(connection->m_read_fn); // a thread reads it
      screened_connections().add(connection, {read, check_, refused_});
      read = read_and_check;
    }
  }

private:
  std::mutex mutex_;
  std::shared_ptr<MessageCheck> check_ = std::make_shared<MessageCheck>();
  std::shared_ptr<RefusedPackets> refused_;
  std::set<ddsi_tran_conn*> mine_;
};

CycloneDdsScreen::CycloneDdsScreen(std::shared_ptr<RefusedPackets> refused)
    : connections_(std::make_unique<Connections>(std::move(refused))) {}

CycloneDdsScreen::~CycloneDdsScreen() = default;

void CycloneDdsScreen::install(const ddsi_domaingv& domain) {
  connections_->install(domain);
}

} // namespace dyncal::bus
