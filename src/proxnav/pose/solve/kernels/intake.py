"""Which of the given points can be used at all."""

import math

from proxnav.geometry.compiled.kernel import kernel


@kernel
def admit(points, pixels, covariances, scores, min_score, width, height, margin, keep, label):
    """Flags usable points; `label` is the index of the first point at the same place. Returns (kept, places).

    Out go: NaN and infinity, scores not above `min_score`, pixels further outside the image than `margin` times its
    size, covariances that are not positive, and repeats of the same place and pixel.
    """
    kept, places = 0, 0
    for i in range(len(points)):
        label[i] = i
        u, v = pixels[i, 0], pixels[i, 1]
        a, c = covariances[i, 0, 0], covariances[i, 1, 1]
        b = 0.5 * (covariances[i, 0, 1] + covariances[i, 1, 0])
        keep[i] = (
            math.isfinite(points[i, 0] + points[i, 1] + points[i, 2])
            and -margin * width <= u <= (1.0 + margin) * width
            and -margin * height <= v <= (1.0 + margin) * height
            and scores[i] > min_score
            and a >= 0.0
            and c >= 0.0
            and a * c - b * b >= 0.0
            and math.isfinite(a + c)
        )
        if not keep[i]:
            continue
        new_place = True
        for j in range(i):
            same = points[i, 0] == points[j, 0] and points[i, 1] == points[j, 1] and points[i, 2] == points[j, 2]
            if keep[j] and same:
                new_place = False
                label[i] = label[j]
                if u == pixels[j, 0] and v == pixels[j, 1]:
                    keep[i] = False
                    break
        kept += keep[i]
        places += new_place
    return kept, places
