// The generator's side of SCPI: one line in, perhaps one line out; errors wait in a queue as IEEE
// 488.2 has it.
//
// Understands, long or short form in any case:
//   *IDN?, *RST, *CLS, *OPC?, :SYSTem:ERRor?
//   :SOURce1:FREQuency[?], :SOURce1:VOLTage[?] (peak to peak), :SOURce1:VOLTage:UNIT VPP
//   :SOURce1:FUNCtion SINusoid|SQUare|ARB
//   :SOURce1:TRACe:DATA:DAC16 (waveform_memory.hpp), :SOURce1:FUNCtion:ARB:MODE SRATE,
//   :SOURce1:FUNCtion:ARB:SRATe, in the words of Rigol alone
//   :OUTPut1[?] ON|OFF, :OUTPut1:LOAD INFinity
// and what left_over_settings.hpp keeps, in the words of a DG4000 or of a 33500,
// and of the bench itself :BENCh:TIME? and :BENCh:WAIT? <bench time in s>, which is answered when
// that time has come. A frequency at which the sensor's response is not known is out of range. One
// thread.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/virtual_bench/model/virtual_bench.hpp"
#include "drivers/virtual_bench/wire/left_over_settings.hpp"
#include "drivers/virtual_bench/wire/waveform_memory.hpp"

namespace dyncal::drivers::virtual_bench {

class ScpiInstrument {
public:
  struct Reply {
    std::optional<std::string> line;    // without line end; nothing: the command has no answer
    std::optional<double> wait_until_s; // :BENCh:WAIT?: answer with the bench time when it has come
  };

  explicit ScpiInstrument(VirtualBench& bench)
      : bench_(bench),
        left_over_(bench.settings().generator_words, bench.settings().faults.left_in_generator) {}

  [[nodiscard]] Reply execute(std::string_view line);

  [[nodiscard]] static std::string time_text(double bench_time_s);

private:
  [[nodiscard]] std::string identity() const;
  [[nodiscard]] Reply query(const std::string& header, std::string_view argument);
  void set(const std::string& header, std::string_view argument);
  void set_function(std::string_view argument);
  // Whether it is about an arbitrary waveform, in words that this generator has.
  bool set_waveform(const std::string& header, std::string_view argument);
  void play_waveform(Drive drive);
  void set_frequency(std::string_view argument);
  void set_voltage(std::string_view argument);
  void set_output(std::string_view argument);
  void complain(const char* error);

  VirtualBench& bench_;
  LeftOverSettings left_over_;
  WaveformMemory waveform_;
  bool is_on_ = false;             // the output, as it answers
  std::deque<std::string> errors_; // at most 20, the last one says that there were more
};

} // namespace dyncal::drivers::virtual_bench
