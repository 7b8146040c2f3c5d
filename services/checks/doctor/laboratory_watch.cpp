#include "services/checks/doctor/laboratory_watch.hpp"

#include <algorithm>

#include "services/contract/known_sources.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr const char* all_benches = "*";
constexpr std::chrono::milliseconds max_wait{200};

template <class Message>
LaboratoryView::SourceKey key_of(const Message& message) {
  return {message.bench().to_string(), message.source().to_string()};
}

} // namespace

Expected<std::unique_ptr<LaboratoryWatch>> LaboratoryWatch::open(bus::Participant& participant,
                                                                 const ProgramIdentity& own,
                                                                 bus::Clock& clock) {
  auto wake_up = std::make_shared<bus::WakeUp>();
  auto descriptions = participant.reader(bus::topics::source_description, all_benches, wake_up);
  auto statuses = participant.reader(bus::topics::source_status, all_benches, wake_up);
  auto analyses = participant.reader(bus::topics::service_status, all_benches, wake_up);
  const AskingPace always_quick{.quick_requests = 1'000'000};
  auto asker = ClockAsker::open(participant, own, clock, wake_up, always_quick);
  auto meter = LinkMeter::open(participant, own, clock, wake_up);
  if (const auto error = first_error(descriptions, statuses, analyses, asker, meter)) {
    return fail(*error);
  }
  return std::unique_ptr<LaboratoryWatch>(new LaboratoryWatch(
      participant, own, clock, std::move(wake_up),
      Readers{std::move(*descriptions), std::move(*statuses), std::move(*analyses)},
      std::move(*asker), std::move(*meter)));
}

void LaboratoryWatch::work() {
  clock_.wait(*wake_up_,
              std::min({clock_.now() + max_wait, asker_.next_request(), meter_.next_probe()}));
  take();
  asker_.work();
  meter_.work(asker_.program_count()); // an answer's echoes came before it
}

void LaboratoryWatch::take() {
  readers_.descriptions.take([this](const wire::SourceDescription& description) {
    ObservedSource& source = view_.sources[key_of(description)];
    source.description = description;
    if (std::string service = service_of(description); !service.empty()) {
      source.writers.insert(std::move(service));
    }
  });
  readers_.statuses.take([this](const wire::SourceStatus& status) {
    ObservedSource& source = view_.sources[key_of(status)];
    DuplicateSourceDetector& turns = turns_[key_of(status)];
    turns.add(status.session());
    source.twins = turns.twins();
    if (!source.first_status || source.first_status->session() != status.session()) {
      source.first_status = status;
    }
    source.status = status;
  });
  readers_.analyses.take([this](const wire::ServiceStatus& status) {
    if (!status.guarded_generator().empty()) {
      const std::string bench = status.bench().to_string();
      view_.guards[bench + " " + status.service().to_string()] = status;
      return; // the run that it names is one that it does not hear
    }
    if (status.run().to_string().empty()) {
      return; // of a recorder
    }
    view_.analyses[status.service().to_string()] = status;
  });
}

LaboratoryView LaboratoryWatch::view() const {
  LaboratoryView view = view_;
  view.programs = asker_.programs();
  view.clocks = asker_.other_hosts();
  view.losses = meter_.losses(view.programs);
  view.discovery = participant_.discovered();
  view.malformed_messages = participant_.malformed_messages();
  return view;
}

} // namespace dyncal::inline checks::doctor
