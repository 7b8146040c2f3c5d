#include "services/bus/host_clocks/clock_responder.hpp"

#include "services/contract/topics.hpp"

namespace dyncal::inline host_clocks {
namespace {

constexpr std::chrono::seconds max_wait{10};

} // namespace

Expected<std::unique_ptr<ClockResponder>>
ClockResponder::open(bus::Participant& participant, ProgramIdentity identity, bus::Clock& clock) {
  auto wake_up = std::make_shared<bus::WakeUp>();
  DYNCAL_TRY(auto answers, participant.writer(bus::topics::clock_answer, all_benches_partition));
  DYNCAL_TRY(auto requests,
             participant.reader(bus::topics::clock_request, all_benches_partition, wake_up));
  DYNCAL_TRY(auto echoes, participant.writer(bus::topics::link_echo, all_benches_partition));
  DYNCAL_TRY(auto probes,
             participant.reader(bus::topics::link_probe, all_benches_partition, wake_up));
  return std::unique_ptr<ClockResponder>(new ClockResponder(
      std::move(identity), clock, std::move(wake_up),
      {std::move(requests), std::move(answers), std::move(probes), std::move(echoes)},
      participant.refused_packets()));
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
  topics_.requests.take([this](const wire::ClockRequest& request) {
    const std::int64_t received_utc_ns = clock_->utc_now_ns();
    if (answers_left_.take(clock_->now())) {
      answer(request, received_utc_ns);
    }
  });
  topics_.probes.take([this](const wire::LinkProbe& probe) {
    if (echoes_left_.take(clock_->now())) {
      echo(probe);
    }
  });
}

bool ClockResponder::Allowance::take(bus::Clock::Instant now) {
  if (now - second_began_ >= std::chrono::seconds(1)) {
    second_began_ = now;
    taken_ = 0;
  }
  return taken_++ < per_second_;
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
  answer.answer_sent_utc_ns(clock_->utc_now_ns());
  // One that does not get through is given up: anyone who still wants to know asks again.
  static_cast<void>(topics_.answers.write(answer, std::chrono::nanoseconds(0)));
}

void ClockResponder::echo(const wire::LinkProbe& probe) {
  wire::LinkEcho echo;
  echo.bench(all_benches_partition);
  echo.asker(probe.asker());
  echo.service(name_);
  echo.series(probe.series());
  echo.probe(probe.number());
  static_cast<void>(topics_.echoes.write(echo, std::chrono::nanoseconds(0))); // as lost as others
}

} // namespace dyncal::inline host_clocks
