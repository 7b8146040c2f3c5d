#include "services/host_clocks/link_meter.hpp"

#include <algorithm>

#include "services/contract/session_number.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::services {

LinkMeter::LinkMeter(std::string name, bus::Clock& clock, bus::Writer<wire::LinkProbe> probes,
                     bus::Reader<wire::LinkEcho> echoes)
    : name_(std::move(name)), clock_(&clock), probes_(std::move(probes)),
      echoes_(std::move(echoes)), series_(random_session()) {}

Expected<LinkMeter> LinkMeter::open(bus::Participant& participant, const ProgramIdentity& identity,
                                    bus::Clock& clock,
                                    const std::shared_ptr<bus::WakeUp>& wake_up) {
  auto probes = participant.writer(bus::topics::link_probe, all_benches_partition);
  auto echoes = participant.reader(bus::topics::link_echo, all_benches_partition, wake_up);
  if (const auto error = first_error(probes, echoes)) {
    return fail(*error);
  }
  return LinkMeter(service_name(identity), clock, std::move(*probes), std::move(*echoes));
}

void LinkMeter::work(std::size_t programs) {
  echoes_.take([this](const wire::LinkEcho& echo) { take(echo); });
  const Instant now = clock_->now();
  if (sent_.empty() && next_probe_ == Instant::max() && programs > 0) {
    next_probe_ = now + settling;
  }
  if (now < next_probe_) {
    return;
  }
  send();
  const std::chrono::milliseconds pace =
      std::max(interval, interval_per_program * static_cast<int>(programs));
  next_probe_ = sent_.size() < max_probes ? now + pace : Instant::max();
}

void LinkMeter::send() {
  wire::LinkProbe probe;
  probe.bench(all_benches_partition);
  probe.asker(name_);
  probe.series(series_);
  probe.number(sent_.size() + 1);
  if (probes_.write(probe, std::chrono::nanoseconds(0)) == bus::WriteOutcome::written) {
    sent_.push_back(clock_->now());
  }
}

void LinkMeter::take(const wire::LinkEcho& echo) {
  const std::string service = echo.service().to_string();
  const bool for_us = echo.asker() == name_ && echo.series() == series_ && echo.number() > 0 &&
                      echo.number() <= sent_.size();
  if (!for_us || (!echoes_of_.contains(service) && echoes_of_.size() >= max_programs)) {
    return;
  }
  EchoCounts& counts = echoes_of_[service];
  if (echo.number() <= counts.newest) {
    counts = {}; // the program had forgotten us, and counts anew
  }
  if (counts.received == 0) {
    counts.first = echo.number();
  }
  counts.newest = echo.number();
  ++counts.received;
}

std::uint64_t LinkMeter::sent_until(Instant time) const {
  return static_cast<std::uint64_t>(std::ranges::upper_bound(sent_, time) - sent_.begin());
}

std::vector<LinkLoss> LinkMeter::losses(const std::vector<HeardProgram>& programs) const {
  std::vector<LinkLoss> losses;
  losses.reserve(programs.size());
  for (const HeardProgram& program : programs) {
    losses.push_back({.identity = program.identity, .answers_probes = program.probes.has_value()});
    LinkLoss& loss = losses.back();
    if (!program.probes) {
      continue;
    }
    const ProbesSent sent{.series = series_,
                          .all = sent_.size(),
                          .early = sent_until(program.first_answer + settling),
                          .due = sent_until(program.asked - settling)};
    const auto echoes = echoes_of_.find(service_name(program.identity));
    loss.there = way_there(sent, *program.probes);
    loss.back =
        way_back(sent, *program.probes, echoes == echoes_of_.end() ? EchoCounts() : echoes->second);
  }
  return losses;
}

} // namespace dyncal::services
