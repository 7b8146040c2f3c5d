// What the kernel reports about one network interface, by rtnetlink: whether it exists, is up and
// connected, and for a CAN controller its state, error counters and bit rates; and the two changes
// that a driver may need: restart after bus-off, down and up.
//
// The interface is known by the name it had at open(). When the kernel renames it, it is followed
// under its new name until it disappears; then the first name is waited for again.
//
// Fails: refused or disconnected, with the kernel's reason. One thread. The descriptor becomes
// readable when update() has something to read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/bus/frame_source.hpp"
#include "drivers/error.hpp"
#include "drivers/link/file_descriptor.hpp"

namespace dyncal::drivers::can {

class LinkMonitor {
public:
  [[nodiscard]] static Expected<LinkMonitor> open(const std::string& interface_name);

  [[nodiscard]] int descriptor() const { return socket_.number(); }
  [[nodiscard]] const LinkState& state() const { return state_; }
  [[nodiscard]] int interface_index() const { return index_; } // 0: not there

  struct Change {
    LinkState state;
    int interface_index = 0;
  };
  // Reads what has come: every change by itself, in its order, so that down and up between two
  // calls are both seen.
  [[nodiscard]] Expected<std::vector<Change>> update();
  // Asks the kernel for everything again.
  [[nodiscard]] Expected<void> ask();

  // After bus-off. Fails (refused) without CAP_NET_ADMIN or where the driver cannot.
  [[nodiscard]] Expected<void> restart_controller();
  [[nodiscard]] Expected<void> set_up(bool up);

private:
  LinkMonitor(std::string name, FileDescriptor socket)
      : wanted_name_(std::move(name)), socket_(std::move(socket)) {
    state_.name = wanted_name_;
  }

  [[nodiscard]] Expected<void> request_links();
  [[nodiscard]] Expected<void> read_messages(bool wait_for_answer);
  void take_message(const void* header);
  [[nodiscard]] Expected<void> change(const void* request, const std::string& what);

  std::string wanted_name_;
  FileDescriptor socket_;
  LinkState state_;
  int index_ = 0;
  std::vector<Change> changes_; // not handed out yet
};

} // namespace dyncal::drivers::can
