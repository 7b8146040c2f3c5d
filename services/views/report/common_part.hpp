// What the values of a result have in common with other results of the bench: the rows of their
// budgets that come from calibrations (analysis/uncertainty/common_contributions.hpp), and what
// these calibrations were: the instruments and the corrections that were applied at that point.
//
// Two values share a row if instruments and corrections are the same and its u is the same within
// 1 %: one that was calibrated again shares nothing. Plain functions, any thread.
//
// Two levels of one result share less: what the reference's certificate names beside its
// sensitivity (its amplitude linearity, its drift) may be another at another level.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "analysis/response/comparison.hpp"
#include "services/evaluation/result/point_identity.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct CommonRow {
  std::string name; // of the contribution
  double u_magnitude_rel = 0.0;
  double u_phase_rad = 0.0;
  bool may_depend_on_level = false;
};

struct CommonPart {   // of one mean
  std::string origin; // instruments and corrections, for comparison alone
  std::vector<CommonRow> rows;
};

using CommonParts = std::map<PointIdentity, CommonPart>;

// `source`: that of the sensor, which belongs to no other result.
[[nodiscard]] CommonParts common_parts_of(const StoredResult& result, const std::string& source);

// 0: nothing is known to be shared.
[[nodiscard]] analysis::SharedUncertainty shared_by(const CommonPart& one, const CommonPart& other);
[[nodiscard]] analysis::SharedUncertainty shared_between_levels(const CommonPart& one,
                                                                const CommonPart& other);

} // namespace dyncal::inline views
