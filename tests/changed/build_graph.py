"""What a change reaches in a build by ninja: from build.ninja, and from the headers that ninja has
noted of each object. Paths are absolute."""

import collections
import os
import re
import subprocess

WORK_FOLDER = "${cmake_ninja_workdir}"
ESCAPED = re.compile(r"\$([ :$])")


def words(text):
    """The paths of a build line, which a space parts that no '$' stands before."""
    return [ESCAPED.sub(r"\1", word) for word in re.findall(r"(?:\$.|[^\s$])+", text)]


class BuildGraph:
    def __init__(self, build):
        self.build = os.path.abspath(build)
        self.users = collections.defaultdict(set)  # of a file: what is made from it
        self.made = set()
        self._read_lines()
        self.has_built = self._read_headers()

    def path(self, name):
        return os.path.normpath(os.path.join(self.build, name.replace(WORK_FOLDER, "")))

    def _read_lines(self):
        with open(os.path.join(self.build, "build.ninja"), encoding="utf-8") as file:
            text = file.read().replace("$\n", "")
        for line in re.findall(r"^build (.*)$", text, re.M):
            outputs, inputs = re.split(r"(?<!\$): *", line, maxsplit=1)
            made = {self.path(word) for word in words(outputs) if word != "|"}
            # What is only to be there before ("||") does not make anything new.
            _rule, *used = words(inputs.split("||")[0])
            for name in used:
                if name != "|":
                    self.users[self.path(name)] |= made
            self.made |= made

    def _read_headers(self):
        noted = subprocess.run(
            ["ninja", "-C", self.build, "-t", "deps"], capture_output=True, text=True, check=True
        ).stdout
        target = None
        for line in noted.splitlines():
            if line.startswith("    "):
                self.users[self.path(line.strip())].add(target)
            elif line:
                target = self.path(line.split(": #deps")[0])
        return target is not None

    def below(self, folder):
        """What is made in a folder of the build."""
        top = self.path(folder) + os.sep
        return {name for name in self.made if name.startswith(top)}

    def reached(self, changed):
        """All that is made from these files, and they."""
        reached = set()
        new = set(changed)
        while new:
            reached |= new
            new = set().union(*(self.users.get(name, ()) for name in new)) - reached
        return reached
