// The instrument's TCP stream, as drivers/acs/README.md defines it: a description line, then binary
// frames.
//
// A frame that holds 20 ms or more becomes a block; shorter frames that follow each other without a
// gap are joined to one. When the instrument goes away, run() tries to reach it again every half
// second until stop(); each return is a new session, because its sample numbers and its clock's
// origin are new. What cannot be understood ends run() with `malformed`: the stream has no mark to
// find the next frame by.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/acs/acs_driver.hpp"
#include "drivers/link/stop_signal.hpp"
#include "drivers/link/tcp_connection.hpp"

namespace dyncal::drivers::acs {

struct SocketSettings {
  std::string address;                           // HOST:PORT
  std::chrono::milliseconds connect_limit{5000}; // how long describe() tries
};

// What the description line says; values of int32 frames are counts, `scale` turns them into the
// unit.
struct StreamDescription {
  SourceDescription source;
  RegularClock clock;
  std::vector<double> scale; // unit per count, one per channel
  bool float64 = false;      // values are float64 in the unit already
};

// Fails (malformed) with a sentence that names the member that is missing or wrong.
[[nodiscard]] Expected<StreamDescription> parse_stream_description(const std::string& line);

class SocketAcs : public AcsDriver {
public:
  explicit SocketAcs(SocketSettings settings) : settings_(std::move(settings)) {}

  [[nodiscard]] Expected<SourceDescription> describe() override;
  [[nodiscard]] Expected<void> run(BlockSink& sink) override;
  void stop() override { stop_.raise(); }

private:
  Expected<void> connect(std::chrono::milliseconds limit);
  Expected<void> connect_again();
  Expected<void> read_session(BlockSink& sink);
  Expected<SampleBlock> read_frame();
  void join(SampleBlock& pending, SampleBlock frame) const;

  SocketSettings settings_;
  StopSignal stop_;
  std::optional<TcpConnection> connection_;
  StreamDescription stream_;
  std::vector<char> payload_;
};

} // namespace dyncal::drivers::acs
