#include "services/programs/virtual_bench/excitation_option.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "analysis/sine/multisine_lines.hpp"
#include "analysis/sine/schroeder_phases.hpp"
#include "services/base/parsed_number.hpp"

namespace dyncal::inline programs::virtual_bench {
namespace {

using drivers::virtual_bench::Programme;

// By which the exciter may raise the peaks of a multi-sine: it turns every line by another angle.
constexpr double dispersion = 1.4;
constexpr std::size_t samples_of_period = 1 << 15;

tl::unexpected<Error> bad_option(const std::string& sentence) {
  return fail(ErrorCode::bad_argument, sentence);
}

// Phases that keep the peaks low; the highest of these.
Expected<double> read_multisine(double period_s, Programme& programme) {
  const auto checked = analysis::check_multisine_lines(programme.frequencies_hz, period_s);
  if (!checked) {
    return bad_option("--frequencies: " + checked.error().message);
  }
  programme.phases_rad = analysis::schroeder_phases(programme.levels_m_s2);
  std::vector<analysis::MultisineLine> lines;
  for (std::size_t i = 0; i < programme.phases_rad.size(); ++i) {
    lines.push_back({*parsed_number<double>(programme.frequencies_hz[i]), programme.levels_m_s2[i],
                     programme.phases_rad[i]});
  }
  const auto waveform = analysis::multisine_waveform(lines, period_s, samples_of_period);
  const auto [lowest, highest] = std::ranges::minmax(waveform);
  return dispersion * std::max(-lowest, highest);
}

} // namespace

Expected<double> read_excitation(const ExcitationWords& words, Programme& programme) {
  for (const std::string& text : words.frequencies) {
    const auto frequency_hz = parsed_number<double>(text);
    if (!frequency_hz || !(*frequency_hz > 0.0 && *frequency_hz <= 5000.0)) {
      return bad_option(
          fmt::format("--frequencies: \"{}\" is not a frequency between 0 and 5000 Hz", text));
    }
  }
  if (words.levels.size() != 1 && words.levels.size() != words.frequencies.size()) {
    return bad_option(fmt::format("--levels: give one level, or one for each of the {} frequencies",
                                  words.frequencies.size()));
  }
  for (const double level : words.levels) {
    if (!(level > 0.0 && level <= 500.0)) {
      return bad_option(fmt::format("--levels: {} m/s^2 is not between 0 and 500", level));
    }
  }
  programme.frequencies_hz = words.frequencies;
  programme.levels_m_s2 = words.levels.size() == 1
                              ? std::vector<double>(words.frequencies.size(), words.levels.front())
                              : words.levels;
  return words.multisine_period_s > 0.0 ? read_multisine(words.multisine_period_s, programme)
                                        : Expected<double>(std::ranges::max(words.levels));
}

} // namespace dyncal::inline programs::virtual_bench
