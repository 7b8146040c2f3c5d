// Options of the commands that write figures of a run: --figures and --error-bars. Any thread.
#pragma once

#include <CLI/CLI.hpp>

#include "services/views/report/run_figures.hpp"

namespace dyncal::inline programs {

// `files` must live until the command line has been parsed.
void add_figure_options(CLI::App& command, FigureFiles& files);

} // namespace dyncal::inline programs
