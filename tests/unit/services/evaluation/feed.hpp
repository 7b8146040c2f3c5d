// Hands messages of the contract to an evaluation or a record, as the analysis service does.
#pragma once

#include "idl/dyncal.h"
#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/triggered_record.hpp"
#include "services/evaluation/run_evaluator.hpp"

namespace dyncal::tests {

inline services::Expected<void> describe(services::RunEvaluator& evaluator,
                                         const wire::SourceDescription& description) {
  return evaluator.describe(description.source().to_string(), services::from_message(description));
}

inline void feed(services::RunEvaluator& evaluator, const wire::SampleBlock& block) {
  evaluator.add(block.source().to_string(), services::view_block(block));
}

// One of another run is left out.
inline void feed(services::RunEvaluator& evaluator, const wire::TriggeredRecord& record) {
  if (record.run() == evaluator.recipe().run) {
    evaluator.add(record.source().to_string(), services::from_message(record));
  }
}

inline bool feed(services::SourceRecord& record, const wire::SampleBlock& block) {
  return record.add(services::view_block(block));
}

} // namespace dyncal::tests
