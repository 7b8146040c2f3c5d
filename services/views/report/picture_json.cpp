#include "services/views/report/picture_json.hpp"

#include <nlohmann/json.hpp>

#include "services/base/per_enumerator.hpp"
#include "services/views/report/json_number.hpp"

namespace dyncal::inline views {
namespace {

using Json = nlohmann::ordered_json;
using figures::Marker;
using figures::Scale;

const char* to_string(Scale scale) {
  return scale == Scale::logarithmic ? "logarithmic" : "linear";
}

const char* to_string(Marker marker) {
  return per_enumerator(marker, {"none", "circle", "square", "triangle", "cross", "dot"});
}

Json series_json(const figures::Series& series) {
  Json points = Json::array();
  for (const figures::Point& point : series.points) {
    points.push_back(
        {json_number(point.x), json_number(point.y), json_number(point.half_bar), point.step});
  }
  return {{"label", series.label},
          {"colour", series.colour},
          {"marker", to_string(series.marker)},
          {"radius", series.radius},
          {"joined", series.joined},
          {"dashes", series.dashes},
          {"line_width", series.line_width},
          {"points", points}};
}

Json panel_json(const figures::Panel& panel) {
  Json band = Json::array();
  for (const figures::BandPoint& point : panel.band) {
    band.push_back({json_number(point.x), json_number(point.low), json_number(point.high)});
  }
  Json bars = Json::array();
  for (const figures::Bar& bar : panel.bars) {
    bars.push_back({json_number(bar.left), json_number(bar.right), json_number(bar.height)});
  }
  Json dots = Json::array();
  for (const figures::Point& dot : panel.dots) {
    dots.push_back({json_number(dot.x), json_number(dot.y)});
  }
  Json series = Json::array();
  for (const figures::Series& one : panel.series) {
    series.push_back(series_json(one));
  }
  Json range; // null: that of the data
  if (panel.y_range && !panel.y_range->empty()) {
    range = {json_number(panel.y_range->low()), json_number(panel.y_range->high())};
  }
  return {{"x_label", panel.x_label},
          {"y_label", panel.y_label},
          {"x_scale", to_string(panel.x_scale)},
          {"y_scale", to_string(panel.y_scale)},
          {"y_range", range},
          {"colour", panel.colour},
          {"band_label", panel.band_label},
          {"dots_label", panel.dots_label},
          {"band", band},
          {"bars", bars},
          {"dots", dots},
          {"series", series}};
}

} // namespace

Json picture_json(const figures::Figure& figure) {
  const figures::Picture& picture = figure.picture;
  Json panels = Json::array();
  for (const figures::Panel& panel : picture.panels) {
    panels.push_back(panel_json(panel));
  }
  return {{"name", figure.name},
          {"title", picture.title.title},
          {"subtitle", picture.title.subtitle},
          {"panel_height", picture.panel_height},
          {"panels", panels}};
}

} // namespace dyncal::inline views
