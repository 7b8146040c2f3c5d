// What users of DDS and of ROS 2 set in the environment, and what it does to dyncal. Plain
// functions; reading the environment while another thread changes it is not allowed.
#pragma once

#include <map>
#include <string>

#include "services/base/finding.hpp"

namespace dyncal::inline checks::doctor {

struct HostView;
struct LaboratoryView;

// Those that are set in this process, and files of the working directory that count as if one was;
// with their values.
[[nodiscard]] std::map<std::string, std::string> dds_variables();

// A warning where this program finds nobody and its DDS implementation heeds one, else a note each.
[[nodiscard]] Findings check_variables(const LaboratoryView& view, const HostView& host);

} // namespace dyncal::inline checks::doctor
