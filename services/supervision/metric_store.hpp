// Numbers that a daemon offers to whoever watches it: families with a name and a sentence, and in
// each one value for every set of labels. Names and units follow Prometheus' conventions: base
// units, counters end in _total.
//
// Any thread. A value stays until it is set again.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace dyncal::services {

enum class MetricKind { counter, gauge };

struct MetricFamily {
  const char* name;
  const char* help;
  MetricKind kind;
};

using MetricLabels = std::vector<std::pair<std::string, std::string>>;

class MetricStore {
public:
  struct Family {
    std::string help;
    MetricKind kind = MetricKind::gauge;
    std::map<MetricLabels, double> values;
  };

  void set(const MetricFamily& family, const MetricLabels& labels, double value);
  // By name.
  [[nodiscard]] std::map<std::string, Family> families() const;

private:
  mutable std::mutex mutex_;
  std::map<std::string, Family> families_;
};

} // namespace dyncal::services
