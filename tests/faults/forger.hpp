// A program that writes on a bench as somebody who is not meant to: with a DDS library, by its own
// participant, from what it reads there. It repeats what programs of the bench have said and
// invents more. For tests of what the others make of that. A thread of its own, while it forges.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "services/bus/bus.hpp"

namespace dyncal::tests {

class Forger {
public:
  Forger(const std::string& dds, int domain, const std::string& bench)
      : bench_(bench), participant_(join(dds, domain)) {}

  // Holds what the conductor of the newest run says, from now on; wait until it has spoken.
  [[nodiscard]] bool hears_excitation(std::chrono::seconds limit) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (heard_.empty() && std::chrono::steady_clock::now() < deadline) {
      listen();
      std::this_thread::yield();
    }
    return !heard_.empty();
  }

  // Every 100 ms all that was heard, the newest with the number of the next link, as contract 2 has
  // it and as the end of the step; and a run of its own.
  void hold_on() {
    forging_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        listen();
        forge_excitations();
        forge_runs();
        std::this_thread::sleep_for(std::chrono::milliseconds(100)); // its rate
      }
    });
  }
  void stop() { forging_ = {}; }

  // From now on, at each block of the source a copy that is a block ahead and 1.1 times as large.
  void send_as(const std::string& source) {
    source_ = source;
    forging_ = std::jthread([this](const std::stop_token& stop) {
      auto blocks = participant_
                        .reader<wire::SampleBlock>(bus::topics::dau_samples,
                                                   bus::Profile::live_samples, bench_, wake_up_)
                        .value();
      auto forged = participant_
                        .writer<wire::SampleBlock>(bus::topics::dau_samples,
                                                   bus::Profile::live_samples, bench_)
                        .value();
      while (!stop.stop_requested()) {
        wake_up_->wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(20));
        send_ahead(blocks, forged);
      }
    });
  }
  [[nodiscard]] std::size_t blocks() const { return blocks_; }

private:
  void send_ahead(bus::Reader<wire::SampleBlock>& blocks, bus::Writer<wire::SampleBlock>& forged) {
    blocks.take_with_writer([&](wire::SampleBlock block, const bus::WriterId& writer) {
      sender_ = sender_.empty() ? writer.participant() : sender_;
      if (writer.participant() != sender_ || block.source().to_string() != source_) {
        return;
      }
      block.block(block.block() + 1);
      block.first_sample(block.first_sample() + block.sample_count());
      if (!block.stamps_ns().empty()) {
        const std::int64_t ahead_ns = block.stamps_ns().back() - block.stamps_ns().front();
        for (std::int64_t& stamp : block.stamps_ns()) {
          stamp += ahead_ns;
        }
      }
      for (double& value : block.values()) {
        value *= 1.1;
      }
      forged.write(block, std::chrono::milliseconds(100));
      ++blocks_;
    });
  }
  static bus::Participant join(const std::string& dds, int domain) {
    bus::ParticipantOptions options;
    options.vendor = bus::parse_vendor(dds).value();
    options.domain = domain;
    options.name = "forger";
    return bus::Participant::create(options).value();
  }
  void listen() {
    excitations_.take_with_writer(
        [&](const wire::Excitation& message, const bus::WriterId& writer) {
          conductor_ = conductor_.empty() ? writer.participant() : conductor_;
          if (writer.participant() == conductor_) {
            heard_.push_back(message);
          }
        });
    plans_.take([&](const wire::Measurement& message) {
      if (message.conductor() != forger_name) {
        plan_ = message;
      }
    });
  }
  void forge_excitations() {
    for (const wire::Excitation& heard : heard_) {
      excitation_.write(heard);
    }
    wire::Excitation next = heard_.back();
    next.link_number(next.link_number() + 1);
    excitation_.write(next);
    next.link("");
    next.link_number(0);
    excitation_.write(next);
    next = heard_.back();
    next.state(wire::EXCITATION_DONE);
    next.window_end_utc_ns(1);
    excitation_.write(next);
  }
  void forge_runs() {
    wire::Measurement run = plan_;
    run.conductor(forger_name);
    run.run("forged");
    run.state(wire::MEASUREMENT_RUNNING);
    run.link_number(run.link_number() + 1);
    measurement_.write(run);
    wire::Excitation of_run = heard_.back();
    of_run.run("forged");
    excitation_.write(of_run);
  }

  static constexpr const char* forger_name = "forger:1";

  std::string bench_;
  bus::Participant participant_;
  bus::Reader<wire::Excitation> excitations_ =
      participant_.reader(bus::topics::excitation, bench_, nullptr).value();
  bus::Reader<wire::Measurement> plans_ =
      participant_.reader(bus::topics::measurement, bench_, nullptr).value();
  bus::Writer<wire::Excitation> excitation_ =
      participant_.writer(bus::topics::excitation, bench_).value();
  bus::Writer<wire::Measurement> measurement_ =
      participant_.writer(bus::topics::measurement, bench_).value();
  std::shared_ptr<bus::WakeUp> wake_up_ = std::make_shared<bus::WakeUp>();
  std::string conductor_; // its participant
  std::string source_;    // that it sends as
  std::string sender_;    // its participant
  std::atomic<std::size_t> blocks_{0};
  std::vector<wire::Excitation> heard_;
  wire::Measurement plan_;
  std::jthread forging_; // the last member: it uses the others
};

} // namespace dyncal::tests
