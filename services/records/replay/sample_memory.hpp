// How the C library hands out memory while recorded files are evaluated: columns of a million
// samples come and go with every step, and pages fresh from the system would cost as much as the
// arithmetic on them.
#pragma once

namespace dyncal::inline records {

// Freed memory is kept for what comes next, and most of it lies in pages of 2 MB where the system
// has such. For the whole process, for good: call it once, before samples are read. Nothing but
// speed depends on it; does nothing without glibc.
void keep_memory_for_samples();

} // namespace dyncal::inline records
