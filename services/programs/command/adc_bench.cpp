#include "services/programs/command/adc_bench.hpp"

#include <fmt/core.h>

#include "services/contract/digest.hpp"

namespace dyncal::inline programs {

std::string no_time_scale(const std::string& source) {
  return fmt::format("source '{}' does not stamp in UTC: sync links unrelated clocks only up to a "
                     "delay, and the phase of the ADC is a delay; let both sources stamp in UTC "
                     "(time_base = \"utc\")",
                     source);
}

Expected<void> check_bench_for_adc(const BenchFile& bench, bool sets_amplitude) {
  const std::string path = bench.path.string();
  if (bench.method.kind != EvaluationMethod::sample_timestamping) {
    return fail(ErrorCode::bad_file,
                path + ": the sync ADC is calibrated on a bench of method.kind = "
                       "\"sample-timestamping\", whose DAU records sync in the data-ready path");
  }
  for (const ChannelName& role : {bench.method.sync_acs, bench.method.sync_dau}) {
    const SourceSettings* source = bench.source(role.source);
    if (source != nullptr && source->is<OscilloscopeSourceSettings>()) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{}: source '{}' is an oscilloscope, whose record is placed in time "
                              "by its trigger, and the DAU does not stamp that; calibrate the ADC "
                              "against a system that stamps in UTC",
                              path, role.source));
    }
    const bool may_be_told_by_instrument = source != nullptr && source->is<SocketSourceSettings>();
    if (source != nullptr && source->time_base != drivers::TimeBase::utc &&
        !may_be_told_by_instrument) {
      return fail(ErrorCode::bad_file, no_time_scale(role.source));
    }
  }
  if (bench.excitation.repetitions < 2) {
    return fail(ErrorCode::bad_file, path + ": excitation.repetitions must be at least 2: the "
                                            "scatter of the calibration is found from them");
  }
  if (sets_amplitude && bench.generator.driver == GeneratorDriver::none) {
    return fail(ErrorCode::bad_argument,
                path + ": --amplitudes sets the generator, but the bench has none");
  }
  return {};
}

BenchFile bench_of_adc_pass(const BenchFile& bench, std::optional<double> amplitude_vpp) {
  BenchFile pass = bench;
  pass.method.reference = bench.method.sync_acs;
  pass.method.dut = {bench.method.sync_dau};
  pass.method.temperature.reset();
  pass.corrections.adc.reset();
  pass.generator.level_tolerance_rel.reset(); // the reference may be without excitation
  pass.text += "\n# dyncal calibrate adc: reference = sync_acs, dut = sync_dau, no corrections";
  if (amplitude_vpp) {
    const double level = 0.5 * *amplitude_vpp * bench.generator.level_per_volt;
    pass.excitation.levels_m_s2.assign(bench.excitation.frequencies_hz.size(), level);
    pass.text += fmt::format(", sync {} V peak to peak", *amplitude_vpp);
  }
  pass.text += '\n';
  pass.sha256 = sha256_hex(pass.text);
  return pass;
}

} // namespace dyncal::inline programs
