#!/usr/bin/env python3
"""Unknown commands and options: one line on standard error that names what was probably meant, and
exit status 2, for every program and every command."""

from programs import PROGRAMS, commands_of, expect, run


def check(program, arguments, part):
    done = run(program, *arguments)
    said = f"{program} {' '.join(arguments)}: {done.returncode}: {done.stdout}{done.stderr}"
    expect(done.returncode == 2, said)
    expect(not done.stdout, said)
    expect(done.stderr.count("\n") == 1 and done.stderr.startswith(f"{program}: "), said)
    expect(part in done.stderr, said)


def main():
    for program in PROGRAMS:
        check(program, ["--versoin"], "did you mean '--version'?")
    check("dyncal", ["rum", "bench.toml"], "did you mean 'dyncal run'?")
    check("dyncal", ["anaylse"], "did you mean 'dyncal analyse'?")
    check("dyncal", ["calibrate", "adx"], "did you mean 'dyncal calibrate adc'?")
    check("dyncal", [], "a command is missing")
    check("dyncal", ["run", "x", "--domian", "77"], "did you mean '--domain'?")
    check("dyncal", ["demo", "--seed", "abc"], "invalid --seed = abc: must be a whole number")
    check("dyncal", ["demo", "--domain", "300"], "--domain")
    check("dyncal", ["analyse", "off.toml", "--output"], "--output needs a value")
    check("dyncal-dau", [], "BENCH.toml is missing")
    check("dyncal-dau", ["a.toml", "--metric", "x"], "did you mean '--metrics'?")
    check("dyncal-recorder", ["--foldr", "x"], "did you mean '--folder'?")
    tried = 0
    for words in commands_of("dyncal"):
        check("dyncal", [*words, "--hepl"], "'--hepl'")
        tried += 1
    expect(tried > 20, f"only {tried} commands")
    print(f"{tried} commands, {len(PROGRAMS)} programs")


main()
