// Where in a source's own clock an excitation step took place, found from its sync channel alone.
//
// The stream is divided into frames of one period, or 100 ms if that is longer, but at most 50
// periods. Frame k is [k L, (k+1) L) of the device's own time: the result does not depend on how
// the samples came in blocks. A sine of the nominal frequency is approximated in each frame (paper
// eq. (1)). Frames belong to one excitation while their residual is small, their amplitude stays,
// and their phase advances as a frequency within `frequency_tolerance_rel` of the nominal one does.
//
// Of such a run of frames the steady part is the longest stretch whose amplitude is within
// `amplitude_tolerance_rel` of the plateau, without frames at its edges that are only partly
// excited, and its phase advances as the nominal frequency's: two frames of a sine a few percent
// off are no step. It is up to two frames at each end shorter than the excitation. Lost samples
// leave frames thinner or empty; an excitation goes on across a gap when its phase does. An
// off-phase must last 0.2 s. The excitation has ended when a frame of less than half its amplitude
// follows; until then a steady run that is louder takes its place, for mains hum on the channel is
// a sine too, and beside 50 Hz one of the step's frequency.
//
// Units: stamps int64 ns of any epoch; the window is half-open. Cost: about one sine and cosine a
// sample; memory: the samples of one frame and some 80 bytes a frame of the excitation. Samples
// that are not finite or not later than the one before are left out and counted.
//
// A multi-sine is found in one of its lines: in every frame all lines are approximated together,
// and the others are taken away first. Its frames are two turns of the nearest lines long.
//
// No window: no stretch of at least two frames and `min_duration_s`; fewer than eight samples in a
// frame; a frequency at a multiple of half the sample rate. One thread; no shared state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct ExcitationWindowSettings {
  double frequency_tolerance_rel = 1.5e-3; // generator and both clocks together
  double amplitude_tolerance_rel = 0.03;   // of the steady part
  double min_duration_s = 0.25;            // a shorter steady part is not a step
  double max_gap_s = 1.0;                  // missing samples longer than this end the excitation
  double max_duration_s = 3600.0;          // an excitation that lasts longer is closed there
};

struct ExcitationWindow {
  std::int64_t begin_ns = 0; // steady sine from here ...
  std::int64_t end_ns = 0;   // ... to here, exclusive
  std::int64_t excited_begin_ns =
      0;                   // start of the first frame that holds the sine, settling included
  std::int64_t off_ns = 0; // end of the last frame that holds it: where to look for the next step
  bool ended = false;      // the excitation is over; otherwise all of this may still grow
  double amplitude = 0.0;  // of the plateau, in the unit of the channel
  double frequency_offset_rel = 0.0; // of the sine in this clock against the nominal frequency
  std::size_t frames = 0;            // of the steady part
  // Of a sine through the phases of the steady part, all in this clock: its frequency, and its
  // phase (lead) in the middle.
  double frequency_hz = 0.0;
  double u_frequency_rel = 0.0;
  std::int64_t middle_ns = 0;
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
};

class ExcitationWindowFinder {
public:
  // `beside`: the other lines that are excited at once.
  explicit ExcitationWindowFinder(const Frequency& frequency,
                                  const ExcitationWindowSettings& settings = {},
                                  std::vector<Frequency> beside = {});

  // The next samples of the stream, in order. REQUIRES: equal sizes. Ignored once the excitation
  // has ended.
  void push(std::span<const std::int64_t> stamps_ns, std::span<const double> sync);

  // The stream is over: the open frame counts and the excitation, if there is one, has ended.
  void finish();

  // The first excitation found, ended or still lasting; empty while there is none.
  [[nodiscard]] std::optional<ExcitationWindow> window() const;
  [[nodiscard]] bool ended() const { return ended_; }

  [[nodiscard]] std::int64_t frame_ns() const { return frame_ns_; }
  [[nodiscard]] std::uint64_t ignored_samples() const { return ignored_samples_; }

private:
  struct Frame {
    std::int64_t index = 0;
    double amplitude = 0.0;
    double u_amplitude = 0.0;
    double phase_rad = 0.0; // against the nominal frequency from origin_ns_ on, at the frame's
                            // centre; unwrapped in a run
    double residual_rms = 0.0;
    double max_residual = 0.0;
    double max_neighbours_rms = 0.0; // the larger of each two adjacent slices' smaller one
    bool usable = false;
  };

  [[nodiscard]] std::size_t samples_of_open_frame(std::span<const std::int64_t> stamps_ns,
                                                  std::span<const double> sync) const;
  void begin_frame_or_ignore(std::int64_t stamp_ns, double sync);
  void close_frame();
  [[nodiscard]] Frame approximate() const;
  [[nodiscard]] std::vector<double> values_without_others() const;
  void take(const Frame& frame);
  [[nodiscard]] bool starts(const Frame& frame) const;
  [[nodiscard]] bool continues(const Frame& frame, double& unwrapped_rad) const;
  void close_run();
  void restart_run(const Frame& last, const Frame& frame);
  [[nodiscard]] bool is_cut_off_by(const Frame& frame) const;
  [[nodiscard]] bool is_quiet(const Frame& frame) const;
  struct Frames { // of the run, [begin, end)
    std::size_t begin = 0;
    std::size_t end = 0;
    [[nodiscard]] std::size_t size() const { return end - begin; }
  };

  [[nodiscard]] Frames longest_steady(double plateau) const;
  [[nodiscard]] Frames without_edges(Frames part) const;
  [[nodiscard]] bool has_nominal_frequency(std::size_t begin, std::size_t end) const;
  [[nodiscard]] std::optional<ExcitationWindow> steady_part() const;
  void describe_sine(Frames part, ExcitationWindow& window) const;
  [[nodiscard]] double mean_advance_rad() const;

  Frequency frequency_;
  ExcitationWindowSettings settings_;
  std::vector<Frequency> beside_;
  std::int64_t frame_ns_;
  std::optional<std::int64_t> origin_ns_; // start of the first frame
  std::int64_t first_stamp_ns_ = 0;
  std::int64_t last_stamp_ns_ = 0;
  std::int64_t open_index_ = 0;
  std::vector<std::int64_t> stamps_ns_; // of the open frame
  std::vector<double> values_;
  std::vector<Frame> run_;
  std::optional<ExcitationWindow> candidate_; // whose run is over, but perhaps not the step
  bool ended_ = false;
  std::uint64_t ignored_samples_ = 0;
};

} // namespace dyncal::analysis
