"""What a fault may do to a calibration: one object a calibration, made by BenchSettings.fault.

    bench(fault=functools.partial(SoftEnds, limit_rel=0.97))

A kind overrides what it touches; everything else passes through. What it draws, it draws from its
own generator, so that the calibration is the one that it would be without the fault. `calibration`
has the settings, the steps with their true times, and sensor_signal(step, times_s) for instants of
one's own. Times are true seconds; arrays that come in are not changed.
"""


class Fault:
    def __init__(self, calibration, rng):
        self.calibration = calibration
        self.settings = calibration.settings
        self.steps = calibration.steps  # may be changed: nothing is recorded yet
        self.rng = rng

    def exciter(self, step, times_s, signal):
        """Acceleration in parts of its amplitude: what reference and sensor have in common."""
        return signal

    def sensor_lag_rad(self, step, times_s):
        """What the sensor is late by, beside its delay."""
        return 0.0

    def reference(self, times_s, values):
        """The whole record of the channel, noise included."""
        return values

    def sensor(self, times_s, values):
        return values

    def sync(self, times_s, values, volts):
        """In either system, before its ADC."""
        return values

    def acs_record(self, times_s, columns):
        """The columns of the file: t_ns, ref, sync or dut."""
        return columns

    def dau_record(self, times_s, columns):
        """The columns of the file: t_ns, dos, sync, sample_number; times_s as they were taken."""
        return columns

    def trace(self, volts, turn):
        """Sync at the oscilloscope before its noise and steps; `turn` is its phase."""
        return volts

    def series_instants(self, step, times_s):
        """When the samples of one series are taken, after the trigger point."""
        return times_s

    def series(self, step, times_s, values):
        """The values of one series."""
        return values

    def bench_tables(self, tables):
        """The bench file: "" for the keys on top, then name of the table to its keys."""
        return tables
