#include "services/daemon/program/last_words.hpp"

#include <csignal>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <sys/resource.h>

#include <gtest/gtest.h>

namespace dyncal::inline daemon {
namespace {

// In a thread, where nothing else catches it.
template <class Exception>
void throw_in_thread(const Exception& exception) {
  set_last_words("dyncal-acs");
  std::thread([&] { throw exception; }).join(); // NOLINT(misc-throw-by-value-catch-by-reference)
}

TEST(LastWords, NameTheRemedyWhereMemoryIsMissing) {
  EXPECT_EXIT(throw_in_thread(std::bad_alloc()), testing::ExitedWithCode(1),
              "^dyncal-acs: out of memory; .*MemoryMax");
}

TEST(LastWords, NameTheRemedyWhereNoThreadCanBeMade) {
  EXPECT_EXIT(throw_in_thread(std::system_error(
                  std::make_error_code(std::errc::resource_unavailable_try_again))),
              testing::ExitedWithCode(1), "^dyncal-acs: no further thread .*TasksMax");
}

// As Cyclone DDS does.
TEST(LastWords, NameTheRemedyWhereALibraryAbortsWithoutMemory) {
  const auto abort_without_memory = [] {
    set_last_words("dyncal-acs");
    // At its first signal the thread sanitizer takes memory of its own.
    std::signal(SIGUSR1, [](int /*signal*/) {});
    std::raise(SIGUSR1);
    const rlimit none{0, 0};
    setrlimit(RLIMIT_AS, &none);
    std::abort();
  };
  EXPECT_EXIT(abort_without_memory(), testing::ExitedWithCode(1),
              "^dyncal-acs: out of memory; .*MemoryMax");
}

TEST(LastWords, LeaveADumpOfWhatIsAnErrorOfOurs) {
  EXPECT_EXIT(throw_in_thread(std::logic_error("two of one name")),
              testing::KilledBySignal(SIGABRT), "^dyncal-acs: two of one name");
}

TEST(LastWords, LeaveADumpWhereALibraryAbortsForAnotherReason) {
  const auto abort_with_all_it_needs = [] {
    set_last_words("dyncal-acs");
    std::abort();
  };
  EXPECT_EXIT(abort_with_all_it_needs(), testing::KilledBySignal(SIGABRT), "^$");
}

} // namespace
} // namespace dyncal::inline daemon
