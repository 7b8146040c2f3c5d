// How a report looks, on the screen and on A4 paper: CSS without anything to fetch.
#pragma once

#include <string_view>

namespace dyncal::inline views {

[[nodiscard]] std::string_view report_style();

} // namespace dyncal::inline views
