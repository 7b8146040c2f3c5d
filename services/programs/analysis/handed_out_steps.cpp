#include "services/programs/analysis/handed_out_steps.hpp"

#include <fmt/core.h>

#include "services/contract/topics.hpp"

namespace dyncal::inline programs {

Expected<HandedOutSteps> HandedOutSteps::open(bus::Participant& participant,
                                              const std::shared_ptr<bus::WakeUp>& wake_up,
                                              std::string bench, std::string run,
                                              std::string source) {
  DYNCAL_TRY(auto reader, participant.reader<wire::AcsStep>(bus::topics::acs_step,
                                                            bus::Profile::results, bench, wake_up));
  return HandedOutSteps(std::move(reader), std::move(bench), std::move(run), std::move(source));
}

void HandedOutSteps::take(const Take& take) {
  reader_.take_with_writer([&](const wire::AcsStep& step, const bus::WriterId& writer) {
    const bool is_ours =
        step.bench() == bench_ && step.run() == run_ && step.source().to_string() == source_;
    if (is_ours && take(step, writer)) {
      steps_.emplace(step.step(), step.repetition());
    }
  });
}

std::string HandedOutSteps::missing(std::size_t planned) const {
  return steps_.size() >= planned
             ? ""
             : fmt::format("source '{}' of bench '{}' has handed out {} of {} steps of its table",
                           source_, bench_, steps_.size(), planned);
}

} // namespace dyncal::inline programs
