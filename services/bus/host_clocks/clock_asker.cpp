#include "services/bus/host_clocks/clock_asker.hpp"

#include <algorithm>

#include "services/contract/topics.hpp"

namespace dyncal::inline host_clocks {
namespace {

constexpr std::size_t open_requests = 8; // an answer to an older one is too late to be of use
// By how much our clock may have moved against the time that passed: slewing, not setting.
constexpr std::chrono::milliseconds max_slew{1};

void take_refused_packets(const wire::ClockAnswer& answer, DiscoveredProgram& program) {
  const std::uint64_t count = answer.packets_refused();
  if (program.answers > 0 && count > program.packets_refused) {
    program.packets_refused_now += count - program.packets_refused;
  }
  program.packets_refused = count;
  program.packets_refused_from = answer.packets_refused_from();
}

} // namespace

Expected<ClockAsker> ClockAsker::open(bus::Participant& participant,
                                      const ProgramIdentity& identity, bus::Clock& clock,
                                      const std::shared_ptr<bus::WakeUp>& wake_up,
                                      AskingPace pace) {
  DYNCAL_TRY(auto requests, participant.writer(bus::topics::clock_request, all_benches_partition));
  DYNCAL_TRY(auto answers,
             participant.reader(bus::topics::clock_answer, all_benches_partition, wake_up));
  return ClockAsker(identity, clock, pace, std::move(requests), std::move(answers));
}

void ClockAsker::work() {
  answers_.take([this](const wire::ClockAnswer& answer) { take(answer); });
  const Instant now = clock_->now();
  std::erase_if(heard_,
                [&](const auto& one) { return now - one.second.last_answer > forgotten_after; });
  if (now >= next_request_) {
    ask();
  }
}

void ClockAsker::ask() {
  const Instant now = clock_->now();
  ++number_;
  next_request_ =
      now + (number_ < static_cast<std::uint64_t>(pace_.quick_requests) ? pace_.quick_interval
                                                                        : pace_.interval);
  wire::ClockRequest request;
  request.bench(all_benches_partition);
  request.asker(name_);
  request.number(number_);
  request.sent_utc_ns(clock_->utc_now_ns());
  sent_.push_back({number_, request.sent_utc_ns(), now});
  if (sent_.size() > open_requests) {
    sent_.pop_front();
  }
  static_cast<void>(requests_.write(request, std::chrono::nanoseconds(0))); // the next one is due
}

void ClockAsker::take(const wire::ClockAnswer& answer) {
  const Instant now = clock_->now();
  const std::int64_t received_utc_ns = clock_->utc_now_ns();
  const auto request = std::ranges::find(sent_, answer.number(), &Request::number);
  const std::string service = answer.service().to_string();
  const bool for_us = answer.asker() == name_ && request != sent_.end() && service != name_;
  if (!for_us || (!heard_.contains(service) && heard_.size() >= max_programs)) {
    return;
  }
  Heard& heard = heard_[service];
  heard.program.identity = identity_of(answer);
  heard.program.contract_version = answer.contract_version();
  take_refused_packets(answer, heard.program);
  if (heard.program.answers == 0) {
    heard.program.first_answer = now;
  }
  heard.program.asked = std::max(heard.program.asked, request->sent);
  ++heard.program.answers;
  heard.last_answer = now;
  const auto slew =
      std::chrono::nanoseconds(received_utc_ns - request->sent_utc_ns) - (now - request->sent);
  if (std::chrono::abs(slew) <= max_slew) {
    heard.offsets.add({.request_sent_ns = request->sent_utc_ns,
                       .request_received_ns = answer.request_received_utc_ns(),
                       .answer_sent_ns = answer.answer_sent_utc_ns(),
                       .answer_received_ns = received_utc_ns},
                      now);
  }
}

std::vector<DiscoveredProgram> ClockAsker::programs() const {
  std::vector<DiscoveredProgram> programs;
  programs.reserve(heard_.size());
  for (const auto& [name, heard] : heard_) {
    programs.push_back(heard.program);
    programs.back().clock = heard.offsets.offset(clock_->now());
  }
  return programs;
}

std::vector<HostClock> ClockAsker::other_hosts() const {
  std::map<std::string, ClockOffset> best;
  for (const DiscoveredProgram& program : programs()) {
    if (!program.clock || program.identity.host == host_) {
      continue;
    }
    const auto [found, first] = best.try_emplace(program.identity.host, *program.clock);
    if (!first && program.clock->bound_s < found->second.bound_s) {
      found->second = *program.clock;
    }
  }
  std::vector<HostClock> hosts;
  hosts.reserve(best.size());
  for (const auto& [host, clock] : best) {
    hosts.push_back({host, clock});
  }
  return hosts;
}

} // namespace dyncal::inline host_clocks
