// A result file as small as its schema allows, with the values that a test gives it.
#pragma once

#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace dyncal::tests {

struct BudgetRow {
  std::string kind = "fit_noise";
  std::string repeats = "anew";
  double u_magnitude_rel = 1e-3;
  double u_phase_rad = 1e-3;
  std::string subject = kind == "fit_noise" ? "the sensor" : "";
};

class ResultText {
public:
  using Json = nlohmann::json;

  explicit ResultText(std::string channel) : channel_(std::move(channel)) {
    json_ = {{"schema", {{"name", "dyncal-result"}, {"version", 2}}},
             {"bench", "b"},
             {"run", "r"},
             {"method", "sample-timestamping"},
             {"phase_convention", "lead"},
             {"software", "dyncal"},
             {"analysis", {{"software", nullptr}, {"host", nullptr}}},
             {"dds", {{"analysis", "none"}}},
             {"began_utc", nullptr},
             {"ended_utc", nullptr},
             {"planned_steps", 1},
             {"interrupted", false},
             {"problem", ""},
             {"recipe_sha256", "abc"}};
    for (const char* list : {"flag_legend", "sources", "steps", "channels", "transfer_function",
                             "group_delay", "sample_clock", "points"}) {
      json_[list] = Json::array();
    }
    add_channel(channel_);
    add_clock();
  }

  // One repetition; u is that of the rows.
  void add(const std::string& frequency_hz, std::complex<double> h,
           const std::vector<BudgetRow>& budget, const std::vector<std::string>& flags = {}) {
    double magnitude2 = 0.0, phase2 = 0.0, anew2 = 0.0;
    Json rows = Json::array();
    for (const BudgetRow& row : budget) {
      magnitude2 += row.u_magnitude_rel * row.u_magnitude_rel;
      phase2 += row.u_phase_rad * row.u_phase_rad;
      anew2 += row.repeats == "anew" ? row.u_phase_rad * row.u_phase_rad : 0.0;
      rows.push_back({{"name", row.kind + (row.subject.empty() ? "" : " " + row.subject)},
                      {"kind", row.kind},
                      {"subject", row.subject},
                      {"distribution", "normal"},
                      {"repeats", row.repeats},
                      {"degrees_of_freedom", nullptr},
                      {"u_magnitude_rel", row.u_magnitude_rel},
                      {"u_lasting_magnitude_rel", 0.0},
                      {"u_phase_rad", row.u_phase_rad}});
    }
    add_value(channel_, frequency_hz, h, std::abs(h) * std::sqrt(magnitude2), std::sqrt(phase2));
    json_["transfer_function"].back()["u_independent_phase_rad"] = std::sqrt(anew2);
    json_["transfer_function"].back()["flags"] = flags;
    json_["transfer_function"].back()["flag_names"] = flags;
    Json point =
        stated(channel_, frequency_hz, h, std::abs(h) * std::sqrt(magnitude2), std::sqrt(phase2));
    point.update({{"step", 1},
                  {"repetition", 1},
                  {"valid", true},
                  {"samples", Json::object()},
                  {"source_samples", Json::array()},
                  {"lost", 0},
                  {"signals", Json::array()},
                  {"data_sha256", ""},
                  {"budget", std::move(rows)}});
    json_["points"].push_back(std::move(point));
  }

  // A mean alone, with k = 2.
  void add_value(const std::string& channel, const std::string& frequency_hz,
                 std::complex<double> h, double u_magnitude, double u_phase_rad,
                 const std::string& unit = R"(\one)") {
    Json value = stated(channel, frequency_hz, h, u_magnitude, u_phase_rad);
    value.update({{"unwrapped_phase_rad", std::arg(h)},
                  {"unwrapped_phase_deg", std::arg(h)},
                  {"scatter_magnitude", 0.0},
                  {"scatter_phase_rad", 0.0},
                  {"unit", unit},
                  {"repetitions", 1},
                  {"u_independent_phase_rad", u_phase_rad}});
    json_["transfer_function"].push_back(std::move(value));
  }

  [[nodiscard]] Json& json() { return json_; }
  [[nodiscard]] std::filesystem::path write(const std::filesystem::path& path) const {
    std::ofstream(path) << json_;
    return path;
  }

private:
  void add_channel(const std::string& channel) {
    json_["channels"].push_back({{"channel", channel},
                                 {"unit", R"(\one)"},
                                 {"responds", true},
                                 {"lost", 0},
                                 {"flags", Json::array()},
                                 {"flag_names", Json::array()}});
  }

  void add_clock() {
    Json clock{{"source", "dau"},
               {"mean_rate_hz", 1003.0},
               {"quantiles_s", Json::object()},
               {"count", 0},
               {"event_count", 0},
               {"events", Json::array()},
               {"temperature_degc", nullptr},
               {"lost", 0},
               {"flags", Json::array()},
               {"flag_names", Json::array()}};
    for (const char* number :
         {"mean_interval_s", "u_mean_interval_s", "sd_s", "min_s", "max_s", "median_s", "mad_sd_s",
          "nominal_rate_hz", "tick_s", "lattice_statistic", "pair_period_samples", "pair_period_s",
          "temperature_correlation", "temperature_slope_s_per_degc"}) {
      clock[number] = nullptr;
    }
    for (const char* quantile : {"0.001", "0.01", "0.5", "0.99", "0.999"}) {
      clock["quantiles_s"][quantile] = nullptr;
    }
    json_["sample_clock"].push_back(std::move(clock));
  }

  [[nodiscard]] static Json stated(const std::string& channel, const std::string& frequency_hz,
                                   std::complex<double> h, double u_magnitude, double u_phase_rad) {
    return {{"channel", channel},
            {"unit", R"(\one)"},
            {"frequency_text_hz", frequency_hz},
            {"frequency_hz", std::stod(frequency_hz)},
            {"level_m_s2", 10.0},
            {"magnitude", std::abs(h)},
            {"u_magnitude", u_magnitude},
            {"k_magnitude", 2.0},
            {"nu_eff_magnitude", nullptr},
            {"U_magnitude", 2.0 * u_magnitude},
            {"phase_rad", std::arg(h)},
            {"phase_deg", std::arg(h) * 180.0 / M_PI},
            {"u_phase_rad", u_phase_rad},
            {"u_phase_deg", u_phase_rad * 180.0 / M_PI},
            {"k_phase", 2.0},
            {"nu_eff_phase", nullptr},
            {"U_phase_rad", 2.0 * u_phase_rad},
            {"U_phase_deg", 2.0 * u_phase_rad * 180.0 / M_PI},
            {"coverage_probability", 0.9545},
            {"flags", Json::array()},
            {"flag_names", Json::array()}};
  }

  std::string channel_;
  Json json_;
};

} // namespace dyncal::tests
