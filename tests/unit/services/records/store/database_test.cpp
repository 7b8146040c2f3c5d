#include "services/records/store/database.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/records/store/migrations.hpp"
#include "tests/unit/services/records/store/silent_server.hpp"
#include "tests/unit/services/records/store/store_places.hpp"

namespace dyncal::inline records {
namespace {

using testing::HasSubstr;

class DatabaseTest : public tests::StorePlaces {};

TEST_P(DatabaseTest, GivesBackTheSameBits) {
  const auto database = open();
  ASSERT_TRUE(database->execute("CREATE TABLE t (i BIGINT, d DOUBLE PRECISION, s TEXT)"));
  const double tiny = std::numeric_limits<double>::denorm_min();
  for (const double number : {0.1, 1.0 / 3.0, 6.02214076e23, -tiny, 9007199254740993.0}) {
    ASSERT_TRUE(database->execute("DELETE FROM t"));
    ASSERT_TRUE(database->execute(
        "INSERT INTO t (i, d, s) VALUES ($1, $2, $3)",
        {std::int64_t{-9'000'000'000'000'000'001}, number, std::string("μ '\"; DROP TABLE t")}));
    const auto rows = database->execute("SELECT i, d, s FROM t");
    ASSERT_TRUE(rows) << rows.error().message;
    ASSERT_EQ(rows->size(), 1U);
    EXPECT_EQ(integer_of(rows->front()[0]), -9'000'000'000'000'000'001);
    EXPECT_EQ(number_of(rows->front()[1]), number);
    EXPECT_EQ(text_of(rows->front()[2]), "μ '\"; DROP TABLE t");
  }
}

TEST_P(DatabaseTest, KnowsWhatIsNotThere) {
  const auto database = open();
  ASSERT_TRUE(database->execute("CREATE TABLE t (d DOUBLE PRECISION, s TEXT)"));
  ASSERT_TRUE(database->execute("INSERT INTO t (d, s) VALUES ($1, $2)",
                                {std::monostate{}, std::monostate{}}));
  const auto rows = database->execute("SELECT d, s FROM t");
  ASSERT_TRUE(rows && rows->size() == 1);
  EXPECT_TRUE(std::isnan(number_of(rows->front()[0])));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(rows->front()[1]));
}

TEST_P(DatabaseTest, KeepsNothingOfATransactionThatFails) {
  const auto database = open();
  ASSERT_TRUE(database->execute("CREATE TABLE t (i BIGINT PRIMARY KEY)"));
  const auto write = [&](std::int64_t second) {
    return database->transaction([&]() -> Expected<void> {
      for (const std::int64_t i : {std::int64_t{1}, second}) {
        DYNCAL_TRY(database->execute("INSERT INTO t (i) VALUES ($1)", {i}));
      }
      return {};
    });
  };
  const auto failed = write(1);
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message, HasSubstr("the store cannot be used"));
  EXPECT_EQ(integer_of(database->execute("SELECT COUNT(*) FROM t")->front()[0]), 0);
  ASSERT_TRUE(write(2)); // and goes on afterwards
  EXPECT_EQ(integer_of(open()->execute("SELECT COUNT(*) FROM t")->front()[0]), 2);
}

TEST_P(DatabaseTest, MigratesAnOlderDatabaseWithItsRows) {
  const auto database = open();
  ASSERT_TRUE(migrate(*database, 1));
  ASSERT_FALSE(database->execute("SELECT * FROM samples"));
  ASSERT_TRUE(database->execute(
      "INSERT INTO results VALUES ('a','b','c','bench','run','complete','m','','','sw',1,1,'','',"
      "'','','')"));
  ASSERT_TRUE(migrate(*database));
  ASSERT_TRUE(migrate(*database)); // nothing is left to do
  EXPECT_TRUE(database->execute("SELECT * FROM samples"));
  EXPECT_EQ(text_of(database->execute("SELECT bench FROM results")->at(0)[0]), "bench");
  const auto versions = database->execute("SELECT version FROM store_version ORDER BY version");
  ASSERT_EQ(versions->size(), static_cast<std::size_t>(newest_store_version()));
  EXPECT_EQ(integer_of(versions->back()[0]), newest_store_version());
}

TEST_P(DatabaseTest, KeepsPointsAndSamplesOfAStoreWithoutAxes) {
  const auto database = open();
  ASSERT_TRUE(migrate(*database, 2));
  ASSERT_TRUE(database->execute(
      "INSERT INTO results VALUES ('a','b','c','bench','run','complete','m','','','sw',1,1,'','',"
      "'','','')"));
  ASSERT_TRUE(database->execute("INSERT INTO points VALUES ('a','dau','dau/x','80',80,10,'1',"
                                "1,0.1,2,0.2,0,0.1,2,0.2,'')"));
  ASSERT_TRUE(database->execute("INSERT INTO samples VALUES ('a','dau/x',1,1,'hash')"));
  ASSERT_TRUE(migrate(*database));
  const auto points = database->execute("SELECT frequency_hz, excited_axis FROM points");
  ASSERT_TRUE(points && points->size() == 1);
  EXPECT_EQ(number_of(points->front()[0]), 80.0);
  EXPECT_EQ(text_of(points->front()[1]), "");
  const auto samples = database->execute("SELECT data_sha256, attempt FROM samples");
  ASSERT_TRUE(samples && samples->size() == 1);
  EXPECT_EQ(text_of(samples->front()[0]), "hash");
  EXPECT_TRUE(std::holds_alternative<std::monostate>(samples->front()[1])); // not known
  EXPECT_TRUE(database->execute("SELECT * FROM closures")->empty());
}

// Rows of a table: text, key of their result, integer, number, number or NULL.
class DrawnRows {
public:
  [[nodiscard]] std::string text() { return fmt::format("µ'\"\\\n{:x}", random_()); }
  [[nodiscard]] DatabaseRow row(const std::string& types, const std::string& key) {
    DatabaseRow row;
    for (const char type : types) {
      row.push_back(type == 'k' ? DatabaseValue{key} : type == 't' ? text() : number(type));
    }
    return row;
  }

private:
  [[nodiscard]] DatabaseValue number(char type) {
    const auto count = static_cast<std::int64_t>(random_() >> 1);
    if (type == 'i') {
      return count;
    }
    return type == 'n' && count % 5 == 0 ? DatabaseValue{}
                                         : std::ldexp(static_cast<double>(count), -70);
  }

  std::mt19937_64 random_{20};
};

void insert(Database& database, const std::string& table, const DatabaseRow& row) {
  std::string places = "$1";
  for (std::size_t i = 2; i <= row.size(); ++i) {
    places += fmt::format(", ${}", i);
  }
  const auto done = database.execute(fmt::format("INSERT INTO {} VALUES ({})", table, places), row);
  ASSERT_TRUE(done) << table << ": " << done.error().message;
}

// Their first columns.
std::vector<DatabaseRow> rows_of(Database& database, const std::string& table,
                                 std::size_t columns) {
  auto rows = database.execute("SELECT * FROM " + table).value();
  for (DatabaseRow& row : rows) {
    row.resize(columns);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

// Every cell of every row, in the tables that it had.
TEST_P(DatabaseTest, KeepsEveryRowOfTheStoreOfRelease020) {
  constexpr int version_of_release = 3;
  constexpr std::size_t results = 40;
  const std::map<std::string, std::string> tables{{"results", "ktttttttttiittttt"},
                                                  {"sources", "kttttt"},
                                                  {"points", "ktttfntnnnnnnnntt"},
                                                  {"samples", "ktiitnnti"},
                                                  {"closures", "ktttttnnntt"}};
  const auto database = open();
  ASSERT_TRUE(migrate(*database, version_of_release));
  DrawnRows drawn;
  for (std::size_t i = 0; i < results; ++i) {
    const std::string key = drawn.text();
    insert(*database, "results", drawn.row(tables.at("results"), key));
    for (const auto& [table, types] : tables) {
      if (table != "results") {
        insert(*database, table, drawn.row(types, key));
      }
    }
  }
  std::map<std::string, std::vector<DatabaseRow>> before;
  for (const auto& [table, types] : tables) {
    before[table] = rows_of(*database, table, types.size());
    EXPECT_EQ(before[table].size(), results) << table;
  }
  ASSERT_GT(newest_store_version(), version_of_release);
  ASSERT_TRUE(migrate(*database));
  for (const auto& [table, types] : tables) {
    EXPECT_EQ(rows_of(*database, table, types.size()), before[table]) << table;
  }
}

TEST_P(DatabaseTest, LeavesADatabaseOfANewerProgramAlone) {
  const auto database = open();
  ASSERT_TRUE(migrate(*database));
  ASSERT_TRUE(database->execute("INSERT INTO store_version (version) VALUES ($1)",
                                {std::int64_t{newest_store_version() + 1}}));
  const auto refused = migrate(*database);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("made by a newer dyncal"));
}

TEST_P(DatabaseTest, DoesNotWaitForGoodForAServer) {
  if (GetParam() != tests::StoreKind::postgres) {
    GTEST_SKIP() << "a file has no server";
  }
  const auto database = open();
  ASSERT_TRUE(database->execute("SELECT pg_sleep(3)")); // slow, but there
  const auto begun = std::chrono::steady_clock::now();
  const auto failed = database->execute("SELECT pg_sleep(60)");
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message, HasSubstr("has not answered within 10 s"));
  const auto again = database->execute("SELECT 1"); // as a ROLLBACK after it
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().message, failed.error().message);
  const auto taken = std::chrono::steady_clock::now() - begun;
  EXPECT_GE(taken, std::chrono::seconds(9));
  EXPECT_LE(taken, std::chrono::seconds(15));
  EXPECT_TRUE(open()->execute("SELECT 1"));
}

INSTANTIATE_TEST_SUITE_P(, DatabaseTest,
                         testing::Values(tests::StoreKind::sqlite, tests::StoreKind::postgres),
                         tests::kind_name);

TEST(StorePlace, IsAServerByItsForm) {
  EXPECT_TRUE(is_server("postgresql://lab@db/dyncal"));
  EXPECT_TRUE(is_server("postgres://lab@db/dyncal"));
  EXPECT_TRUE(is_server("host=db dbname=dyncal"));
  EXPECT_FALSE(is_server("runs/dyncal.sqlite"));
}

TEST(StorePlace, IsShownWithoutItsPassword) {
  EXPECT_EQ(without_password("postgresql://lab:se:cret@db/dyncal"), "postgresql://lab@db/dyncal");
  EXPECT_EQ(without_password("postgresql://lab:se@c/ret@db/dyncal"), "postgresql://lab@db/dyncal");
  EXPECT_EQ(without_password("host=db password = secret"), "host=db password=...");
  EXPECT_EQ(without_password("host=db password='se cret' dbname=x"),
            "host=db password=... dbname=x");
}

TEST(OpenPostgres, SaysWhatIsWrongWithoutAServer) {
  const auto database = open_postgres("host=/nowhere dbname=x password=secret");
  ASSERT_FALSE(database);
  EXPECT_THAT(database.error().message, HasSubstr("password=..."));
  EXPECT_THAT(database.error().message, testing::Not(HasSubstr("secret")));
}

TEST(OpenPostgres, DoesNotWaitForGoodForAConnection) {
  const SilentServer server;
  const int port = server.port();
  for (const std::string& place :
       {fmt::format("postgresql://lab:a?b@127.0.0.1:{}/dyncal", port),
        fmt::format("host=127.0.0.1 port={} dbname=dyncal user=lab", port),
        fmt::format("postgresql://lab@127.0.0.1:{}/dyncal?connect_timeout=2", port)}) {
    const auto begun = std::chrono::steady_clock::now();
    const auto database = open_postgres(place);
    ASSERT_FALSE(database);
    if (database.error().code == ErrorCode::bad_argument) {
      GTEST_SKIP() << database.error().message;
    }
    EXPECT_THAT(database.error().message, HasSubstr("timeout expired"));
    EXPECT_LE(std::chrono::steady_clock::now() - begun, std::chrono::seconds(10)) << place;
  }
}

TEST(OpenSqlite, RefusesWhatIsNotADatabase) {
  const tests::TemporaryFolder folder;
  const auto database = open_sqlite(folder.write("x.sqlite", std::string(5000, 'x')));
  const auto used = database ? migrate(**database) : Expected<void>(fail(database.error()));
  ASSERT_FALSE(used);
  EXPECT_THAT(used.error().message, HasSubstr("file is not a database"));
  EXPECT_FALSE(open_sqlite("/proc/none/x.sqlite"));
}

} // namespace
} // namespace dyncal::inline records
