// The plan of a run, from the bench file to the recipe by which it is evaluated: all frequencies in
// the order of the bench file, then all again for the next repetition; method, roles, corrections
// and uncertainties as the bench file gives them.
//
// Plain functions, any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/instrument/adc_calibration.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline run {

// Fails (bad_argument) as check_recipe() does.
[[nodiscard]] Expected<Recipe>
plan_recipe(const BenchFile& file, const std::string& run,
            const std::vector<analysis::AdcCalibrationPoint>& adc_calibration);

// Fails (bad_argument) with what only 'dyncal analyse' evaluates, and what to do for a run.
[[nodiscard]] Expected<void> check_for_run(const Recipe& recipe);

// The file of the ADC's calibration, as it is now; nothing when the bench file names none.
[[nodiscard]] std::optional<AdcFile> adc_file_of(const BenchFile& bench);

} // namespace dyncal::inline run
