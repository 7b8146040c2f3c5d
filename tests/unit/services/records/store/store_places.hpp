// Databases for tests that hold for every kind of database: a fresh one for each test, of a file or
// of a server that all tests of the program share. Tests of servers are skipped, with the reason,
// where there is none.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "services/records/store/database.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/store/postgres_server.hpp"

namespace dyncal::tests {

enum class StoreKind { sqlite, postgres };

inline std::string kind_name(const testing::TestParamInfo<StoreKind>& info) {
  return info.param == StoreKind::sqlite ? "Sqlite" : "Postgres";
}

class StorePlaces : public testing::TestWithParam<StoreKind> {
protected:
  void SetUp() override {
    if (GetParam() == StoreKind::postgres) {
      static std::string missing;
      if (!server() && missing.empty()) {
        server() = PostgresServer::start(missing);
      }
      if (!server()) {
        GTEST_SKIP() << missing;
      }
      const auto refused = records::open_postgres("dbname=none host=/nowhere");
      if (!refused && refused.error().code == base::ErrorCode::bad_argument) {
        GTEST_SKIP() << refused.error().message;
      }
      place_ = server()->fresh_place();
    } else {
      place_ = (folder_.path() / "dyncal.sqlite").string();
    }
  }
  [[nodiscard]] std::unique_ptr<records::Database> open() const {
    auto database =
        records::is_server(place_) ? records::open_postgres(place_) : records::open_sqlite(place_);
    EXPECT_TRUE(database) << database.error().message;
    return database ? std::move(*database) : nullptr;
  }
  static void TearDownTestSuite() { server().reset(); }

  TemporaryFolder folder_;
  std::string place_;

private:
  static std::unique_ptr<PostgresServer>& server() {
    static std::unique_ptr<PostgresServer> one;
    return one;
  }
};

} // namespace dyncal::tests
