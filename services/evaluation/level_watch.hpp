// Notices an exciter that is driven far above the planned level while a step is still excited: a
// level_per_volt that is wrong by a factor, an amplifier whose gain was changed.
//
// The level is the amplitude at the excited step's frequency in the newest window of the reference
// (record/channel_level.hpp); it is looked at once a window. It counts as far above the plan when
// it exceeds twice the highest level that the recipe plans at this frequency, so that samples of
// another step that come late raise no alarm. Of a multi-sine it is the rms of all lines, against
// that of their levels. A reference that shows no acceleration, or a multi-sine as velocity or
// displacement, and steps that nobody announces (recorded files), are not watched: there the result
// carries a flag (method/step_results.cpp).
//
// Belongs to one thread; the recipe must outlive it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/source_record.hpp"

namespace dyncal::inline evaluation {

class LevelWatch {
public:
  static constexpr double max_excess = 2.0; // times the planned level

  explicit LevelWatch(const Recipe& recipe) : recipe_(recipe) {}

  // `reference`: the record of the reference's source; `step`: the one that is excited now.
  // Returns one sentence when the level is far above the plan.
  [[nodiscard]] std::optional<std::string> look(const SourceRecord& reference,
                                                const RecipeStep& step);

private:
  const Recipe& recipe_;
  std::optional<std::int64_t> looked_ns_; // newest stamp when it was looked at last
};

} // namespace dyncal::inline evaluation
