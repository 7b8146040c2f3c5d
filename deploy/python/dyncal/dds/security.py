"""A participant of a secured laboratory, as a program of dyncal is one (deploy/guide/security.md).

The folder is that of `dyncal security issue ROLE`, services/security/identity_folder.hpp: role
`watcher` reads all benches, `source` publishes samples of its own. The plug-ins of DDS Security
belong to the library of Cyclone DDS. Debian's has them (its package libddsc0debian), and Python
uses it where version 0.10 of `cyclonedds` was compiled on it; the wheels of PyPI have none.
"""

from __future__ import annotations

import os
import pathlib

import cyclonedds.core  # loads the library  # noqa: F401
from cyclonedds.core import Policy, Qos

# Property, name of the file, the function that it begins and ends with.
PLUG_INS = (
    ("auth", "libdds_security_auth.so", "authentication"),
    ("access", "libdds_security_ac.so", "access_control"),
    ("crypto", "libdds_security_crypto.so", "crypto"),
)
# What the properties of DDS Security call the files of a folder.
FILES = {
    "dds.sec.auth.identity_ca": "ca.pem",
    "dds.sec.auth.identity_certificate": "cyclonedds.pem",
    "dds.sec.auth.private_key": "cyclonedds_key.pem",
    "dds.sec.access.permissions_ca": "ca.pem",
    "dds.sec.access.governance": "governance.p7s",
    "dds.sec.access.permissions": "cyclonedds_permissions.p7s",
}


class SecurityError(RuntimeError):
    """Why a participant cannot be secured, in one sentence."""


def revoked_list(folder: str | os.PathLike[str]) -> pathlib.Path:
    """The certificates that do not count any more: DYNCAL_REVOKED where it is set."""
    return pathlib.Path(os.environ.get("DYNCAL_REVOKED") or pathlib.Path(folder) / "revoked.pem")


def identity(folder: str | os.PathLike[str]) -> Qos:
    """The QoS of a participant with the identity of this folder.

    Raises SecurityError: a file is missing, or the library has no plug-ins. What the files hold is
    looked at by `dyncal security check FOLDER`, and by the library, which then makes no
    participant.
    """
    place = pathlib.Path(folder).resolve()
    properties = plug_ins()
    files = {name: place / file for name, file in FILES.items()}
    files["org.eclipse.cyclonedds.sec.auth.crl"] = revoked_list(folder).resolve()
    for name, file in files.items():
        if not os.access(file, os.R_OK):
            raise SecurityError(
                f"{file}: cannot be read; the folder of a program is made by 'dyncal security "
                "issue AUTHORITY watcher --output FOLDER'"
            )
        properties[name] = f"file:{file}"
    return Qos(*(Policy.Property(name, value) for name, value in properties.items()))


def plug_ins() -> dict[str, str]:
    """The properties that name them."""
    library = library_in_use()
    folders = (library.parent / "libddsc0debian", library.parent)  # Debian's, others'
    properties = {}
    for name, file, function in PLUG_INS:
        found = next((folder / file for folder in folders if (folder / file).exists()), None)
        if found is None:
            raise SecurityError(
                f"{library} comes without the plug-ins of DDS Security ({file}), as the wheels of "
                "cyclonedds on PyPI do: compile version 0.10.5 on Debian's library "
                "(deploy/python/install.sh --secured does, for dyncal-bridge)"
            )
        properties[f"dds.sec.{name}.library.path"] = str(found)
        properties[f"dds.sec.{name}.library.init"] = f"init_{function}"
        properties[f"dds.sec.{name}.library.finalize"] = f"finalize_{function}"
    return properties


def library_in_use() -> pathlib.Path:
    """The library of Cyclone DDS that this process has loaded."""
    with open("/proc/self/maps", encoding="utf-8") as maps:
        paths = (line.split(maxsplit=5)[-1].strip() for line in maps if "libddsc" in line)
        return pathlib.Path(next(paths, "libddsc.so"))
