"""Running an ONNX graph: OpenVINO in bfloat16 where the processor multiplies it, ONNX Runtime everywhere else."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np

from proxnav.errors import InputError

Backend = Literal["auto", "onnxruntime", "openvino"]
Session = Callable[[np.ndarray], list[np.ndarray]]
"""One batch in, the graph's outputs in their order."""


def open_session(path: Path, backend: Backend = "auto", threads: int = 0) -> Session:
    """A graph ready to run; `threads` 0 takes all cores. InputError when the file is absent or damaged."""
    if not path.is_file():
        raise InputError(f"{path}: no such model file; give the name of a shipped model or a folder with model.json")
    if threads < 0:
        raise InputError(f"threads must be 0 (all cores) or more, found {threads}")
    if backend == "openvino" and not _can_import_openvino():
        raise InputError("OpenVINO is not installed; pip install openvino, or choose the backend onnxruntime")
    if backend == "auto":
        backend = "openvino" if _has_bfloat16() and _can_import_openvino() else "onnxruntime"
    try:
        return _openvino(path, threads) if backend == "openvino" else _onnxruntime(path, threads)
    except RuntimeError as error:
        raise InputError(
            f"{path}: not a graph that {backend} can run ({(str(error).splitlines() or ['no reason given'])[0]})"
        ) from None


def _onnxruntime(path: Path, threads: int) -> Session:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.log_severity_level = 3
    wanted = ("CUDAExecutionProvider", "CPUExecutionProvider")
    providers = [name for name in wanted if name in onnxruntime.get_available_providers()]
    try:
        session = onnxruntime.InferenceSession(str(path), options, providers)
    except Exception as error:  # its exceptions share no base class but Exception
        raise RuntimeError(str(error)) from error
    name = session.get_inputs()[0].name
    return lambda batch: [np.asarray(output) for output in session.run(None, {name: batch})]


@cache
def _openvino_core() -> Any:
    """One that lives as long as the process.

    Its plugin gives the thread an alternate signal stack on processors with AMX and unmaps it when it goes, also when
    it is still in use: of several plugins that come and go the next Ctrl-C would be a segmentation fault.
    """
    import openvino

    return openvino.Core()


def _openvino(path: Path, threads: int) -> Session:
    hints: dict[str, str] = {"PERFORMANCE_HINT": "LATENCY"}
    if _has_bfloat16():
        hints["INFERENCE_PRECISION_HINT"] = "bf16"
    if threads:
        hints["INFERENCE_NUM_THREADS"] = str(threads)
    compiled = _openvino_core().compile_model(str(path), "CPU", hints)
    request = compiled.create_infer_request()
    return lambda batch: [np.array(output) for output in request.infer([batch]).to_tuple()]


def _can_import_openvino() -> bool:
    from importlib.util import find_spec

    return find_spec("openvino") is not None


def _has_bfloat16() -> bool:
    """Whether the processor multiplies bfloat16 in hardware (Linux says so in /proc/cpuinfo)."""
    try:
        flags = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    except OSError:
        return False
    return "avx512_bf16" in flags or "amx_bf16" in flags
