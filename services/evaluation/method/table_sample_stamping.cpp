#include <cmath>
#include <map>

#include <fmt/core.h>

#include "analysis/method/table_stamping.hpp"
#include "services/contract/digest.hpp"
#include "services/evaluation/method/calibrated_channels.hpp"
#include "services/evaluation/method/disturbance_cut.hpp"
#include "services/evaluation/method/method_kinds.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double same_window_rel = 0.01; // of the step, either end; or a period

// Both in UTC, and the same: then what the exciter does along the step, both see alike.
bool has_same_window(const ReferenceStep& row, const SelectedChannels& dau,
                     const RecipeStep& step) {
  if (row.window_begin_utc_ns == 0 || row.window_end_utc_ns <= row.window_begin_utc_ns ||
      dau.record().description().time_base != drivers::TimeBase::utc || dau.stamps_ns().empty()) {
    return false;
  }
  const double length_ns = static_cast<double>(row.window_end_utc_ns - row.window_begin_utc_ns);
  const double off_ns = std::max(same_window_rel * length_ns, 1e9 / step.frequency.hz());
  const auto alike = [&](std::int64_t a, std::int64_t b) {
    return std::abs(static_cast<double>(a - b)) <= off_ns;
  };
  return alike(row.window_begin_utc_ns, dau.stamps_ns().front()) &&
         alike(row.window_end_utc_ns, dau.stamps_ns().back());
}

analysis::Expected<EvaluatedStep> evaluate_channels(const StepTask& task, const ReferenceStep& row,
                                                    const SelectedChannels& dau) {
  const Recipe& recipe = *task.recipe;
  DYNCAL_TRY(const auto adc, adc_response(recipe, task.step()));
  DYNCAL_TRY(const auto response, reference_response(recipe, task.step()));
  analysis::SampleStampingInput input{.frequency = task.step().frequency,
                                      .frequency_search_rel = recipe.frequency_search_rel,
                                      .dau_stamps_ns = dau.stamps_ns(),
                                      .sync_dau = dau.channel(0),
                                      .dut = dau.channels_from(1),
                                      .adc = adc,
                                      .reference_delay_s = recipe.reference_delay_s,
                                      .reference_response = response,
                                      .systematic = recipe.systematic};
  input.systematic.dau_tick_s = dau.record().description().tick_s;
  const analysis::EvaluatedReference reference{.channel = recipe.reference().text(),
                                               .sync_channel = recipe.excitation().text(),
                                               .amplitude = row.amplitude_m_s2,
                                               .u_amplitude = row.u_amplitude_m_s2,
                                               .phase_rad = row.phase_rad,
                                               .u_phase_rad = row.u_phase_rad,
                                               .same_window =
                                                   has_same_window(row, dau, task.step())};
  return analysis::evaluate_table_stamping(input, reference)
      .map([](const analysis::SampleStampingResult& result) {
        return EvaluatedStep{
            {result.reference, result.sync_acs, result.sync_dau}, result.points, result.findings};
      });
}

std::vector<std::string> units_of_sensor(const SelectedChannels& dau) {
  std::vector<std::string> units;
  for (std::size_t i = 1; i < dau.size(); ++i) {
    units.push_back(ratio_unit(reference_step_unit, dau.unit(i)));
  }
  return units;
}

// Of the samples and of the row.
std::string digest_of_step(const SelectedChannels& dau, const ReferenceStep& row) {
  return sha256_hex(fmt::format("{} {} {} {} {}", digest_of({&dau}), row.amplitude_m_s2,
                                row.u_amplitude_m_s2, row.phase_rad, row.u_phase_rad));
}

std::vector<StepResult> evaluate(StepTask task, const ReferenceStep& row,
                                 SourceInterval dau_source) {
  const std::vector<ChannelName> dut = calibrated_channels(*task.recipe, *dau_source.record);
  std::vector<ChannelName> of_dau{task.recipe->roles.sync_sensor};
  of_dau.insert(of_dau.end(), dut.begin(), dut.end());
  SelectedChannels dau(std::move(dau_source), std::move(of_dau), task.recipe->mains_hz);
  const auto step =
      evaluate_without_knocks(task, {&dau}, [&] { return evaluate_channels(task, row, dau); });
  return make_results(task,
                      {.dut = dut,
                       .reference_unit = reference_step_unit,
                       .units = units_of_sensor(dau),
                       .samples = {dau.summary()},
                       .data_sha256 = digest_of_step(dau, row),
                       .common = {{}, {}, {&dau, 0}},
                       .first_dut = {&dau, 1}},
                      step);
}

// Sample time stamping against the steps that the reference's system has evaluated itself
// (analysis/method/table_stamping.hpp). Steps are found in the DAU's sync alone; each waits for its
// row, and has no value where its system says that there is none, or none has come when the run is
// over. An excitation that is made again has a row of its own, the next one of its step.
class TableSampleStamping : public Method {
public:
  using Method::Method;

  [[nodiscard]] std::vector<SearchedChannel> searches() const override {
    return {{roles_.sync_sensor, {roles_.sync_sensor.source}}};
  }

  void add(ReferenceStep step) override {
    std::vector<ReferenceStep>& rows = rows_[step.step];
    if (rows.empty() || !(rows.back() == step)) { // else it was sent again
      rows.push_back(std::move(step));
    }
  }

  [[nodiscard]] bool is_complete(std::size_t step, const RunRecords& records) const override {
    return row_of(step, records) != nullptr || records.excitation().is_cut_short();
  }

  [[nodiscard]] Evaluation evaluation(std::size_t step, const RunRecords& records) override {
    const SourceRecord& dau = records.of(roles_.sync_sensor.source);
    const auto of_dau = records.interval(0, step);
    if (!of_dau) {
      return not_found(step, records, roles_.sync_sensor, calibrated_channels(*recipe_, dau));
    }
    const ReferenceStep* row = row_of(step, records);
    if (row == nullptr || !row->problem.empty()) {
      return [results = results_without_value(
                  records.planned(step), calibrated_channels(*recipe_, dau),
                  row != nullptr ? row->problem
                                 : fmt::format("source '{}' gave no row of its table for this step",
                                               recipe_->reference_table))](const std::stop_token&) {
        return results;
      };
    }
    SourceInterval samples = records.samples(roles_.sync_sensor.source, *of_dau);
    StepTask task = make_step_task(recipe_, step, records, {samples});
    return [task = std::move(task), row = *row, samples = std::move(samples)](
               const std::stop_token& stop) { return evaluate(task.until(stop), row, samples); };
  }

  // A row that its system has taken back, since the table does not bear it out any more.
  [[nodiscard]] bool settle(std::span<StepResult> results) const override {
    bool changed = false;
    for (StepResult& result : results) {
      const auto rows = rows_.find(result.step);
      const bool is_taken_back = rows != rows_.end() && rows->second.size() > result.attempt &&
                                 !rows->second.back().problem.empty();
      if (is_taken_back && !has_flag(result.flags, ResultFlag::step_number_uncertain)) {
        result.flags.push_back(
            flag_with_reason(ResultFlag::step_number_uncertain, rows->second.back().problem));
        changed = true;
      }
    }
    return changed;
  }

  [[nodiscard]] std::optional<std::string> clock_source() const override {
    return roles_.sync_sensor.source;
  }

private:
  [[nodiscard]] const ReferenceStep* row_of(std::size_t step, const RunRecords& records) const {
    const auto rows = rows_.find(records.planned(step).step);
    const std::uint32_t attempt = records.excitation().order().attempt(step);
    return rows != rows_.end() && rows->second.size() >= attempt ? &rows->second[attempt - 1]
                                                                 : nullptr;
  }

  std::map<std::uint32_t, std::vector<ReferenceStep>> rows_; // by step, in the order they came
};

} // namespace

std::unique_ptr<Method> make_table_sample_stamping(std::shared_ptr<const Recipe> recipe) {
  return std::make_unique<TableSampleStamping>(std::move(recipe));
}

} // namespace dyncal::inline evaluation
