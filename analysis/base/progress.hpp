// How far a long computation is, told to whoever wants to know: the share of it that is done, from
// 0 to 1, never falling. Called in the thread of the computation, after some milliseconds of work
// each; empty: nobody wants to know. It changes no result and cannot stop anything.
#pragma once

#include <functional>

namespace dyncal::analysis {

using Progress = std::function<void(double share)>;

} // namespace dyncal::analysis
