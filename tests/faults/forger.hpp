// A program that writes on a bench as somebody who is not meant to: with a DDS library, by its own
// participant, from what it reads there. It repeats what programs of the bench have said and
// invents more. For tests of what the others make of that. A thread of its own, while it forges.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
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
  void stop() {
    forging_ = {};
    repeating_.clear();
  }

  // From now on, at each block of the source a copy that is a block ahead and larger by `factor`.
  void send_as(const std::string& source, double factor = 1.1) {
    // From files, all sources are of dyncal-acs.
    for (const auto& topic : {bus::topics::dau_samples, bus::topics::acs_samples}) {
      repeat(bus::Topic<wire::SampleBlock>{topic.name, bus::Profile::live_samples},
             [source, factor](wire::SampleBlock& block) {
               put_ahead(block, factor);
               return block.source().to_string() == source;
             });
    }
  }
  // Results of the analysis once more, larger by `factor`.
  void publish_results(double factor) {
    repeat(bus::topics::calibration_result, [factor](wire::CalibrationResult& result) {
      result.magnitude(result.magnitude() * factor);
      return true;
    });
    repeat(bus::topics::transfer_function, [factor](wire::TransferFunction& function) {
      for (wire::TransferPoint& point : function.points()) {
        point.magnitude(point.magnitude() * factor);
      }
      return true;
    });
  }
  // The analysis has failed, it says; of the analysis' own name, or another.
  void fail_runs(bool by_its_name) {
    repeat(bus::topics::service_status, [by_its_name](wire::ServiceStatus& status) {
      status.health(wire::HEALTH_FAILED);
      status.message("forged");
      status.service(by_its_name ? status.service().to_string() : "analysis@forged:1");
      return !status.run().to_string().empty(); // of an analysis
    });
  }
  void abort_runs() {
    repeat(bus::topics::measurement, [](wire::Measurement& run) {
      run.state(wire::MEASUREMENT_ABORTED);
      return true;
    });
  }
  void command_to_abort() {
    auto commands = std::make_shared<bus::Writer<wire::Command>>(
        participant_.writer(bus::topics::command, bench_).value());
    repeat(bus::topics::measurement, [this, commands](wire::Measurement& run) {
      wire::Command command;
      command.bench(bench_);
      command.target("conductor");
      command.kind(wire::COMMAND_ABORT);
      command.run(run.run().to_string());
      command.sender("mallory");
      commands->write(command);
      ++forged_;
      return false;
    });
  }
  // Messages written.
  [[nodiscard]] std::size_t forged() const { return forged_; }
  // Messages of others that came.
  [[nodiscard]] std::size_t heard() const { return heard_of_others_; }

private:
  static void put_ahead(wire::SampleBlock& block, double factor) {
    block.block(block.block() + 1);
    block.first_sample(block.first_sample() + block.sample_count());
    if (!block.stamps_ns().empty()) {
      const std::int64_t ahead_ns = block.stamps_ns().back() - block.stamps_ns().front();
      for (std::int64_t& stamp : block.stamps_ns()) {
        stamp += ahead_ns;
      }
    }
    for (double& value : block.values()) {
      value *= factor;
    }
  }
  // Whatever the first program says in this topic of which `change` returns that it is to be
  // written, changed, until the end.
  template <class Message, class Change>
  void repeat(const bus::Topic<Message>& topic, Change change) {
    auto wake_up = std::make_shared<bus::WakeUp>();
    auto reader =
        std::make_shared<bus::Reader<Message>>(participant_.reader(topic, bench_, wake_up).value());
    repeating_.emplace_back([this, topic, change, wake_up, reader](const std::stop_token& stop) {
      std::map<std::string, bus::Writer<Message>> writers; // by run
      std::string sender;
      while (!stop.stop_requested()) {
        wake_up->wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(20));
        reader->take_with_writer([&](Message message, const bus::WriterId& writer) {
          if (!sender.empty() && writer.participant() != sender) {
            return;
          }
          ++heard_of_others_;
          if (change(message)) {
            sender = writer.participant();
            writer_for(topic, message, writers).write(message, std::chrono::milliseconds(100));
            ++forged_;
          }
        });
      }
    });
  }
  // Where who reads only its run hears it as well.
  template <class Message>
  bus::Writer<Message>& writer_for(const bus::Topic<Message>& topic, const Message& message,
                                   std::map<std::string, bus::Writer<Message>>& writers) {
    const std::string run =
        topic.profile == bus::Profile::results ? message_run(message) : std::string();
    const auto found = writers.find(run);
    if (found != writers.end()) {
      return found->second;
    }
    auto writer = run.empty() ? participant_.writer(topic, bench_)
                              : participant_.writer_of_run(topic, bench_, run);
    return writers.emplace(run, std::move(writer).value()).first->second;
  }
  template <class Message>
  static std::string message_run(const Message& message) {
    if constexpr (requires { message.run(); }) {
      return message.run().to_string();
    } else {
      return "";
    }
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
  std::string conductor_; // its participant
  std::atomic<std::size_t> forged_{0};
  std::atomic<std::size_t> heard_of_others_{0};
  std::vector<wire::Excitation> heard_;
  wire::Measurement plan_;
  std::jthread forging_; // the last members: they use the others
  std::deque<std::jthread> repeating_;
};

} // namespace dyncal::tests
