"""A camera matrix and distortion coefficients, as OpenCV, ROS and NumPy users keep them: pixel centres are whole."""

from dataclasses import replace

from proxnav.errors import InputError
from proxnav.geometry.camera import Camera
from proxnav.geometry.camera_files.fields import Fields, upright, whole
from proxnav.geometry.camera_files.pixel_origin import CENTRE, stated, to_corner

MATRIX = ("camera_matrix", "cameramatrix", "k", "mtx", "m", "intrinsic_matrix", "camera_intrinsics", "intrinsics")
DISTORTION = (
    "distortion_coefficients", "distcoeffs", "dist_coeffs", "distortion_coeffs", "dist", "d", "distortion",
)  # fmt: skip
_ROS_COUNTS = {"plumb_bob": (0, 4, 5), "rational_polynomial": (8, 12, 14), "equidistant": (4,)}


def is_one(fields: Fields) -> bool:
    """Whether these are the fields of such a file."""
    return bool(fields.names & set(MATRIX))


def read_matrices(fields: Fields) -> tuple[Camera, tuple[str, ...]]:
    """(camera, notes)."""
    K = fields.numbers(9, *MATRIX)
    if K is None:
        raise InputError(f"{fields.where}: the camera matrix is empty")
    if not K.any():
        raise InputError(f"{fields.where}: the camera matrix is all zeros, as of a camera that is not calibrated yet")
    (fx, _, cx), (_, fy, cy), _ = upright(K.reshape(3, 3), fields.where).tolist()
    width, height = fields.size("add image_width and image_height, in an npz width and height")
    k = fields.numbers(None, *DISTORTION)
    _check_count(fields, 0 if k is None else len(k))
    (cx, cy), notes = to_corner(cx, cy, stated(fields) or CENTRE)
    projection = fields.projection()
    coefficients = tuple(k.tolist()) if k is not None else (0.0,) * (4 if projection == "fisheye" else 5)
    camera = Camera(width, height, fx, fy, cx, cy, coefficients, projection, fields.calibration_sigma())
    camera, as_delivered = _delivered(camera, fields)
    return camera, (*notes, *as_delivered, *_other_projection(fields, fx, fy))


def _check_count(fields: Fields, count: int) -> None:
    model = str(fields.find("distortion_model")).lower()
    wanted = _ROS_COUNTS.get(model)
    if wanted is not None and count not in wanted:
        raise InputError(
            f"{fields.where}: {model} has {' or '.join(str(n) for n in wanted if n)} coefficients, found {count}; "
            "correct the distortion_model"
        )


def _delivered(camera: Camera, fields: Fields) -> tuple[Camera, tuple[str, ...]]:
    """The camera of the image that ROS delivers: a region of the sensor, then binned."""
    notes = list[str]()
    roi = fields.find("roi")
    if isinstance(roi, dict) and (Fields(roi, fields.where).number("width") or 0) > 0:
        part = Fields(roi, f"{fields.where}: roi")
        x, y = part.number("x_offset") or 0.0, part.number("y_offset") or 0.0
        width, height = part.size("it needs width and height")
        if x + width > camera.width or y + height > camera.height:
            raise InputError(f"{part.where} reaches beyond the image of {camera.width} x {camera.height} px")
        camera = camera.cropped(x, y, width, height)
        notes.append(f"camera of the region of {width} x {height} px at ({x:g}, {y:g})")
    bx, by = (whole(fields.number(name) or 1.0, fields.where) for name in ("binning_x", "binning_y"))
    if bx > 1 or by > 1:
        width, height = camera.width // bx, camera.height // by
        whole_bins = replace(camera, width=width * bx, height=height * by)
        camera = whole_bins.resized(width, height)
        notes.append(f"binned {bx} x {by} to {width} x {height} px")
    return camera, tuple(notes)


def _other_projection(fields: Fields, fx: float, fy: float) -> tuple[str, ...]:
    """A note where ROS's projection matrix, that of rectified images, is another camera."""
    P = fields.numbers(12, "projection_matrix", "p")
    if P is None or not P.any():
        return ()
    P = P.reshape(3, 4)
    notes = list[str]()
    if abs(P[0, 0] - fx) > 1e-6 * fx or abs(P[1, 1] - fy) > 1e-6 * fy:
        notes.append(
            "camera_matrix is taken, for images as the camera gives them; rectified ones have projection_matrix "
            f"(fx {P[0, 0]:g} px)"
        )
    if P[0, 3] != 0.0 or P[1, 3] != 0.0:
        notes.append("the baseline in projection_matrix is left aside: one camera, not a stereo pair")
    return tuple(notes)
