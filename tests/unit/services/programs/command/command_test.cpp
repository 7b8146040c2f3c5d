#include "services/programs/command/command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using testing::ElementsAre;

struct TestOptions {
  int status = 3;
};

void add_status(CLI::App& command, TestOptions& options) {
  command.add_option("--status", options.status);
}

Expected<int> run_status(const TestOptions& options) {
  return options.status;
}

Expected<void> run_failure(TestOptions& /*options*/) {
  return fail(ErrorCode::bad_file, "it is not there");
}

Expected<void> run_nothing(const TestOptions& /*options*/) {
  return {};
}

// Not in the order of their places.
const Command inner_command{31, "outer inner", "below another", add_status, run_nothing};
const Command failing_command{20, "failing", "fails", add_status, run_failure};
const Command status_command{10, "status", "has a status of its own", add_status, run_status};
const Command outer_command{30, "outer", "has another below it"};

Expected<int> outcome_of(const std::string& words) {
  CLI::App app;
  Command::Action chosen;
  add_commands(app, chosen);
  app.parse(words);
  return chosen();
}

TEST(Command, AreListedByTheirPlaces) {
  CLI::App app;
  Command::Action chosen;
  add_commands(app, chosen);
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) {
    names.push_back(command->get_name());
  }
  EXPECT_THAT(names, ElementsAre("status", "failing", "outer"));
  EXPECT_EQ(app.get_subcommand("outer")->get_subcommand("inner")->get_description(),
            "below another");
}

TEST(Command, TheChosenOneRunsWithItsOptions) {
  EXPECT_EQ(outcome_of("status"), 3);
  EXPECT_EQ(outcome_of("status --status 4"), 4);
  EXPECT_EQ(outcome_of("outer inner"), 0);
  const auto failed = outcome_of("failing");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "it is not there");
}

TEST(Command, OneWithOthersBelowItNeedsOneOfThem) {
  EXPECT_THROW(static_cast<void>(outcome_of("outer")), CLI::RequiredError);
}

} // namespace
} // namespace dyncal::inline programs
