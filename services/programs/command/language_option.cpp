#include "services/programs/command/language_option.hpp"

#include <string>
#include <utility>

#include <CLI/CLI.hpp>

namespace dyncal::inline programs {

void add_language_option(CLI::App& command, std::vector<Language>& languages) {
  command.add_option_function<std::string>(
      "--language",
      [&languages](const std::string& codes) {
        auto read = parse_languages(codes);
        if (!read) {
          throw CLI::ValidationError("--language", read.error().message);
        }
        languages = std::move(*read);
      },
      "of the document: en, de, or both as de,en (default: that of the laboratory file, else "
      "en)");
}

} // namespace dyncal::inline programs
