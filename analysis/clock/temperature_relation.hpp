// How the sample interval follows the temperature that the sensor reports (paper section 4.2).
//
// Gives the correlation coefficient, the slope of the regression line, mean and standard deviation
// in bins of temperature, and a bounded sample of pairs for a scatter plot. Bins start at 0.01 degC
// and double their width whenever there would be too many; of the pairs every 1st, 2nd, 4th ... is
// kept. Units: degC, ns. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace dyncal::analysis {

struct TemperatureBin {
  double temperature_degc = 0.0; // centre
  double mean_interval_ns = 0.0;
  double sd_interval_ns = 0.0;
  std::uint64_t count = 0;
};

class TemperatureRelation {
public:
  TemperatureRelation(std::size_t max_bins, std::size_t max_pairs);

  void add(double temperature_degc, std::int64_t interval_ns);

  [[nodiscard]] double correlation() const;       // 0 where it is not defined
  [[nodiscard]] double slope_ns_per_degc() const; // 0 where it is not defined
  [[nodiscard]] std::vector<TemperatureBin> bins() const;
  [[nodiscard]] const std::vector<double>& pair_temperatures_degc() const {
    return pair_temperatures_degc_;
  }
  [[nodiscard]] const std::vector<double>& pair_intervals_ns() const { return pair_intervals_ns_; }

private:
  struct Moments { // Welford's recurrence
    std::uint64_t count = 0;
    double mean = 0.0;
    double squares = 0.0;
    void add(double value);
    void merge(const Moments& other);
  };
  void widen_bins();
  void keep_pair(double temperature_degc, double interval_ns);

  std::size_t max_bins_;
  std::size_t max_pairs_;
  double bin_degc_ = 0.01;
  std::map<std::int64_t, Moments> bins_; // by temperature / width, rounded down
  Moments temperature_;
  Moments interval_;
  double products_ = 0.0;
  std::uint64_t every_ = 1;
  std::vector<double> pair_temperatures_degc_;
  std::vector<double> pair_intervals_ns_;
};

} // namespace dyncal::analysis
