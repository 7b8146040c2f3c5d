// Lines of numbers over TCP as a source of samples. README.md defines them.
//
// Values are in the units of the settings, stamps n / rate from 0 in a clock of the instrument's
// own. describe() fails with invalid_setting where the settings name a channel that the lines do
// not have, with malformed where they are no numbers, and as TcpConnection does; run() with
// malformed alone. One thread calls both, stop() any.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/acs_driver.hpp"
#include "drivers/link/stop_signal.hpp"
#include "drivers/link/tcp_connection.hpp"
#include "drivers/sample_rate.hpp"

namespace dyncal::drivers::text_stream {

struct TextStreamSettings {
  std::string address; // HOST:PORT
  SampleRate rate;
  std::map<std::string, std::string> channels{}; // "channel_1" -> ours
  std::map<std::string, std::string> units{};    // our name -> D-SI
};

class TextStream : public SampleSource {
public:
  explicit TextStream(TextStreamSettings settings) : settings_(std::move(settings)) {}

  [[nodiscard]] Expected<SourceDescription> describe() override;
  [[nodiscard]] Expected<void> run(SampleSink& sink) override;
  void stop() override { stop_.raise(); }

private:
  [[nodiscard]] Expected<void> connect();
  // Until the instrument is gone (disconnected), or sends what is not understood.
  [[nodiscard]] Expected<void> read_session(SampleSink& sink);
  [[nodiscard]] Expected<std::vector<double>> read_sample();
  [[nodiscard]] Expected<void> name_channels();

  TextStreamSettings settings_;
  StopSignal stop_;
  std::optional<TcpConnection> connection_;
  SourceDescription description_;
  std::vector<double> first_sample_; // read to see how many channels there are
  SampleCounts counts_;
};

// The row of services/bench/file/acs_drivers.cpp: driver = "text-stream".
[[nodiscard]] const AcsDriver& driver();

} // namespace dyncal::drivers::text_stream
