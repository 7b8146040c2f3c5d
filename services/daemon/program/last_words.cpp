#include "services/daemon/program/last_words.hpp"

#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>

#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace dyncal::inline daemon {
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

[[noreturn]] void end_without_memory() {
  end_without("out of memory; give it more (MemoryMax of its systemd unit, or ulimit -v), or less "
              "to do");
}

// A process counts as a thread does, for TasksMax and for the user's limit. The bare call, since
// the library's own is not safe within a signal.
bool can_make_thread() {
  const long child = syscall(SYS_clone, SIGCHLD, nullptr, nullptr, nullptr, nullptr);
  if (child == 0) {
    _exit(0);
  }
  return child > 0 && waitpid(static_cast<pid_t>(child), nullptr, 0) == child;
}

// As much as the stack of a thread takes, and what glibc reserves for what it will allocate: a
// thread that ended meanwhile may have left room for less.
bool has_memory() {
  constexpr std::size_t bytes = (std::size_t{8} + 64) << 20U;
  void* const found =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return found != MAP_FAILED && munmap(found, bytes) == 0;
}

void end_if_something_lacks() {
  if (!can_make_thread()) {
    end_without("no further thread can be made; raise TasksMax of its systemd unit, or the user's "
                "limit (ulimit -u)");
  }
  if (!has_memory()) {
    end_without_memory();
  }
}

// Of a library that aborts for want of a thread or of memory; otherwise the abort goes on.
void before_abort(int /*signal*/) {
  end_if_something_lacks();
}

[[noreturn]] void say_and_end() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) {
      std::rethrow_exception(thrown);
    }
    say("ended by an error of its own; please report it");
  } catch (const std::bad_alloc&) {
    end_without_memory();
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again) {
      end_if_something_lacks(); // a thread's stack is memory
      end_without("no further thread could be made; raise TasksMax or MemoryMax of its systemd "
                  "unit, or the user's limits (ulimit -u, -v)");
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
  struct sigaction action {};
  action.sa_handler = before_abort;
  sigaction(SIGABRT, &action, nullptr);
}

} // namespace dyncal::inline daemon
