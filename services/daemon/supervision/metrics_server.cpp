#include "services/daemon/supervision/metrics_server.hpp"

#include <arpa/inet.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#ifdef DYNCAL_HAVE_PROMETHEUS
#include <prometheus/collectable.h>
#include <prometheus/exposer.h>
#include <prometheus/registry.h>
#endif

namespace dyncal::inline daemon {
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

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

// The number after a name in /proc/self/status.
double status_number(const std::string& status, const std::string& name) {
  const auto found = status.find(name);
  double number = 0.0;
  if (found != std::string::npos) {
    std::istringstream(status.substr(found + name.size())) >> number;
  }
  return number;
}

// With the names that Prometheus' own clients give them.
void add_process_metrics(MetricStore& store) {
  std::ifstream file("/proc/self/status");
  const std::string status{std::istreambuf_iterator<char>(file), {}};
  constexpr double bytes_per_kb = 1024.0;
  store.gauge("process_resident_memory_bytes", "Resident memory size in bytes.", {},
              status_number(status, "VmRSS:") * bytes_per_kb);
  store.gauge("process_virtual_memory_bytes", "Virtual memory size in bytes.", {},
              status_number(status, "VmSize:") * bytes_per_kb);
  store.gauge("process_threads", "Number of threads of the process.", {},
              status_number(status, "Threads:"));
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) {
    store.counter("process_cpu_seconds_total", "Total user and system CPU time spent in seconds.",
                  {}, seconds(usage.ru_utime) + seconds(usage.ru_stime));
  }
  std::error_code error;
  const std::filesystem::directory_iterator descriptors("/proc/self/fd", error);
  if (!error) {
    store.gauge("process_open_fds", "Number of open file descriptors.", {},
                static_cast<double>(std::distance(begin(descriptors), end(descriptors))));
  }
}

// Looks at the process whenever somebody asks.
class ProcessMetrics final : public prometheus::Collectable {
public:
  [[nodiscard]] std::vector<prometheus::MetricFamily> Collect() const override {
    add_process_metrics(store_);
    return store_.registry()->Collect();
  }

private:
  mutable MetricStore store_;
};

} // namespace

struct MetricsServer::Implementation {
  Implementation(const std::string& address, const MetricStore& store)
      : process(std::make_shared<ProcessMetrics>()), exposer(address, 1) {
    exposer.RegisterCollectable(store.registry());
    exposer.RegisterCollectable(process);
  }
  std::shared_ptr<ProcessMetrics> process; // outlives the exposer, which holds it weakly
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

} // namespace dyncal::inline daemon
