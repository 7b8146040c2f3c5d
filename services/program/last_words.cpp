#include "services/program/last_words.hpp"

#include <array>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>

#include <unistd.h>

namespace dyncal::services {
namespace {

std::array<char, 64> program_name{};

void write_text(const char* text) {
  static_cast<void>(!write(STDERR_FILENO, text, std::strlen(text)));
}

void say(const char* sentence) {
  write_text(program_name.data());
  write_text(": ");
  write_text(sentence);
  write_text("\n");
}

[[noreturn]] void end_without(const char* sentence) {
  say(sentence);
  _exit(1);
}

[[noreturn]] void say_and_end() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) {
      std::rethrow_exception(thrown);
    }
    say("ended by an error of its own; please report it");
  } catch (const std::bad_alloc&) {
    end_without("out of memory; give it more (MemoryMax of its systemd unit), or less to do");
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again) {
      end_without("no further thread can be made; raise TasksMax of its systemd unit, or the "
                  "user's limit (ulimit -u)");
    }
    say(error.what());
  } catch (const std::exception& error) {
    say(error.what());
  } catch (...) {
    say("ended by an error of its own; please report it");
  }
  std::abort();
}

} // namespace

void set_last_words(const std::string& program) {
  std::strncpy(program_name.data(), program.c_str(), program_name.size() - 1);
  std::set_terminate(say_and_end);
}

} // namespace dyncal::services
