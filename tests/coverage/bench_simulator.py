"""Draws one calibration: what a laboratory's instruments would have recorded of a sensor whose
transfer function is known, with every error that the bench file states drawn from its stated
uncertainty, and with the faults that are asked for.

    H(f) = |H|(f) e^{-2 pi i f tau}     of the sensor: output over acceleration; a delay is negative

Everything happens in one true time (seconds from 0 on). Each instrument then has its own:
- ACS: equidistant stamps from an epoch of its own, rate off by some 1e-7; records the reference
  (relative error of magnitude and phase drawn anew at every frequency, the same in all repetitions)
  and sync.
- DAU: UTC stamps on a lattice of 9.26 ns at the sensor's own, irregular sample instants; records
  the sensor, and sync through an ADC whose lag is known from a calibration with an error.
- Oscilloscope and series sensor (series time stamping): a trace of sync about every trigger, and a
  series that begins with the trigger output.

Errors that a bench file states are drawn independently from frequency to frequency, so that
results of different frequencies are independent of each other and a binomial bound holds.
"""

import collections
import dataclasses
import math

import numpy as np

import bench_files
import disturbances

DAU_EPOCH_NS = 1_700_000_000_123_456_789
ACS_EPOCH_NS = 5_000_000_000
DAU_TICK_NS = 1e9 / 108e6
ADC_GAIN, ADC_DELAY_S, ADC_STEP_V = 0.16625, 0.468e-6, 20.0 / 4096
DSO_DELAY_S, U_DSO_DELAY_S = 236e-9, 1e-9
STANDARD_GRAVITY = 9.80665
RAMP_S = 0.02
FAULT_SEED = 77
ACS_SEED = 78
CLOCK_SEED = 79
SYNC_RATE_HZ = 2000.0
U_CLOCK_OF_SYNC_S = 1e-9  # stated of the clocks that the sensor's is compared with


@dataclasses.dataclass
class Step:
    """One excitation, in true time: reference and sync as they are, not as they are recorded."""

    frequency_text: str
    frequency_hz: float
    repetition: int
    begin_s: float
    end_s: float
    amplitude: float
    phase_rad: float  # of the acceleration at begin_s
    sync_phase_rad: float
    magnitude: float  # of the sensor in this repetition
    delay_rad: float

    def evaluated_s(self, settings):
        """About what is evaluated: a reader may choose other ends by a frame."""
        begin_s = self.begin_s + settings.settling_s + RAMP_S
        return begin_s, begin_s + settings.duration_s


@dataclasses.dataclass
class Truth:
    magnitude: dict  # by frequency as text
    phase_rad: dict
    sample_rate_hz: float  # NaN where no sensor has a clock of its own
    lost: dict  # samples that were lost in the evaluated part, by (frequency as text, repetition)
    repetitions: int


def magnitude_of_sensor(frequency_hz):
    """Flat, then falling: a low pass of first order, without its phase."""
    return 0.97 / math.hypot(1.0, frequency_hz / 900.0)


class Calibration:
    """All series of one calibration. `write` leaves them in a folder, with the bench file."""

    def __init__(self, settings, seed):
        self.settings = settings
        self.rng = np.random.default_rng(seed)
        self.delay_s = 1.5e-3 + 1e-4 * self.rng.standard_normal()
        self.sensor_rate_hz = settings.sensor_rate_hz * (
            1.0 + settings.sensor_rate_scatter_rel * self.rng.standard_normal()
        )
        self.mains_hz = settings.mains_hz * (1.0 + 2e-4 * self.rng.standard_normal())
        self.generator_error = settings.generator_error_rel * self.rng.uniform(-1.0, 1.0)
        self.reference_error = {}  # by frequency as text: relative magnitude, phase
        self.adc_lag_error_rad = {}
        for text in settings.frequencies:
            draw = self.rng.standard_normal(3)
            self.reference_error[text] = (
                settings.u_reference_magnitude_rel * draw[0],
                settings.u_reference_phase_rad * draw[1],
            )
            self.adc_lag_error_rad[text] = settings.u_adc_lag_rad * draw[2]
        of_acs = np.random.default_rng([ACS_SEED, *np.atleast_1d(seed)])
        self.acs_delay_s = {  # of the reference behind the other channels
            text: settings.u_acs_delay_s * of_acs.standard_normal()
            for text in settings.frequencies
        }
        self.clock_rng = np.random.default_rng([CLOCK_SEED, *np.atleast_1d(seed)])
        self.steps = self._plan()
        self.end_s = self.steps[-1].end_s + settings.pause_s
        self.lost = collections.Counter()
        # Drawn apart, so that a class draws the same calibrations with and without its fault.
        self.fault = settings.fault(self, np.random.default_rng([FAULT_SEED, *np.atleast_1d(seed)]))

    def real_frequency_hz(self, text):
        """A generator is never exactly where it was told to be."""
        return float(text) * (1.0 + self.generator_error)

    def _plan(self):
        steps, now_s = [], self.settings.pause_s
        for repetition in range(1, self.settings.repetitions + 1):
            for text in self.settings.frequencies:
                frequency_hz = self.real_frequency_hz(text)
                # Four frames of the search for excitation: none of them need be evaluated.
                margin_s = 0.2 + 4.0 * max(1.0 / frequency_hz, min(0.1, 50.0 / frequency_hz))
                end_s = now_s + self.settings.settling_s + self.settings.duration_s + margin_s
                scatter = self.settings.run_scatter_rel * self.rng.standard_normal(2)
                steps.append(
                    Step(
                        frequency_text=text,
                        frequency_hz=frequency_hz,
                        repetition=repetition,
                        begin_s=now_s,
                        end_s=end_s,
                        amplitude=self.settings.level_m_s2 * self.settings.level_factor,
                        phase_rad=self.rng.uniform(0.0, 2.0 * np.pi),
                        sync_phase_rad=self.rng.uniform(0.0, 2.0 * np.pi),
                        magnitude=magnitude_of_sensor(frequency_hz) * (1.0 + scatter[0]),
                        delay_rad=2.0 * np.pi * frequency_hz * self.delay_s - scatter[1],
                    )
                )
                now_s = end_s + self.settings.pause_s
        return steps

    def truth(self):
        turned_rad = 0.0 if self.settings.sensor_sign > 0.0 else np.pi
        real_hz = {text: self.real_frequency_hz(text) for text in self.settings.frequencies}
        return Truth(
            magnitude={text: magnitude_of_sensor(f) for text, f in real_hz.items()},
            phase_rad={
                text: turned_rad - 2.0 * np.pi * f * self.delay_s for text, f in real_hz.items()
            },
            sample_rate_hz=math.nan if self.settings.method == "analogue" else self.sensor_rate_hz,
            lost=self.lost,
            repetitions=self.settings.repetitions,
        )

    # Signals in true time.

    def _steps_in(self, times_s):
        for step in self.steps:
            first, behind = np.searchsorted(times_s, [step.begin_s, step.end_s])
            yield step, slice(first, behind)

    @staticmethod
    def _envelope(step, times_s):
        ramp = np.minimum(times_s - step.begin_s, step.end_s - times_s) / RAMP_S
        return np.clip(ramp, 0.0, 1.0)

    def _excitation(self, step, times_s, lag_rad=0.0, more_harmonics=()):
        """Acceleration in parts of its amplitude, with harmonics, late by a phase."""
        turn = 2.0 * np.pi * step.frequency_hz * (times_s - step.begin_s) + step.phase_rad
        signal = np.sin(turn - lag_rad)
        for harmonics in (self.settings.harmonics_rel, more_harmonics):
            for number, part in enumerate(harmonics, 2):
                signal = signal + part * np.sin(number * (turn - lag_rad) + 0.4 * number)
        return self.fault.exciter(step, times_s, self._envelope(step, times_s) * signal)

    def reference_response(self, frequency_hz):
        """What its channel reads over what is: magnitude, phase as lead."""
        if not self.settings.calibrated_reference:
            return 1.0, 0.0
        return 1.0 + 2e-5 * frequency_hz, -1e-4 * frequency_hz

    def _reference(self, times_s):
        s = self.settings
        noise = s.reference_noise_rel * s.level_m_s2 * s.level_factor
        values = noise * self.rng.standard_normal(times_s.size)
        for step, part in self._steps_in(times_s):
            magnitude_error, phase_error = self.reference_error[step.frequency_text]
            magnitude, phase_rad = self.reference_response(float(step.frequency_text))
            read = step.amplitude * magnitude * (1.0 + magnitude_error)
            delay_rad = 2.0 * np.pi * step.frequency_hz * self.acs_delay_s[step.frequency_text]
            values[part] += read * self._excitation(
                step, times_s[part], lag_rad=delay_rad - phase_error - phase_rad
            )
            limit = s.reference_range_rel * step.amplitude
            values[part] = disturbances.over_range(values[part], -limit, limit)
        if s.reference_not_measured_rel:
            values = disturbances.not_measured(values, s.reference_not_measured_rel, self.rng)
            self._count_lost(times_s, np.isfinite(values))
        return self.fault.reference(times_s, values)

    def _sync(self, times_s, volts, lag_s=0.0):
        s = self.settings
        values = s.sync_noise_rel * volts * self.rng.standard_normal(times_s.size)
        values += disturbances.hum(
            times_s, s.sync_hum_rel * volts, self.mains_hz, self.rng.uniform(0.0, 2.0 * np.pi)
        )
        for step, part in self._steps_in(times_s):
            angular = 2.0 * np.pi * step.frequency_hz
            turn = angular * (times_s[part] - step.begin_s - lag_s) + step.sync_phase_rad
            values[part] += volts * self._envelope(step, times_s[part]) * np.sin(turn)
        return self.fault.sync(times_s, values, volts)

    def _sensor(self, times_s):
        s = self.settings
        level = s.level_m_s2 * s.level_factor * magnitude_of_sensor(float(s.frequencies[0]))
        values = s.sensor_noise_rel * level * self.rng.standard_normal(times_s.size)
        values += s.sensor_offset_rel * level + (STANDARD_GRAVITY if s.gravity else 0.0)
        values += disturbances.hum(
            times_s, s.sensor_hum_rel * level, self.mains_hz, self.rng.uniform(0.0, 2.0 * np.pi)
        )
        values = disturbances.over_range(values, -s.sensor_range_m_s2, s.sensor_range_m_s2)
        for step, part in self._steps_in(times_s):
            values[part] = self._sensor_in_step(step, times_s[part], values[part])
        if s.resolution_rel:
            values = disturbances.resolved(values, s.resolution_rel * level)
        return self.fault.sensor(times_s, values)

    def sensor_signal(self, step, times_s):
        """What the sensor should say, without noise and offset, in its unit."""
        return self.settings.sensor_sign * step.amplitude * step.magnitude * self._excitation(
            step,
            times_s,
            step.delay_rad + self.fault.sensor_lag_rad(step, times_s),
            self.settings.sensor_harmonics_rel,
        )

    def _sensor_in_step(self, step, times_s, quiet):
        s = self.settings
        amplitude = step.amplitude * step.magnitude
        values = quiet + self.sensor_signal(step, times_s)
        if s.drift_rel:
            of_step = (step.end_s - step.begin_s) / s.duration_s
            values += disturbances.slow_drift(times_s, of_step * s.drift_rel * amplitude, self.rng)
        limit = min(s.sensor_range_m_s2, s.sensor_range_rel * amplitude)
        values = disturbances.over_range(values, -limit, limit)
        if s.stuck_samples:
            middle = values.size // 2 + self.rng.integers(-values.size // 8, values.size // 8)
            values = disturbances.stuck(values, middle, s.stuck_samples)
        if s.not_measured_rel:
            values = disturbances.not_measured(values, s.not_measured_rel, self.rng)
        return values

    # Records.

    def _write_acs(self, folder):
        s = self.settings
        stamps_ns = np.round(np.arange(0.0, self.end_s * s.acs_rate_hz) * 1e9 / s.acs_rate_hz)
        utc = s.method == "absolute-time"
        rate_error = 0.0 if utc else s.acs_rate_error_rel * self.rng.standard_normal()
        times_s = stamps_ns * 1e-9 * (1.0 + rate_error)
        epoch_ns = DAU_EPOCH_NS if utc else ACS_EPOCH_NS
        columns = {"t_ns": stamps_ns.astype(np.int64) + epoch_ns, "ref": self._reference(times_s)}
        if s.method == "analogue":
            columns["dut"] = self._sensor(times_s)
        elif s.method != "absolute-time":
            columns["sync"] = self._sync(times_s, 5.0)
        bench_files.write_record(folder / "acs.npy", self.fault.acs_record(times_s, columns))

    def _sensor_instants(self):
        """True time of each sample: intervals scatter by 20 ns about their mean."""
        mean_s = 1.0 / self.sensor_rate_hz
        if self.settings.regular_stamps:
            return mean_s * np.arange(1, int(self.end_s / mean_s))
        intervals_s = mean_s + 20e-9 * self.rng.standard_normal(int(self.end_s / mean_s))
        # The mean over the record is the rate that counts as true.
        intervals_s += mean_s - np.mean(intervals_s)
        return np.cumsum(intervals_s)

    def _clock_offset_ns(self, times_s):
        """Of the clock that stamps the sensor; one for each step where it counts."""
        if not self.settings.u_stamp_s:
            return 150.0 * self.rng.standard_normal()
        half_pause_s = 0.5 * self.settings.pause_s
        borders_s = [step.end_s + half_pause_s for step in self.steps[:-1]]
        of_steps = 1e9 * self.settings.u_stamp_s * self.clock_rng.standard_normal(len(self.steps))
        return of_steps[np.searchsorted(borders_s, times_s)]

    def _write_sync_alone(self, folder):
        """The DAU of a sensor that stamps by itself: on the same time scale, at another rate."""
        times_s = np.arange(0.0, self.end_s, 1.0 / SYNC_RATE_HZ)
        sync = ADC_GAIN * self._sync(times_s, 5.0, ADC_DELAY_S)
        columns = {
            "t_ns": np.round(times_s * 1e9).astype(np.int64) + DAU_EPOCH_NS,
            "sync": disturbances.resolved(sync, ADC_GAIN * ADC_STEP_V),
        }
        bench_files.write_record(folder / "dau.npy", columns)

    def _write_sensor(self, folder):
        """With sync, or where the sensor stamps by itself without it."""
        s = self.settings
        times_s = self._sensor_instants()
        offset_ns = self._clock_offset_ns(times_s)
        captured_ns = times_s * 1e9 + offset_ns + 10.0 * self.rng.standard_normal(times_s.size)
        if s.regular_stamps:
            captured_ns, tick_ns = times_s * 1e9, 1.0
        else:
            tick_ns = DAU_TICK_NS
        ticks_ns = np.round(np.round(captured_ns / tick_ns) * tick_ns).astype(np.int64)
        columns = {"t_ns": ticks_ns + DAU_EPOCH_NS, "dos": self._sensor(times_s)}
        if s.method == "sample-timestamping" and not s.own_clock:
            sync = ADC_GAIN * self._sync(times_s, 5.0, ADC_DELAY_S)
            columns["sync"] = disturbances.resolved(sync, ADC_GAIN * ADC_STEP_V)
        if s.records_sample_numbers:
            columns["sample_number"] = np.arange(times_s.size) + 1
        kept = disturbances.lost_samples(times_s.size, s.lost_rel, self.rng)
        arrives = np.isin(np.arange(times_s.size), kept) & np.isfinite(columns["dos"])
        self._count_lost(times_s, arrives)
        columns = {name: values[kept] for name, values in columns.items()}
        if s.disordered_stamps:
            faults = s.disordered_stamps * len(self.steps)
            columns["t_ns"] = disturbances.disordered_stamps(columns["t_ns"], faults, self.rng)
        columns = self.fault.dau_record(times_s[kept], columns)
        name = "sensor.npy" if s.own_clock else "dau.npy"
        bench_files.write_record(folder / name, columns)

    def _count_lost(self, times_s, arrives):
        for step in self.steps:
            first, behind = np.searchsorted(times_s, step.evaluated_s(self.settings))
            lost = int(np.count_nonzero(~arrives[first:behind]))
            self.lost[step.frequency_text, step.repetition] += lost

    def _write_shots(self, folder):
        s = self.settings
        for part in ("dso", "tss"):
            (folder / part).mkdir()
        for number, step in enumerate(self.steps, 1):
            delay_s = DSO_DELAY_S + U_DSO_DELAY_S * self.rng.standard_normal()
            dso_rate = 1.0 + self.rng.uniform(-s.dso_rate_rel, s.dso_rate_rel)
            for shot in range(1, s.shots + 1):
                name = f"step-{number}-shot-{shot}.csv"
                sync_rad = s.trigger_noise_rad * self.rng.standard_normal()
                self._write_trace(folder / "dso" / name, step, sync_rad, dso_rate)
                self._write_series(folder / "tss" / name, step, sync_rad, delay_s)

    def _write_trace(self, path, step, sync_rad, dso_rate):
        """Some periods of sync, of two or more at least 40 ms, a tenth of it before the trigger."""
        s = self.settings
        samples = 800
        least_s = 0.04 if s.trace_periods >= 2.0 else 0.0
        interval_s = max(s.trace_periods / step.frequency_hz, least_s) / samples
        first_s = -samples // 10 * interval_s
        times_s = (first_s + interval_s * np.arange(samples)) * dso_rate
        turn = 2.0 * np.pi * step.frequency_hz * times_s + sync_rad
        values = self.fault.trace(5.0 * np.sin(turn), turn)
        values += s.trace_noise_v * self.rng.standard_normal(samples)
        values = disturbances.resolved(values, s.trace_step_v)
        bench_files.write_shot(path, "CH1", r"\volt", values, 1.0 / interval_s, first_s)

    def _write_series(self, path, step, sync_rad, delay_s):
        s = self.settings
        start_s = delay_s + s.start_jitter_s * self.rng.standard_normal()
        if s.start == "free-running":
            start_s += self.rng.uniform(0.0, 1.0 / self.sensor_rate_hz)
        times_s = start_s + np.arange(s.series_samples) / self.sensor_rate_hz
        times_s = self.fault.series_instants(step, times_s)
        behind_sync = step.phase_rad - step.sync_phase_rad
        turn = 2.0 * np.pi * step.frequency_hz * times_s + sync_rad + behind_sync - step.delay_rad
        amplitude = step.amplitude * step.magnitude
        noise = s.sensor_noise_rel * self.rng.standard_normal(s.series_samples)
        values = amplitude * (np.sin(turn) + noise + s.sensor_offset_rel)
        values = self.fault.series(step, times_s, values)
        unit = r"\metre\second\tothe{-2}"
        bench_files.write_shot(path, "z", unit, values, 1000.0)

    # The bench file.

    def _write_adc_calibration(self, folder):
        points = []
        for text in self.settings.frequencies:
            lag_rad = 2.0 * np.pi * float(text) * ADC_DELAY_S + self.adc_lag_error_rad[text]
            points.append((float(text), ADC_GAIN, lag_rad, self.settings.u_adc_lag_rad))
        bench_files.write_adc_calibration(folder / "adc.json", "ADC1", points)

    def _write_reference_calibration(self, folder):
        s = self.settings
        frequencies_hz = sorted(float(text) for text in s.frequencies)
        points = [
            (f, *self.reference_response(f), s.u_reference_magnitude_rel, s.u_reference_phase_rad)
            for f in frequencies_hz
        ]
        bench_files.write_reference_calibration(folder / "reference.csv", points)

    def _sources_and_method(self):
        s = self.settings
        metres = "m/s^2"
        acs = {"driver": "file", "path": "acs.npy", "units": {"ref": metres, "sync": "V"}}
        dau = {"driver": "file", "path": "dau.npy", "time_base": "utc"}
        dau["units"] = {"dos": metres, "sync": "V"}
        if s.u_stamp_s:
            dau["u_stamp_s"] = s.u_stamp_s
        method = {"kind": s.method, "reference": "acs/ref"}
        sources = {"sources.acs": acs}
        if s.method == "analogue":
            acs["units"] = {"ref": metres, "dut": metres}
            method["dut"] = ["acs/dut"]
        elif s.method == "absolute-time":
            acs["units"] = {"ref": metres}
            acs["time_base"] = "utc"
            if s.u_stamp_s:
                acs["u_stamp_s"] = U_CLOCK_OF_SYNC_S
            dau["units"] = {"dos": metres}
            sources["sources.dau"] = dau
            method["dut"] = ["dau/dos"]
        elif s.method == "sample-timestamping":
            sources["sources.dau"] = dau
            method.update(sync_dau="dau/sync", dut=["dau/dos"])
            if s.own_clock:
                sources["sources.sensor"] = {**dau, "path": "sensor.npy", "units": {"dos": metres}}
                sources["sources.dau"] = {**dau, "units": {"sync": "V"}}
                if s.u_stamp_s:
                    sources["sources.dau"]["u_stamp_s"] = U_CLOCK_OF_SYNC_S
                method["dut"] = ["sensor/dos"]
        else:
            dso = {"driver": "oscilloscope", "path": "dso", "channels": {"CH1": "sync"}}
            sources["sources.dso"] = dso
            sources["sources.tss"] = {"driver": "series", "path": "tss", "units": {"z": metres}}
            method.update(sync_dso="dso/sync", dut=["tss/z"], shots=s.shots)
            method["trigger_phase_correction"] = s.corrects_trigger_phase
        if s.method in ("sample-timestamping", "series-timestamping"):
            method["sync_acs"] = f"acs/{s.sync_acs_channel}"
        return {**sources, "method": method}

    def _write_bench_file(self, folder):
        s = self.settings
        tables = {"": {"bench": "simulated"}}
        tables["excitation"] = {
            "frequencies_hz": list(s.frequencies),
            "level": s.level_m_s2,
            "repetitions": s.repetitions,
            "settling_s": s.settling_s,
            "duration_s": s.duration_s,
        }
        tables.update(self._sources_and_method())
        corrections = {}
        if s.calibrated_reference:
            self._write_reference_calibration(folder)
            corrections["reference"] = "reference.csv"
        if s.method == "sample-timestamping" and s.states_adc_calibration:
            self._write_adc_calibration(folder)
            corrections["adc"] = {"file": "adc.json", "channel": "ADC1"}
        elif s.method == "series-timestamping":
            corrections["dso_delay"] = {"value_s": DSO_DELAY_S, "u_s": U_DSO_DELAY_S}
        tables["corrections"] = corrections
        uncertainty = {"acs_rate_rel": s.acs_rate_error_rel}
        if s.states_reference_uncertainty and not s.calibrated_reference:
            uncertainty["reference_magnitude_rel"] = s.u_reference_magnitude_rel
            uncertainty["reference_phase_rad"] = s.u_reference_phase_rad
        if s.method == "series-timestamping" and s.states_dso_rate:
            uncertainty["dso_rate_rel"] = s.dso_rate_rel / math.sqrt(3.0)
        if s.method != "absolute-time":
            uncertainty["acs_delay_s"] = s.u_acs_delay_s
        if s.stated_u_adc_delay_s:
            uncertainty["adc_delay_s"] = s.stated_u_adc_delay_s
        tables["uncertainty"] = uncertainty
        tables = self.fault.bench_tables(tables)
        bench_files.write_bench_file(folder / "bench.toml", tables)

    def write(self, folder):
        """Writes everything; returns the truth. The same seed writes the same bytes."""
        self._write_acs(folder)
        if self.settings.method in ("sample-timestamping", "absolute-time"):
            self._write_sensor(folder)
            if self.settings.own_clock:
                self._write_sync_alone(folder)
        elif self.settings.method == "series-timestamping":
            self._write_shots(folder)
        self._write_bench_file(folder)
        return self.truth()
