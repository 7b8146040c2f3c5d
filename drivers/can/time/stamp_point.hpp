// Which instant of a frame an adapter's stamp means; the adapter's maker knows. Kernel stamps are
// always taken after the end. Any thread.
#pragma once

namespace dyncal::drivers::can {

enum class StampPoint { start_of_frame, end_of_frame, unknown };

} // namespace dyncal::drivers::can
