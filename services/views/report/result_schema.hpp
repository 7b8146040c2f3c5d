// The schema of result files, result.schema.json, as it is compiled in. Any thread.
#pragma once

namespace dyncal::inline views {

[[nodiscard]] const char* result_schema_text();

} // namespace dyncal::inline views
