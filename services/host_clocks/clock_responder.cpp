#include "services/host_clocks/clock_responder.hpp"

#include "services/contract/topics.hpp"

namespace dyncal::services {
namespace {

constexpr std::chrono::seconds max_wait{10};

} // namespace

Expected<std::unique_ptr<ClockResponder>>
ClockResponder::open(bus::Participant& participant, ProgramIdentity identity, bus::Clock& clock) {
  auto wake_up = std::make_shared<bus::WakeUp>();
  auto answers = participant.writer(bus::topics::clock_answer, all_benches_partition);
  auto requests = participant.reader(bus::topics::clock_request, all_benches_partition, wake_up);
  auto links = LinkResponder::open(participant, service_name(identity), clock, wake_up);
  if (const auto error = first_error(answers, requests, links)) {
    return fail(*error);
  }
  return std::unique_ptr<ClockResponder>(
      new ClockResponder(std::move(identity), clock, std::move(wake_up), std::move(*requests),
                         std::move(*answers), std::move(*links), participant.refused_packets()));
}

Expected<std::unique_ptr<ClockResponder>> ClockResponder::start(bus::Participant& participant,
                                                                ProgramIdentity identity) {
  auto responder = open(participant, std::move(identity), bus::system_clock());
  if (responder) {
    ClockResponder& started = **responder;
    started.thread_ = std::jthread([&started](const std::stop_token& stop) { started.run(stop); });
  }
  return responder;
}

void ClockResponder::run(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { wake_up_->ring(); });
  while (!stop.stop_requested()) {
    clock_->wait(*wake_up_, clock_->now() + max_wait);
    work();
  }
}

void ClockResponder::work() {
  requests_.take([this](const wire::ClockRequest& request) {
    const std::int64_t received_utc_ns = clock_->utc_now_ns();
    if (may_answer()) {
      links_.work(); // what came before the request counts in its answer
      answer(request, received_utc_ns);
    }
  });
  links_.work();
}

bool ClockResponder::may_answer() {
  const auto now = clock_->now();
  if (now - second_began_ >= std::chrono::seconds(1)) {
    second_began_ = now;
    answers_in_second_ = 0;
  }
  return answers_in_second_++ < max_answers_per_s;
}

void ClockResponder::answer(const wire::ClockRequest& request, std::int64_t received_utc_ns) {
  wire::ClockAnswer answer;
  answer.bench(all_benches_partition);
  answer.asker(request.asker());
  answer.service(name_);
  answer.number(request.number());
  answer.request_sent_utc_ns(request.sent_utc_ns());
  answer.request_received_utc_ns(received_utc_ns);
  answer.program(identity_.program);
  answer.host(identity_.host);
  answer.process_id(identity_.process_id);
  answer.software(identity_.software);
  answer.dds(identity_.dds);
  answer.contract_version(wire::CONTRACT_VERSION);
  answer.packets_refused(refused_->count());
  answer.packets_refused_from(refused_->last_sender());
  const ProbeCounts probes = links_.counts(request.asker().to_string());
  answer.answers_probes(true);
  answer.probe_series(probes.series);
  answer.first_probe(probes.first);
  answer.newest_probe(probes.newest);
  answer.probes_received(probes.received);
  answer.probes_echoed(probes.echoed);
  answer.answer_sent_utc_ns(clock_->utc_now_ns());
  // One that does not get through is given up: whoever still wants to know asks again.
  static_cast<void>(answers_.write(answer, std::chrono::nanoseconds(0)));
}

} // namespace dyncal::services
