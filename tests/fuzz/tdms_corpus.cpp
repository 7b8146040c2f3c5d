// Writes seeds of tdms_fuzz into the folder that it is given: a file of each form.
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/unit/drivers/files/tdms_bytes.hpp"

namespace {

using namespace dyncal::drivers::files;

std::string channels(bool big_endian) {
  TdmsBytes bytes(big_endian);
  bytes.add(std::uint32_t{3});
  bytes.text("/'g'/'a'").index(2, 2).add(std::uint32_t{8});
  bytes.property("wf_increment", 0.001).time("wf_start_time", 3'000'000'000, 1U);
  bytes.property("wf_start_offset", 0.5).property("unit_string", "V");
  bytes.property("NI_Number_Of_Scales", 1U).property("NI_Scale[0]_Scale_Type", "Linear");
  bytes.property("NI_Scale[0]_Linear_Slope", 2.0).property("NI_Scale[0]_Linear_Y_Intercept", 1.0);
  bytes.text("/'g'/'b'").index(10, 2).add(std::uint32_t{0});
  bytes.text("/'g'/'c'").index(0x08000C, 2).add(std::uint32_t{0});
  return bytes.bytes();
}

std::string daqmx() {
  TdmsBytes bytes;
  bytes.add(std::uint32_t{1}).text("/'g'/'a'").add(std::uint32_t{0x1269}).add(~std::uint32_t{0});
  bytes.add(std::uint32_t{1}).add(std::uint64_t{2}).add(std::uint32_t{1});
  for (const std::uint32_t number : {3U, 0U, 0U, 0U, 0U, 1U, 4U}) {
    bytes.add(number); // one scaler, and the width of the one buffer
  }
  bytes.add(std::uint32_t{6}).property("NI_Number_Of_Scales", 2U);
  bytes.property("NI_Scale[1]_Scale_Type", "Polynomial");
  bytes.property("NI_Scale[1]_Polynomial_Coefficients_Size", 1U);
  bytes.property("NI_Scale[1]_Polynomial_Coefficients[0]", 2.0);
  bytes.property("NI_Scale[1]_Polynomial_Input_Source", 0U).property("wf_increment", 0.3);
  return bytes.bytes();
}

} // namespace

int main(int, char** arguments) {
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
  };
  const std::string data(2 * (2 + 8 + 8), '\x11');
  const std::string whole = tdms_segment(tdms_whole, channels(false), data);
  write("contiguous", whole + tdms_segment(tdms_raw_data, "", data + data));
  write("interleaved", tdms_segment(tdms_whole | tdms_interleaved, channels(false), data + data));
  write("big_endian", tdms_segment(tdms_whole | tdms_big_endian, channels(true), data));
  write("unclosed", whole + tdms_segment(tdms_raw_data, "", data.substr(0, 20), false));
  write("daqmx", tdms_segment(tdms_whole | tdms_daqmx, daqmx(), std::string(8, '\x22')));
  return 0;
}
