"""Trajectory files to histories: formats are recognised by content, SPICE kernels taken together."""

from collections.abc import Sequence
from pathlib import Path

from proxnav.errors import InputError
from proxnav.trajectories.readers.ccsds import read_aem, read_oem
from proxnav.trajectories.readers.ccsds_xml import xml_kinds
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.history import History
from proxnav.trajectories.readers.mat_table import is_mat, read_mat
from proxnav.trajectories.readers.spice_kernels import is_kernel, read_kernels
from proxnav.trajectories.readers.stk_attitude import read_stk_attitude
from proxnav.trajectories.readers.stk_ephemeris import read_stk_ephemeris
from proxnav.trajectories.readers.tabular import histories
from proxnav.trajectories.readers.text import head_of, is_xml, read_lines
from proxnav.trajectories.readers.text_table import is_report, read_csv, read_report


def read_files(paths: Sequence[str | Path], config: ReaderConfig) -> list[History]:
    """Orbits and attitudes of all files, in their own frames and at their own times; InputError names the file."""
    kernels = [path for path in paths if is_kernel(path, head_of(path))]
    found = read_kernels(kernels, config) if kernels else []
    for path in paths:
        if path not in kernels:
            found += _read(path, config)
    return found


def _read(path: str | Path, config: ReaderConfig) -> list[History]:
    if is_mat(head_of(path)):
        return histories(read_mat(path, config.columns), config)
    lines = read_lines(path)
    head = "\n".join(lines[:60]).lower()
    first = next(line.strip().lower() for line in lines if line.strip())
    if first.startswith("stk.v"):
        scalar_first = None if config.quaternion_order is None else config.quaternion_order == "wxyz"
        is_attitude = "begin attitude" in " ".join(head.split())
        return [read_stk_attitude(path, scalar_first) if is_attitude else read_stk_ephemeris(path)]
    kinds = xml_kinds(path) if is_xml(path) else _kvn_kinds(head)
    if kinds:
        orbits = list(read_oem(path)) if "OEM" in kinds else []
        return [*orbits, *(read_aem(path, config.quaternion_order) if "AEM" in kinds else ())]
    if first.startswith("begin ") or Path(path).suffix.lower() in (".e", ".a"):
        raise InputError(f"{path}, line 1: the banner stk.v.<number> is missing; add it or export the file again")
    if is_report(lines):
        return histories(read_report(path), config)
    return histories(read_csv(path, config.columns), config)


def _kvn_kinds(head: str) -> tuple[str, ...]:
    return ("OEM",) if "_oem_vers" in head else ("AEM",) if "_aem_vers" in head else ()
