#!/usr/bin/env python3
"""Completion in real shells: what bash, zsh and fish offer for a part of a command line."""

import pathlib
import shutil
import subprocess
import tempfile

from programs import PROGRAMS, commands_of, environment, expect, output_of

# What is typed, and what must be among the offers, or must not.
CASES = [
    ("dyncal an", {"analyse"}, {"run", "--output"}),
    ("dyncal calibrate ", {"adc", "dso-delay", "time"}, {"run"}),
    ("dyncal run --do", {"--domain"}, {"--output"}),
    ("dyncal model --filter ", {"fir", "iir"}, {"--filter"}),
    ("dyncal calibrate adc --amp", {"--amplitudes"}, set()),
    ("dyncal run b", {"bench.toml"}, {"b.txt"}),
    ("dyncal-dau b", {"bench.toml"}, {"b.txt"}),
    ("dyncal gu", set(), {"guard-output"}),
]


def finished(*command, **more):
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, **more)
    expect(done.returncode == 0, f"{command[0]}: {done.stdout}{done.stderr}")
    expect(not done.stderr.strip(), f"{command[0]}: {done.stderr}")
    return {line.split("\t")[0].strip() for line in done.stdout.splitlines()}


def in_bash(script, line, folder):
    words = line.split(" ")
    program = words[0]
    typed = " ".join(f"'{word}'" for word in words)
    code = f"""
        source '{script}'
        complete -p {program} >/dev/null || exit 3
        COMP_WORDS=({typed})
        COMP_CWORD={len(words) - 1}
        COMP_LINE='{line}'
        COMP_POINT=${{#COMP_LINE}}
        _{program.replace("-", "_")} {program} "${{COMP_WORDS[COMP_CWORD]}}"
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    return finished("bash", "--norc", "-c", code, cwd=folder, env=environment())


# The functions of zsh's completion system need a line editor: here they print what they are given.
ZSH_STUBS = """
    compdef() { : }
    compadd() { shift; print -l -- "$@" | grep -- "^$PREFIX" || : }
    _describe() {
        [[ $1 == -o ]] && shift
        local entry
        for entry in "${(@P)2}"; do [[ $entry == ${PREFIX}* ]] && print -r -- "${entry%%:*}"; done
        return 0
    }
    _files() {
        local entry
        for entry in ${PREFIX}${~${2:-*}}(N); do print -r -- "$entry"; done
        return 0
    }
"""


def in_zsh(script, line, folder):
    words = line.split(" ")
    typed = " ".join(f"'{word}'" for word in words)
    code = f"""{ZSH_STUBS}
        source '{script}'
        words=({typed})
        CURRENT={len(words)}
        PREFIX='{words[-1]}'
        _{words[0].replace("-", "_")}
    """
    return finished("zsh", "-f", "-c", code, cwd=folder, env=environment())


def in_fish(script, line, folder):
    code = f"source '{script}'; complete -C '{line}'"
    more = {"HOME": str(folder), "XDG_CONFIG_HOME": str(folder / "c"), "TERM": "dumb"}
    return finished("fish", "--no-config", "-c", code, cwd=folder, env=environment(**more))


def check(shell, offers_in, folder):
    scripts = {}
    for program in PROGRAMS:
        scripts[program] = folder / f"{program}.{shell}"
        scripts[program].write_text(output_of(program, "--print-completion", shell))
    for line, wanted, unwanted in CASES:
        offers = offers_in(scripts[line.split(" ")[0]], line, folder)
        expect(wanted <= offers, f"{shell}, '{line}': {wanted} is not among {sorted(offers)}")
        if shell == "fish":  # offers files that do not fit, after those that do
            unwanted = unwanted - {"b.txt"}
        expect(not unwanted & offers, f"{shell}, '{line}': {unwanted & offers} is offered")
    line = "dyncal "
    offers = offers_in(scripts["dyncal"], line, folder)
    commands = {words[0] for words in commands_of("dyncal")}
    expect(len(commands) > 15, f"only {commands}")
    expect(commands <= offers, f"{shell}: {commands - offers} is not offered")
    print(f"{shell}: {len(CASES) + 1} command lines")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "files").mkdir()
        files = folder / "files"
        (files / "bench.toml").write_text("")
        (files / "b.txt").write_text("")
        for shell, offers_in in [("bash", in_bash), ("zsh", in_zsh), ("fish", in_fish)]:
            if shutil.which(shell):
                check(shell, offers_in, files)
            else:
                print(f"SKIPPED: there is no {shell} here, so its completion was not tried")


main()
