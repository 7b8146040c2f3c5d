// What a file says of a device by its calibration certificate: name, manufacturer, model, serial,
// certificate, issued_by, issued, and valid_until or interval_months, which counts from `issued`.
// Of the reference also standard and traceability. All but the name may be left out; documents
// object to what they need. What cannot be is refused in the table. Any thread.
#pragma once

#include "services/bench/file/toml_table.hpp"
#include "services/contract/reference_standard.hpp"

namespace dyncal::inline bench {

[[nodiscard]] CalibratedDevice read_calibrated_device(TomlTable& table);

// With the one device.
[[nodiscard]] ReferenceStandard read_reference_standard(TomlTable& table);

} // namespace dyncal::inline bench
