// Random numbers that are the same on every machine and compiler for the same seed.
//
// xoshiro256** (Blackman and Vigna 2018), and the polar method for the normal distribution; the
// distributions of the standard library may differ between implementations. Each component of a
// model has an object of its own, so that what one component draws does not shift the others. One
// thread an object.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace dyncal::drivers::virtual_bench {

class Random {
public:
  // Streams of different names are independent of each other.
  Random(std::uint64_t seed, std::string_view name);

  [[nodiscard]] std::uint64_t bits();
  [[nodiscard]] double uniform(); // [0, 1)
  [[nodiscard]] double uniform(double from, double to) { return from + (to - from) * uniform(); }
  [[nodiscard]] double normal(); // mean 0, standard deviation 1
  [[nodiscard]] double normal(double standard_deviation) { return standard_deviation * normal(); }
  [[nodiscard]] bool happens(double probability) {
    return probability > 0.0 && uniform() < probability;
  }

private:
  std::array<std::uint64_t, 4> state_{};
  double spare_ = 0.0;
  bool has_spare_ = false;
};

} // namespace dyncal::drivers::virtual_bench
