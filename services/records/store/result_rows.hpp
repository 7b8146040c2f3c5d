// The rows of one result in the tables of a store: written together, and removed together. Both
// need a transaction of the caller; fail (bad_file) as databases do. Any thread, as the database.
#pragma once

#include <string>

#include "services/base/error.hpp"
#include "services/records/store/database.hpp"
#include "services/records/store/result_record.hpp"

namespace dyncal::inline records {

[[nodiscard]] Expected<void> insert_result(Database& database, const ResultRecord& record);
[[nodiscard]] Expected<void> remove_result(Database& database, const std::string& result_sha256);

} // namespace dyncal::inline records
