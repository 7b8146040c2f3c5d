// Changes of the interfaces of a network namespace that belongs to the test alone.
#include "services/daemon/program/network_changes.hpp"

#include <gtest/gtest.h>
#include <net/if.h>
#include <sched.h>
#include <string>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace dyncal::inline daemon {
namespace {

// The kernel has announced it when this returns.
void set_loopback(bool up) {
  const int any = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  std::string("lo").copy(request.ifr_name, IFNAMSIZ - 1);
  ASSERT_EQ(ioctl(any, SIOCGIFFLAGS, &request), 0);
  request.ifr_flags =
      static_cast<short>(up ? request.ifr_flags | IFF_UP : request.ifr_flags & ~IFF_UP);
  ASSERT_EQ(ioctl(any, SIOCSIFFLAGS, &request), 0);
  close(any);
}

TEST(NetworkChanges, AreAnnouncedOnceAndNothingElseIs) {
  bool may_unshare = true;
  std::thread([&] { // the namespace is the thread's
    may_unshare = unshare(CLONE_NEWNET) == 0;
    if (!may_unshare) {
      return;
    }
    NetworkChanges changes;
    EXPECT_FALSE(changes.any());
    for (const bool up : {true, false, true}) {
      set_loopback(up); // and with it, its address
      EXPECT_TRUE(changes.any()) << up;
      EXPECT_FALSE(changes.any()) << up;
    }
  })
      .join();
  if (!may_unshare) {
    GTEST_SKIP() << "a network of its own needs root";
  }
}

TEST(NetworkChanges, AreAssumedWhereMoreWasAnnouncedThanTheKernelKeeps) {
  bool may_unshare = true;
  std::thread([&] {
    may_unshare = unshare(CLONE_NEWNET) == 0;
    if (!may_unshare) {
      return;
    }
    NetworkChanges changes;
    for (int times = 0; times < 2000; ++times) {
      set_loopback(times % 2 == 0);
    }
    EXPECT_TRUE(changes.any());
    while (changes.any()) { // until all are read
    }
    set_loopback(true);
    EXPECT_TRUE(changes.any());
  }).join();
  if (!may_unshare) {
    GTEST_SKIP() << "a network of its own needs root";
  }
}

} // namespace
} // namespace dyncal::inline daemon
