// Writes the few SVG elements that a plot needs. Lengths are pixels, y grows downwards, as in SVG
// itself.
//
// Text is escaped; coordinates have two decimals, whatever the locale.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline views::figures {

struct Pixel {
  double x;
  double y;
};

struct Box {
  double left;
  double top;
  double width;
  double height;
  [[nodiscard]] double right() const { return left + width; }
  [[nodiscard]] double bottom() const { return top + height; }
};

struct Stroke {
  std::string colour = "#333333";
  double width = 1;
  std::string dashes{}; // e.g. "5 3"; empty: a solid line
  double opacity = 1;
};

enum class Anchor { start, middle, end };

struct TextStyle {
  double size = 12;
  Anchor anchor = Anchor::start;
  std::string colour = "#222222";
  bool bold = false;
  bool upwards = false; // turned by 90 degrees, to be read from below
};

enum class Marker { none, circle, square, triangle, cross, dot };

class Svg {
public:
  Svg(double width, double height);

  void line(Pixel from, Pixel to, const Stroke& stroke);
  void polyline(std::span<const Pixel> points, const Stroke& stroke);
  void polygon(std::span<const Pixel> points, std::string_view fill, double opacity);
  void rectangle(const Box& box, std::string_view fill, const Stroke& stroke);
  void marker(Marker marker, Pixel centre, double radius, const Stroke& stroke);
  // Many small dots in one element.
  void dots(std::span<const Pixel> centres, double diameter, const Stroke& stroke);
  void text(Pixel where, std::string_view text, const TextStyle& style);
  // What follows is shown only inside the box, until end_clip.
  void begin_clip(const Box& box);
  void end_clip();

  // The whole document.
  [[nodiscard]] std::string finish() const;

private:
  std::string body_;
  double width_;
  double height_;
  int clips_ = 0;
};

// About as wide as the text will be: fonts differ.
[[nodiscard]] double text_width(std::string_view text, double size);

// In lines that are no wider than that, broken at spaces; a longer word has a line of its own.
[[nodiscard]] std::vector<std::string> wrap_text(std::string_view text, double size,
                                                 double max_width);

} // namespace dyncal::inline views::figures
