#include "services/program/last_words.hpp"

#include <csignal>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <gtest/gtest.h>

namespace dyncal::services {
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

TEST(LastWords, LeaveADumpOfWhatIsAnErrorOfOurs) {
  EXPECT_EXIT(throw_in_thread(std::logic_error("two of one name")),
              testing::KilledBySignal(SIGABRT), "^dyncal-acs: two of one name");
}

} // namespace
} // namespace dyncal::services
