// A picture: what files, reports and the page in the browser draw of one figure. Panels in rows
// below a title and a legend, with text below them.
//
// It holds plain numbers, labels with units, and looks; nobody who draws it adds a label, a colour
// or a unit. Panels of one column stand above each other over one x axis where only the last shows
// its tick labels. svg_of() draws it; the same picture gives the same bytes, whatever the locale.
// The page gets it as JSON (report/picture_json.hpp). Plain functions, any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "services/views/figures/panel.hpp"

namespace dyncal::inline views::figures {

struct PictureTitle {
  std::string title{};
  std::string subtitle{}; // may be empty
};

struct Picture {
  PictureTitle title{};
  std::vector<Panel> panels{}; // row by row
  std::size_t columns = 1;
  std::vector<std::string> below{}; // one paragraph each
  double width = 820;               // pixels, as all of a drawing
  double panel_height = 250;
};

[[nodiscard]] std::string svg_of(const Picture& picture);

} // namespace dyncal::inline views::figures
