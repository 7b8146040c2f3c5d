// The tables of an exported HDF5 file, as they lie in memory and in the file: which samples are
// which shot, steps and results (README.md has the layout).
#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/files/hdf5_library.hpp"

namespace dyncal::inline records {

using drivers::files::Hdf5Handle;

inline constexpr std::uint32_t hdf5_layout = 2;

// A record of a shot.
struct Hdf5Shot {
  std::uint64_t session = 0;
  std::uint64_t shot = 0;
  std::uint64_t first_column = 0;
  std::int64_t trigger_utc_ns = 0;
  std::int64_t received_utc_ns = 0;
  double first_sample_s = 0.0;
  double interval_s = 0.0;
  std::uint32_t sample_count = 0;
  std::uint32_t step = 0;
  std::uint32_t attempt = 0;
  std::uint32_t run = 0;              // by its place in the attribute Runs, from 1; 0: none
  std::uint32_t acknowledged_run = 0; // the same
  std::uint32_t end_of_stream = 0;
};

// For people.
struct Hdf5Excitation {
  std::uint32_t run = 0; // from 1, by the attribute Runs
  std::uint32_t step = 0;
  std::uint32_t repetition = 0;
  std::uint32_t attempt = 0;
  std::uint32_t state = 0; // wire::ExcitationState
  std::uint32_t reserved = 0;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
  std::int64_t window_begin_utc_ns = 0;
  std::int64_t window_end_utc_ns = 0;
};

struct Hdf5Result {
  std::uint32_t run = 0;
  std::uint32_t channel = 0; // from 1, by the attribute Channels
  std::uint32_t step = 0;
  std::uint32_t repetition = 0;
  std::uint32_t valid = 0;
  std::uint32_t attempt = 0;
  std::uint64_t lost = 0;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
  double magnitude = 0.0;
  double u_magnitude = 0.0;
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
};

// Compound types of the library for these; T is one of them.
template <class T>
[[nodiscard]] Hdf5Handle hdf5_type();
template <>
[[nodiscard]] Hdf5Handle hdf5_type<Hdf5Shot>();
template <>
[[nodiscard]] Hdf5Handle hdf5_type<Hdf5Excitation>();
template <>
[[nodiscard]] Hdf5Handle hdf5_type<Hdf5Result>();

} // namespace dyncal::inline records
