// A picture as JSON, for whoever draws it elsewhere: the page in the browser. Every member of
// figures/picture.hpp and panel.hpp under its own name; points are arrays:
//
//   series.points [x, y, half_bar], band [x, low, high], bars [left, right, height], dots [x, y]
//
// Numbers are in the units that the labels name; null: not finite. Any thread.
#pragma once

#include <nlohmann/json.hpp>

#include "services/report/figures/figure.hpp"

namespace dyncal::services {

// With the figure's name.
[[nodiscard]] nlohmann::ordered_json picture_json(const figures::Figure& figure);

} // namespace dyncal::services
