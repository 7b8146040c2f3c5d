// --language of commands that make documents. What is passed must live until the command line has
// been read.
#pragma once

#include <vector>

#include "services/views/language/language.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
} // namespace CLI

namespace dyncal::inline programs {

// `languages` stays empty without the option.
void add_language_option(CLI::App& command, std::vector<Language>& languages);

} // namespace dyncal::inline programs
