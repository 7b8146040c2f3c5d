#include "services/supervision/metric_store.hpp"

namespace dyncal::services {

void MetricStore::set(const MetricFamily& family, const MetricLabels& labels, double value) {
  const std::lock_guard lock(mutex_);
  Family& stored = families_[family.name];
  if (stored.values.empty()) {
    stored.help = family.help;
    stored.kind = family.kind;
  }
  stored.values[labels] = value;
}

std::map<std::string, MetricStore::Family> MetricStore::families() const {
  const std::lock_guard lock(mutex_);
  return families_;
}

} // namespace dyncal::services
