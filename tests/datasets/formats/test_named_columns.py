"""Tables with a header are read by their names; what contradicts is refused."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.datasets.formats import Labels, ReadOptions, read_labels, write_labels
from proxnav.datasets.formats.pose_bowl import read_pose_bowl
from proxnav.errors import InputError
from proxnav.geometry import Camera

CAMERA = Camera(64, 48, 60.0, 61.0, 32.0, 24.0)


def read(tmp_path: Path, text: str, format: str = "auto", **options: object) -> Labels:
    (tmp_path / "t.csv").write_text(text)
    return read_labels(tmp_path / "t.csv", format, ReadOptions(**options))


def values(header: str, separator: str = ",") -> str:
    """A row under a header of any order: 0.8, 0.6, 0, 0 (wxyz) at (0.1, 0.2, 10) m."""
    known = {"qw": "0.8", "qx": "0.6", "qy": "0", "qz": "0", "tx": "0.1", "ty": "0.2", "tz": "10"}
    known |= {"category": "sunlamp", "filename": "img000.png", "image": "img000.png", "sequence": "RT000"}
    names = [name.strip().lower().replace("_", "").replace("quat", "q") for name in header.split(separator)]
    cells = [known.get(name) or known["t" + name] for name in names]
    return header + "\n" + separator.join(cells) + "\n"


HEADERS = [
    "filename,sequence,Tx,Ty,Tz,Qx,Qy,Qz,Qw",
    "filename,sequence,Tx,Ty,Tz,Qw,Qx,Qy,Qz",
    "filename,sequence,Qw,Qx,Qy,Qz,Tx,Ty,Tz",
    "Qz,Tz,filename,Qy,Ty,Qx,Tx,sequence,Qw",
    "sequence,filename,Tz,Ty,Tx,Qy,Qx,Qw,Qz",
    "image,x,y,z,qw,qx,qy,qz",
    "filename,q_x,q_y,q_z,q_w,t_x,t_y,t_z",
    "category,filename,qw,qx,qy,qz,tx,ty,tz",
    "filename,quat_w,quat_x,quat_y,quat_z,tx,ty,tz",
]


@pytest.mark.parametrize("header", HEADERS)
def test_columns_are_read_by_their_names_in_any_order(header: str, tmp_path: Path) -> None:
    (record,) = read(tmp_path, values(header)).records
    np.testing.assert_allclose(record.T_cam_target.q_wxyz, [0.8, 0.6, 0.0, 0.0])
    np.testing.assert_allclose(record.T_cam_target.t_m, [0.1, 0.2, 10.0])
    assert record.filename == "img000.png"


def test_semicolons_separate_as_well(tmp_path: Path) -> None:
    (record,) = read(tmp_path, values("filename;sequence;Tx;Ty;Tz;Qw;Qx;Qy;Qz", ";")).records
    np.testing.assert_allclose(record.T_cam_target.q_wxyz, [0.8, 0.6, 0.0, 0.0])


@pytest.mark.parametrize(("unit", "metres"), [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("km", 1e3)])
@pytest.mark.parametrize("form", ["T{} [{}]", "T{} ({})", "T{}_{}", "t{}[{}]"])
def test_the_unit_of_a_header_is_kept(form: str, unit: str, metres: float, tmp_path: Path) -> None:
    axes = ",".join(form.format(axis, unit) for axis in "xyz")
    (record,) = read(tmp_path, f"filename,{axes},qw,qx,qy,qz\na.png,100,200,3000,1,0,0,0\n").records
    np.testing.assert_allclose(record.T_cam_target.t_m, np.array([100.0, 200.0, 3000.0]) * metres)


def test_the_row_with_scalar_first_under_spark_is_not_read_as_scalar_last(tmp_path: Path) -> None:
    text = "filename,sequence,Tx,Ty,Tz,Qw,Qx,Qy,Qz\nimg000.png,RT000,0.1,0.2,10.0,0.8,0.6,0.0,0.0\n"
    (record,) = read(tmp_path, text, "spark").records
    np.testing.assert_allclose(record.T_cam_target.q_wxyz, [0.8, 0.6, 0.0, 0.0])


def test_numbered_quaternions_are_in_the_order_of_the_format_or_of_the_option(tmp_path: Path) -> None:
    text = "filename,q1,q2,q3,q4,r1,r2,r3\na.png,0.8,0.6,0,0,0,0,9\n"
    np.testing.assert_allclose(read(tmp_path, text).records[0].T_cam_target.q_wxyz, [0.8, 0.6, 0, 0])
    last = read(tmp_path, text, quaternion_order="xyzw").records[0].T_cam_target.q_wxyz
    np.testing.assert_allclose(last, [0, 0.8, 0.6, 0])
    zero = read(tmp_path, text.replace("q1,q2,q3,q4", "q0,q1,q2,q3")).records[0].T_cam_target.q_wxyz
    np.testing.assert_allclose(zero, [0.8, 0.6, 0, 0])


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("filename,sequence,Tx,Ty,Tz,Qw,Qx,Qy\na.png,s,0,0,9,1,0,0\n", "no column for a quaternion"),
        ("filename,Tx,Ty,Tz,roll,pitch,yaw\na.png,0,0,9,1,0,0\n", "no column for a quaternion"),
        ("filename,Tx,Ty,Tx,Qw,Qx,Qy,Qz\na.png,0,0,9,1,0,0,0\n", "column 'tx' twice"),
        ("Tx,Ty,Tz,Qw,Qx,Qy,Qz\n0,0,9,1,0,0,0\n", "no column for filename"),
        ("filename,Tx [mm],Ty [m],Tz [m],Qw,Qx,Qy,Qz\na.png,0,0,9,1,0,0,0\n", "in one unit"),
        ("filename,Tx [ft],Ty [ft],Tz [ft],Qw,Qx,Qy,Qz\na.png,0,0,9,1,0,0,0\n", "in one unit"),
        ("filename,Tx,Ty,Tz,Qw,Qx,Qy,Qz\na.png,0,0,9,1,0,0\n", "expected 8 columns"),
        ("chain_id,i,x,y,z,qw,qx,qy,qz\na0a,0,0,0,0,1,0,0,0\n", "camera moved since the first image"),
    ],
)
@pytest.mark.parametrize("format", ["auto", "spark"])
def test_a_header_that_lacks_or_contradicts_is_one_sentence(text: str, found: str, format: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=found) as error:
        read(tmp_path, text, format)
    assert "\n" not in str(error.value)


def test_a_pose_bowl_table_without_its_header_is_no_spark_table(tmp_path: Path) -> None:
    for format in ("auto", "spark"):
        with pytest.raises(InputError, match=r"file name of an image, found 'a0a'|none of spec2019"):
            read(tmp_path, "a0a,0,0,0,0,1,0,0,0\na0a,1,1,2,3,0.8,0.6,0,0\n", format)


def test_an_option_that_contradicts_the_header_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"names qw, qx, qy, qz; --quaternion-order xyzw contradicts it"):
        read(tmp_path, values(HEADERS[1]), quaternion_order="xyzw")
    assert len(read(tmp_path, values(HEADERS[0]), quaternion_order="xyzw")) == 1


@pytest.mark.parametrize("format", ["krn", "spnv2"])
def test_the_lists_of_keypoints_are_read_by_a_header_too_and_without_points(
    format: str, labels: Labels, tmp_path: Path
) -> None:
    table = next(write_labels(labels, tmp_path / "out", format).rglob("train.csv"))
    rows = [line.split(",") for line in table.read_text().splitlines()]
    before = read_labels(table).records[0]
    sides = "xmin,xmax,ymin,ymax" if format == "krn" else "xmin,ymin,xmax,ymax"
    head = ["filename", *sides.split(","), "qw", "qx", "qy", "qz", "tx", "ty", "tz"]
    head += [f"{axis}{k}" for k in range((len(rows[0]) - 12) // 2) for axis in "uv"]
    turned = [4, 0, 2, 1, 3, 8, 9, 10, 11, 5, 6, 7, *range(12, len(head))]
    table.write_text("\n".join(",".join(row[k] for k in turned) for row in [head, *rows]) + "\n")
    after = read_labels(table).records[0]
    np.testing.assert_array_equal(after.T_cam_target.matrix(), before.T_cam_target.matrix())
    np.testing.assert_array_equal(after.box_xyxy, before.box_xyxy)
    np.testing.assert_array_equal(after.keypoints_px, before.keypoints_px)
    table.write_text("\n".join(",".join(row[:12]) for row in rows) + "\n")
    assert read_labels(table).records[0].keypoints_px is None


def test_a_pose_bowl_table_is_motion_of_the_camera(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text(
        "chain_id,i,x,y,z,qw,qx,qy,qz\na0a,0,0,0,0,1,0,0,0\na0a,1,1.0,2.0,3.0,0.8,0.6,0,0\n"
    )
    found = read_pose_bowl(tmp_path / "p.csv")
    np.testing.assert_allclose(found["a0a", 1].t_m, [1.0, 2.0, 3.0])
    np.testing.assert_allclose(found["a0a", 1].q_wxyz, [0.8, 0.6, 0.0, 0.0])
    (tmp_path / "p.csv").write_text("chain_id,i,x,y,z,qw,qx,qy,qz\na0a,0,0,0,1,1,0,0,0\n")
    with pytest.raises(InputError, match="image 0 of a chain is its reference"):
        read_pose_bowl(tmp_path / "p.csv")
