"""Where is the target, and how sure is that? Named 3-D points and where a detector saw them give a pose."""

import numpy as np

import proxnav as pn
from proxnav.targets.loading import load_target


def main(noise_px: float = 0.7, seed: int = 0) -> pn.PoseResult:
    """Projects the keypoints of Space Rider, disturbs them, loses some, and solves for the pose."""
    camera = pn.Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
    target = load_target("space-rider")
    T_true = pn.Pose.from_wxyz("cam", "target", np.array([0.5, 0.5, -0.5, 0.5]), [1.0, -0.5, 40.0])

    rng = np.random.default_rng(seed)
    pixels = camera.project(T_true @ target.keypoints_m)
    pixels = pixels + rng.normal(0.0, noise_px, pixels.shape)
    pixels[::6] = np.nan  # not found
    pixels[1] += 80.0  # found in the wrong place
    covariances = np.tile(np.eye(2) * noise_px**2, (len(pixels), 1, 1))

    result = pn.estimate_pose(target.keypoints_m, pixels, camera, covariances_px2=covariances)
    print(f"status {result.status}, {int(result.inliers.sum())} of {len(pixels)} keypoints agree")
    if result.T_cam_target is None or result.covariance is None:
        return result

    sigma = np.sqrt(np.diagonal(result.covariance))
    errors = pn.pose_errors(result.T_cam_target, T_true)
    print(f"position {result.T_cam_target.t_m.round(3)} m, claimed sigma {sigma[:3].round(3)} m")
    print(f"attitude sigma {np.degrees(sigma[3:]).round(2)} deg")
    print(f"errors: {errors.e_t_norm_m:.3f} m, {np.degrees(errors.e_r_rad):.2f} deg, E_C {errors.e_c:.4f}")
    return result


if __name__ == "__main__":
    main()
