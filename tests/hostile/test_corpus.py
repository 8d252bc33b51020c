"""Whatever fuzzing found, and whole files: each is a value or one sentence. tools/fuzz.py adds to the corpus."""

import shutil
from pathlib import Path

import pytest

from hostile_readers import READERS, value_or_refusal

CORPUS = Path(__file__).parent / "corpus"
FILES = sorted(path for path in CORPUS.rglob("*") if path.is_file())


def laid_out(path: Path, folder: Path) -> Path:
    """The corpus file `<stem>[-anything].<ending>` under its reader's name, among whole neighbours."""
    reader = READERS[path.parent.name]
    names = [name for name in reader.names if name.rpartition(".")[2] == path.suffix[1:]]
    name = next(n for n in sorted(names, key=len, reverse=True) if path.name.startswith(n.rpartition(".")[0]))
    reader.prepare(folder)
    shutil.copyfile(path, folder / name)
    return folder / name


@pytest.mark.parametrize("path", FILES, ids=[f"{path.parent.name}-{path.name}" for path in FILES])
def test_a_corpus_file_is_a_value_or_one_sentence(path: Path, tmp_path: Path) -> None:
    refusal = value_or_refusal(READERS[path.parent.name], laid_out(path, tmp_path))
    assert refusal is None or (refusal and "\n" not in refusal)


def test_every_reader_has_a_whole_file_in_the_corpus_that_it_reads(tmp_path: Path) -> None:
    for name in {"trajectories", "camera", "labels", "tables", "keypoints", "points", "meshes", "images"}:
        (tmp_path / name).mkdir()
        whole = next((CORPUS / name).glob("*-whole.*"))
        assert value_or_refusal(READERS[name], laid_out(whole, tmp_path / name)) is None, name
