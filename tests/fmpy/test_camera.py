"""The camera against OpenCV and against the geometry typed in again."""

import cv2
import numpy as np
import pytest

R, L1, L2, GROUND, SCALE = 1.0, 6.19, 6.9, -8.0, 25.6  # world units; 25.6 px a world unit


def centres(q1, q2):
    """Places of the three circles in pixels, u right, v up."""
    drum = np.array([R * q1, GROUND + R])
    joint = drum + L1 * np.array([np.sin(q1), np.cos(q1)])
    tip = joint + L2 * np.array([np.sin(q2), np.cos(q2)])
    return SCALE * np.array([drum, joint, tip])


def look(unit, q1, q2, **values):
    """One frame of a resting arm: the unit after initialisation, with frame 0 delivered."""
    return unit("camera").start(q1=q1, q2=q2, **values)


def centroids(camera):
    return np.array(camera.get("u1", "v1", "u2", "v2", "u3", "v3")).reshape(3, 2)


def test_simulated_alone(unit):
    camera = look(unit, 0.1, -0.2)
    assert camera.get("valid") and camera.get("frame") == 1
    assert camera.get("t_mid") == pytest.approx(-0.005 / 30, abs=1e-15)  # E_t/(2 omega_cam) before the end at 0
    camera.step(0.0, 1.0)
    assert camera.get("frame") == 31, "a step may hold any number of frames"
    assert np.abs(centroids(camera) - centres(0.1, -0.2)).max() < 0.3  # px; binary centroids err by 0.08 rms
    assert camera.get("q1_est", "q2_est") == pytest.approx([0.1, -0.2], abs=2e-3)  # C17: max 1.2e-3


@pytest.mark.parametrize("threshold,sigma,area_expected,rms_expected", [(128, 0.0, 82.35, 0.081), (191, 0.0, 75.0, None)])
def test_clean_centroids(unit, threshold, sigma, area_expected, rms_expected):
    rng = np.random.default_rng(5)
    camera = look(unit, 0.0, 0.0, threshold=threshold, omega_cam=30.0, sigma=sigma)
    errors, areas = [], []
    for k in range(400):
        q = rng.uniform(-0.3, 0.3, 2)
        camera.set(q1=q[0], q2=q[1]).step(k / 30, 1 / 30)
        # A still picture: the pose moves before the shutter opens, so take the second frame of each pose.
        errors.append((centroids(camera) - centres(*q)).ravel())
        areas.append(camera.get("area1", "area2", "area3"))
    assert np.mean(areas) == pytest.approx(area_expected, abs=1.0)  # C15: 75 +- 1 px; the disc has 82.35
    if rms_expected:
        # Circle 1 hardly leaves its row, so only the other two sample the lattice evenly.
        assert np.std(np.array(errors)[:, 2:]) == pytest.approx(rms_expected, rel=0.05)


def test_opencv_finds_the_same_centroids_in_the_written_frames(unit, tmp_path):
    camera = look(unit, 0.2, 0.9, k1=0.1, sigma=4.0, frames_dir=str(tmp_path / "frames"))
    picture = cv2.imread(str(tmp_path / "frames" / "frame_000000.png"), cv2.IMREAD_GRAYSCALE)
    assert picture.shape == (512, 512)
    _, _, stats, found = cv2.connectedComponentsWithStats((picture >= 191).astype(np.uint8), connectivity=8)
    ours = centroids(camera)
    keep = [i for i in range(1, len(stats)) if 40 <= stats[i, cv2.CC_STAT_AREA] <= 130]
    assert len(keep) == 3
    theirs = np.array([[found[i][0] + 0.5 - 256.0, 256.0 - (found[i][1] + 0.5)] for i in keep])
    for place in ours:  # the same pixels, so the same sums; only the division rounds
        assert np.abs(theirs - place).sum(axis=1).min() < 1e-9
    assert sorted(stats[i, cv2.CC_STAT_AREA] for i in keep) == sorted(camera.get("area1", "area2", "area3"))


def test_noise_in_the_written_frames(unit, tmp_path):
    """sigma = 15 on a background of 128: what a user measures on the PNG files, after rounding to 8 bits."""
    camera = unit("camera").start(background=128.0, threshold=250, sigma=15.0, frames_dir=str(tmp_path), q1=0.0, q2=0.0)
    camera.step(0.0, 0.2)
    mask = np.ones((512, 512), bool)
    mask[:, 200:312] = False  # the arm
    values = np.concatenate(
        [cv2.imread(str(tmp_path / f"frame_{k:06}.png"), cv2.IMREAD_GRAYSCALE)[mask].astype(float) for k in range(6)]
    )
    # 1.2e6 values: the mean is known to 0.014, the deviation to 0.0007 of itself.
    assert values.mean() == pytest.approx(128.0, abs=0.06)
    assert values.std() == pytest.approx(np.sqrt(15.0**2 + 1 / 12), rel=0.004)


def test_lost_identification_holds_the_estimate(unit):
    camera = look(unit, 0.05, 0.1)
    before = camera.get("q1_est", "q2_est")
    camera.set(threshold=255, N_min=100).step(0.0, 0.1)
    assert not camera.get("valid") and camera.get("q1_est", "q2_est") == before
    assert camera.get("frame") == 4, "frames are still delivered"


def test_delay_need_not_be_a_multiple_of_anything(unit):
    camera = unit("camera").start(T_delay=0.0123, q1=0.0, q2=0.0)
    assert camera.get("frame") == 0 and not camera.get("valid")
    camera.step(0.0, 0.012)
    assert camera.get("frame") == 0
    camera.step(0.012, 0.001)
    assert camera.get("frame") == 1
