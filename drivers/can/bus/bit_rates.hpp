// The bit rates of a CAN bus, in bit/s. Plain data; any thread.
#pragma once

namespace dyncal::drivers::can {

struct BitRates {
  double nominal_per_s = 0.0;
  double data_per_s = 0.0; // of the data phase of FD frames with bit rate switch
};

} // namespace dyncal::drivers::can
