// What every process has, with the names that Prometheus' own clients give it. Any thread.
#pragma once

#include "services/daemon/supervision/metric_store.hpp"

namespace dyncal::inline daemon {

// Resident and virtual memory, processor time, open descriptors, threads, time of start.
void add_process_metrics(MetricStore& store);

} // namespace dyncal::inline daemon
