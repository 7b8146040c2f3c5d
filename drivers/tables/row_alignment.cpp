#include "drivers/tables/row_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dyncal::drivers::tables {
namespace {

using Frequencies = std::span<const double>;

// Longest common subsequences: of the first i steps and j rows, and of those from there on.
class CommonLengths {
public:
  CommonLengths(Frequencies steps, Frequencies rows)
      : steps_(steps), rows_(rows), width_(rows.size() + 1), before_((steps.size() + 1) * width_),
        behind_(before_.size()) {
    for (std::size_t i = 0; i < steps.size(); ++i) {
      for (std::size_t j = 0; j < rows.size(); ++j) {
        before_[at(i + 1, j + 1)] = alike(i, j)
                                        ? before_[at(i, j)] + 1
                                        : std::max(before_[at(i, j + 1)], before_[at(i + 1, j)]);
      }
    }
    for (std::size_t i = steps.size(); i-- > 0;) {
      for (std::size_t j = rows.size(); j-- > 0;) {
        behind_[at(i, j)] = alike(i, j) ? behind_[at(i + 1, j + 1)] + 1
                                        : std::max(behind_[at(i, j + 1)], behind_[at(i + 1, j)]);
      }
    }
  }

  // Some longest way gives the step this row.
  [[nodiscard]] bool may_have(std::size_t step, std::size_t row) const {
    return alike(step, row) &&
           before_[at(step, row)] + 1 + behind_[at(step + 1, row + 1)] == behind_[at(0, 0)];
  }
  // Some longest way gives the step none.
  [[nodiscard]] bool may_lack(std::size_t step) const {
    for (std::size_t row = 0; row <= rows_.size(); ++row) {
      if (before_[at(step, row)] + behind_[at(step + 1, row)] == behind_[at(0, 0)]) {
        return true;
      }
    }
    return false;
  }

private:
  [[nodiscard]] std::size_t at(std::size_t step, std::size_t row) const {
    return step * width_ + row;
  }
  [[nodiscard]] bool alike(std::size_t step, std::size_t row) const {
    return std::abs(rows_[row] - steps_[step]) <= same_frequency_rel * steps_[step];
  }

  Frequencies steps_;
  Frequencies rows_;
  std::size_t width_;
  std::vector<std::uint32_t> before_;
  std::vector<std::uint32_t> behind_;
};

} // namespace

std::vector<StepRow> align_rows(Frequencies step_frequencies_hz, Frequencies row_frequencies_hz) {
  const CommonLengths lengths(step_frequencies_hz, row_frequencies_hz);
  std::vector<StepRow> result(step_frequencies_hz.size());
  for (std::size_t step = 0; step < result.size(); ++step) {
    std::vector<std::size_t> possible;
    for (std::size_t row = 0; row < row_frequencies_hz.size(); ++row) {
      if (lengths.may_have(step, row)) {
        possible.push_back(row);
      }
    }
    result[step].certain = possible.empty() || (possible.size() == 1 && !lengths.may_lack(step));
    if (!result[step].certain) {
      result[step].possible = std::move(possible);
    } else if (!possible.empty()) {
      result[step].row = possible.front();
    }
  }
  return result;
}

} // namespace dyncal::drivers::tables
