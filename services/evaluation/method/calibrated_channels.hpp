// The channels under calibration of sample time stamping: the recipe's, or, where it names none,
// all of the DAU but sync, temperature and analogue inputs. Plain function; any thread.
#pragma once

#include <vector>

#include "services/contract/channel_name.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/source_record.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] std::vector<ChannelName> calibrated_channels(const Recipe& recipe,
                                                           const SourceRecord& dau);

} // namespace dyncal::inline evaluation
