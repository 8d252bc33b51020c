"""Coverage-guided fuzzing of every reader (atheris): anything but a value or an InputError is a finding.

    python tools/fuzz.py trajectories --seconds 300 --out out/fuzz     one reader
    python tools/fuzz.py all --seconds 300 --out out/fuzz              each in a process of its own, in turn

An input is one byte that chooses the file name, then the file. A finding is kept once for each place in the code, under
OUT/findings/READER/, named as the reader wants it: moved into tests/hostile/corpus/READER/ it is a regression test.
OUT/READER.json counts executions, processor time and findings.
"""

import argparse
import hashlib
import json
import subprocess
import sys
import tempfile
import time
import traceback
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT)]
CORPUS = ROOT / "tests" / "hostile" / "corpus"
SLOW_S = 10.0
"""Of processor time for one input of at most 20 kB: more is a finding."""


def main() -> None:
    """Parses the words and fuzzes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("reader")
    parser.add_argument("--seconds", type=int, default=300)
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"))
    options = parser.parse_args()
    if options.reader == "all":
        fuzz_all(options)
    else:
        fuzz(options.reader, options.seconds, options.out)


def fuzz_all(options: argparse.Namespace) -> None:
    """Every reader in turn; one that the fuzzer ends (memory, a crash of native code) does not end the others."""
    from hostile_readers import READERS

    for name in READERS:
        command = [sys.executable, __file__, name, "--seconds", str(options.seconds), "--out", str(options.out)]
        (options.out / "logs").mkdir(parents=True, exist_ok=True)
        with (options.out / "logs" / f"{name}.log").open("w") as log:
            code = subprocess.run(command, stdout=log, stderr=log).returncode
        print(name, "ended with", code, flush=True)


def fuzz(name: str, seconds: int, out: Path) -> None:
    """One reader; never returns, the fuzzer ends the process."""
    import atheris

    instrument = atheris.instrument_imports  # pyright: ignore[reportAttributeAccessIssue]
    with instrument(include=["proxnav"], enable_loader_override=False):
        from hostile_readers import READERS, value_or_refusal

        reader = READERS[name]
        work = Path(tempfile.mkdtemp(dir="/dev/shm" if Path("/dev/shm").is_dir() else None))
        (work / "warm").mkdir()
        reader.prepare(work / "warm")
        for warm in reader.names:  # imports of the reader happen here, under instrumentation
            (work / "warm" / warm).write_bytes(b"{}")
            try:
                value_or_refusal(reader, work / "warm" / warm)
            except Exception as error:  # will be found again, and kept
                print("warm-up:", repr(error))
    log = Log(name, out)
    folders = {}
    for number in range(len(reader.names)):
        folders[number] = work / str(number)
        folders[number].mkdir()
        reader.prepare(folders[number])

    def one(data: bytes) -> None:
        number = data[0] % len(reader.names) if data else 0
        path = folders[number] / reader.names[number]
        path.write_bytes(data[1:])
        start = time.process_time()
        try:
            value_or_refusal(reader, path)
            if (took := time.process_time() - start) > SLOW_S:
                raise TimeoutError(f"{took:.0f} s of processor time")
        except Exception as error:
            log.found(error, path.name, data[1:])
        log.count()

    seeds = seed_folder(name, out)
    kept = out / "corpus" / name
    kept.mkdir(parents=True, exist_ok=True)
    # libFuzzer's own limit is of wall time, which says little on a busy machine: it is for endless loops only.
    flags = [f"-max_total_time={seconds}", "-timeout=1200", "-rss_limit_mb=6000", "-max_len=20000"]
    flags.append(f"-artifact_prefix={out}/artifacts-{name}-")
    atheris.Setup([sys.argv[0], *flags, str(kept), str(seeds)], one)
    atheris.Fuzz()


class Log:
    """Counts to a file now and then: the fuzzer ends the process without a word to us."""

    def __init__(self, name: str, out: Path) -> None:
        self.name, self.out = name, out
        self.executions, self.places = 0, {}
        self.earlier = self._read()
        self.said = 0.0

    def _read(self) -> dict:
        path = self.out / f"{self.name}.json"
        return json.loads(path.read_text()) if path.exists() else {"executions": 0, "cpu_s": 0.0, "findings": {}}

    def count(self) -> None:
        """One more execution."""
        self.executions += 1
        if time.monotonic() - self.said > 5.0:
            self.write()

    def found(self, error: Exception, name: str, content: bytes) -> None:
        """Keeps the first input that fails at a place."""
        frames = [f for f in traceback.extract_tb(error.__traceback__) if "/proxnav/" in f.filename]
        last = frames[-1] if frames else traceback.extract_tb(error.__traceback__)[-1]
        place = f"{type(error).__name__} at {last.filename.split('/proxnav/')[-1]}:{last.lineno}"
        if place in self.places or place in self.earlier["findings"]:
            return
        self.places[place] = str(error)[:160]
        folder = self.out / "findings" / self.name
        folder.mkdir(parents=True, exist_ok=True)
        stem, _, ending = name.rpartition(".")
        (folder / f"{stem}-{hashlib.sha256(content).hexdigest()[:8]}.{ending}").write_bytes(content)
        self.write()

    def write(self) -> None:
        """The sums, those of earlier runs included."""
        self.said = time.monotonic()
        content = {
            "executions": self.earlier["executions"] + self.executions,
            "cpu_s": round(self.earlier["cpu_s"] + time.process_time(), 1),
            "findings": self.earlier["findings"] | self.places,
        }
        self.out.mkdir(parents=True, exist_ok=True)
        temporary = self.out / f".{self.name}.json"
        temporary.write_text(json.dumps(content, indent=1) + "\n")
        temporary.replace(self.out / f"{self.name}.json")


def seed_folder(name: str, out: Path) -> Path:
    """Inputs to begin with: the committed corpus and what the reader's own neighbours look like."""
    from hostile_readers import READERS

    reader, folder = READERS[name], out / "seeds" / name
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as neighbours:
        reader.prepare(Path(neighbours))
        sources = [p for p in Path(neighbours).rglob("*") if p.is_file()] + list((CORPUS / name).glob("*"))
        for path in sources:
            number = choice(reader.names, path.name)
            if number is not None and path.stat().st_size < 20_000:
                (folder / path.name).write_bytes(bytes([number]) + path.read_bytes())
    return folder


def choice(names: tuple[str, ...], file_name: str) -> int | None:
    """Which of the reader's names a corpus file `<stem>[-anything].<ending>` stands for."""
    stem, _, ending = file_name.rpartition(".")
    for number, name in enumerate(names):
        own, _, kind = name.rpartition(".")
        if kind == ending and stem.split("-")[0] == own:
            return number
    return None


if __name__ == "__main__":
    main()
