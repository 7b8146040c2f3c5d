// Two participants that talk to each other and to no test running beside: of given vendors, or of
// the memory bus, which has to behave as they do.
#pragma once

#include <chrono>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/bus/bus.hpp"
#include "services/bus/memory/memory_network.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::bus {

using Carrier = std::optional<Vendor>; // nothing: the memory bus

struct CarrierPair {
  Carrier writer;
  Carrier reader;
};

inline std::vector<CarrierPair> carrier_pairs() {
  std::vector<CarrierPair> pairs;
  for (const Vendor writer : vendors_in_this_build()) {
    for (const Vendor reader : vendors_in_this_build()) {
      pairs.push_back({writer, reader});
    }
  }
  pairs.push_back({std::nullopt, std::nullopt});
  return pairs;
}

inline std::string pair_name(const testing::TestParamInfo<CarrierPair>& pair) {
  const auto name = [](Carrier carrier) { return carrier ? to_string(*carrier) : "memory"; };
  return name(pair.param.writer) + "_to_" + name(pair.param.reader);
}

class BusPair : public testing::TestWithParam<CarrierPair> {
protected:
  const std::string bench_ = "bus-test";
  MemoryNetwork network_;
  Participant writing_ = join(GetParam().writer);
  std::vector<std::string> warnings_; // of the reading one
  Participant reading_ =
      join(GetParam().reader, [this](const std::string& warning) { warnings_.push_back(warning); });
  std::shared_ptr<WakeUp> bell_ = std::make_shared<WakeUp>();

  Participant join(Carrier carrier, std::function<void(const std::string&)> warn = {}) {
    if (!carrier) {
      return network_.join("bus test", std::move(warn));
    }
    ParticipantOptions options;
    options.vendor = *carrier;
    options.domain = tests::own_dds_domain();
    options.name = "bus test";
    options.warn = std::move(warn);
    return Participant::create(options).value();
  }

  template <class T>
  Writer<T> writer(const char* topic, Profile profile) {
    return writing_.writer<T>(topic, profile, bench_).value();
  }
  template <class T>
  Reader<T> reader(const char* topic, Profile profile) {
    return reading_.reader<T>(topic, profile, bench_, bell_).value();
  }

  // True when the condition came true in time; it is tried whenever something has come.
  template <class Condition>
  [[nodiscard]] bool wait_for(Condition&& condition,
                              std::chrono::milliseconds limit = tests::patience) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
      const auto now = std::chrono::steady_clock::now();
      if (now >= deadline) {
        return false;
      }
      bell_->wait_until(std::min(deadline, now + std::chrono::milliseconds(20)));
    }
    return true;
  }

  template <class T, class U>
  [[nodiscard]] bool wait_for_match(const Writer<T>& writer, const Reader<U>& reader) {
    return wait_for([&] { return writer.matched_readers() == 1 && reader.matched_writers() == 1; });
  }
};

} // namespace dyncal::bus
