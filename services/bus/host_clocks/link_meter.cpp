#include "services/bus/host_clocks/link_meter.hpp"

#include <algorithm>

#include "services/contract/session_number.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline host_clocks {
namespace {

constexpr std::uint32_t first_contract_with_probes = 2;
constexpr std::uint32_t first_contract_with_padding = 3; // of which older ones take no notice
constexpr double too_lossy_to_tell = 0.5;

} // namespace

std::optional<double> lost_part(const LinkLoss& loss) {
  if (loss.sent < fewest_probes) {
    return std::nullopt;
  }
  return static_cast<double>(loss.sent - loss.echoed) / static_cast<double>(loss.sent);
}

bool drops_long_packets(const LinkLoss& loss) {
  return loss.long_sent >= fewest_probes && loss.long_echoed == 0 &&
         lost_part(loss).value_or(1.0) < too_lossy_to_tell;
}

LinkMeter::LinkMeter(std::string name, bus::Clock& clock, bus::Writer<wire::LinkProbe> probes,
                     bus::Reader<wire::LinkEcho> echoes)
    : name_(std::move(name)), clock_(&clock), probes_(std::move(probes)),
      echoes_(std::move(echoes)), short_{random_session()}, long_{random_session()} {}

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
  if (probes() == 0 && next_probe_ == Instant::max() && programs > 0) {
    next_probe_ = now + settling;
  }
  if (now < next_probe_) {
    return;
  }
  ++turn_;
  if (turn_ % turns_of_long == 0) {
    send(long_, padding_bytes);
  } else {
    send(short_, 0);
  }
  const std::chrono::milliseconds pace =
      std::max(interval, interval_per_program * static_cast<int>(programs));
  next_probe_ = probes() < max_probes ? now + pace : Instant::max();
}

void LinkMeter::send(Series& series, std::size_t padding) {
  wire::LinkProbe probe;
  probe.bench(all_benches_partition);
  probe.asker(name_);
  probe.series(series.id);
  probe.number(series.sent.size() + 1);
  probe.padding(std::string(padding, ' '));
  if (probes_.write(probe, std::chrono::nanoseconds(0)) == bus::WriteOutcome::written) {
    series.sent.push_back(clock_->now());
  }
}

void LinkMeter::take(const wire::LinkEcho& echo) {
  const std::string service = echo.service().to_string();
  const std::uint64_t number = echo.probe();
  Series& series = echo.series() == long_.id ? long_ : short_;
  const bool for_us = echo.asker() == name_ && echo.series() == series.id && number > 0 &&
                      number <= series.sent.size();
  if (!for_us || (!series.echoes.contains(service) && series.echoes.size() >= max_programs)) {
    return;
  }
  Echoes& echoes = series.echoes[service];
  if (number > echoes.newest) {
    echoes.first = echoes.count == 0 ? number : echoes.first;
    echoes.newest = number;
    ++echoes.count;
  }
}

LinkMeter::Count LinkMeter::count_of(const Series& series, const DiscoveredProgram& program) {
  const auto sent_until = [&](Instant time) {
    return static_cast<std::uint64_t>(std::ranges::upper_bound(series.sent, time) -
                                      series.sent.begin());
  };
  const std::uint64_t due = sent_until(program.asked - settling);
  const auto found = series.echoes.find(service_name(program.identity));
  if (found == series.echoes.end()) {
    return {due - std::min(due, sent_until(program.first_answer + settling)), 0};
  }
  const Echoes& echoes = found->second;
  return {std::max(echoes.newest, due) - echoes.first + 1, echoes.count};
}

LinkLoss LinkMeter::loss(const DiscoveredProgram& program) const {
  LinkLoss loss{.identity = program.identity};
  loss.answers_probes = program.contract_version >= first_contract_with_probes;
  if (loss.answers_probes) {
    const Count of_short = count_of(short_, program);
    loss.sent = of_short.sent;
    loss.echoed = of_short.echoed;
  }
  if (program.contract_version >= first_contract_with_padding) {
    const Count of_long = count_of(long_, program);
    loss.long_sent = of_long.sent;
    loss.long_echoed = of_long.echoed;
  }
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
