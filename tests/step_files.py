"""Polyhedra as STEP AP214 files, written by hand: flat coloured faces, lengths in a unit of one's choice."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

_HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('polyhedra'),'2;1');
FILE_NAME('','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('automotive design');
#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);
#3=PRODUCT_CONTEXT('',#1,'mechanical');
#4=PRODUCT('{name}','{name}','',(#3));
#5=PRODUCT_DEFINITION_FORMATION('','',#4);
#6=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#7=PRODUCT_DEFINITION('design','',#5,#6);
#8=PRODUCT_DEFINITION_SHAPE('','',#7);
#9=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT({prefix},.METRE.));
#10=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));
#11=(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT());
#12=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-05),#9,'distance_accuracy_value','');
#13=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#12))
GLOBAL_UNIT_ASSIGNED_CONTEXT((#9,#10,#11)) REPRESENTATION_CONTEXT('',''));
#14=CARTESIAN_POINT('',(0.,0.,0.));
#15=DIRECTION('',(0.,0.,1.));
#16=DIRECTION('',(1.,0.,0.));
#17=AXIS2_PLACEMENT_3D('',#14,#15,#16);
"""


Rgb = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Polyhedron:
    """A closed solid of flat faces."""

    name: str
    corners: Float[np.ndarray, "n 3"]
    faces: Sequence[tuple[int, ...]]
    """Corner indices, counter-clockwise seen from outside."""
    rgb: Rgb | Sequence[Rgb]
    """One colour, or one for each face."""


class _Lines:
    """Entities in order; each call gives the number of the one that it adds."""

    def __init__(self, first: int) -> None:
        self.text: list[str] = []
        self.next = first

    def add(self, entity: str) -> int:
        self.text.append(f"#{self.next}={entity};")
        self.next += 1
        return self.next - 1


def cuboid(name: str, low: Sequence[float], high: Sequence[float], rgb: Rgb | Sequence[Rgb]) -> Polyhedron:
    """A box between two opposite corners; faces at -x, +x, -y, +y, -z, +z."""
    corner = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)], dtype=np.float64)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Polyhedron(name, np.asarray(low) + corner * (np.asarray(high) - np.asarray(low)), quads, rgb)


def write_step(path: Path, solids: Sequence[Polyhedron], prefix: str = ".MILLI.") -> Path:
    """The solids as one part; `prefix` is that of the metre: .MILLI., .CENTI. or $ for none."""
    lines = _Lines(18)
    breps, styled = [], []
    for solid in solids:
        brep, faces = _solid(lines, solid)
        breps.append(brep)
        colours = dict(zip(faces, solid.rgb, strict=True)) if np.ndim(solid.rgb) == 2 else {brep: solid.rgb}
        styled += [_styled(lines, item, colour) for item, colour in colours.items()]
    listed = ",".join(f"#{brep}" for brep in breps)
    shape = lines.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',(#17,{listed}),#13)")
    lines.add(f"SHAPE_DEFINITION_REPRESENTATION(#8,#{shape})")
    styles = ",".join(f"#{item}" for item in styled)
    lines.add(f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({styles}),#13)")
    body = _HEAD.format(name=path.stem, prefix=prefix) + "\n".join(lines.text)
    path.write_text(body + "\nENDSEC;\nEND-ISO-10303-21;\n")
    return path


def _solid(lines: _Lines, solid: Polyhedron) -> tuple[int, list[int]]:
    """(a MANIFOLD_SOLID_BREP whose faces share their edges, its faces)."""
    points = [lines.add(f"CARTESIAN_POINT('',{_triple(p)})") for p in solid.corners]
    vertices = [lines.add(f"VERTEX_POINT('',#{p})") for p in points]
    edges: dict[tuple[int, int], int] = {}
    faces = [_face(lines, solid, face, points, vertices, edges) for face in solid.faces]
    shell = lines.add(f"CLOSED_SHELL('',({','.join(f'#{f}' for f in faces)}))")
    return lines.add(f"MANIFOLD_SOLID_BREP('{solid.name}',#{shell})"), faces


def _face(lines: _Lines, solid: Polyhedron, face: tuple[int, ...], points, vertices, edges) -> int:
    oriented = []
    for a, b in zip(face, (*face[1:], face[0]), strict=True):
        key = (min(a, b), max(a, b))
        if key not in edges:
            along = solid.corners[key[1]] - solid.corners[key[0]]
            length = float(np.linalg.norm(along))
            direction = lines.add(f"DIRECTION('',{_triple(along / length)})")
            vector = lines.add(f"VECTOR('',#{direction},{length!r})")
            line = lines.add(f"LINE('',#{points[key[0]]},#{vector})")
            edges[key] = lines.add(f"EDGE_CURVE('',#{vertices[key[0]]},#{vertices[key[1]]},#{line},.T.)")
        oriented.append(lines.add(f"ORIENTED_EDGE('',*,*,#{edges[key]},{'.T.' if key[0] == a else '.F.'})"))
    loop = lines.add(f"EDGE_LOOP('',({','.join(f'#{e}' for e in oriented)}))")
    bound = lines.add(f"FACE_OUTER_BOUND('',#{loop},.T.)")
    p = solid.corners[list(face[:3])]
    x, normal = p[1] - p[0], np.cross(p[1] - p[0], p[2] - p[1])
    axes = [lines.add(f"DIRECTION('',{_triple(v / np.linalg.norm(v))})") for v in (normal, x)]
    place = lines.add(f"AXIS2_PLACEMENT_3D('',#{points[face[0]]},#{axes[0]},#{axes[1]})")
    plane = lines.add(f"PLANE('',#{place})")
    return lines.add(f"ADVANCED_FACE('',(#{bound}),#{plane},.T.)")


def _styled(lines: _Lines, item: int, rgb: Rgb) -> int:
    colour = lines.add(f"COLOUR_RGB('',{rgb[0]!r},{rgb[1]!r},{rgb[2]!r})")
    fill = lines.add(f"FILL_AREA_STYLE_COLOUR('',#{colour})")
    area = lines.add(f"FILL_AREA_STYLE('',(#{fill}))")
    surface = lines.add(f"SURFACE_STYLE_FILL_AREA(#{area})")
    side = lines.add(f"SURFACE_SIDE_STYLE('',(#{surface}))")
    usage = lines.add(f"SURFACE_STYLE_USAGE(.BOTH.,#{side})")
    style = lines.add(f"PRESENTATION_STYLE_ASSIGNMENT((#{usage}))")
    return lines.add(f"STYLED_ITEM('color',(#{style}),#{item})")


def _triple(values) -> str:
    return f"({','.join(repr(float(v)) for v in values)})"
