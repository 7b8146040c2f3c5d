// The virtual bench on the network: ACS stream (TCP), generator (TCP, SCPI), SmartUp Unit (UDP), on
// request oscilloscope and time series sensor (TCP), and the pace of bench time.
//
// Speed x: bench time runs x times as fast as the host's clock. Speed 0 ("max"): while a client of
// the generator waits for a bench time and the ACS stream is being read, as fast as the consumers
// allow; otherwise in real time.
//
// Bench time never runs ahead of what the ACS client has taken by more than a tenth of a second
// beyond the sockets' buffers, and no more than `datagrams_per_s` leave in a second of the host, so
// that receive buffers of the usual size hold them.
//
// One thread runs it; the StopSignal may be raised from any.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "drivers/link/address.hpp"
#include "drivers/link/file_descriptor.hpp"
#include "drivers/link/stop_signal.hpp"
#include "drivers/virtual_bench/model/virtual_bench.hpp"
#include "drivers/virtual_bench/wire/datagram_path.hpp"
#include "drivers/virtual_bench/wire/line_clients.hpp"
#include "drivers/virtual_bench/wire/smartup_format.hpp"
#include "drivers/virtual_bench/wire/stream_client.hpp"
#include "drivers/virtual_bench/wire/triggered_server.hpp"

namespace dyncal::drivers::virtual_bench {

struct ServerSettings {
  Address dau;        // where the unit's datagrams go
  Address acs_listen; // port 0: the system chooses
  Address generator_listen;
  double speed = 1.0;      // 0: as fast as possible
  double duration_s = 0.0; // bench time after which run() ends; 0: never
  PathSettings path;
  double datagrams_per_s = 4000.0; // of the host's seconds
  std::uint32_t sensor_id = 0xbccb0100;
  bool with_ticks = false;
  std::optional<TriggeredSettings> triggered; // oscilloscope and time series sensor
  // For a bench that keeps UTC: bench time is the host's UTC plus this lead, whatever was delayed,
  // so that somebody who is told what happens (after_advance) can do it at its very instant.
  // `speed` then has no meaning.
  double utc_lead_s = 0.03;
  std::function<void(double time_s)> after_advance; // bench time has come to `time_s`
  // With what the ACS has sampled since it sent last, newest last.
  std::function<void(const AcsSamples&)> with_samples;
};

class BenchServer {
public:
  BenchServer(VirtualBench& bench, const ServerSettings& settings);

  // Fails (refused) when an address cannot be listened on.
  [[nodiscard]] Expected<void> open();
  [[nodiscard]] std::uint16_t acs_port() const;
  [[nodiscard]] std::uint16_t generator_port() const;
  [[nodiscard]] const std::optional<TriggeredServer>& triggered() const { return triggered_; }

  // Returns at the end of the duration or when stopped.
  void run(const StopSignal& stop);

private:
  using Clock = std::chrono::steady_clock;

  void serve_sockets();
  void wait_for_events(const StopSignal& stop, std::chrono::milliseconds limit) const;
  // Bench time that may be reached now; the present one: wait.
  [[nodiscard]] double allowed_time_s();
  [[nodiscard]] double paced_time_s();
  [[nodiscard]] bool consumers_keep_up();
  [[nodiscard]] bool datagrams_are_taken();
  void hold_pace();
  void advance_to(double time_s);
  void send_frame();
  void send_datagram(const std::string& datagram);
  void end_stream(const StopSignal& stop);

  VirtualBench& bench_;
  ServerSettings settings_;
  ScpiInstrument instrument_;
  LineClients generator_clients_;
  StreamClient stream_;
  SmartUpPacker packer_;
  DatagramPath path_;
  std::optional<TriggeredServer> triggered_;
  FileDescriptor acs_listener_;
  FileDescriptor generator_listener_;
  FileDescriptor unit_socket_;
  AcsSamples frame_;
  double next_description_s_ = 0.05;
  Clock::time_point pace_host_; // bench time pace_bench_s_ belongs to this instant of the host
  double pace_bench_s_ = 0.0;
  double datagram_credit_ = 0.0;
  Clock::time_point credit_at_;
  bool receiver_on_this_host_ = false;
  std::chrono::microseconds queue_look_interval_;
  Clock::time_point queue_looked_at_;
  std::size_t may_wait_bytes_ = 0; // there at the last look, and sent since
};

} // namespace dyncal::drivers::virtual_bench
