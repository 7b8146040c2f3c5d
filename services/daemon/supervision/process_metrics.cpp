#include "services/daemon/supervision/process_metrics.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

namespace dyncal::inline daemon {
namespace {

constexpr MetricFamily resident_memory{"process_resident_memory_bytes",
                                       "Resident memory size in bytes.", MetricKind::gauge};
constexpr MetricFamily virtual_memory{"process_virtual_memory_bytes",
                                      "Virtual memory size in bytes.", MetricKind::gauge};
constexpr MetricFamily cpu_seconds{"process_cpu_seconds_total",
                                   "Total user and system CPU time spent in seconds.",
                                   MetricKind::counter};
constexpr MetricFamily open_descriptors{"process_open_fds", "Number of open file descriptors.",
                                        MetricKind::gauge};
constexpr MetricFamily threads{"process_threads", "Number of threads of the process.",
                               MetricKind::gauge};

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

} // namespace

void add_process_metrics(MetricStore& store) {
  std::ifstream file("/proc/self/status");
  const std::string status{std::istreambuf_iterator<char>(file), {}};
  constexpr double bytes_per_kb = 1024.0;
  store.set(resident_memory, {}, status_number(status, "VmRSS:") * bytes_per_kb);
  store.set(virtual_memory, {}, status_number(status, "VmSize:") * bytes_per_kb);
  store.set(threads, {}, status_number(status, "Threads:"));
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) {
    store.set(cpu_seconds, {}, seconds(usage.ru_utime) + seconds(usage.ru_stime));
  }
  std::error_code error;
  const std::filesystem::directory_iterator descriptors("/proc/self/fd", error);
  if (!error) {
    store.set(open_descriptors, {},
              static_cast<double>(std::distance(begin(descriptors), end(descriptors))));
  }
}

} // namespace dyncal::inline daemon
