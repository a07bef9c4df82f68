"""shisei.fuse on a simulated take; the simulation is written here, apart from the package."""
import dataclasses

import numpy as np
import pytest

import shisei

Rotation = pytest.importorskip("scipy.spatial.transform").Rotation
G = 9.80665
MOUNTING = Rotation.from_rotvec([0.3, -1.1, 0.7])  # body from sensor
LEVER = np.array([0.03, -0.02, 0.05])  # of the sensor, in body axes
OFFSET_S = 1.7  # sensor time at optical time 0


def sines(seed, count, low_hz, high_hz):
    rng = np.random.default_rng(seed)
    return rng.uniform(low_hz, high_hz, (count, 3)) * 2 * np.pi, rng.uniform(0, 2 * np.pi, (count, 3))


def motion(t):
    """Position and attitude of the body in a y-up world at times t."""
    (w, a), (v, b) = sines(1, 4, 0.1, 0.8), sines(2, 4, 0.1, 0.7)
    position = sum(0.12 * np.sin(np.outer(t, w[k]) + a[k]) for k in range(4)) + [0, 1, 0]
    attitude = Rotation.from_euler("YXZ", sum(0.45 * np.sin(np.outer(t, v[k]) + b[k]) for k in range(4)))
    return position, attitude


def take(lost=((8.0, 9.0), (14.0, 16.0)), duration=25.0):
    rng = np.random.default_rng(3)
    time = np.arange(int(duration * 120)) / 120
    position, attitude = motion(time)
    seen = position + rng.normal(0, 1e-4, position.shape)
    q = np.roll((attitude * Rotation.from_rotvec(rng.normal(0, 3e-4, position.shape))).as_quat(), 1, axis=1)
    for start, end in lost:
        hidden = (time >= start) & (time < end)
        seen[hidden], q[hidden] = np.nan, np.nan
    return shisei.OpticalTake(time, seen, q), position, attitude


def sensor(duration=25.0, rate=200, seed=4):
    """Rates as means of the steps, accelerations by differences of a fine path; noise and biases on top."""
    rng = np.random.default_rng(seed)
    t = np.arange(int(duration * rate)) / rate
    h = 1e-3
    where = lambda at: motion(at)[0] + motion(at)[1].apply(LEVER)  # noqa: E731
    acceleration = (where(t + h) - 2 * where(t) + where(t - h)) / h**2
    now, before = motion(t)[1] * MOUNTING, motion(t - 1 / rate)[1] * MOUNTING
    gyro = (before.inv() * now).as_rotvec() * rate
    acc = now.inv().apply(acceleration + [0, G, 0])
    return shisei.ImuRecording(t + OFFSET_S, acc + [0.05, -0.03, 0.02] + rng.normal(0, 0.02, acc.shape),
                               gyro + [0.004, -0.002, 0.003] + rng.normal(0, 0.002, acc.shape))


def test_gaps_are_filled_and_the_rest_is_left_alone():
    optical, position, attitude = take()
    imu = sensor()
    fused = shisei.fuse(optical, imu)
    seen = ~np.isnan(optical.position_m[:, 0])
    assert (fused.source[seen] == "optical").all() and (fused.source[~seen] == "bridged").all()
    np.testing.assert_array_equal(fused.position_m[seen], optical.position_m[seen])
    moved = np.linalg.norm(fused.position_m - position, axis=1)[~seen]
    q = Rotation.from_quat(np.roll(fused.q_wxyz, -1, axis=1))
    turned = np.degrees((q.inv() * attitude).magnitude())[~seen]
    assert np.sqrt((moved**2).mean()) < 0.012 and np.sqrt((turned**2).mean()) < 0.25, (moved.max(), turned.max())
    assert (moved < 4 * fused.sigma_m[~seen] + 1e-3).mean() > 0.95
    assert [(g.first, g.end) for g in fused.gaps] == [(960, 1080), (1680, 1920)]
    assert all(g.source == "bridged" and 0 < g.sigma_m < 0.1 for g in fused.gaps)
    assert abs(fused.sync.offset_s - OFFSET_S) < 2e-3 and fused.sync.explained > 0.99
    mounting = Rotation.from_quat(np.roll(fused.sync.body_from_sensor, -1))
    assert np.degrees((mounting.inv() * MOUNTING).magnitude()) < 0.3
    np.testing.assert_allclose(fused.lever_arm_m, LEVER, atol=0.01)
    assert fused.up[1] > 0.9999 and fused.axes == "y-up"
    columns = fused.columns()
    assert list(columns)[:9] == ["frame", "time_s", "p_x", "p_y", "p_z", "q_w", "q_x", "q_y", "q_z"]
    assert all(len(column) == len(optical.time_s) for column in columns.values())


def test_a_marker_that_is_still_seen_holds_the_body():
    optical, position, attitude = take(lost=((8.0, 16.0),))
    imu, rng = sensor(), np.random.default_rng(6)
    places = {"front": np.array([0.06, 0.01, 0.0]), "left": np.array([0.0, 0.02, 0.05])}
    markers = {k: position + attitude.apply(at) + rng.normal(0, 1e-4, position.shape) for k, at in places.items()}
    markers["left"][960:1920] = np.nan
    marked = dataclasses.replace(optical, markers_m=markers)
    lost = np.isnan(optical.position_m[:, 0])
    bare, fused = shisei.fuse(optical, imu), shisei.fuse(marked, imu)
    off = lambda found: np.linalg.norm(found.position_m - position, axis=1)[lost].max()  # noqa: E731
    assert off(fused) < 2e-3 and off(bare) > 10 * off(fused), (off(fused), off(bare))
    assert (fused.held == lost).all() and not bare.held.any() and bare.markers == {}
    assert (fused.source[lost] == "bridged").all() and (fused.gap_s[lost] == 0).all()
    assert fused.gaps[0].sigma_m < 0.003 < bare.gaps[0].sigma_m
    for name, at in places.items():
        np.testing.assert_allclose(fused.markers[name].at_m, at, atol=1e-4)
    few = dataclasses.replace(optical, markers_m={"once": np.where(np.arange(len(position))[:, None] < 20, position, np.nan)})
    assert shisei.fuse(few, imu).markers == {"once": None}
    with pytest.raises((shisei.ShapeError, shisei.DomainError)):
        shisei.fuse(dataclasses.replace(optical, markers_m={"short": position[:-1]}), imu)


def test_data_frames_and_mappings_are_the_same_recording():
    optical, _, _ = take()
    imu = sensor()
    expected = shisei.fuse(optical, imu).position_m
    mapping = {"time_s": imu.time_s, "acc_m_s2": imu.acc_m_s2, "gyro_rad_s": imu.gyro_rad_s}
    np.testing.assert_array_equal(shisei.fuse(optical, mapping).position_m, expected)
    pandas = pytest.importorskip("pandas")
    columns = {"time_s": imu.time_s, **{f"acc_{a}": imu.acc_m_s2[:, k] for k, a in enumerate("xyz")},
               **{f"gyr_{a}": imu.gyro_rad_s[:, k] for k, a in enumerate("xyz")}}
    np.testing.assert_array_equal(shisei.fuse(optical, pandas.DataFrame(columns)).position_m, expected)
    with pytest.raises(shisei.ShapeError, match="gyr"):
        shisei.fuse(optical, pandas.DataFrame(columns).drop(columns="gyr_x"))


def motive_csv(path, optical):
    """A take as Motive 1.24 writes it: quaternions x y z w, blank cells where the body was lost."""
    with open(path, "w", encoding="utf-8") as file:
        file.write("Format Version,1.24,Take Name,test,Capture Frame Rate,120.000000,Export Frame Rate,120.000000,"
                   f"Total Frames in Take,{len(optical.time_s)},Rotation Type,Quaternion,Length Units,Meters,"
                   "Coordinate Space,Global\n\n")
        file.write(",Type" + ",Rigid Body" * 7 + "\n,Name" + ",Tool" * 7 + "\n,ID" + ",1" * 7 + "\n")
        file.write("," + ",Rotation" * 4 + ",Position" * 3 + "\nFrame,Time (Seconds),X,Y,Z,W,X,Y,Z\n")
        for k, (p, q) in enumerate(zip(optical.position_m, optical.q_wxyz)):
            cells = [""] * 7 if np.isnan(p[0]) else [f"{x:.9f}" for x in (*q[1:], q[0], *p)]
            file.write(",".join([str(k), f"{k / 120:.6f}", *cells]) + "\n")


def test_files_are_read_where_paths_are_given(tmp_path):
    optical, _, _ = take()
    imu = sensor()
    motive_csv(tmp_path / "take.csv", optical)
    rows = np.column_stack([imu.time_s, imu.acc_m_s2, imu.gyro_rad_s])
    np.savetxt(tmp_path / "imu.csv", rows, delimiter=",", header="time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z", comments="")
    read = shisei.read_motive(tmp_path / "take.csv", body="tool")
    assert read.name == "Tool" and read.axes == "y-up" and (read.frame == np.arange(len(optical.time_s))).all()
    np.testing.assert_allclose(read.position_m, optical.position_m, atol=1e-8)
    fused = shisei.fuse(tmp_path / "take.csv", tmp_path / "imu.csv")
    np.testing.assert_allclose(fused.position_m, shisei.fuse(optical, imu).position_m, atol=1e-4)
    (tmp_path / "no.csv").write_text("a,b\n1,2\n")
    with pytest.raises(shisei.DomainError):
        shisei.read_motive(tmp_path / "no.csv")
    with pytest.raises(shisei.DomainError, match="Tool"):
        shisei.read_motive(tmp_path / "take.csv", body="hat")
    with pytest.raises(OSError):
        shisei.fuse(tmp_path / "absent.csv", imu)


def test_what_does_not_belong_together_is_refused():
    optical, _, _ = take()
    imu = sensor()
    rng = np.random.default_rng(9)
    other = shisei.ImuRecording(imu.time_s, imu.acc_m_s2, np.cumsum(rng.normal(0, 0.05, imu.gyro_rad_s.shape), axis=0))
    with pytest.raises(shisei.ConditionError):
        shisei.fuse(optical, other)
    with pytest.raises(shisei.ShapeError):
        shisei.fuse(optical, shisei.ImuRecording(imu.time_s[:-1], imu.acc_m_s2, imu.gyro_rad_s))
    with pytest.raises((shisei.DomainError, shisei.ShapeError)):
        shisei.fuse(optical, shisei.ImuRecording(imu.time_s[::-1].copy(), imu.acc_m_s2, imu.gyro_rad_s))
    with pytest.raises(shisei.DomainError):
        shisei.fuse(optical, shisei.ImuRecording(imu.time_s, imu.acc_m_s2, imu.gyro_rad_s * np.nan))
    with pytest.raises(TypeError):
        shisei.fuse(optical, imu, body="Tool")
