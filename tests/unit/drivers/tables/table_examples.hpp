// Small tables as each of the systems writes them, made for tests.
#pragma once

#include <string>

namespace dyncal::drivers::tables {

inline const std::string strict_example = "loop;frequency;ex_amp;ex_amp_std;phase;phase_std\n"
                                          "\n"
                                          "#Number;Hz;m/s^2;m/s^2;deg;deg\n"
                                          "0;10.0;2.739;0.000548;-43.7679;0.04\n"
                                          "# by hand\n"
                                          "1;12.5;2.744;0.000549;46.8090;0.05\n";

inline const std::string spektra_csv_example =
    "Number;Frequency;Acceleration;S;Std.dev. S;Dev.;Phase;Std.Dev. Phase;Distortion. Ref;"
    "Distortion. DUT.;Gain. Ref;Gain DUT\n"
    ";Hz;m/s2;mV/(m/s2);%;%;deg;deg;%;%;dB;dB\n"
    "1;80;19.998;12.34;0.65;0.1;-12.5;0.2;0.05;0.07;0;20\n"
    "2;250;100.1;12.30;0.46;0.1;-77.25;0.1;0.5;0.7;0;20\n";

// ISO-8859-1, decimal comma.
inline const std::string spektra_prp_example = [] {
  std::string text;
  for (int line = 1; line <= 17; ++line) {
    text += "Pr\xfc"
            "fling\t" +
            std::to_string(line) + "\r\n";
  }
  return text + "Frequency,\tAccel.,\tS,\tStdrd. dev.,\tDev.,\tPhase,\tDist.,\r\n"
                "Hz\tm/s\xb2 Peak\tmV/(m/s\xb2)\t%\tdB\tDegree\t%\r\n"
                "10,0\t2,739\t12,34\t0,009\t(Ref. value)\t-43,7679\t0,1\r\n"
                "12,5\t2,744\t12,30\t0,034\t0,01\t46,8090\t0,1\r\n";
}();

} // namespace dyncal::drivers::tables
