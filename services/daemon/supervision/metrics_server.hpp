// Serves a MetricStore over HTTP at /metrics, in the text format of Prometheus, and with it what
// every process has: memory, processor time, descriptors, threads (process_*).
//
// Listens in threads of its own for as long as the object lives; a scrape holds up nobody. There is
// no encryption and no password: listen on loopback, or in a network that you trust.
#pragma once

#include <memory>
#include <string>

#include "services/base/error.hpp"
#include "services/daemon/supervision/metric_store.hpp"

namespace dyncal::inline daemon {

class MetricsServer {
public:
  // `address` is "ADDRESS:PORT"; port 0: any free one. `store` outlives the server. Fails
  // (bad_argument) when the address is no such, or this build has no metrics, (network) when it
  // cannot be listened at, for example because the port is in use.
  [[nodiscard]] static Expected<std::unique_ptr<MetricsServer>> start(const std::string& address,
                                                                      const MetricStore& store);
  ~MetricsServer();
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  [[nodiscard]] int port() const;

private:
  struct Implementation;
  explicit MetricsServer(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

// False: this build has no prometheus-cpp.
[[nodiscard]] bool can_serve_metrics();

} // namespace dyncal::inline daemon
