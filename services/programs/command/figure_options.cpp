#include "services/programs/command/figure_options.hpp"

#include <string>

#include "services/views/figures/error_bar_names.hpp"

namespace dyncal::inline programs {

void add_figure_options(CLI::App& command, FigureFiles& files) {
  CLI::Option* folder =
      command.add_option("--figures", files.folder, "write figures (SVG and CSV) into this folder");
  command
      .add_option_function<std::string>(
          "--error-bars",
          [&files](const std::string& name) {
            files.error_bars = *figures::parse_error_bars(name);
          },
          "what the bars of the figures show: standard (u, default), expanded (U) or none")
      ->check(CLI::IsMember({"standard", "u", "expanded", "U", "none"}))
      ->needs(folder);
}

} // namespace dyncal::inline programs
