#include "services/programs/command/triaxial_lines.hpp"

#include <cmath>
#include <numbers>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/views/report/result_file.hpp"

namespace dyncal::inline programs {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degrees = 180.0 / std::numbers::pi;

// The two axes across one, from which and towards which angles count.
char first_across(std::size_t axis) {
  return axis_names[axis == 0 ? 1 : 0];
}
char second_across(std::size_t axis) {
  return axis_names[axis == 2 ? 1 : 2];
}

Json json_of_largest(const ResponsePoint& point) {
  Json all = Json::array();
  for (std::size_t i = 0; i < 3; ++i) {
    if (const auto& largest = point.largest[i]) {
      all.push_back({{"axis", std::string(1, axis_names[i])},
                     {"ratio", largest->ratio},
                     {"u_ratio", largest->u_ratio},
                     {"angle_rad", largest->angle_rad},
                     {"from", std::string(1, first_across(i))},
                     {"towards", std::string(1, second_across(i))}});
    }
  }
  return all;
}

void print_largest(const std::vector<ResponsePoint>& points) {
  bool has_head = false;
  for (const ResponsePoint& point : points) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& largest = point.largest[i];
      if (!largest) {
        continue;
      }
      if (!has_head) {
        fmt::print("\nlargest transverse sensitivity over all directions\n{:>12} {:>6} {:>12} "
                   "{:>12}   direction\n",
                   "f / Hz", "axis", "transverse", "u");
        has_head = true;
      }
      fmt::print("{:>12g} {:>6} {:>11.3f}% {:>11.3f}%   {:.0f} degrees from {} towards {}\n",
                 point.frequency_hz, axis_names[i], 100.0 * largest->ratio,
                 100.0 * largest->u_ratio, degrees * largest->angle_rad, first_across(i),
                 second_across(i));
    }
  }
}

} // namespace

void print_json(const TriaxialText& text) {
  Json json{{"channels", text.channels},
            {"triaxial_reference", text.triaxial_reference},
            {"points", Json::array()}};
  for (const ResponsePoint& point : text.points) {
    Json one{{"frequency_hz", point.frequency_hz},
             {"level_m_s2", point.level_m_s2},
             {"excitations", Json::array()}};
    for (std::size_t j = 0; j < 3; ++j) {
      if (!point.columns[j]) {
        continue;
      }
      Json axes = Json::array();
      for (std::size_t i = 0; i < 3; ++i) {
        const std::complex<double> h = (*point.columns[j])[i];
        axes.push_back({{"axis", std::string(1, axis_names[i])},
                        {"real", h.real()},
                        {"imaginary", h.imag()},
                        {"u_component", point.u[j][i]},
                        {"magnitude", std::abs(h)},
                        {"phase_rad", std::arg(h)},
                        {"ratio", point.transverse[j]->ratio[i]},
                        {"u_ratio", point.transverse[j]->u_ratio[i]}});
      }
      one["excitations"].push_back({{"along", std::string(1, axis_names[j])},
                                    {"response", std::move(axes)},
                                    {"largest_transverse_ratio", point.transverse[j]->largest}});
    }
    one["largest_transverse"] = json_of_largest(point);
    json["points"].push_back(std::move(one));
  }
  fmt::print("{}\n", json_text(json, 2));
}

void print_table(const TriaxialText& text, double transverse_motion_rel) {
  const bool with_level = have_several_levels(text.points);
  const auto level_column = [&](const std::string& of) {
    return with_level ? fmt::format(" {:>16}", of) : std::string();
  };
  fmt::print("{:>12}{} {:>6} {:>12} {:>12} {:>12} {:>12} {:>12}   {}\n", "f / Hz",
             level_column("level / (m/s^2)"), "along", "|H_x|", "|H_y|", "|H_z|", "transverse", "u",
             "largest of the ratios to the excited axis");
  for (const ResponsePoint& point : text.points) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (!point.columns[j]) {
        continue;
      }
      const analysis::Axes& h = *point.columns[j];
      const analysis::TransverseSensitivity& transverse = *point.transverse[j];
      const std::size_t largest =
          transverse.ratio[(j + 1) % 3] > transverse.ratio[(j + 2) % 3] ? (j + 1) % 3 : (j + 2) % 3;
      fmt::print("{:>12g}{} {:>6} {:>12.6f} {:>12.6f} {:>12.6f} {:>11.3f}% {:>11.3f}%   {}\n",
                 point.frequency_hz, level_column(fmt::format("{}", point.level_m_s2)),
                 axis_names[j], std::abs(h[0]), std::abs(h[1]), std::abs(h[2]),
                 100.0 * transverse.largest, 100.0 * transverse.u_ratio[largest],
                 axis_names[largest]);
    }
  }
  print_largest(text.points);
  if (text.triaxial_reference) {
    fmt::print("\ntransverse motion of the exciter is corrected by the triaxial reference\n");
  } else if (transverse_motion_rel > 0.0) {
    fmt::print(
        "\ntransverse motion of the exciter is unknown up to {} of the motion along its axis; u "
        "includes that\n",
        transverse_motion_rel);
  } else {
    fmt::print("\ntransverse motion of the exciter is assumed to be zero; --transverse-motion "
               "states its bound\n");
  }
}

} // namespace dyncal::inline programs
