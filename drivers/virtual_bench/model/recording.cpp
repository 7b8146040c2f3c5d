#include "drivers/virtual_bench/model/recording.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double pause_s = 0.3;
constexpr double margin_s = 0.1; // a step lasts a little longer than is evaluated
constexpr double multisine_margin_s = 3.0;
constexpr double multisine_pause_s = 3.0;
constexpr double slice_s = 0.1;

// Shortest text that reads back as the same number.
template <class Number>
void put(std::string& line, Number value) {
  char text[40];
  const auto [end, status] = std::to_chars(text, text + sizeof(text), value);
  line.append(text, end);
}

class CsvFiles {
public:
  CsvFiles(const VirtualBench& bench, const std::filesystem::path& folder)
      : bench_(bench), acs_(folder / "acs.csv", std::ios::binary),
        dau_(folder / "dau.csv", std::ios::binary) {
    acs_ << "t_ns";
    for (const AcsChannel& channel : bench.acs().channels()) {
      acs_ << ',' << channel.name;
    }
    acs_ << '\n';
    dau_ << "t_ns,sample_number";
    for (const UnitChannel& channel : bench.unit().channels()) {
      dau_ << ',' << channel.name;
    }
    dau_ << '\n';
  }

  void write(const AcsSamples& samples) {
    text_.clear();
    for (std::size_t i = 0; i < samples.samples(); ++i) {
      put(text_, bench_.acs().stamp_ns(samples.first_sample + i));
      for (std::size_t channel = 0; channel < samples.channels; ++channel) {
        text_ += ',';
        put(text_, samples.counts[samples.channels * i + channel] *
                       bench_.acs().channels()[channel].scale);
      }
      text_ += '\n';
    }
    acs_ << text_;
  }

  void write(const UnitSample& sample) {
    text_.clear();
    put(text_, sample.utc_ns);
    text_ += ',';
    put(text_, sample.sample_number);
    for (const UnitChannel& channel : bench_.unit().channels()) {
      text_ += ',';
      if (sample.data[channel.index]) {
        put(text_,
            static_cast<double>(*sample.data[channel.index])); // read back, it must be the same
                                                               // double as from a datagram
      }
    }
    text_ += '\n';
    dau_ << text_;
  }

  [[nodiscard]] bool complete() { return acs_.flush().good() && dau_.flush().good(); }

private:
  const VirtualBench& bench_;
  std::ofstream acs_;
  std::ofstream dau_;
  std::string text_;
};

void run_for(VirtualBench& bench, double duration_s, CsvFiles& files) {
  const double end_s = bench.now_s() + duration_s;
  while (bench.now_s() < end_s) {
    AcsSamples acs;
    bench.advance_to(std::min(bench.now_s() + slice_s, end_s), acs,
                     [&](const UnitSample& sample) { files.write(sample); });
    if (bench.acs().sends(acs)) {
      files.write(acs);
    }
  }
}

DriveLine line_of(const Programme& programme, std::size_t step) {
  return {std::strtod(programme.frequencies_hz[step].c_str(), nullptr),
          programme.levels_m_s2[step] / VirtualBench::level_per_volt,
          step < programme.phases_rad.size() ? programme.phases_rad[step] : 0.0};
}

void record_steps(VirtualBench& bench, const Programme& programme, CsvFiles& files) {
  for (std::size_t step = 0; step < programme.frequencies_hz.size(); ++step) {
    run_for(bench, pause_s, files);
    const DriveLine line = line_of(programme, step);
    bench.set_drive({line.frequency_hz, line.amplitude_v, true});
    run_for(bench, programme.settling_s + programme.duration_s + margin_s, files);
    bench.set_drive({line.frequency_hz, 0.0, false});
  }
}

void record_multisine(VirtualBench& bench, const Programme& programme, CsvFiles& files) {
  run_for(bench, multisine_pause_s, files);
  Drive drive{.on = true};
  for (std::size_t step = 0; step < programme.frequencies_hz.size(); ++step) {
    drive.lines.push_back(line_of(programme, step));
  }
  bench.set_drive(drive);
  run_for(bench, programme.settling_s + programme.duration_s + multisine_margin_s, files);
  drive.on = false;
  bench.set_drive(drive);
}

} // namespace

Expected<void> record_csv(VirtualBench& bench, const Programme& programme,
                          const std::filesystem::path& folder) {
  CsvFiles files(bench, folder);
  const bool multisine = !programme.phases_rad.empty();
  for (int repetition = 0; repetition < programme.repetitions; ++repetition) {
    multisine ? record_multisine(bench, programme, files) : record_steps(bench, programme, files);
  }
  run_for(bench, multisine ? multisine_pause_s : pause_s, files);
  if (!files.complete()) {
    return fail(ErrorCode::refused,
                folder.string() + ": acs.csv and dau.csv cannot be written there");
  }
  return {};
}

} // namespace dyncal::drivers::virtual_bench
