// The tables of the store, as a list of changes from version to version.
//
// A released change is never edited: another is added behind it. Table `store_version` holds the
// number of changes that a database has. A database of a newer dyncal is left alone and refused
// (bad_file). All changes that are missing are one transaction.
#pragma once

#include <memory>
#include <string>

#include "services/base/error.hpp"
#include "services/records/store/database.hpp"

namespace dyncal::inline records {

[[nodiscard]] int newest_store_version();

// A file or a server (database.hpp), with all tables.
[[nodiscard]] Expected<std::unique_ptr<Database>> open_migrated(const std::string& place);

// Brings the database to `version`; does nothing when it is there already.
[[nodiscard]] Expected<void> migrate(Database& database, int version = newest_store_version());

} // namespace dyncal::inline records
