#include "services/bus/default_partition.hpp"

#include <atomic>

namespace dyncal::bus {
namespace {

// Of the process, which has one participant.
std::atomic<bool> samples_are_there = false;

bool is_there(Profile profile) {
  switch (profile) {
  case Profile::results:
  case Profile::state:
    return true;
  case Profile::samples:
  case Profile::live_samples:
  case Profile::live_records:
  case Profile::paced_samples:
    return samples_are_there;
  case Profile::command:
  case Profile::catch_up:
  case Profile::probe:
    break;
  }
  return false;
}

} // namespace

std::vector<std::string> partitions_of_writer(Profile profile, bool secured,
                                              std::vector<std::string> partitions) {
  if (!secured && is_there(profile)) {
    partitions.emplace_back();
  }
  return partitions;
}

void publish_samples_in_default_partition(bool wanted) {
  samples_are_there = wanted;
}

} // namespace dyncal::bus
