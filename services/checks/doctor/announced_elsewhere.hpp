// Who announces itself where this program does not look: in another DDS domain, or by an interface
// that it does not use. Plain functions, any thread.
#pragma once

#include <string>

#include "services/checks/doctor/laboratory_view.hpp"

namespace dyncal::inline checks::doctor {

// A part of a sentence, such as "dyncal-analysis announces itself in DDS domain 9, from 10.98.0.1:
// give --domain 9"; of programs of dyncal alone where there are any. Empty: nobody.
[[nodiscard]] std::string announced_elsewhere(const LaboratoryView& view);

} // namespace dyncal::inline checks::doctor
