"""A live bench whose sensor records a series by itself: an oscilloscope triggers it."""

from bench_laboratory import BenchLaboratory

SERVICES = ("dyncal-analysis", "dyncal-dso", "dyncal-acs", "dyncal-guard")


class SeriesLaboratory(BenchLaboratory):
    preset = "tss"
    channels = 1
    sensor_uncertainty = ""
    run_s = 14.0

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, services=SERVICES, **options)

    def sensor_text(self):
        return f"""[sources.dso]
driver = "oscilloscope"
address = "127.0.0.1:{self.ports['dso']}"
[sources.tss]
driver = "series"
address = "127.0.0.1:{self.ports['tss']}"
[method]
kind = "series-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dso = "dso/sync"
dut = ["tss/acceleration_z"]
shots = 3
[corrections]
dso_delay = {{ value_s = 236e-9, u_s = 1e-9 }}"""
