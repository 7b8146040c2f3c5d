// The log of a program: lines of time, program, level and text on standard error.
//
// Written by a thread of its own, no thread that serves a device ever waits for anyone who reads
// the log. Bound: 8192 lines are held. Policy when full: the oldest is discarded; how many were is
// logged with the next line.
#pragma once

#include <string>

namespace dyncal::inline daemon {

enum class LogWriting {
  at_once,  // by the thread that logs
  by_thread // by a thread of the log
};

// Before other threads start. Sets the last words of the program too (last_words.hpp).
void set_up_log(const std::string& program, LogWriting writing = LogWriting::at_once);

// Writes what is held; later lines are written at once. When other threads have ended.
void finish_log();

} // namespace dyncal::inline daemon
