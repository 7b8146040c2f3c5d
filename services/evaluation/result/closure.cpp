#include "services/evaluation/result/closure.hpp"

#include <array>

#include <fmt/core.h>

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline evaluation {
namespace {

struct Names {
  std::string_view name, title;
};

constexpr std::array names{
    Names{"clock_rate", "rate of the sensor's clock"},
    Names{"clock_ratio", "ratio of the clocks in each step"},
    Names{"excitation_frequency", "frequency of the excitation"},
    Names{"level", "level of the excitation"},
    Names{"samples_counted", "samples counted"},
    Names{"repetitions", "repetitions of a point"},
    Names{"repetition_scatter", "scatter of the repetitions"},
    Names{"first_repeated", "first point repeated at the end"},
    Names{"delay_fit", "phase against the group delay"},
    Names{"delay_alternatives", "other group delays"},
    Names{"phase_at_zero", "phase towards 0 Hz"},
    Names{"channel_delays", "delays of channels of one kind"},
    Names{"channel_clocks", "clocks of channels of one sensor"},
    Names{"clock_links", "sync against UTC"},
};

} // namespace

std::string_view to_string(ClosureKind kind) {
  return names.at(static_cast<std::size_t>(kind)).name;
}

std::string_view title_of(ClosureKind kind) {
  return names.at(static_cast<std::size_t>(kind)).title;
}

std::string_view to_string(Verdict verdict) {
  return per_enumerator(verdict, {"closes", "open", "not_possible"});
}

std::string closure_line(const std::string& channel, const Closure& closure) {
  return fmt::format("{}: {}: {}", channel, title_of(closure.kind), closure.sentence);
}

bool is_open(const Closure& closure) {
  return closure.verdict == Verdict::open;
}

} // namespace dyncal::inline evaluation
