#include "drivers/virtual_bench/model/sensor_clock.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double first_edge_s = 0.01;

class Mpu9250Clock : public SensorClock {
public:
  Mpu9250Clock(std::uint64_t seed, double thermal_cycle_s)
      : random_(seed, "sensor clock"), cycle_s_(thermal_cycle_s),
        late_probability_(late_edges_per_cycle * mean_interval_s / thermal_cycle_s) {}

  SensorEdge next() override {
    const double temperature = temperature_at(time_s_);
    if (!started_ || random_.happens(redraw_probability)) {
      level_ns_ = draw_level(temperature);
      started_ = true;
    }
    double phase_noise_ns = random_.normal(3.0);
    if (random_.happens(late_probability_)) {
      phase_noise_ns += random_.uniform(30.0, 163.0);
    }
    const SensorEdge edge{time_s_ + 1e-9 * phase_noise_ns, temperature};
    time_s_ +=
        1e-9 * (996955.15 + 0.835 * level_ns_ + 1.5 * (temperature - 28.2) + random_.normal(5.0));
    return edge;
  }

private:
  static constexpr double mean_interval_s = 996.96e-6;
  static constexpr double late_edges_per_cycle = 32.0;
  static constexpr double redraw_probability = 0.02;
  static constexpr std::array<double, 4> levels_ns{-39.0, -13.0, 13.0, 39.0};
  static constexpr std::array<double, 4> level_temperatures_degc{26.8, 27.9, 28.5, 28.95};

  [[nodiscard]] double temperature_at(double time_s) const {
    const double turns = time_s / cycle_s_;
    const double phase = turns - 2.0 * std::floor(turns / 2.0); // 0..2: warm up, then back
    const double x = phase < 1.0 ? phase : 2.0 - phase;
    return 27.0 + 1.8 * (1.0 - std::exp(-3.0 * x)) + 0.15 * std::sin(14.0 * std::numbers::pi * x);
  }

  double draw_level(double temperature) {
    std::array<double, 4> weights{};
    double sum = 0.0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const double distance = (temperature - level_temperatures_degc[k]) / 0.35;
      weights[k] = std::exp(-0.5 * distance * distance) + 0.03;
      sum += weights[k];
    }
    double drawn = random_.uniform() * sum;
    for (std::size_t k = 0; k + 1 < weights.size(); ++k) {
      if (drawn < weights[k]) {
        return levels_ns[k];
      }
      drawn -= weights[k];
    }
    return levels_ns.back();
  }

  Random random_;
  double cycle_s_;
  double late_probability_;
  double time_s_ = first_edge_s;
  double level_ns_ = 0.0;
  bool started_ = false;
};

class Bma280Clock : public SensorClock {
public:
  explicit Bma280Clock(std::uint64_t seed)
      : random_(seed, "sensor clock"), until_pair_(draw_distance()) {}

  SensorEdge next() override {
    const SensorEdge edge{time_s_, 25.0};
    double interval_ns = 485000.0 + random_.normal(12.0);
    if (--until_pair_ == 0) {
      interval_ns += lobe_ns;
      early_next_ = true;
      until_pair_ = draw_distance();
    } else if (early_next_) {
      interval_ns -= lobe_ns;
      early_next_ = false;
    }
    time_s_ += 1e-9 * interval_ns;
    return edge;
  }

private:
  static constexpr double lobe_ns = 4200.0;

  int draw_distance() { return 2198 + static_cast<int>(random_.uniform(0.0, 5.0)); }

  Random random_;
  double time_s_ = first_edge_s;
  int until_pair_;
  bool early_next_ = false;
};

} // namespace

std::unique_ptr<SensorClock> make_sensor_clock(SensorKind kind, std::uint64_t seed,
                                               double thermal_cycle_s) {
  if (kind == SensorKind::bma280) {
    return std::make_unique<Bma280Clock>(seed);
  }
  return std::make_unique<Mpu9250Clock>(seed, thermal_cycle_s);
}

} // namespace dyncal::drivers::virtual_bench
