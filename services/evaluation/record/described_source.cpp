#include "services/evaluation/record/described_source.hpp"

#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/interferometer/decimation_filter.hpp"
#include "services/contract/excitation_quantity.hpp"
#include "services/contract/role_quantities.hpp"

namespace dyncal::inline evaluation {
namespace {

Expected<void> check_channels(const Recipe& recipe, const SourceRecord& source) {
  for (const ChannelName& name : recipe.channels()) {
    if (name.source == source.source() && !source.channel(name.channel)) {
      std::vector<std::string> there;
      for (const drivers::ChannelDescription& channel : source.description().channels) {
        there.push_back(channel.name);
      }
      return fail(ErrorCode::no_source,
                  fmt::format("source '{}' has no channel '{}'; it has: {}", name.source,
                              name.channel, fmt::join(there, ", ")));
    }
  }
  return {};
}

Expected<void> check_quantities(const Recipe& recipe, const RunRecords& records) {
  const auto described =
      [&](const ChannelName& name) -> std::optional<drivers::ChannelDescription> {
    if (name.source == recipe.reference_table) {
      return std::nullopt; // it has no samples
    }
    const SourceRecord& record = records.of(name.source);
    const auto channel = record.described() ? record.channel(name.channel) : std::nullopt;
    return channel ? std::optional(record.description().channels[*channel]) : std::nullopt;
  };
  const auto problems = find_quantity_problems(recipe.roles, described);
  return problems.empty() ? Expected<void>{}
                          : fail(ErrorCode::no_source, fmt::format("{} {}", problems.front().role,
                                                                   problems.front().sentence));
}

// A displacement of quadrature signals went through a filter that is flat up to a part of its rate.
Expected<void> check_pass_band(const Recipe& recipe, const SourceRecord& source) {
  const ChannelName& reference = recipe.reference();
  const double limit_hz = analysis::flat_pass_band * source.description().nominal_rate_hz;
  if (reference.source != source.source() ||
      quadrature_signals_of(source.description(), reference.channel) == nullptr) {
    return {};
  }
  for (const RecipeStep& step : recipe.steps) {
    if (step.frequency.hz() > limit_hz) {
      return fail(
          ErrorCode::no_source,
          fmt::format("step {} has {} Hz, but {} is right up to {:.6g} Hz only at its rate; "
                      "raise output_rate_hz of its interferometer, or take the step out of "
                      "the bench file",
                      step.step, step.frequency_text_hz, reference.text(), limit_hz));
    }
  }
  return {};
}

// A sine at or above half the sample rate looks like one of another frequency.
Expected<void> check_frequencies(const Recipe& recipe, const SourceRecord& source) {
  const double rate_hz = source.description().nominal_rate_hz;
  if (rate_hz <= 0.0) {
    return {}; // not known before samples come
  }
  for (const RecipeStep& step : recipe.steps) {
    if (step.frequency.hz() >= 0.5 * rate_hz) {
      return fail(ErrorCode::no_source,
                  fmt::format("step {} has {} Hz, but source '{}' takes {:.6g} samples a second, "
                              "which show frequencies below {:.6g} Hz only: take the step out of "
                              "the bench file, or set the source to a higher rate",
                              step.step, step.frequency_text_hz, source.source(), rate_hz,
                              0.5 * rate_hz));
    }
  }
  return {};
}

} // namespace

Expected<void> check_source(const Recipe& recipe, const RunRecords& records,
                            const SourceRecord& source) {
  return check_channels(recipe, source)
      .and_then([&] { return check_quantities(recipe, records); })
      .and_then([&] { return check_frequencies(recipe, source); })
      .and_then([&] { return check_pass_band(recipe, source); });
}

void keep_needed_channels(const Recipe& recipe, SourceRecord& source) {
  std::set<std::size_t> columns;
  for (const ChannelName& name : recipe.channels()) {
    if (name.source == source.source()) {
      columns.insert(*source.channel(name.channel));
    }
  }
  source.keep_only(std::move(columns));
}

} // namespace dyncal::inline evaluation
