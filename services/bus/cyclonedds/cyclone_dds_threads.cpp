#include "services/bus/cyclonedds/cyclone_dds_threads.hpp"

#include <exception>
#include <future>
#include <thread>
#include <vector>

namespace dyncal::bus {
namespace {

// Three for what was received, two that receive, one for events, one that frees memory.
constexpr int threads_of_a_domain = 7;

} // namespace

base::Expected<void> check_threads_for_cyclone_dds() {
  std::promise<void> end;
  const std::shared_future<void> ended = end.get_future().share();
  std::vector<std::jthread> threads;
  threads.reserve(threads_of_a_domain);
  base::Expected<void> result;
  try {
    for (int i = 0; i < threads_of_a_domain; ++i) {
      threads.emplace_back([ended] { ended.wait(); });
    }
  } catch (const std::exception&) { // no thread, or no memory for one
    result = fail(base::ErrorCode::network,
                  "no further thread can be made for Cyclone DDS; raise TasksMax or MemoryMax of "
                  "its systemd unit, or the user's limits (ulimit -u, -v)");
  }
  end.set_value();
  return result;
}

} // namespace dyncal::bus
