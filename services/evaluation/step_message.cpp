#include "services/evaluation/step_message.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "services/contract/digest.hpp"
#include "services/contract/unit.hpp"
#include "services/evaluation/contribution_message.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

} // namespace

wire::SourceSamples samples_message(const SourceRecord& record, const StepSamples& series,
                                    const StretchOfTime& stretch) {
  wire::SourceSamples samples;
  samples.source(record.source());
  samples.used(series.stamps_ns.size());
  samples.lost(record.lost_between(stretch.begin_ns, stretch.end_ns));
  samples.not_trusted(series.not_trusted);
  samples.first_stamp_ns(series.stamps_ns.empty() ? 0 : series.stamps_ns.front());
  samples.last_stamp_ns(series.stamps_ns.empty() ? 0 : series.stamps_ns.back());
  return samples;
}

wire::SineFit fit_message(const analysis::ChannelFit& channel) {
  wire::SineFit message;
  message.channel(channel.channel);
  message.frequency_hz(channel.frequency.hz());
  message.u_frequency_hz(channel.u_frequency_hz);
  message.phase_origin_ns(channel.phase_origin_ns);
  message.sine(channel.fit.sine);
  message.cosine(channel.fit.cosine);
  message.offset(channel.fit.offset);
  message.u_sine(std::sqrt(channel.fit.covariance[0]));
  message.u_cosine(std::sqrt(channel.fit.covariance[3]));
  message.u_offset(std::sqrt(channel.fit.covariance[5]));
  message.residual_rms(std::sqrt(
      channel.fit.rss / static_cast<double>(std::max<std::uint64_t>(channel.fit.samples, 1))));
  message.sample_count(channel.fit.samples);
  return message;
}

wire::CalibrationResult result_head(const Recipe& recipe, const RecipeStep& step,
                                    const std::string& channel) {
  wire::CalibrationResult result;
  result.bench(recipe.bench);
  result.run(recipe.run);
  result.channel(channel);
  result.step(step.step);
  result.repetition(step.repetition);
  result.frequency_text_hz(step.frequency_text_hz);
  result.frequency_hz(step.frequency.hz());
  result.level_m_s2(step.level_m_s2);
  result.valid(false);
  result.magnitude(nan_value);
  result.u_magnitude(nan_value);
  result.phase_rad(nan_value);
  result.u_phase_rad(nan_value);
  result.software(software_version());
  result.recipe_sha256(recipe.sha256);
  return result;
}

// Output per input, as D-SI knows it: "\one" when both are the same.
std::string ratio_unit(const SourceRecord& acs, const std::string& reference,
                       const SourceRecord& dau, const std::string& channel) {
  const std::string in = acs.description().channels()[*acs.channel(reference)].unit();
  const std::string out = dau.description().channels()[*dau.channel(channel)].unit();
  if (in == out) {
    return R"(\one)";
  }
  return in.empty() || out.empty() ? "" : fmt::format("({})/({})", short_form(out), short_form(in));
}

void add_budget(std::span<const analysis::Contribution> budget, wire::CalibrationResult& result) {
  for (const analysis::Contribution& row : budget) {
    result.budget().push_back(contribution_message(row));
  }
}

wire::CalibrationResult point_result(const Recipe& recipe, const RecipeStep& step,
                                     const ChannelName& name, const analysis::TransferPoint& point,
                                     std::span<const analysis::ChannelFit> common_fits) {
  wire::CalibrationResult result = result_head(recipe, step, name.text());
  result.valid(true);
  result.magnitude(point.magnitude);
  result.u_magnitude(point.u_magnitude);
  result.phase_rad(point.phase_rad);
  result.u_phase_rad(point.u_phase_rad);
  for (const analysis::ChannelFit& fit : common_fits) {
    result.fits().push_back(fit_message(fit));
  }
  result.fits().push_back(fit_message(point.dut));
  add_budget(point.budget, result);
  return result;
}

std::string digest_of(std::initializer_list<const StepSamples*> parts) {
  Digest digest;
  for (const StepSamples* part : parts) {
    digest.add(part->stamps_ns.data(), part->stamps_ns.size() * sizeof(std::int64_t));
    for (const auto& column : part->columns) {
      digest.add(column.data(), column.size() * sizeof(double));
    }
  }
  return digest.hex();
}

} // namespace dyncal::services
