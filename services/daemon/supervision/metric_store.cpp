#include "services/daemon/supervision/metric_store.hpp"

#ifdef DYNCAL_HAVE_PROMETHEUS
#include <prometheus/counter.h>
#include <prometheus/registry.h>
#endif

namespace dyncal::inline daemon {

#ifdef DYNCAL_HAVE_PROMETHEUS

MetricStore::MetricStore() : registry_(std::make_shared<prometheus::Registry>()) {}

void MetricStore::set(const MetricFamily& family, const MetricLabels& labels, double value) {
  const auto registered = [&](auto builder) -> auto& {
    return builder.Name(family.name).Help(family.help).Register(*registry_);
  };
  if (family.kind == MetricKind::gauge) {
    registered(prometheus::BuildGauge()).Add(labels).Set(value);
    return;
  }
  auto& counters = registered(prometheus::BuildCounter());
  const std::lock_guard lock(mutex_);
  auto* counter = &counters.Add(labels);
  if (value < counter->Value()) {
    counters.Remove(counter);
    counter = &counters.Add(labels);
  }
  counter->Increment(value - counter->Value());
}

#else

MetricStore::MetricStore() = default;

void MetricStore::set(const MetricFamily& /*family*/, const MetricLabels& /*labels*/,
                      double /*value*/) {}

#endif

} // namespace dyncal::inline daemon
