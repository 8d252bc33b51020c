"""CCSDS messages in XML: the same numbers as in KVN, and damage in a sentence."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.errors import InputError, InputNote
from proxnav.geometry import quaternion
from proxnav.trajectories import ReaderConfig, read_trajectory
from proxnav.trajectories.readers.ccsds import read_aem, read_oem

DATA = Path(__file__).parents[1] / "data" / "trajectories"
HEAD = "<header><CREATION_DATE>2026-01-01T00:00:00</CREATION_DATE><ORIGINATOR>TEST</ORIGINATOR></header>"


def element(name: str, value: object, units: str = "") -> str:
    return f'<{name} units="{units}">{value}</{name}>' if units else f"<{name}>{value}</{name}>"


def xml_of(kvn: Path) -> str:
    """A message of one META section as an element, written after 505.0-B."""
    lines = [line.strip() for line in kvn.read_text().splitlines() if line.strip()]
    start, stop = lines.index("META_START"), lines.index("META_STOP")
    kind = "oem" if "OEM" in lines[0] else "aem"
    version = lines[0].split("=")[1].strip()
    meta = "".join(element(*(part.strip() for part in line.split("="))) for line in lines[start + 1 : stop])
    rows = [line.split() for line in lines[stop + 1 :] if not line.startswith("DATA")]
    make = state if kind == "oem" else attitude
    body = f"<segment><metadata>{meta}</metadata><data>{''.join(make(row) for row in rows)}</data></segment>"
    return f'<{kind} id="CCSDS_{kind.upper()}_VERS" version="{version}">{HEAD}<body>{body}</body></{kind}>'


def state(row: list[str]) -> str:
    places = "".join(element(n, x, "km") for n, x in zip(("X", "Y", "Z"), row[1:4], strict=True))
    speeds = "".join(element(n, x, "km/s") for n, x in zip(("X_DOT", "Y_DOT", "Z_DOT"), row[4:7], strict=True))
    return f"<stateVector>{element('EPOCH', row[0])}{places}{speeds}</stateVector>"


def attitude(row: list[str]) -> str:
    parts = "".join(element(n, x) for n, x in zip(("Q1", "Q2", "Q3", "QC"), row[1:], strict=True))
    inner = f"{element('EPOCH', row[0])}<quaternion>{parts}</quaternion>"
    return f"<attitudeState><quaternionEphemeris>{inner}</quaternionEphemeris></attitudeState>"


def write(folder: Path, name: str) -> Path:
    path = folder / f"{name}.xml"
    path.write_text(f'<?xml version="1.0" encoding="UTF-8"?>\n{xml_of(DATA / name)}\n')
    return path


def test_orbits_in_xml_are_those_in_kvn(tmp_path):
    (kvn,), (xml,) = read_oem(DATA / "ok.oem"), read_oem(write(tmp_path, "ok.oem"))
    assert (xml.name, xml.epoch, xml.frame, xml.method, xml.nodes) == (
        kvn.name, kvn.epoch, kvn.frame, kvn.method, kvn.nodes
    )  # fmt: skip
    assert xml.segments[0].values == pytest.approx(kvn.segments[0].values, abs=1e-9)
    assert xml.segments[0].rates == pytest.approx(kvn.segments[0].rates, abs=1e-12)


@pytest.mark.parametrize("name", ["v2.aem", "lvlh.aem"])
def test_attitudes_in_xml_are_those_in_kvn(tmp_path, name):
    (kvn,), (xml,) = read_aem(DATA / name), read_aem(write(tmp_path, name))
    assert (xml.name, xml.epoch, xml.frame, xml.nodes) == (kvn.name, kvn.epoch, kvn.frame, kvn.nodes)
    assert np.max(quaternion.angle_between(xml.segments[0].values, kvn.segments[0].values)) < 1e-12


def test_a_combined_message_with_name_spaces_holds_the_whole_flight(tmp_path):
    path = tmp_path / "flight.xml"
    parts = "".join(xml_of(DATA / name) for name in ("ok.oem", "chaser.oem", "v2.aem"))
    path.write_text(f'<ndm xmlns="urn:ccsds:schema:ndmxml"><MESSAGE_ID>1</MESSAGE_ID>{parts}</ndm>')
    flight = read_trajectory([path])
    kvn = read_trajectory([DATA / name for name in ("ok.oem", "chaser.oem", "v2.aem")])
    assert flight.r_eci_chaser_m == pytest.approx(kvn.r_eci_chaser_m, abs=1e-9)
    assert flight.q_eci_target == pytest.approx(kvn.q_eci_target, abs=1e-12)


def test_covariances_are_noted(tmp_path):
    path = write(tmp_path, "ok.oem")
    path.write_text(path.read_text().replace("</data>", "<covarianceMatrix><CX_X>1</CX_X></covarianceMatrix></data>"))
    with pytest.warns(InputNote, match=r"orbit of TARGET: its 1 covariance matrices are not used"):
        read_trajectory([path, DATA / "chaser.oem"], ReaderConfig())


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [("</oem>", "", "not readable as XML"), ("<oem ", "<!DOCTYPE oem><oem ", "declares a document type"),
     ('<oem id="', '<opm id="', "not readable as XML"), ("<X units=\"km\">", "<X units=\"m\">", "X is in m, the"),
     (">6778.137000000<", ">much<", "expected a number in <X>, found 'much'"),
     ("2026-01-01T00:01:00.000", "soon", "line 2"),
     ("stateVector", "elements", "no data rows follow"), ("segment>", "part>", "holds no <segment>"),
     ("metadata>", "m>", "lacks <metadata> or <data>")],
)  # fmt: skip
def test_a_damaged_message_is_one_sentence(tmp_path, old, new, said):
    path = write(tmp_path, "ok.oem")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=said) as error:
        read_trajectory([path])
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_another_xml_file_is_said_to_be_none(tmp_path):
    path = tmp_path / "page.xml"
    path.write_text("<html><body/></html>")
    with pytest.raises(InputError, match="an XML file of <html>; a trajectory is an <oem>"):
        read_trajectory([path])
