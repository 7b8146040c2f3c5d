// A result file of the kind that `dyncal model` reads, with the keys that it needs.
#pragma once

#include <complex>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace dyncal::tests {

struct BudgetRow {
  std::string name = "noise of the sensor";
  std::string repeats = "anew";
  double u_magnitude_rel = 1e-3;
  double u_phase_rad = 1e-3;
};

class ResultText {
public:
  explicit ResultText(std::string channel) : channel_(std::move(channel)) {
    json_ = {{"schema", {{"name", "dyncal-result"}, {"version", 1}}},
             {"channels", {{{"channel", channel_}, {"responds", true}}}},
             {"transfer_function", nlohmann::json::array()},
             {"points", nlohmann::json::array()},
             {"sample_clock", {{{"source", "dau"}, {"mean_rate_hz", 1003.0}}}}};
  }

  // One repetition; u is that of the rows.
  void add(const std::string& frequency_hz, std::complex<double> h,
           const std::vector<BudgetRow>& budget, std::vector<std::string> flags = {}) {
    double magnitude2 = 0.0, phase2 = 0.0, anew2 = 0.0;
    nlohmann::json rows = nlohmann::json::array();
    for (const BudgetRow& row : budget) {
      magnitude2 += row.u_magnitude_rel * row.u_magnitude_rel;
      phase2 += row.u_phase_rad * row.u_phase_rad;
      anew2 += row.repeats == "anew" ? row.u_phase_rad * row.u_phase_rad : 0.0;
      rows.push_back({{"name", row.name},
                      {"distribution", "normal"},
                      {"repeats", row.repeats},
                      {"degrees_of_freedom", nullptr},
                      {"u_magnitude_rel", row.u_magnitude_rel},
                      {"u_lasting_magnitude_rel", 0.0},
                      {"u_phase_rad", row.u_phase_rad}});
    }
    const double frequency = std::stod(frequency_hz);
    json_["transfer_function"].push_back(
        {{"channel", channel_},
         {"frequency_text_hz", frequency_hz},
         {"frequency_hz", frequency},
         {"level_m_s2", 10.0},
         {"magnitude", std::abs(h)},
         {"U_magnitude", 2.0 * std::abs(h) * std::sqrt(magnitude2)},
         {"phase_rad", std::arg(h)},
         {"U_phase_rad", 2.0 * std::sqrt(phase2)},
         {"u_independent_phase_rad", std::sqrt(anew2)},
         {"unit", R"(\one)"},
         {"flag_names", std::move(flags)}});
    json_["points"].push_back({{"channel", channel_},
                               {"frequency_hz", frequency},
                               {"level_m_s2", 10.0},
                               {"valid", true},
                               {"magnitude", std::abs(h)},
                               {"phase_rad", std::arg(h)},
                               {"budget", std::move(rows)}});
  }

  [[nodiscard]] nlohmann::json& json() { return json_; }
  [[nodiscard]] std::filesystem::path write(const std::filesystem::path& path) const {
    std::ofstream(path) << json_;
    return path;
  }

private:
  std::string channel_;
  nlohmann::json json_;
};

} // namespace dyncal::tests
