# Programs of two versions, or of two releases of Debian, and a bench of files that both know; to be
# sourced. Options that take_side_option knows, SIDE being this or other:
#
#   --SIDE DIR          the folder of its programs
#   --SIDE-system ROOT  a folder with the release of Debian whose libraries they need (of
#                       tests/other-release.sh, for instance)
#   --SIDE-name NAME    what it is called
#
# Sets programs[SIDE] and name[SIDE]. Makes hosts as tests/faults/bad_network.sh, which see.
. "$(dirname "${BASH_SOURCE[0]}")/../faults/bad_network.sh"
declare -A programs=() system=([this]= [other]=) name=([this]=this [other]=other)

# Fails where the option is another one.
take_side_option() {
  local side=${1#--}
  case $1 in
  --this | --other) programs[$side]=$(realpath "$2") ;;
  --this-system | --other-system) system[${side%-system}]=$(realpath "$2") ;;
  --this-name | --other-name) name[${side%-name}]=$2 ;;
  *) return 1 ;;
  esac
}

# prepare_sides SUBJECT HOST...
prepare_sides() {
  [[ ${programs[this]:-} && ${programs[other]:-} ]] ||
    { echo "--this DIR and --other DIR are needed" && exit 2; }
  make_hosts "$@"
  command -v python3 >/dev/null || skip "there is no command python3"
  local side
  for side in this other; do
    [[ -z ${system[$side]} ]] || wrap_programs "$side"
    echo "${name[$side]}: $("${programs[$side]}/dyncal" --version | head -n 1)"
  done
  write_bench
}

# By the loader and the libraries of its own system: it sees the files of this one.
wrap_programs() {
  local program root=${system[$1]}
  mkdir "$folder/$1"
  for program in dyncal dyncal-acs dyncal-analysis dyncal-virtual-bench; do
    printf '#!/bin/sh\nexec %q --library-path %q --argv0 "$0" %q "$@"\n' \
      "$root/lib64/ld-linux-x86-64.so.2" "$root/usr/lib/x86_64-linux-gnu" \
      "${programs[$1]}/$program" >"$folder/$1/$program"
    chmod +x "$folder/$1/$program"
  done
  programs[$1]=$folder/$1
}

# 18 points, by $folder/bench.toml.
write_bench() {
  "${programs[this]}/dyncal-virtual-bench" --preset mpu9250-ptb --seed 3 --record-csv "$folder" \
    --adc-file "$folder/adc.json" --frequencies 20,80,160 --levels 10,100,100 --repetitions 2 \
    --settling 0.5 --duration-per-step 2.0 2>"$folder/log"
  cat >"$folder/bench.toml" <<TOML
bench = "mixed"
[excitation]
frequencies_hz = ["20", "80", "160"]
level = [10.0, 100.0, 100.0]
repetitions = 2
settling_s = 0.5
duration_s = 1.5
[sources.dau]
driver = "file"
path = "dau.csv"
play = 6
units = { acceleration_x = "m/s^2", acceleration_y = "m/s^2", acceleration_z = "m/s^2", sync = "V" }
[sources.acs]
driver = "file"
path = "acs.csv"
play = 6
units = { reference = "m/s^2", sync = "V" }
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_x", "dau/acceleration_y", "dau/acceleration_z"]
[corrections]
adc = { file = "adc.json", channel = "ADC1" }
[uncertainty]
reference_magnitude_rel = 5e-4
reference_phase_rad = 5e-4
acs_delay_s = 1e-8
TOML
}

# One line: where points and transfer functions of two files of results differ, in what both have;
# nothing where they are equal to the last bit. Fails when there is nothing to compare.
compare() {
  python3 - "$@" <<'PYTHON'
import json, sys

def differences(left, right, at=""):
    if isinstance(left, dict) and isinstance(right, dict):
        for key in left.keys() & right.keys():
            yield from differences(left[key], right[key], f"{at}.{key}")
    elif isinstance(left, list) and isinstance(right, list) and len(left) == len(right):
        for number, (one, other) in enumerate(zip(left, right)):
            yield from differences(one, other, f"{at}[{number}]")
    elif left != right:
        yield f"{at[1:]}: {left!r:.40} and {right!r:.40}"

expected, found = (json.load(open(path)) for path in sys.argv[1:])
if len(expected["points"]) != 18 or not expected["transfer_function"]:
    sys.exit("nothing to compare with")
if not expected["points"][0].keys() & found["points"][0].keys() >= {"magnitude", "phase_rad"}:
    sys.exit("no values to compare")
every = [one for part in ("points", "transfer_function")
         for one in differences(expected[part], found[part], "." + part)]
if every:
    print(f"{len(every)} differences;", every[0])
PYTHON
}

vendor_of() { [[ $1 == F ]] && echo fastdds || echo cyclonedds; }
network=(--domain 47 --interface lab)
services=()
begin() { # host, side, program, vendor, what it says when it is ready, arguments
  : >"$folder/$3.log"
  (on "$1" "${programs[$2]}/$3" "${@:6}" "${network[@]}" --dds "$(vendor_of "$4")" \
    >/dev/null 2>"$folder/$3.log") &
  services+=("$!")
  for ((i = 0; i < 600; i++)); do
    grep -q "$5" "$folder/$3.log" && return
    sleep 0.1
  done
  echo "FAILED: $3 is not ready" && tail -3 "$folder/$3.log" && exit 1
}
end_services() {
  kill "${services[@]}" 2>/dev/null || true
  wait "${services[@]}" 2>/dev/null || true
  services=()
}
