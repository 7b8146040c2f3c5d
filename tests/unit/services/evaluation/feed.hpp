// Hands messages of the contract to an evaluation or a record, as the analysis service does.
#pragma once

#include "idl/dyncal.h"
#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/triggered_record.hpp"
#include "services/evaluation/run_evaluator.hpp"

namespace dyncal::tests {

inline base::Expected<void> describe(evaluation::RunEvaluator& evaluator,
                                     const wire::SourceDescription& description) {
  return evaluator.describe(description.source().to_string(), dyncal::from_message(description));
}

inline void feed(evaluation::RunEvaluator& evaluator, const wire::SampleBlock& block) {
  evaluator.add(block.source().to_string(), contract::view_block(block));
}

// One of another run is left out.
inline void feed(evaluation::RunEvaluator& evaluator, const wire::TriggeredRecord& record) {
  if (record.run() == evaluator.recipe().run) {
    evaluator.add(record.source().to_string(), dyncal::from_message(record));
  }
}

inline bool feed(evaluation::SourceRecord& record, const wire::SampleBlock& block) {
  return record.add(contract::view_block(block));
}

} // namespace dyncal::tests
