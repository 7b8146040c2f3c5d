// The generator of a bench, connected with its output off, and the guard that switches the output
// off if the program dies.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "drivers/generator/generator.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/run/output_guard.hpp"

namespace dyncal::inline run {

struct GeneratorConnection {
  std::optional<OutputGuard> guard; // to be dismissed when the output is known to be off
  std::unique_ptr<drivers::generator::Generator> generator;
};

// Shows the operator what to set; for a generator without an interface.
using AskOperator = std::function<void(const std::string& request)>;

// How a run comes by its generator; tests bring one of their own.
using ConnectGenerator =
    std::function<Expected<GeneratorConnection>(const GeneratorSettings&, AskOperator)>;

// By the bench file's driver: SCPI, or set by hand. Fails (device) if there is no instrument at the
// address or the guard cannot be started.
[[nodiscard]] Expected<GeneratorConnection> connect_generator(const GeneratorSettings& settings,
                                                              AskOperator ask);

} // namespace dyncal::inline run
