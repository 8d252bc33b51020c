"""The Blender worker as a process: started, asked, watched, replaced."""

import contextlib
import subprocess
import tempfile
import threading
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import IO, Any

from proxnav.rendering.cycles.wire import Arrays, Message, read_message, skip_to_magic, write_message

_STDERR_LINES = 40


class WorkerDied(Exception):
    """The worker ended or fell silent; another one can repeat the request."""


class WorkerFailed(RuntimeError):
    """The worker answered with an error of its own; repeating the request would fail again."""


@dataclass
class BlenderWorker:
    """A running Blender worker with its private folder."""

    process: subprocess.Popen[bytes]
    folder: tempfile.TemporaryDirectory
    stderr: deque[str]
    """The last lines that Blender printed."""
    listener: threading.Thread
    """Fills `stderr`, so that the pipe never blocks Blender."""
    memory_mb: float = 0.0
    """Resident memory at its last answer."""

    @staticmethod
    def start(command: list[str], timeout_s: float) -> "BlenderWorker":
        """Starts the worker and waits until it speaks; WorkerDied shows what it printed when it does not."""
        pipe = subprocess.PIPE
        process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, start_new_session=True)
        stderr = deque[str](maxlen=_STDERR_LINES)
        listener = threading.Thread(target=_drain, args=(_open(process.stderr), stderr), daemon=True)
        listener.start()
        folder = tempfile.TemporaryDirectory(prefix="proxnav-cycles-", ignore_cleanup_errors=True)
        worker = BlenderWorker(process, folder, stderr, listener)
        try:
            worker._within(timeout_s, lambda: skip_to_magic(_open(process.stdout)))
        except WorkerDied:
            worker.stop()
            raise
        return worker

    def ask(self, header: Mapping[str, Any], arrays: Arrays, timeout_s: float) -> Message:
        """Sends a request and waits for its answer."""

        def exchange() -> Message:
            write_message(_open(self.process.stdin), {**header, "folder": self.folder.name}, arrays)
            return read_message(_open(self.process.stdout))

        answer, results = self._within(timeout_s, exchange)
        self.memory_mb = answer["memory_mb"]
        if answer["status"] != "ok":
            raise WorkerFailed(f"Blender could not {header['command']}:\n{answer['message']}")
        return answer, results

    def stop(self) -> None:
        """Ends the worker and removes its folder; harmless when it is dead already."""
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            with contextlib.suppress(BrokenPipeError):  # bytes that the dead worker never read
                _open(stream).close()
        self.folder.cleanup()

    def _within(self, timeout_s: float, action: Any) -> Any:
        """Runs a blocking exchange; a watchdog kills the worker when it takes too long, which ends the exchange."""
        late = threading.Event()

        def kill() -> None:
            late.set()
            self.process.kill()

        watchdog = threading.Timer(timeout_s, kill)
        watchdog.start()
        try:
            return action()
        except (EOFError, OSError) as error:
            self.process.kill()  # it may have closed its pipe and live on
            self.process.wait()
            self.listener.join(timeout=2.0)
            reason = f"gave no answer in {timeout_s:g} s" if late.is_set() else f"ended ({error})"
            raise WorkerDied(self._obituary(reason)) from None
        finally:
            watchdog.cancel()

    def _obituary(self, reason: str) -> str:
        last = "\n".join(self.stderr) or "(nothing)"
        return f"the Blender worker {reason}, exit status {self.process.returncode}; it last printed:\n{last}"


def _open(stream: IO[bytes] | None) -> Any:
    assert stream is not None, "started with pipes"
    return stream


def _drain(stream: IO[bytes], lines: deque[str]) -> None:
    """Keeps the last lines of a stream until it ends."""
    with stream:
        for line in stream:
            lines.append(line.decode(errors="replace").rstrip())
