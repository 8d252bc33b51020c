"""Other people's data sets and pose files, in and out, through one form in memory."""

from proxnav.datasets.formats.labels import LabelRecord, Labels
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.read import READERS, read_labels, read_pose_records
from proxnav.datasets.formats.write import WRITERS, write_labels

__all__ = [
    "READERS", "WRITERS", "LabelRecord", "Labels", "ReadOptions", "WriteOptions", "read_labels", "read_pose_records",
    "write_labels",
]  # fmt: skip
