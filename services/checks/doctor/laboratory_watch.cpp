#include "services/checks/doctor/laboratory_watch.hpp"

#include <algorithm>

#include "services/contract/topics.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr const char* all_benches = "*";
constexpr std::chrono::milliseconds max_wait{200};

} // namespace

Expected<std::unique_ptr<LaboratoryWatch>> LaboratoryWatch::open(bus::Participant& participant,
                                                                 const ProgramIdentity& own,
                                                                 bus::Clock& clock) {
  auto wake_up = std::make_shared<bus::WakeUp>();
  DYNCAL_TRY(auto descriptions,
             participant.reader(bus::topics::source_description, all_benches, wake_up));
  DYNCAL_TRY(auto statuses, participant.reader(bus::topics::source_status, all_benches, wake_up));
  DYNCAL_TRY(auto services, participant.reader(bus::topics::service_status, all_benches, wake_up));
  const AskingPace always_quick{.quick_requests = 1'000'000};
  DYNCAL_TRY(auto asker, ClockAsker::open(participant, own, clock, wake_up, always_quick));
  DYNCAL_TRY(auto meter, LinkMeter::open(participant, own, clock, wake_up));
  return std::unique_ptr<LaboratoryWatch>(
      new LaboratoryWatch(participant, own, clock,
                          Readers{std::move(descriptions), std::move(statuses), std::move(services),
                                  std::move(wake_up)},
                          std::move(asker), std::move(meter)));
}

void LaboratoryWatch::work() {
  clock_.wait(*readers_.wake_up,
              std::min({clock_.now() + max_wait, asker_.next_request(), meter_.next_probe()}));
  const auto feed = [this](const auto& message) { state_.take(message); };
  readers_.descriptions.take(feed);
  readers_.statuses.take_with_writer(
      [this](const auto& status, const bus::WriterId& writer) { take(status, writer); });
  readers_.services.take(feed);
  asker_.work();
  meter_.work(asker_.program_count()); // an answer's echoes came before it
}

void LaboratoryWatch::take(const wire::SourceStatus& status, const bus::WriterId& writer) {
  state_.take(status);
  const LaboratoryView::Key key{status.bench().to_string(), status.source().to_string()};
  if (!senders_.contains(key) && senders_.size() >= limits.sources) {
    return;
  }
  if (auto& senders = senders_[key]; writer.is_known() && senders.size() < max_senders) {
    senders.insert(writer.participant());
  }
}

LaboratoryView LaboratoryWatch::view() const {
  LaboratoryView view;
  view.own = own_;
  view.senders = senders_;
  for (const auto& [name, bench] : state_.benches()) {
    for (const auto& [source_name, source] : bench.sources) {
      view.sources.emplace(std::pair(name, source_name), source);
    }
    for (const auto& [service_name, service] : bench.services) {
      if (service.is_guard()) {
        view.guards.emplace(std::pair(name, service_name), service);
      } else if (service.is_analysis()) {
        view.analyses.insert_or_assign(service_name, service);
      }
    }
  }
  view.programs = asker_.programs();
  view.clocks = asker_.other_hosts();
  view.losses = meter_.losses(view.programs);
  view.discovery = participant_.discovered();
  view.malformed_messages = participant_.malformed_messages();
  return view;
}

} // namespace dyncal::inline checks::doctor
