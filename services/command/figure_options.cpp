#include "services/command/figure_options.hpp"

#include <map>
#include <string>

namespace dyncal::services {

void add_figure_options(CLI::App& command, FigureFiles& files) {
  using figures::ErrorBars;
  CLI::Option* folder =
      command.add_option("--figures", files.folder, "write figures (SVG and CSV) into this folder");
  command
      .add_option("--error-bars", files.error_bars,
                  "what the bars of the figures show: standard (u, default), expanded (U) or none")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, ErrorBars>{{"standard", ErrorBars::standard},
                                           {"u", ErrorBars::standard}, // as the page calls them
                                           {"expanded", ErrorBars::expanded},
                                           {"U", ErrorBars::expanded},
                                           {"none", ErrorBars::none}}))
      ->needs(folder);
}

} // namespace dyncal::services
