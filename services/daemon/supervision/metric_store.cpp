#include "services/daemon/supervision/metric_store.hpp"

#ifdef DYNCAL_HAVE_PROMETHEUS
#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/registry.h>
#endif

namespace dyncal::inline daemon {

#ifdef DYNCAL_HAVE_PROMETHEUS

MetricStore::MetricStore() : registry_(std::make_shared<prometheus::Registry>()) {}

void MetricStore::gauge(const char* name, const char* help, const MetricLabels& labels,
                        double value) {
  prometheus::BuildGauge().Name(name).Help(help).Register(*registry_).Add(labels).Set(value);
}

void MetricStore::counter(const char* name, const char* help, const MetricLabels& labels,
                          double value) {
  auto& counters = prometheus::BuildCounter().Name(name).Help(help).Register(*registry_);
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

void MetricStore::gauge(const char* /*name*/, const char* /*help*/, const MetricLabels& /*labels*/,
                        double /*value*/) {}

void MetricStore::counter(const char* /*name*/, const char* /*help*/,
                          const MetricLabels& /*labels*/, double /*value*/) {}

#endif

} // namespace dyncal::inline daemon
