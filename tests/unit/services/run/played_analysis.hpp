// The analysis service as the conductor of a run meets it: on the memory bus, each message when the
// test wants it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::tests {

class PlayedAnalysis {
public:
  // Before contract 2 all was written in the partition of the bench alone.
  PlayedAnalysis(bus::MemoryNetwork& network, std::string bench, std::string run,
                 std::string service = "analysis@test:1",
                 std::uint32_t contract_version = wire::CONTRACT_VERSION)
      : bench_(std::move(bench)), run_(std::move(run)), service_(std::move(service)),
        contract_version_(contract_version), participant_(network.join(service_)) {}

  // Its own, for commands.
  [[nodiscard]] bus::Writer<wire::Command> command_writer() {
    return participant_.writer(bus::topics::command, bench_).value();
  }
  void report(wire::ArmState arm, const std::string& failure = "") {
    report(arm, failure.empty() ? wire::HEALTH_OK : wire::HEALTH_FAILED, failure);
  }
  void report(wire::ArmState arm, wire::HealthState health, const std::string& message) {
    wire::ServiceStatus status;
    status.service(service_);
    status.run(run_);
    status.bench(bench_);
    status.arm(arm);
    status.health(health);
    status.message(message);
    status.dds("memory");
    status.software("dyncal of the test");
    status.contract_version(contract_version_);
    status.results_published(results_);
    status.transfer_functions_published(transfer_functions_);
    status_.write(status);
  }
  void publish_result(std::uint32_t step, const std::string& channel = "dau/acceleration_x") {
    wire::CalibrationResult result;
    result.bench(bench_);
    result.run(run_);
    result.channel(channel);
    result.step(step);
    result.repetition(1);
    result_.write(result);
    ++results_;
  }
  // One of a step's last attempt; a later attempt has the same key.
  void publish(wire::CalibrationResult result) {
    result.bench(bench_);
    result.run(run_);
    result.repetition(1);
    result_.write(result);
    results_ += result.attempt() <= 1 ? 1 : 0;
  }
  // The same key comes once more, settled, and is not counted again.
  void publish_provisional_result(std::uint32_t step, bool settled) {
    wire::CalibrationResult result;
    result.bench(bench_);
    result.run(run_);
    result.channel("dau/acceleration_x");
    result.step(step);
    result.repetition(1);
    result.provisional(!settled);
    result_.write(result);
    results_ += settled ? 0 : 1;
  }
  void publish_transfer_function(const std::string& channel) {
    wire::TransferFunction function;
    function.bench(bench_);
    function.run(run_);
    function.channel(channel);
    transfer_function_.write(function);
    ++transfer_functions_;
  }
  // Announced, but written later or never.
  void count_transfer_function() { ++transfer_functions_; }

  // Every Measurement and Excitation that came since the last call.
  [[nodiscard]] std::vector<wire::Measurement> measurements() { return take(measurement_); }
  [[nodiscard]] std::vector<wire::Excitation> excitations() { return take(excitation_); }

private:
  template <class T>
  std::vector<T> take(bus::Reader<T>& reader) {
    std::vector<T> all;
    reader.take([&](const T& message) {
      if (message.run().to_string() == run_) {
        all.push_back(message);
      }
    });
    return all;
  }
  template <class T>
  bus::Writer<T> writer(const bus::Topic<T>& topic) {
    return contract_version_ < 2 ? participant_.writer(topic, bench_).value()
                                 : participant_.writer_of_run(topic, bench_, run_).value();
  }
  template <class T>
  bus::Reader<T> reader(const char* topic) {
    return participant_.reader<T>(topic, bus::Profile::state, bench_, nullptr).value();
  }

  std::string bench_;
  std::string run_;
  std::string service_;
  std::uint32_t contract_version_;
  bus::Participant participant_;
  bus::Writer<wire::ServiceStatus> status_ = writer(bus::topics::service_status);
  bus::Writer<wire::CalibrationResult> result_ = writer(bus::topics::calibration_result);
  bus::Writer<wire::TransferFunction> transfer_function_ = writer(bus::topics::transfer_function);
  bus::Reader<wire::Measurement> measurement_ = reader<wire::Measurement>(bus::topics::measurement);
  bus::Reader<wire::Excitation> excitation_ = reader<wire::Excitation>(bus::topics::excitation);
  std::uint64_t results_ = 0;
  std::uint64_t transfer_functions_ = 0;
};

} // namespace dyncal::tests
