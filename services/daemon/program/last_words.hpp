// What a program says when it cannot go on: one line that names what was missing and the remedy, in
// place of "terminate called after throwing".
//
//   out of memory     MemoryMax of its systemd unit, ulimit -v, or less to do
//   no thread         TasksMax of its systemd unit, or the user's limit (ulimit -u)
//
// These end the program with status 1, wherever they are met: nothing of a program can be trusted
// without memory, and systemd starts it again. Any other exception that nobody caught is an error
// of ours: it is named, and the program aborts, so that there is a dump. A library that aborts
// (Cyclone DDS, where it cannot make a thread) ends the same way, if there is still no thread or no
// memory to be had: both are tried. Nothing is allocated on this way. Call once, before other
// threads start.
#pragma once

#include <string>

namespace dyncal::inline daemon {

void set_last_words(const std::string& program);

} // namespace dyncal::inline daemon
