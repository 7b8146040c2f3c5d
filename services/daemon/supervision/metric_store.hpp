// Numbers that a daemon offers to anyone who watches it, in prometheus-cpp's registry: families
// with a name and a sentence, and in each one value for every set of labels. Names and units follow
// Prometheus' conventions: base units, counters end in _total.
//
// A daemon counts by itself and reports totals. A counter that is given a smaller one begins again,
// which Prometheus takes for a restart. Any thread. A value stays until it is set again.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace prometheus {
class Registry;
}

namespace dyncal::inline daemon {

using MetricLabels = std::map<std::string, std::string>;

class MetricStore {
public:
  MetricStore();

  // `name` and `help` of the family.
  void gauge(const char* name, const char* help, const MetricLabels& labels, double value);
  void counter(const char* name, const char* help, const MetricLabels& labels, double value);
  // Null where this build has no prometheus-cpp.
  [[nodiscard]] const std::shared_ptr<prometheus::Registry>& registry() const { return registry_; }

private:
  std::mutex mutex_; // of counters that begin again
  std::shared_ptr<prometheus::Registry> registry_;
};

} // namespace dyncal::inline daemon
