// A figure: its picture and its numbers (CSV), and how both become files.
//
// Every CSV has comment lines that begin with "#", one header line that names the units, and
// numbers with 17 significant digits, so that reading them gives back the same bits.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/views/figures/picture.hpp"

namespace dyncal::inline views::figures {

struct Figure {
  std::string name; // of the files, without their endings
  Picture picture;
  std::string csv;
  [[nodiscard]] std::string svg() const { return svg_of(picture); }
};

// Writes NAME.svg and NAME.csv into the folder, which is made when it is missing, and returns their
// paths. Fails (bad_file) when the folder cannot be made or a file cannot be written.
[[nodiscard]] Expected<std::vector<std::filesystem::path>>
write(const Figure& figure, const std::filesystem::path& folder);

// "# text" and a line end; line breaks in the text become spaces.
[[nodiscard]] std::string csv_comment(const std::string& text);

// 17 significant digits; "nan" and "inf" where a value is not finite.
[[nodiscard]] std::string csv_number(double value);

} // namespace dyncal::inline views::figures
