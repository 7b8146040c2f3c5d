#include "services/views/figures/svg.hpp"

#include <iterator>

#include <fmt/format.h>

#include "services/base/per_enumerator.hpp"
#include "services/views/figures/markup.hpp"

namespace dyncal::inline views::figures {
namespace {

std::string attributes(const Stroke& stroke) {
  std::string result =
      fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\"", escaped(stroke.colour), stroke.width);
  if (!stroke.dashes.empty()) {
    result += fmt::format(" stroke-dasharray=\"{}\"", escaped(stroke.dashes));
  }
  if (stroke.opacity < 1) {
    result += fmt::format(" stroke-opacity=\"{:.2f}\"", stroke.opacity);
  }
  return result;
}

std::string pairs(std::span<const Pixel> points) {
  std::string result;
  for (const auto& point : points) {
    fmt::format_to(std::back_inserter(result), "{:.2f},{:.2f} ", point.x, point.y);
  }
  return result;
}

const char* word(Anchor anchor) {
  return per_enumerator(anchor, {"start", "middle", "end"});
}

} // namespace

Svg::Svg(double width, double height) : width_(width), height_(height) {}

void Svg::line(Pixel from, Pixel to, const Stroke& stroke) {
  body_ += fmt::format("<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" {}/>\n",
                       from.x, from.y, to.x, to.y, attributes(stroke));
}

void Svg::polyline(std::span<const Pixel> points, const Stroke& stroke) {
  if (points.size() < 2) {
    return;
  }
  body_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke-linejoin=\"round\" {}/>\n",
                       pairs(points), attributes(stroke));
}

void Svg::polygon(std::span<const Pixel> points, std::string_view fill, double opacity) {
  body_ += fmt::format("<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{:.2f}\"/>\n",
                       pairs(points), escaped(fill), opacity);
}

void Svg::rectangle(const Box& box, std::string_view fill, const Stroke& stroke) {
  body_ += fmt::format(
      "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\" {}/>\n",
      box.left, box.top, box.width, box.height, escaped(fill), attributes(stroke));
}

void Svg::marker(Marker marker, Pixel c, double r, const Stroke& stroke) {
  const auto style = attributes(stroke);
  switch (marker) {
  case Marker::none:
    break;
  case Marker::circle:
    body_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"none\" {}/>\n",
                         c.x, c.y, r, style);
    break;
  case Marker::dot:
    body_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"{}\" {}/>\n", c.x,
                         c.y, r, escaped(stroke.colour), style);
    break;
  case Marker::square:
    body_ += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"none\" {}/>\n",
        c.x - r, c.y - r, 2 * r, 2 * r, style);
    break;
  case Marker::triangle:
    body_ += fmt::format(
        "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}L{:.2f} {:.2f}Z\" fill=\"none\" {}/>\n", c.x,
        c.y - r, c.x + 0.9 * r, c.y + 0.6 * r, c.x - 0.9 * r, c.y + 0.6 * r, style);
    break;
  case Marker::cross:
    body_ += fmt::format(
        "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}M{:.2f} {:.2f}L{:.2f} {:.2f}\" fill=\"none\" {}/>\n",
        c.x - r, c.y - r, c.x + r, c.y + r, c.x - r, c.y + r, c.x + r, c.y - r, style);
    break;
  }
}

void Svg::dots(std::span<const Pixel> centres, double diameter, const Stroke& stroke) {
  if (centres.empty()) {
    return;
  }
  Stroke round = stroke;
  round.width = diameter;
  body_ += fmt::format("<path fill=\"none\" stroke-linecap=\"round\" {} d=\"", attributes(round));
  for (const auto& centre : centres) {
    fmt::format_to(std::back_inserter(body_), "M{:.2f} {:.2f}h0", centre.x, centre.y);
  }
  body_ += "\"/>\n";
}

void Svg::text(Pixel where, std::string_view text, const TextStyle& style) {
  body_ += fmt::format(
      "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.1f}\" text-anchor=\"{}\" "
      "fill=\"{}\"{}{}>{}</text>\n",
      where.x, where.y, style.size, word(style.anchor), escaped(style.colour),
      style.bold ? " font-weight=\"bold\"" : "",
      style.upwards ? fmt::format(" transform=\"rotate(-90 {:.2f} {:.2f})\"", where.x, where.y)
                    : "",
      escaped(text));
}

void Svg::begin_clip(const Box& box) {
  ++clips_;
  body_ += fmt::format("<clipPath id=\"clip{}\"><rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" "
                       "height=\"{:.2f}\"/></clipPath>\n"
                       "<g clip-path=\"url(#clip{})\">\n",
                       clips_, box.left, box.top, box.width, box.height, clips_);
}

void Svg::end_clip() {
  body_ += "</g>\n";
}

std::string Svg::finish() const {
  return fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                     "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" "
                     "height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
                     "font-family=\"'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif\">\n"
                     "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n{2}</svg>\n",
                     width_, height_, body_);
}

double text_width(std::string_view text, double size) {
  double em = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xc0) == 0x80) {
      continue; // the rest of a UTF-8 character
    }
    const bool narrow = std::string_view(" .,:;'|()[]/ijltfI").find(c) != std::string_view::npos;
    const bool wide = std::string_view("mwMWGOQ%@").find(c) != std::string_view::npos;
    em += narrow ? 0.37 : (wide ? 0.9 : 0.63);
  }
  return em * size;
}

std::vector<std::string> wrap_text(std::string_view text, double size, double max_width) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t space = text.find(' ');
    const std::string_view word = text.substr(0, space);
    text.remove_prefix(space == std::string_view::npos ? text.size() : space + 1);
    if (lines.empty() || text_width(lines.back() + " " + std::string(word), size) > max_width) {
      lines.emplace_back(word);
    } else {
      lines.back().append(" ").append(word);
    }
  }
  return lines;
}

} // namespace dyncal::inline views::figures
