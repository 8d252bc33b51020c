"""Layouts of the standard ROS 2 messages that an export uses: common_interfaces, tf2_msgs, and Foxglove's annotations.

A layout is what travels in the file, so that it plays where these packages are not installed.
"""

_TIME = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec")
_HEADER = ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id")
_POINT = ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z")
_QUATERNION = ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w")
_POSE = ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation")
_POSE_COVARIANCE = ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance")
_VECTOR = ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z")
_TRANSFORM = ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation")
_STAMPED = (
    "geometry_msgs/TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform",
)
_REGION = (
    "sensor_msgs/RegionOfInterest",
    "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify",
)
_POINT2 = ("foxglove_msgs/Point2", "float64 x\nfloat64 y")
_COLOR = ("foxglove_msgs/Color", "float64 r\nfloat64 g\nfloat64 b\nfloat64 a")
_CIRCLE = (
    "foxglove_msgs/CircleAnnotation",
    "builtin_interfaces/Time timestamp\nfoxglove_msgs/Point2 position\nfloat64 diameter\nfloat64 thickness\n"
    "foxglove_msgs/Color fill_color\nfoxglove_msgs/Color outline_color",
)
_POINTS = (
    "foxglove_msgs/PointsAnnotation",
    "builtin_interfaces/Time timestamp\nuint8 type\nfoxglove_msgs/Point2[] points\nfoxglove_msgs/Color outline_color\n"
    "foxglove_msgs/Color[] outline_colors\nfoxglove_msgs/Color fill_color\nfloat64 thickness",
)
_TEXT = (
    "foxglove_msgs/TextAnnotation",
    "builtin_interfaces/Time timestamp\nfoxglove_msgs/Point2 position\nstring text\nfloat64 font_size\n"
    "foxglove_msgs/Color text_color\nfoxglove_msgs/Color background_color",
)

LINE_LOOP, POINTS = 2, 1
"""`type` of a PointsAnnotation."""


def _layout(fields: str, *parts: tuple[str, str]) -> str:
    return fields + "".join(f"\n{'=' * 80}\nMSG: {name}\n{layout}" for name, layout in parts) + "\n"


LAYOUTS = {
    "sensor_msgs/msg/CompressedImage": _layout("std_msgs/Header header\nstring format\nuint8[] data", _HEADER, _TIME),
    "sensor_msgs/msg/CameraInfo": _layout(
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\n"
        "float64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi",
        _HEADER, _TIME, _REGION,
    ),
    "geometry_msgs/msg/PoseStamped": _layout(
        "std_msgs/Header header\ngeometry_msgs/Pose pose", _HEADER, _TIME, _POSE, _POINT, _QUATERNION
    ),
    "geometry_msgs/msg/PoseWithCovarianceStamped": _layout(
        "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose",
        _HEADER, _TIME, _POSE_COVARIANCE, _POSE, _POINT, _QUATERNION,
    ),
    "tf2_msgs/msg/TFMessage": _layout(
        "geometry_msgs/TransformStamped[] transforms", _STAMPED, _HEADER, _TIME, _TRANSFORM, _VECTOR, _QUATERNION
    ),
    "foxglove_msgs/msg/ImageAnnotations": _layout(
        "foxglove_msgs/CircleAnnotation[] circles\nfoxglove_msgs/PointsAnnotation[] points\n"
        "foxglove_msgs/TextAnnotation[] texts",
        _CIRCLE, _POINTS, _TEXT, _TIME, _POINT2, _COLOR,
    ),
}  # fmt: skip
