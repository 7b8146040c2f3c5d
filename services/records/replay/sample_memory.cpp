#include "services/records/replay/sample_memory.hpp"

#include <cstdlib>
#include <limits>
#include <malloc.h>
#include <memory>
#include <sys/mman.h>

namespace dyncal::inline records {

void keep_memory_for_samples() {
#ifdef __GLIBC__
  ::mallopt(M_MMAP_MAX, 0);
  ::mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  ::mallopt(M_ARENA_MAX, 1); // one heap for all threads, for memory passes from one to another
  // The heap grows to this size without being touched; asked for now, large pages come when it is.
  constexpr std::size_t size = std::size_t{512} << 20U;
  constexpr std::size_t large_page = std::size_t{2} << 20U;
  void* const room = std::malloc(size);
  void* begin = room;
  std::size_t rest = size;
  if (room != nullptr && std::align(large_page, size - large_page, begin, rest) != nullptr) {
    ::madvise(begin, size - large_page, MADV_HUGEPAGE);
  }
  std::free(room);
#endif
}

} // namespace dyncal::inline records
