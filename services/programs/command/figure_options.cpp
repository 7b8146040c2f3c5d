#include "services/programs/command/figure_options.hpp"

#include <map>
#include <string>
#include <vector>

namespace dyncal::inline programs {
namespace {

using figures::ErrorBars;

ErrorBars bars_named(const std::string& name) {
  static const std::map<std::string, ErrorBars> names{{"standard", ErrorBars::standard},
                                                      {"u", ErrorBars::standard}, // as on the page
                                                      {"expanded", ErrorBars::expanded},
                                                      {"U", ErrorBars::expanded},
                                                      {"none", ErrorBars::none}};
  return names.at(name);
}

} // namespace

void add_figure_options(CLI::App& command, FigureFiles& files) {
  CLI::Option* folder =
      command.add_option("--figures", files.folder, "write figures (SVG and CSV) into this folder");
  command
      .add_option_function<std::string>(
          "--error-bars",
          [&files](const std::string& name) { files.error_bars = bars_named(name); },
          "what the bars of the figures show: standard (u, default), expanded (U) or none")
      ->check(CLI::IsMember(std::vector<std::string>{"standard", "u", "expanded", "U", "none"}))
      ->needs(folder);
}

} // namespace dyncal::inline programs
