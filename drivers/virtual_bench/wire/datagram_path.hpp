// The network between the unit and its receiver: loses, doubles and swaps datagrams with given
// probabilities. One thread.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {

struct PathSettings { // probabilities per datagram
  double loss = 0.0;
  double duplicate = 0.0;
  double reorder = 0.0; // comes after the one behind it
};

class DatagramPath {
public:
  using Deliver = std::function<void(const std::string&)>;

  DatagramPath(std::uint64_t seed, const PathSettings& settings, Deliver deliver)
      : random_(seed, "datagram path"), settings_(settings), deliver_(std::move(deliver)) {}

  void send(const std::string& datagram);

private:
  Random random_;
  PathSettings settings_;
  Deliver deliver_;
  std::optional<std::string> held_;
};

} // namespace dyncal::drivers::virtual_bench
