#include "services/supervision/metrics_server.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>

#include "services/supervision/process_metrics.hpp"

#ifdef DYNCAL_HAVE_PROMETHEUS
#include <prometheus/collectable.h>
#include <prometheus/exposer.h>
#include <prometheus/metric_family.h>
#endif

namespace dyncal::services {
namespace {

std::optional<sockaddr_in> parse_address(const std::string& text) {
  const auto colon = text.rfind(':');
  sockaddr_in address{};
  address.sin_family = AF_INET;
  if (colon == std::string::npos ||
      inet_pton(AF_INET, text.substr(0, colon).c_str(), &address.sin_addr) != 1) {
    return std::nullopt;
  }
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + colon + 1, end, port);
  if (parsed.ec != std::errc() || parsed.ptr != end) {
    return std::nullopt;
  }
  address.sin_port = htons(port);
  return address;
}

// Why nobody can listen there; empty if it is free. The HTTP server itself does not say why.
std::string reason_against(const sockaddr_in& address) {
  const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  const bool free =
      bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  const std::string reason = free ? "" : std::strerror(errno);
  close(descriptor);
  return reason;
}

} // namespace

#ifdef DYNCAL_HAVE_PROMETHEUS

namespace {

prometheus::MetricFamily to_prometheus(const std::string& name, const MetricStore::Family& family) {
  prometheus::MetricFamily converted;
  const bool counter = family.kind == MetricKind::counter;
  converted.name = name;
  converted.help = family.help;
  converted.type = counter ? prometheus::MetricType::Counter : prometheus::MetricType::Gauge;
  for (const auto& [labels, value] : family.values) {
    prometheus::ClientMetric metric;
    for (const auto& [label, text] : labels) {
      metric.label.push_back({label, text});
    }
    (counter ? metric.counter.value : metric.gauge.value) = value;
    converted.metric.push_back(std::move(metric));
  }
  return converted;
}

class StoreToCollect final : public prometheus::Collectable {
public:
  explicit StoreToCollect(const MetricStore& store) : store_(store) {}
  [[nodiscard]] std::vector<prometheus::MetricFamily> Collect() const override {
    MetricStore of_process;
    add_process_metrics(of_process);
    std::vector<prometheus::MetricFamily> families;
    for (const MetricStore* store : {&store_, const_cast<const MetricStore*>(&of_process)}) {
      for (const auto& [name, family] : store->families()) {
        families.push_back(to_prometheus(name, family));
      }
    }
    return families;
  }

private:
  const MetricStore& store_;
};

} // namespace

struct MetricsServer::Implementation {
  Implementation(const std::string& address, const MetricStore& store)
      : collectable(std::make_shared<StoreToCollect>(store)), exposer(address, 1) {
    exposer.RegisterCollectable(collectable);
  }
  std::shared_ptr<StoreToCollect> collectable; // outlives the exposer, which holds it weakly
  prometheus::Exposer exposer;
};

bool can_serve_metrics() {
  return true;
}

Expected<std::unique_ptr<MetricsServer>> MetricsServer::start(const std::string& address,
                                                              const MetricStore& store) {
  const auto parsed = parse_address(address);
  if (!parsed) {
    return fail(ErrorCode::bad_argument, "invalid --metrics '" + address +
                                             "': must be ADDRESS:PORT with an IPv4 address, for "
                                             "example 127.0.0.1:9464");
  }
  if (const std::string reason = reason_against(*parsed); !reason.empty()) {
    return fail(ErrorCode::network, "--metrics " + address + ": cannot listen there (" + reason +
                                        "); give every program of this host a port of its own");
  }
  try {
    return std::unique_ptr<MetricsServer>(
        new MetricsServer(std::make_unique<Implementation>(address, store)));
  } catch (const std::exception& error) {
    return fail(ErrorCode::network,
                "--metrics " + address + ": cannot listen there (" + error.what() + ")");
  }
}

int MetricsServer::port() const {
  const auto ports = implementation_->exposer.GetListeningPorts();
  return ports.empty() ? 0 : ports.front();
}

#else

struct MetricsServer::Implementation {};

bool can_serve_metrics() {
  return false;
}

Expected<std::unique_ptr<MetricsServer>> MetricsServer::start(const std::string& address,
                                                              const MetricStore& /*store*/) {
  static_cast<void>(parse_address);
  static_cast<void>(reason_against);
  return fail(ErrorCode::bad_argument, "--metrics " + address +
                                           ": this build has no metrics, because prometheus-cpp "
                                           "was not there (Debian: prometheus-cpp-dev)");
}

int MetricsServer::port() const {
  return 0;
}

#endif

MetricsServer::MetricsServer(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

MetricsServer::~MetricsServer() = default;

} // namespace dyncal::services
