// The oscilloscope's side of SCPI as the Rigol MSO5000 series speaks it, and what a bad network or
// instrument makes of the answers.
//
// Understands long and short forms in any case:
//   *IDN?, *CLS, *OPC?, :SYSTem:ERRor?, :SYSTem:AOUTput, :ACQuire:TYPE, :ACQuire:MDEPth
//   :CHANnel<n>:DISPlay, :SCALe, :OFFSet           :TIMebase:MAIN:SCALe, :OFFSet
//   :TRIGger:MODE, :COUPling, :STATus?             :TRIGger:EDGE:SOURce, :SLOPe, :LEVel
//   :SINGle, :STOP
//   :WAVeform:SOURce[?], :MODE, :FORMat, :POINts, :STARt, :STOP, :PREamble?, :DATA?
// Anything else is -113 in the error queue. One thread.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/virtual_bench/model/oscilloscope_model.hpp"
#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {

// Probabilities per answer.
//   half-answer   the second half never comes        garbage      bytes that mean nothing
//   wrong-length  a block says another length        other-answer the answer to another question
//   disconnect    half of the answer, then the end   slow         the answer takes a second (of the
//   host)
using ScopeFaults = std::map<std::string, double>;
[[nodiscard]] const std::vector<std::string>& scope_fault_names();

class OscilloscopeScpi {
public:
  OscilloscopeScpi(OscilloscopeModel& model, std::uint64_t seed, ScopeFaults faults)
      : model_(model), random_(seed, "DSO faults"), faults_(std::move(faults)), serial_(seed) {}

  struct Reply {
    std::string bytes; // with line end; empty: none
    bool disconnect = false;
    bool slow = false;
  };
  [[nodiscard]] Reply execute(std::string_view line);

private:
  [[nodiscard]] std::optional<std::string> query(const std::string& header);
  void set(const std::string& header, std::string_view argument);
  bool set_input(const std::string& header, std::string_view argument);
  void set_number(const std::string& header, std::string_view argument);
  [[nodiscard]] std::string preamble() const;
  [[nodiscard]] std::string data();
  [[nodiscard]] Reply spoiled(std::string answer);
  void complain(const char* error);

  OscilloscopeModel& model_;
  Random random_;
  ScopeFaults faults_;
  std::uint64_t serial_;
  std::deque<std::string> errors_;
  std::size_t source_ = 0;
  std::size_t first_point_ = 1;
  std::size_t last_point_ = 1000;
};

} // namespace dyncal::drivers::virtual_bench
