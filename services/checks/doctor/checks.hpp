// The judges: what was observed becomes findings. Each looks at one thing and gives at least one
// finding unless it says otherwise, so that a report shows what was looked at. Plain functions, any
// thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/base/finding.hpp"
#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline checks::doctor {

struct HostView;
struct LaboratoryView;

// Who is there: programs and an analysis service, versions of software and contract, clocks.
[[nodiscard]] Findings check_programs(const LaboratoryView& view);

// Every source: state, losses, buffer, twins, and whether its service has read the same bench file
// as the others of its bench and as `bench`, if one is given.
[[nodiscard]] Findings check_sources(const LaboratoryView& view,
                                     const std::optional<BenchFile>& bench);

// Programs that write samples on a bench and describe no source there. Nothing where none does.
[[nodiscard]] Findings check_writers(const LaboratoryView& view);

// The guards of exciters: whether one is there that has the address of the generator of `bench`,
// if one is given, and whether an output may be on that a guard cannot switch off.
[[nodiscard]] Findings check_guards(const LaboratoryView& view,
                                    const std::optional<BenchFile>& bench);

// Writers and readers of the contract's topics that have one another's topic and do not match, and
// why: type, QoS (qos_mismatch.hpp), partition.
[[nodiscard]] Findings check_endpoints(const LaboratoryView& view,
                                       const std::vector<std::string>& benches);

// What the network between the hosts lets through, as far as it shows: multicast, unicast of
// discovery, samples.
[[nodiscard]] Findings check_network(const LaboratoryView& view);

// Whether all participants have the implementation of this program, and what that means for
// --vendors. Nothing where others are there and may be.
[[nodiscard]] Findings check_vendors(const LaboratoryView& view, bool is_said_to_be_one);

// What is lost on the way to every program that answers, and back.
[[nodiscard]] Findings check_loss(const LaboratoryView& view);

// This host: buffers, MTU, sockets, room for results.
[[nodiscard]] Findings check_host(const HostView& host, int domain);

// Whether a partition's name, which may be a pattern, matches that of the other side. Two patterns
// do not match.
[[nodiscard]] bool partitions_match(const std::string& first, const std::string& second);

} // namespace dyncal::inline checks::doctor
