#include "services/views/figures/svg.hpp"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/views/figures/well_formed.hpp"

namespace dyncal::inline views::figures {
namespace {

TEST(SvgText, IsEscaped) {
  Svg svg(100, 50);
  svg.text({1, 2}, "a < b & \"c\" > d \x01", {});
  const auto document = svg.finish();
  EXPECT_EQ(problem_of(document), "");
  EXPECT_THAT(texts_of(document), testing::ElementsAre("a < b & \"c\" > d \xef\xbf\xbd"));
}

TEST(SvgDocument, IsWellFormedWithEveryElement) {
  Svg svg(200, 100);
  const std::array<Pixel, 3> points = {Pixel{1, 2}, Pixel{3, 4}, Pixel{5, 6}};
  svg.begin_clip({0, 0, 10, 10});
  svg.line({0, 0}, {1, 1}, {.dashes = "5 3", .opacity = 0.5});
  svg.polyline(points, {});
  svg.polygon(points, "#123456", 0.4);
  svg.rectangle({0, 0, 5, 5}, "none", {});
  for (const auto marker : {Marker::none, Marker::circle, Marker::square, Marker::triangle,
                            Marker::cross, Marker::dot}) {
    svg.marker(marker, {5, 5}, 3, {});
  }
  svg.dots(points, 2, {});
  svg.text({5, 5}, "up", {.anchor = Anchor::middle, .bold = true, .upwards = true});
  svg.end_clip();
  EXPECT_EQ(problem_of(svg.finish()), "");
}

TEST(SvgPolyline, NeedsTwoPoints) {
  Svg svg(10, 10);
  svg.polyline(std::array<Pixel, 1>{Pixel{1, 1}}, {});
  EXPECT_EQ(count_elements(svg.finish(), "polyline"), 0U);
}

TEST(TextWidth, CountsCharactersNotBytes) {
  EXPECT_DOUBLE_EQ(text_width("µµ", 10), text_width("nn", 10));
}

} // namespace
} // namespace dyncal::inline views::figures
