#include "services/daemon/program/command_line.hpp"

#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/daemon/program/completion.hpp"

namespace dyncal::inline daemon {
namespace {

using testing::HasSubstr;

struct Program {
  CLI::App app{"Tries command lines.", "dyncal-try"};
  std::string bench;
  std::string filter;
  int domain = 0;
  unsigned seed = 0;
  std::string json;
  double level = 0.0;
  double offset = 0.0;

  Program() {
    app.require_subcommand(1);
    CLI::App* run = app.add_subcommand("run", "run it");
    run->add_option("BENCH.toml", bench, "bench file")->required();
    run->add_option("--domain", domain, "DDS domain")->check(CLI::Range(0, 232));
    run->add_option("--seed", seed, "of the noise");
    run->add_option("--json", json, "file's name");
    run->add_option("--level", level, "amplitude")->check(CLI::PositiveNumber);
    run->add_option("--offset", offset, "of it")->check(CLI::NonNegativeNumber);
    run->add_option("--filter", filter, "kind of filter")->check(CLI::IsMember({"fir", "iir"}));
    CLI::App* calibrate = app.add_subcommand("calibrate", "an instrument");
    calibrate->require_subcommand(1);
    calibrate->add_subcommand("adc", "of a DAU");
    app.add_subcommand("hidden", "not for people")->group("");
  }

  Expected<bool> parse(const std::vector<const char*>& words) {
    std::vector<const char*> argv{"dyncal-try"};
    argv.insert(argv.end(), words.begin(), words.end());
    return parse_command_line(app, static_cast<int>(argv.size()), argv.data());
  }
};

std::string problem(const std::vector<const char*>& words) {
  Program program;
  const auto parsed = program.parse(words);
  EXPECT_FALSE(parsed.has_value());
  return parsed ? "" : parsed.error().message;
}

TEST(CommandLine, GoodOneGoesOn) {
  Program program;
  EXPECT_EQ(program.parse({"run", "a.toml", "--domain", "7"}).value_or(false), true);
  EXPECT_EQ(program.domain, 7);
}

TEST(CommandLine, ANumberThatIsTooSmallIsNamedWithWhatItMayBe) {
  EXPECT_EQ(problem({"run", "a.toml", "--level", "-1"}), "invalid --level = -1: must be above 0");
  EXPECT_EQ(problem({"run", "a.toml", "--level", "0"}), "invalid --level = 0: must be above 0");
  EXPECT_EQ(problem({"run", "a.toml", "--offset", "-1"}),
            "invalid --offset = -1: must be 0 or more");
  // By CLI11 of Debian 12 and 13.
  EXPECT_THAT(problem({"run", "a.toml", "--domain", "233"}),
              testing::AnyOf("--domain: Value 233 not in range 0 to 232",
                             "--domain: Value 233 not in range [0 - 232]"));
}

TEST(CommandLine, UnknownCommand) {
  EXPECT_EQ(problem({"rum", "a.toml"}),
            "unknown command 'dyncal-try rum'; did you mean 'dyncal-try run'?");
  EXPECT_EQ(problem({"xyzzy"}),
            "unknown command 'dyncal-try xyzzy'; 'dyncal-try --help' lists all");
  EXPECT_EQ(problem({"calibrate", "adx"}),
            "unknown command 'dyncal-try calibrate adx'; did you mean 'dyncal-try calibrate adc'?");
  EXPECT_EQ(problem({"hiddn"}),
            "unknown command 'dyncal-try hiddn'; 'dyncal-try --help' lists all");
}

TEST(CommandLine, UnknownOption) {
  EXPECT_EQ(problem({"run", "x", "--domian", "77"}),
            "unknown option '--domian' of 'dyncal-try run'; did you mean '--domain'?");
  EXPECT_EQ(problem({"run", "x", "--domian=77"}),
            "unknown option '--domian' of 'dyncal-try run'; did you mean '--domain'?");
  EXPECT_EQ(problem({"run", "x", "--xyzzyx"}),
            "unknown option '--xyzzyx' of 'dyncal-try run'; 'dyncal-try run --help' lists all");
  EXPECT_EQ(problem({"run", "x", "y"}), "'y' is one argument too many for 'dyncal-try run'");
}

TEST(CommandLine, WhatIsMissingOrCannotBe) {
  EXPECT_EQ(problem({}), "a command is missing; 'dyncal-try --help' lists all");
  EXPECT_EQ(problem({"run"}), "BENCH.toml is missing; see 'dyncal-try run --help'");
  EXPECT_EQ(problem({"run", "x", "--json"}), "--json needs a value; see 'dyncal-try run --help'");
  EXPECT_EQ(problem({"run", "x", "--seed", "abc"}),
            "invalid --seed = abc: must be a whole number, 0 or more");
  EXPECT_THAT(problem({"run", "x", "--domain", "300"}), HasSubstr("--domain"));
}

TEST(CommandLine, EverySentenceIsOneLine) {
  for (const auto& words : std::vector<std::vector<const char*>>{{},
                                                                 {"rum"},
                                                                 {"run", "--"},
                                                                 {"run", "x", "--domain", "a\nb"},
                                                                 {"--print-completion", "no"}}) {
    EXPECT_EQ(problem(words).find('\n'), std::string::npos);
  }
}

TEST(CommandLine, ListsItsCommandsButHiddenOnes) {
  Program program;
  testing::internal::CaptureStdout();
  EXPECT_EQ(program.parse({"--print-commands"}).value_or(true), false);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "dyncal-try\tTries command lines.\n"
                                                    "dyncal-try run\trun it\n"
                                                    "dyncal-try calibrate\tan instrument\n"
                                                    "dyncal-try calibrate adc\tof a DAU\n");
}

TEST(CommandLine, CompletionOfThreeShells) {
  const Program program;
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const auto script = completion_script(program.app, shell);
    ASSERT_TRUE(script.has_value()) << shell;
    EXPECT_THAT(*script, HasSubstr("--complete")) << shell;
  }
  EXPECT_THAT(completion_script(program.app, "tcsh").error().message,
              HasSubstr("there is for bash, zsh and fish"));
}

TEST(CommandLine, OffersWhatFitsBehindItsWords) {
  const Program program;
  const auto offers = [&](const std::vector<std::string>& words) {
    return completion_offers(program.app, words);
  };
  EXPECT_EQ(offers({""}), "run\trun it\ncalibrate\tan instrument\n");
  EXPECT_EQ(offers({}), offers({""}));
  EXPECT_EQ(offers({"calibrate", ""}), "adc\tof a DAU\n");
  EXPECT_THAT(offers({"run", "--"}), HasSubstr("--seed\tof the noise\n"));
  EXPECT_EQ(offers({"run", ""}), "/*.toml\tfiles\n");
  EXPECT_EQ(offers({"run", "--json", "x"}), "/*\tfiles\n");
  EXPECT_EQ(offers({"run", "--json", "=", "x"}), "/*\tfiles\n");
  EXPECT_EQ(offers({"run", "--json", "="}), "/*\tfiles\n");
  EXPECT_EQ(offers({"run", "--filter", "f"}), "fir\tkind of filter\niir\tkind of filter\n");
  EXPECT_EQ(offers({"run", "--filter=f"}),
            "--filter=fir\tkind of filter\n--filter=iir\tkind of filter\n");
}

} // namespace
} // namespace dyncal::inline daemon
