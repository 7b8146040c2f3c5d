// A picture as JSON, for the page in the browser, which draws it. Members have the names of
// figures/picture.hpp and panel.hpp; what only a file needs (the width, text below, enlarged
// parts) is left out. Points are arrays:
//
//   series.points [x, y, half_bar, step], band [x, low, high], bars [left, right, height],
//   dots [x, y]
//
// Numbers are in the units that the labels name; null: not finite. Step 0: of no single step. Any
// thread.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "services/views/figures/figure.hpp"

namespace dyncal::inline views {

// With the figure's name.
[[nodiscard]] nlohmann::ordered_json picture_json(const figures::Figure& figure);

} // namespace dyncal::inline views
