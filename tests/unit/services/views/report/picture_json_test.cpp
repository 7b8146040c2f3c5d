#include "services/views/report/picture_json.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dyncal::inline views {
namespace {

using nlohmann::json;

figures::Figure small_figure() {
  figures::Panel panel{.x_label = "frequency in Hz",
                       .y_label = "magnitude in 1",
                       .x_scale = figures::Scale::logarithmic};
  panel.band = {{10, 0.5, 1.5}};
  panel.bars = {{1, 2, 3}};
  panel.dots = {{4, 5}, {6, std::numeric_limits<double>::quiet_NaN()}};
  panel.series = {{.label = "#1", .points = {{10, 1, 0.1, 7}}, .marker = figures::Marker::square}};
  return {"name", {.title = {"<title>", "line"}, .panels = {panel}}, "csv"};
}

TEST(PictureJson, HasTitlesAxesAndAllThatIsDrawn) {
  const json picture = picture_json(small_figure());
  EXPECT_EQ(picture["name"], "name");
  EXPECT_EQ(picture["title"], "<title>");
  EXPECT_EQ(picture["subtitle"], "line");
  EXPECT_EQ(picture["panel_height"], 250);
  ASSERT_EQ(picture["panels"].size(), 1U);
  const json panel = picture["panels"][0];
  EXPECT_EQ(panel["x_label"], "frequency in Hz");
  EXPECT_EQ(panel["x_scale"], "logarithmic");
  EXPECT_EQ(panel["y_scale"], "linear");
  EXPECT_TRUE(panel["y_range"].is_null());
  EXPECT_EQ(panel["band"], json::parse("[[10, 0.5, 1.5]]"));
  EXPECT_EQ(panel["bars"], json::parse("[[1, 2, 3]]"));
  EXPECT_EQ(panel["dots"], json::parse("[[4, 5], [6, null]]"));
  EXPECT_EQ(panel["series"][0]["label"], "#1");
  EXPECT_EQ(panel["series"][0]["marker"], "square");
  EXPECT_EQ(panel["series"][0]["points"], json::parse("[[10, 1, 0.1, 7]]"));
}

TEST(PictureJson, HasTheRangeOfTheAxisWhereThePictureSetsIt) {
  figures::Figure figure = small_figure();
  figures::Range range;
  range.include(-1);
  range.include(3);
  figure.picture.panels[0].y_range = range;
  EXPECT_EQ(json(picture_json(figure))["panels"][0]["y_range"], json::parse("[-1, 3]"));
}

} // namespace
} // namespace dyncal::inline views
