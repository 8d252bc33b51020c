"""Whatever the bytes are: labels, or one sentence."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.datasets.formats.small_sets import make_dataset

from proxnav.datasets.formats import (
    READERS,
    WRITERS,
    Labels,
    ReadOptions,
    WriteOptions,
    read_labels,
    read_pose_records,
    write_labels,
)
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.errors import InputError
from proxnav.geometry import Camera

CAMERA = Camera(64, 48, 60.0, 61.0, 32.0, 24.0)
OPTIONS = ReadOptions(camera=CAMERA)
SENTENCE_LENGTH = 600

cells = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True).map(repr),
    st.sampled_from(
        ["", "=1+1", "@SUM(A1)", "1e999", "nan", "img1.png", "../../a.png", "/etc/passwd", "C:\\a.png", "lightbox",
         "0x1", "1 0 0 0 1 0 0 0 1", "0 0 1000", "-1", "1", "0", "0.5", "\x00", "\u202egnp.png", "9" * 500]
    ),
    st.text(max_size=8),
)  # fmt: skip
tables = st.lists(st.lists(cells, min_size=1, max_size=18), max_size=4).map(
    lambda rows: "\n".join(",".join(row) for row in rows)
)
values = st.recursive(
    st.one_of(
        st.none(), st.booleans(), st.integers(), st.just(10**400), st.floats(), st.text(max_size=6),
        st.sampled_from(["img1.png", "../a.png", "=a.png"]), st.just([1.0, 0.0, 0.0, 0.0]), st.just([0.0, 0.0, 9.0]),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.dictionaries(
            st.sampled_from(
                ["poses", "filename", "q_vbs2tango", "q_vbs2tango_true", "r_Vo2To_vbs_true", "images", "annotations",
                 "categories", "info", "keypoint_origin", "id", "image_id", "file_name", "keypoints", "bbox",
                 "q_cam_target", "t_cam_target", "covariance", "0", "cam_R_m2c", "cam_t_m2c", "cam_K", "obj_id"]
            ),
            inner,
            max_size=6,
        ),
    ),
    max_leaves=20,
)  # fmt: skip


def outcome(read: Callable[[], object]) -> object:
    """What `read` returns, or its refusal."""
    try:
        return read()
    except InputError as error:
        return error


def value_or_sentence(path: Path, format: str = "auto") -> None:
    found = outcome(lambda: read_labels(path, format, OPTIONS))
    assert isinstance(found, Labels | InputError)
    if isinstance(found, InputError):
        assert "\n" not in str(found)
        assert len(str(found)) < SENTENCE_LENGTH + len(str(path)) * 2


@settings(max_examples=60, deadline=None)
@given(content=st.binary(max_size=300), name=st.sampled_from(["a.csv", "a.json"]), format=st.sampled_from([*READERS]))
def test_any_bytes_are_a_value_or_a_sentence(tmp_path_factory, content, name, format) -> None:
    path = tmp_path_factory.mktemp("b") / name
    path.write_bytes(content)
    value_or_sentence(path)
    value_or_sentence(path if format not in ("proxnav", "bop") else path.parent, format)


@settings(max_examples=150, deadline=None)
@given(text=tables, format=st.sampled_from(["krn", "spnv2", "spec2019", "spec2021", "spark", "bop-results"]))
def test_any_table_is_a_value_or_a_sentence(tmp_path_factory, text, format) -> None:
    path = tmp_path_factory.mktemp("t") / "a.csv"
    path.write_text(text, encoding="utf-8", errors="replace")
    value_or_sentence(path)
    value_or_sentence(path, format)


@settings(max_examples=60, deadline=None)
@given(poses=tables, images=tables)
def test_any_urso_folder_is_a_value_or_a_sentence(tmp_path_factory, poses, images) -> None:
    folder = tmp_path_factory.mktemp("u")
    (folder / "train_poses_gt.csv").write_text(poses, encoding="utf-8", errors="replace")
    (folder / "train_images.csv").write_text(images, encoding="utf-8", errors="replace")
    value_or_sentence(folder)


@settings(max_examples=150, deadline=None)
@given(content=values, format=st.sampled_from(["auto", "speed+", "coco", "detectron2"]))
def test_any_json_is_a_value_or_a_sentence(tmp_path_factory, content, format) -> None:
    path = tmp_path_factory.mktemp("j") / "a.json"
    path.write_text(json.dumps(content))
    value_or_sentence(path, format)


@settings(max_examples=100, deadline=None)
@given(truth=values, cameras=values, infos=values)
def test_any_bop_scene_is_a_value_or_a_sentence(tmp_path_factory, truth, cameras, infos) -> None:
    folder = tmp_path_factory.mktemp("s")
    for name, content in (("scene_gt", truth), ("scene_camera", cameras), ("scene_gt_info", infos)):
        (folder / f"{name}.json").write_text(json.dumps(content))
    value_or_sentence(folder)


@given(st.text(max_size=300))
def test_a_name_that_passes_stays_below_its_folder(name: str) -> None:
    passed = outcome(lambda: checked_name(name, "a file"))
    if isinstance(passed, InputError):
        assert "\n" not in str(passed)
        assert str(passed).isascii()
        return
    folder = Path("/data/set/images")
    assert (folder / passed).resolve().is_relative_to(folder)
    assert passed[0] not in "=+-@"


@pytest.mark.parametrize(
    "name", ["../a.png", "a/../../b.png", "/etc/passwd", "C:\\a.png", "..\\a.png", "\\\\host\\a", ""]
)
def test_names_that_climb_are_refused_in_every_format(name: str, labels: Labels, tmp_path: Path) -> None:
    with pytest.raises(InputError):
        checked_name(name, "a file")
    good = labels.records[0].filename
    for format in ("proxnav", "speed+", "speed", "krn", "spnv2", "spec2019", "spark", "urso", "bop"):
        out = write_labels(labels, tmp_path / format, format)
        for path in [path for path in out.rglob("*") if path.suffix in (".csv", ".json")]:
            text = path.read_text()
            if good in text:
                path.write_text(text.replace(good, name if path.suffix == ".csv" else json.dumps(name)[1:-1]))
                refused_or_below(path if format in ("krn", "spnv2", "spec2019", "spark") else out, format, name)
                path.write_text(text)


def refused_or_below(source: Path, format: str, name: str) -> None:
    """One sentence; or, where the format puts a folder before the name so that it cannot climb, a name below it."""
    found = outcome(lambda: read_labels(source, format))
    if isinstance(found, InputError):
        assert "\n" not in str(found)
        return
    assert (format, name) in (("krn", "/etc/passwd"), ("urso", "/etc/passwd"), ("bop", ""))
    names = [record.filename for record in found.records]
    assert "etc/passwd" in names or names == ["000003.png", *names[1:]]


@pytest.mark.parametrize("cell", ["=HYPERLINK(1)", "+1.png", "@SUM(1).png", "-cmd.png"])
def test_formula_cells_are_refused(cell: str, tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text(f"{cell},1,0,0,0,0,0,9\n")
    with pytest.raises(InputError, match="formula"):
        read_labels(tmp_path / "s.csv", "spec2019")
    (tmp_path / "s.csv").write_text("img1.png,=1,0,0,0,0,0,9\n")
    with pytest.raises(InputError, match="expected a number"):
        read_labels(tmp_path / "s.csv", "spec2019")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("img1.png,1,0,0,0,0,0\n", "7 columns"),
        ("img1.png,1,0,0,0,0,0,nan\n", "finite"),
        ("img1.png,1,0,0,0,0,0,1e999\n", "finite"),
        ("img1.png,1,1,0,0,0,0,9\n", "unit quaternion"),
        ("img1.png,1,0,0,0,0,0,9\nimg2.png,1,0,0\n", "row 2"),
        ("", "no rows"),
        ("\xff\xfe", "expected|columns|rows"),
    ],
)
def test_malformed_tables_name_what_is_wrong(text: str, sentence: str, tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text(text)
    with pytest.raises(InputError, match=sentence):
        read_labels(tmp_path / "s.csv", "auto" if "7" in sentence else "spec2019")


def test_a_huge_file_is_refused_before_it_is_read(tmp_path: Path) -> None:
    with (tmp_path / "s.csv").open("wb") as file:
        file.truncate(2**30)  # sparse: takes no space
    with pytest.raises(InputError, match="larger than"):
        read_labels(tmp_path / "s.csv")
    with (tmp_path / "s.json").open("wb") as file:
        file.truncate(2**32)
    with pytest.raises(InputError, match="larger than"):
        read_labels(tmp_path / "s.json")


def test_two_images_of_one_name_are_refused(tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text("img1.png,1,0,0,0,0,0,9\nimg1.png,1,0,0,0,0,0,8\n")
    with pytest.raises(InputError, match="more than once"):
        read_pose_records(tmp_path / "s.csv")
    with pytest.raises(InputError, match="more than once"):
        write_labels(read_labels(tmp_path / "s.csv"), tmp_path / "out", "poses")


def test_html_in_a_name_is_a_name(tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text("<b onload=x>.png,1,0,0,0,0,0,9\n")
    records = read_pose_records(tmp_path / "s.csv")
    assert isinstance(records["<b onload=x>.png"], PoseRecord)
    np.testing.assert_array_equal(records["<b onload=x>.png"].T_cam_target.t_m, [0.0, 0.0, 9.0])


def _leaves(content: object, path: tuple = ()) -> list[tuple]:
    """Paths to everything below `content`."""
    inner = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    return [path, *(leaf for key, value in inner for leaf in _leaves(value, (*path, key)))]


def _with(content: object, path: tuple, value: object) -> object:
    """`content` with `value` at `path`."""
    if not path:
        return value
    changed = dict(content) if isinstance(content, dict) else list(content)
    changed[path[0]] = _with(content[path[0]], path[1:], value)
    return changed


_NAMED = [format for format in WRITERS if format != "tum"]  # which has times for names, and neither JSON nor csv


@pytest.fixture(scope="module")
def valid_sets(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """One small set of every format, each in its folder."""
    labels = read_labels(make_dataset(tmp_path_factory.mktemp("valid") / "set", 2))
    folder = tmp_path_factory.mktemp("formats")
    options = WriteOptions(split="lightbox/test", images="none")
    return {format: write_labels(labels, folder / format, format, options) for format in _NAMED}


@settings(max_examples=250, deadline=None)
@given(format=st.sampled_from(_NAMED), data=st.data())
def test_any_change_of_a_valid_set_is_a_value_or_a_sentence(valid_sets, format, data) -> None:
    folder = valid_sets[format]
    path = data.draw(st.sampled_from(sorted(p for p in folder.rglob("*") if p.suffix in (".json", ".csv"))))
    before = path.read_bytes()
    if path.suffix == ".json":
        content = json.loads(before)
        leaf = data.draw(st.sampled_from(_leaves(content)))
        path.write_text(json.dumps(_with(content, leaf, data.draw(values))))
    else:
        rows = [line.split(",") for line in before.decode().splitlines()]
        row = data.draw(st.sampled_from(rows))
        row[data.draw(st.integers(0, len(row) - 1))] = data.draw(cells)
        path.write_text("\n".join(map(",".join, rows)), encoding="utf-8", errors="replace")
    try:
        tables = [] if format in ("proxnav", "urso", "speed+", "speed", "bop") else sorted(folder.rglob("*.csv"))
        for source in (folder, *tables):
            value_or_sentence_of_its_own(source, format)
    finally:
        path.write_bytes(before)


def value_or_sentence_of_its_own(path: Path, format: str) -> None:
    """As above, with nothing but what the set itself says; read through to the keypoints."""
    for name in ("auto", format):
        found = outcome(lambda name=name: read_labels(path, name))
        assert isinstance(found, Labels | InputError)
        assert "\n" not in str(found) or isinstance(found, Labels)


@pytest.mark.parametrize("format", ["spec2019", "spec2021", "spark", "krn", "spnv2", "urso", "speed+", "bop-results"])
@pytest.mark.parametrize("name", ["=1+1.png", "@SUM(1).png", "../../a.png", "/etc/passwd"])
def test_no_export_holds_such_names(name: str, format: str, labels: Labels, tmp_path: Path) -> None:
    """Wherever a name came from: no cell that a spreadsheet computes and no path that climbs is ever written."""
    evil = replace(labels, records=tuple(replace(r, filename=name) for r in labels.records[:1]))
    options = WriteOptions(split="lightbox/test", images="none", validation_share=0.0)
    with pytest.raises(InputError) as caught:
        write_labels(evil, tmp_path / "out", format, options)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()
