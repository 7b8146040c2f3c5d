// Two participants of given vendors that talk to each other and to no test running beside.
#pragma once

#include <chrono>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

#include "services/bus/bus.hpp"

namespace dyncal::bus {

using Clock = std::chrono::steady_clock;

struct VendorPair {
  Vendor writer;
  Vendor reader;
};

inline std::vector<VendorPair> vendor_pairs() {
  std::vector<VendorPair> pairs;
  for (const Vendor writer : vendors_in_this_build()) {
    for (const Vendor reader : vendors_in_this_build()) {
      pairs.push_back({writer, reader});
    }
  }
  return pairs;
}

inline std::string pair_name(const testing::TestParamInfo<VendorPair>& pair) {
  return vendor_word(pair.param.writer) + "_to_" + vendor_word(pair.param.reader);
}

class BusPair : public testing::TestWithParam<VendorPair> {
protected:
  static constexpr std::chrono::seconds patience{30};

  // A bench of this process alone: tests may run side by side in one domain.
  const std::string bench_ = "bus-test-" + std::to_string(getpid());
  Participant writing_ = join(GetParam().writer);
  std::vector<std::string> warnings_; // of the reading one
  Participant reading_ =
      join(GetParam().reader, [this](const std::string& warning) { warnings_.push_back(warning); });
  std::shared_ptr<WakeUp> bell_ = std::make_shared<WakeUp>();

  static Participant join(Vendor vendor, std::function<void(const std::string&)> warn = {}) {
    ParticipantOptions options;
    options.vendor = vendor;
    options.domain = 40 + static_cast<int>(getpid() % 10);
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
  [[nodiscard]] bool wait_for(Condition&& condition, std::chrono::milliseconds limit = patience) {
    const auto deadline = Clock::now() + limit;
    while (!condition()) {
      if (Clock::now() >= deadline) {
        return false;
      }
      bell_->wait_until(std::min(deadline, Clock::now() + std::chrono::milliseconds(20)));
    }
    return true;
  }

  template <class T, class U>
  [[nodiscard]] bool wait_for_match(const Writer<T>& writer, const Reader<U>& reader) {
    return wait_for([&] { return writer.matched_readers() == 1 && reader.matched_writers() == 1; });
  }
};

} // namespace dyncal::bus
