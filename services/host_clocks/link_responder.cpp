#include "services/host_clocks/link_responder.hpp"

#include <algorithm>

#include "services/contract/topics.hpp"
#include "services/host_clocks/clock_messages.hpp"

namespace dyncal::services {

Expected<LinkResponder> LinkResponder::open(bus::Participant& participant, std::string service,
                                            bus::Clock& clock,
                                            const std::shared_ptr<bus::WakeUp>& wake_up) {
  auto echoes = participant.writer(bus::topics::link_echo, all_benches_partition);
  auto probes = participant.reader(bus::topics::link_probe, all_benches_partition, wake_up);
  if (const auto error = first_error(echoes, probes)) {
    return fail(*error);
  }
  return LinkResponder(std::move(service), clock, std::move(*probes), std::move(*echoes));
}

void LinkResponder::work() {
  probes_.take([this](const wire::LinkProbe& probe) { take(probe); });
}

ProbeCounts LinkResponder::counts(const std::string& asker) const {
  const auto found = askers_.find(asker);
  return found == askers_.end() ? ProbeCounts() : found->second.counts;
}

ProbeCounts& LinkResponder::counts_of(const std::string& asker) {
  if (!askers_.contains(asker) && askers_.size() >= max_askers) {
    askers_.erase(std::ranges::min_element(askers_, {},
                                           [](const auto& one) { return one.second.last_probe; }));
    ++forgotten_askers_;
  }
  Asker& known = askers_[asker];
  known.last_probe = clock_->now();
  return known.counts;
}

void LinkResponder::take(const wire::LinkProbe& probe) {
  ProbeCounts& counts = counts_of(probe.asker().to_string());
  if (counts.series != probe.series()) {
    counts = {.series = probe.series()};
  }
  if (probe.number() <= counts.newest) {
    return; // DDS brings none twice, and none after one behind it
  }
  if (counts.received == 0) {
    counts.first = probe.number();
  }
  counts.newest = probe.number();
  ++counts.received;
  if (may_echo()) {
    echo(probe, counts);
  } else {
    ++not_echoed_;
  }
}

bool LinkResponder::may_echo() {
  const auto now = clock_->now();
  if (now - second_began_ >= std::chrono::seconds(1)) {
    second_began_ = now;
    echoes_in_second_ = 0;
  }
  return echoes_in_second_++ < max_echoes_per_s;
}

void LinkResponder::echo(const wire::LinkProbe& probe, ProbeCounts& counts) {
  wire::LinkEcho echo;
  echo.bench(all_benches_partition);
  echo.asker(probe.asker());
  echo.service(service_);
  echo.series(probe.series());
  echo.number(counts.echoed + 1);
  echo.probe(probe.number());
  if (echoes_.write(echo, std::chrono::nanoseconds(0)) == bus::WriteOutcome::written) {
    ++counts.echoed;
  } else {
    ++not_echoed_;
  }
}

} // namespace dyncal::services
