// What is checked of a bench file, as plain functions of what was looked at. Each returns its
// findings; none repeats what the reader of the file has refused already (BenchView::problems), and
// none trusts values that it refused. Any thread.
#pragma once

#include <span>

#include "services/base/finding.hpp"
#include "services/checks/bench_check/bench_view.hpp"

namespace dyncal::inline checks::bench_check {

// Files that the bench names: there, readable, their SHA-256.
[[nodiscard]] Findings check_files(const BenchView& view);
// Channels with a role, their quantities, names and units against what the sources deliver.
[[nodiscard]] Findings check_channels(const BenchView& view);
// Every frequency against half the sample rate of every source, and the length of a step.
[[nodiscard]] Findings check_rates(const BenchView& view);
// Every frequency and level against the calibrations of the reference and the sync ADC.
[[nodiscard]] Findings check_corrections(const BenchView& view);
// Voltage and level of every step against the limits of the generator.
[[nodiscard]] Findings check_levels(const BenchView& view);
// Standard uncertainties that are missing or zero.
[[nodiscard]] Findings check_uncertainty(const BenchView& view);
// How many steps, and how long they take; what a run refuses before its first step.
[[nodiscard]] Findings check_plan(const BenchView& view);
// Ports, addresses, CAN messages and names that two sources or two benches want.
[[nodiscard]] Findings check_collisions(std::span<const BenchView> views);

// The errors for which `dyncal run` excites nothing, in the order of the file. Files that sources
// play are left to those who play them, perhaps on other hosts.
[[nodiscard]] Findings find_errors_before_run(const BenchView& view);

// All of them, with what the readers refused, in the order of files and lines.
[[nodiscard]] Findings check_benches(std::span<const BenchView> views);

} // namespace dyncal::inline checks::bench_check
