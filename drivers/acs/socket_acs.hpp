// The TCP stream of an analogue calibration system (ACS) as a source of samples. README.md defines
// it: a description line, then binary frames.
//
// A frame that holds 20 ms or more becomes a block; shorter frames that follow each other without a
// gap are joined to one. When the instrument disconnects, run() tries to reach it again every half
// second until stop(); each return is a new session, because its sample numbers and its clock's
// origin are new. An instrument that falls silent in the middle of a frame is disconnected and
// reached again, for it will not go on where it stopped; between frames it may be silent as long as
// it likes. A sink that blocks makes the instrument wait.
//
// describe() fails with invalid_setting when the settings name a channel that the instrument does
// not have; an instrument that lacks one after a reconnection is warned of and counted. What cannot
// be understood ends run() with malformed: the stream has no mark to find the next frame by.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/link/stop_signal.hpp"
#include "drivers/link/tcp_connection.hpp"
#include "drivers/sample_source.hpp"

namespace dyncal::drivers::acs {

struct SocketSettings {
  std::string address;                           // HOST:PORT
  std::chrono::milliseconds connect_limit{5000}; // how long describe() tries
  std::chrono::milliseconds frame_limit{5000};   // for the next bytes of a frame that has begun
  std::map<std::string, std::string> channels{}; // the instrument's name -> ours
  std::map<std::string, std::string> units{};    // our name -> D-SI
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

class SocketAcs : public SampleSource {
public:
  explicit SocketAcs(SocketSettings settings) : settings_(std::move(settings)) {}

  [[nodiscard]] Expected<SourceDescription> describe() override;
  [[nodiscard]] Expected<void> run(SampleSink& sink) override;
  void stop() override { stop_.raise(); }

private:
  Expected<void> connect(std::chrono::milliseconds limit);
  Expected<void> connect_again(SampleSink& sink);
  Expected<void> name_channels();
  Expected<void> read_session(SampleSink& sink);
  Expected<SampleBlock> read_frame();
  Expected<void> read_rest_of_frame(std::span<char> bytes);
  void count(SampleSink& sink) const;
  void join(SampleBlock& pending, SampleBlock frame) const;

  SocketSettings settings_;
  StopSignal stop_;
  std::optional<TcpConnection> connection_;
  StreamDescription stream_;
  std::vector<char> payload_;
  SampleCounts counts_;
  std::uint64_t channels_missing_ = 0; // after a reconnection
};

} // namespace dyncal::drivers::acs
