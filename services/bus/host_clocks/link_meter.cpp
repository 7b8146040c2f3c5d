#include "services/bus/host_clocks/link_meter.hpp"

#include <algorithm>

#include "services/contract/session_number.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline host_clocks {
namespace {

constexpr std::uint32_t first_contract_with_probes = 2;

} // namespace

std::optional<double> lost_part(const LinkLoss& loss) {
  if (loss.sent < fewest_probes) {
    return std::nullopt;
  }
  return static_cast<double>(loss.sent - loss.echoed) / static_cast<double>(loss.sent);
}

LinkMeter::LinkMeter(std::string name, bus::Clock& clock, bus::Writer<wire::LinkProbe> probes,
                     bus::Reader<wire::LinkEcho> echoes)
    : name_(std::move(name)), clock_(&clock), probes_(std::move(probes)),
      echoes_(std::move(echoes)), series_(random_session()) {}

Expected<LinkMeter> LinkMeter::open(bus::Participant& participant, const ProgramIdentity& identity,
                                    bus::Clock& clock,
                                    const std::shared_ptr<bus::WakeUp>& wake_up) {
  DYNCAL_TRY(auto probes, participant.writer(bus::topics::link_probe, all_benches_partition));
  DYNCAL_TRY(auto echoes,
             participant.reader(bus::topics::link_echo, all_benches_partition, wake_up));
  return LinkMeter(service_name(identity), clock, std::move(probes), std::move(echoes));
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
  const std::uint64_t number = echo.probe();
  const bool for_us =
      echo.asker() == name_ && echo.series() == series_ && number > 0 && number <= sent_.size();
  if (!for_us || (!echoes_of_.contains(service) && echoes_of_.size() >= max_programs)) {
    return;
  }
  Echoes& echoes = echoes_of_[service];
  if (number > echoes.newest) {
    echoes.first = echoes.count == 0 ? number : echoes.first;
    echoes.newest = number;
    ++echoes.count;
  }
}

std::uint64_t LinkMeter::sent_until(Instant time) const {
  return static_cast<std::uint64_t>(std::ranges::upper_bound(sent_, time) - sent_.begin());
}

LinkLoss LinkMeter::loss(const DiscoveredProgram& program) const {
  LinkLoss loss{.identity = program.identity};
  loss.answers_probes = program.contract_version >= first_contract_with_probes;
  if (!loss.answers_probes) {
    return loss;
  }
  const std::uint64_t due = sent_until(program.asked - settling);
  const auto found = echoes_of_.find(service_name(program.identity));
  if (found == echoes_of_.end()) {
    loss.sent = due - std::min(due, sent_until(program.first_answer + settling));
    return loss;
  }
  const Echoes& echoes = found->second;
  loss.sent = std::max(echoes.newest, due) - echoes.first + 1;
  loss.echoed = echoes.count;
  return loss;
}

std::vector<LinkLoss> LinkMeter::losses(const std::vector<DiscoveredProgram>& programs) const {
  std::vector<LinkLoss> losses;
  losses.reserve(programs.size());
  for (const DiscoveredProgram& program : programs) {
    losses.push_back(loss(program));
  }
  return losses;
}

} // namespace dyncal::inline host_clocks
