"""Allan deviation, sphere, Earth rate, motion between rests and on a foot, calibration from many poses."""
import csv
import json
import math
import pathlib

import numpy as np
import pytest

import shisei

ROOT = pathlib.Path(__file__).resolve().parents[3]
G = 9.80665


def nist_series(count):
    """The test series of NIST SP 1065, section 12.4."""
    n, values = 1234567890, []
    for _ in range(count):
        values.append(n / 2147483647)
        n = n * 16807 % 2147483647
    return np.array(values)


def article():
    with open(ROOT / "fixtures/published/earth_directions.csv", encoding="utf-8") as f:
        return np.array([[float(row[c]) for c in ("gyr_x", "gyr_y", "gyr_z")] for row in csv.DictReader(f)])


def test_allan_deviation_agrees_with_allantools():
    with open(ROOT / "fixtures/allan/allantools.csv", encoding="utf-8") as f:
        rows = [r for r in csv.DictReader(line for line in f if not line.startswith("#"))]
    found = shisei.allan_deviation(nist_series(5000), rate_hz=100)
    seen = 0
    for row in (r for r in rows if r["series"] == "white"):
        at = np.flatnonzero(np.abs(found.tau_s - int(row["m"]) / 100) < 1e-9)
        if len(at):
            np.testing.assert_allclose(found.deviation[at[0]], float(row["oadev"]), rtol=1e-10)
            seen += 1
    assert seen >= 5
    assert (found.low < found.deviation).all() and (found.deviation < found.high).all()
    # white, uniform in 0 … 1: N = sqrt(1/12 · 0.01 s)
    assert abs(found.random_walk.value - math.sqrt(1 / 12 * 0.01)) < 4 * found.random_walk.sigma
    column = shisei.allan_deviation(nist_series(5000).reshape(-1, 1), dt_s=0.01)
    np.testing.assert_array_equal(column.deviation, found.deviation)
    sheet = shisei.sheet.AllanDev(nist_series(5000).reshape(-1, 1), 0.01)
    np.testing.assert_array_equal(sheet, np.column_stack([found.tau_s, found.deviation, found.low, found.high]))
    for bad, error in ((np.zeros((40, 3)), shisei.ShapeError), (np.zeros(40), shisei.ConditionError),
                       (np.arange(9.0), shisei.ConditionError), ([np.nan] * 40, shisei.DomainError)):
        with pytest.raises(error):
            shisei.allan_deviation(bad, rate_hz=100)


def test_the_published_sphere_and_why_not_to_believe_it():
    sphere = shisei.fit_sphere(article())
    assert abs(sphere.radius - 7.657709e-5) < 5e-12 and sphere.condition > 300 and sphere.radius_sigma > 0
    np.testing.assert_allclose(shisei.sheet.FitSphere(article()), [*sphere.center, sphere.radius], rtol=1e-14)
    found = shisei.earth_rate(gyro_rad_s=article())
    assert found.flat and found.fit == "circle" and found.rate_rad_s is None and found.sidereal_day_h is None
    assert abs(found.horizontal_rad_s.value - 6.3769e-5) < 5e-7
    latitude = math.radians(35.4)
    known = shisei.earth_rate(gyro_rad_s=article(), latitude_rad=latitude)
    np.testing.assert_allclose(known.rate_rad_s.value, found.horizontal_rad_s.value / math.cos(latitude), rtol=1e-12)
    np.testing.assert_allclose(known.sidereal_day_h.value, 2 * math.pi / known.rate_rad_s.value / 3600, rtol=1e-12)
    assert known.heading_rad.shape == (8, 2)
    table = shisei.sheet.EarthRate(article())
    assert table.shape == (4, 2) and np.isnan(table[0]).all() and table[1, 0] == found.horizontal_rad_s.value


def test_earth_rate_finds_the_truth():
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    latitude, rate, bias = 0.62, 7.292115e-5, np.array([2e-4, -1e-4, 5e-5])
    earth = rate * np.array([0, math.cos(latitude), math.sin(latitude)])
    rng = np.random.default_rng(3)
    back = rotation.random(24, random_state=7).inv()
    gyro = back.apply(earth) + bias + rng.normal(0, 3e-7, (24, 3))
    acc = back.apply([0, 0, G])
    sigma = np.full((24, 3), 3e-7)
    found = shisei.earth_rate(gyro_rad_s=gyro, sigma_rad_s=sigma, acc_m_s2=acc)
    assert found.fit == "levelled" and not found.flat
    for measured, truth in ((found.rate_rad_s, rate), (found.latitude_rad, latitude),
                            (found.horizontal_rad_s, earth[1]), (found.sidereal_day_h, 23.934472)):
        assert 0 < measured.sigma < 0.02 * abs(truth) and abs(measured.value - truth) < 4 * measured.sigma, measured
    np.testing.assert_allclose(found.gyro_bias_rad_s, bias, atol=5e-7)
    plain = shisei.earth_rate(gyro_rad_s=gyro)
    assert plain.fit == "sphere" and plain.latitude_rad is None and plain.horizontal_rad_s is None
    assert abs(plain.rate_rad_s.value - rate) < 4 * plain.rate_rad_s.sigma
    for bad, error in (({"gyro_rad_s": gyro[:2]}, shisei.ConditionError),
                       ({"gyro_rad_s": gyro[:1].repeat(9, axis=0)}, shisei.ConditionError),
                       ({"gyro_rad_s": gyro, "acc_m_s2": acc[:3]}, shisei.ShapeError),
                       ({"gyro_rad_s": gyro, "acc_m_s2": acc * np.nan}, shisei.DomainError),
                       ({"gyro_rad_s": gyro, "latitude_rad": 2.0}, shisei.DomainError)):
        with pytest.raises(error):
            shisei.earth_rate(**bad)


def slide(seconds, metres, rate_hz):
    """Accelerations of a smooth slide of so many metres: x = metres (s − sin 2πs / 2π)."""
    s = (np.arange(int(seconds * rate_hz)) + 0.5) / (seconds * rate_hz)
    return metres * 2 * np.pi / seconds**2 * np.sin(2 * np.pi * s)


def level(forward, rate_hz, seed=1):
    """Readings of a level sensor with this acceleration along x."""
    rng = np.random.default_rng(seed)
    acc = np.column_stack([forward, np.zeros_like(forward), np.full_like(forward, G)])
    return (acc + [0.05, -0.03, 0.02] + rng.normal(0, 0.01, acc.shape),
            np.array([0.004, -0.002, 0.003]) + rng.normal(0, 0.001, acc.shape))


def test_rest_to_rest_ends_where_it_ended():
    still = np.zeros(300)
    acc, gyro = level(np.concatenate([still, slide(2, 1.0, 100), still]), 100)
    track = shisei.rest_to_rest(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100)
    n = len(acc)
    assert track.position_m.shape == track.velocity_m_s.shape == track.sigma_position_m.shape == (n, 3)
    assert track.world_from_body.shape == (n, 4) and track.rest[0] and track.rest[-1] and not track.rest[n // 2]
    assert not track.stance.any() and 1.5 < track.longest_without_rest_s < 3.5
    error = track.position_m[-1] - [1, 0, 0]
    assert np.linalg.norm(error) < 0.05 and (np.abs(error) < 4 * track.sigma_position_m[-1] + 1e-3).all(), error
    assert np.linalg.norm(track.velocity_m_s[-1]) < 1e-2 and np.abs(track.velocity_m_s[:, 0]).max() > 0.9
    np.testing.assert_allclose(track.gyro_bias_rad_s, [0.004, -0.002, 0.003], atol=5e-4)
    told = shisei.rest_to_rest(acc_m_s2=acc, gyro_rad_s=gyro, time_s=np.arange(n) / 100, end_m=[1, 0, 0])
    assert np.linalg.norm(told.position_m[-1] - [1, 0, 0]) < 0.006
    assert (told.sigma_position_m[-1] < track.sigma_position_m[-1]).all()
    with pytest.raises(shisei.ConditionError, match="without a rest"):
        shisei.rest_to_rest(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, max_without_rest_s=1.0)
    rng = np.random.default_rng(2)
    with pytest.raises(shisei.ConditionError):
        shisei.rest_to_rest(acc_m_s2=acc + rng.normal(0, 5, acc.shape), gyro_rad_s=gyro, rate_hz=100)
    for bad in ({"gravity_m_s2": 0.0}, {"end_m": [0, 0, 0], "end_sigma_m": 0.0}, {"end_m": [0, 0, math.nan]}):
        with pytest.raises(shisei.DomainError):
            shisei.rest_to_rest(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, **bad)
    with pytest.raises(shisei.ShapeError):
        shisei.rest_to_rest(acc_m_s2=acc[:10], gyro_rad_s=gyro, rate_hz=100)


def test_a_foot_that_stands_at_every_step():
    rate = 200
    stride = np.concatenate([slide(0.6, 1.2, rate), np.zeros(int(0.5 * rate))])
    acc, gyro = level(np.concatenate([np.zeros(2 * rate), np.tile(stride, 10), np.zeros(rate)]), rate, seed=4)
    track = shisei.foot_motion(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=rate)
    assert track.stance.any() and track.longest_without_rest_s < 1.0
    error = np.linalg.norm(track.position_m[-1] - [12, 0, 0])
    assert error < 0.02 * 12, track.position_m[-1]
    with pytest.raises(shisei.ConditionError):
        shisei.foot_motion(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=rate, max_without_rest_s=0.1)


def poses_and_turns(acc_matrix, acc_bias, gyro_matrix, gyro_bias, poses=18, rate_hz=100):
    """Raw readings of a sensor at rest in random poses, turned smoothly from one to the next."""
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    targets = rotation.random(poses, random_state=11)
    rng = np.random.default_rng(12)
    acc, gyro = [], []
    s = (np.arange(rate_hz) + 0.5) / rate_hz
    for k in range(poses):
        still = targets[k].inv().apply([0, 0, G])
        acc.append(np.tile(still, (2 * rate_hz, 1)))
        gyro.append(np.zeros((2 * rate_hz, 3)))
        if k + 1 < poses:
            vector = (targets[k].inv() * targets[k + 1]).as_rotvec()
            share = s - np.sin(2 * np.pi * s) / (2 * np.pi)
            on_the_way = targets[k] * rotation.from_rotvec(np.outer(share, vector))
            acc.append(on_the_way.inv().apply([0, 0, G]))
            gyro.append(np.outer(1 - np.cos(2 * np.pi * s), vector))
    acc, gyro = np.concatenate(acc), np.concatenate(gyro)
    return (acc @ np.linalg.inv(acc_matrix).T + acc_bias + rng.normal(0, 0.01, acc.shape),
            gyro @ np.linalg.inv(gyro_matrix).T + gyro_bias + rng.normal(0, 0.001, gyro.shape))


def test_many_poses_and_the_turns_between_them(tmp_path):
    acc_matrix = np.array([[1.01, 0.004, -0.006], [0, 0.99, 0.003], [0, 0, 1.005]])
    gyro_matrix = np.array([[1.02, 0.003, -0.004], [0.002, 0.985, 0.005], [-0.003, 0.001, 1.01]])
    acc_bias, gyro_bias = np.array([0.2, -0.15, 0.3]), np.array([0.01, -0.02, 0.005])
    acc, gyro = poses_and_turns(acc_matrix, acc_bias, gyro_matrix, gyro_bias)
    found = shisei.multi_pose(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, gyro_turns=True)
    c = found.calibration
    truth = np.concatenate([acc_bias, acc_matrix[np.triu_indices(3)]])
    mine = np.concatenate([c.acc_bias_m_s2, np.array(c.acc_matrix)[np.triu_indices(3)]])
    assert found.acc_sigma.shape == (9,) and (found.acc_sigma[:3] < 0.005).all()
    assert (np.abs(mine - truth) < 4.5 * found.acc_sigma).all(), (mine - truth) / found.acc_sigma
    np.testing.assert_allclose(c.gyro_matrix, gyro_matrix, atol=2e-3)
    np.testing.assert_allclose(c.gyro_bias_rad_s, gyro_bias, atol=2e-4)
    assert len(found.rows) == len(found.poses_m_s2) == 18 and found.held_out_rms_m_s2 < 0.01
    assert found.gyro_sigma.shape == (9,) and found.turn_residual_rms_rad < 0.01
    np.testing.assert_allclose(np.linalg.norm(found.suggested_up, axis=1), 1)
    c.save(tmp_path / "cal.json")
    document = json.loads((tmp_path / "cal.json").read_text(encoding="utf-8"))
    assert document["method"] == "gyro-turns" and np.shape(document["covariance"]["values"]) == (9, 9)
    plain = shisei.multi_pose(acc_m_s2=acc, gyro_rad_s=gyro, dt_s=0.01)
    np.testing.assert_array_equal(plain.calibration.gyro_matrix, np.eye(3))
    np.testing.assert_allclose(plain.calibration.gyro_bias_rad_s, gyro_bias, atol=2e-4)
    assert plain.gyro_sigma is None and plain.calibration.acc_bias_m_s2 == c.acc_bias_m_s2
    # a six-face, multi-pose or learnt calibration all serve the estimator
    assert shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, calibration=c).rest.any()
    with pytest.raises(shisei.ConditionError):
        shisei.multi_pose(acc_m_s2=acc[:600], gyro_rad_s=gyro[:600], rate_hz=100)
    with pytest.raises(shisei.ShapeError):
        shisei.multi_pose(acc_m_s2=acc[:600], gyro_rad_s=gyro, rate_hz=100)
    with pytest.raises(shisei.DomainError):
        shisei.multi_pose(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, gravity_m_s2=-1)


def faces_and_turns(rate_hz=100, seed=5):
    """Six faces of 2 s, a turn of 360° in 3 s about each axis that points up, in counts, and the rows of each part."""
    rng = np.random.default_rng(seed)
    acc_matrix = np.array([[1.01, 0.01, -0.02], [0.02, 0.98, 0.01], [0, 0.01, 1.0]]) * G / 2048
    gyro_matrix = np.array([[1.02, 0.01, 0], [-0.01, 0.99, 0.02], [0.01, 0, 1.01]]) * math.radians(1 / 16.4)
    acc, gyro, parts, row = [], [], {}, 0
    for name in ("+x", "-x", "+y", "-y", "+z", "-z", "turn x", "turn y", "turn z"):
        axis = "xyz".index(name[-1])
        n = 300 if name.startswith("turn") else 200
        a, w = np.zeros((n, 3)), np.zeros((n, 3))
        a[:, axis] = -G if name.startswith("-") else G
        if name.startswith("turn"):
            w[:, axis] = 2 * np.pi / 3 * (1 - np.cos(2 * np.pi * (np.arange(n) + 0.5) / n))
        acc.append(a @ np.linalg.inv(acc_matrix).T + [20, -50, 30] + rng.normal(0, 3, a.shape))
        gyro.append(w @ np.linalg.inv(gyro_matrix).T + [5, -8, 3] + rng.normal(0, 1, w.shape))
        parts[name], row = (row, row + n), row + n
    return np.vstack(acc), np.vstack(gyro), parts, acc_matrix, gyro_matrix


def test_known_turns_find_both_matrices():
    acc, gyro, parts, acc_matrix, gyro_matrix = faces_and_turns()
    found = shisei.known_turns(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, parts=parts)
    for got, sigma, truth in ((found.calibration.acc_matrix, found.acc_matrix_sigma, acc_matrix),
                              (found.calibration.gyro_matrix, found.gyro_matrix_sigma, gyro_matrix)):
        assert sigma.shape == (3, 3) and (sigma > 0).all() and (sigma < 0.002 * truth[0, 0]).all()
        assert (np.abs(np.array(got) - truth) < 4 * sigma).all()
    np.testing.assert_allclose(found.calibration.gyro_bias_rad_s, [5, -8, 3], atol=0.2)
    back = shisei.known_turns(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, parts=parts, turn_rad=-2 * np.pi, signed=True)
    np.testing.assert_allclose(back.calibration.gyro_matrix, -np.array(found.calibration.gyro_matrix), rtol=1e-12)
    for bad, error in (({"parts": {**parts, "turn x": parts["turn y"]}}, shisei.ConditionError),
                       ({"parts": {"+x": (0, 9)}}, shisei.ShapeError),
                       ({"parts": {**parts, "+x": (5, 10**9)}}, shisei.ShapeError),
                       ({"turn_rad": 0.0, "parts": parts}, shisei.DomainError)):
        with pytest.raises(error):
            shisei.known_turns(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, **bad)
    with pytest.raises(shisei.ShapeError):
        shisei.known_turns(acc_m_s2=acc[:-1], gyro_rad_s=gyro, rate_hz=100)


def test_the_mean_of_a_recording_at_rest():
    rng = np.random.default_rng(8)
    gyro = rng.normal([1e-3, -2e-3, 5e-4], 2e-3, (6000, 3))
    found = shisei.mean_rate(gyro_rad_s=gyro, acc_m_s2=np.tile([0, 0, G], (6000, 1)), rate_hz=100)
    np.testing.assert_allclose(found.gyro_rad_s, gyro.mean(0), rtol=1e-9)
    np.testing.assert_allclose(found.sigma_rad_s, 2e-3 / math.sqrt(6000), rtol=0.6)
    np.testing.assert_allclose(found.acc_m_s2, [0, 0, G], rtol=1e-12)
    assert abs(found.span_s - 60) < 0.02 and found.long_steps == 0
    # a gap of 1 s gives its one sample no weight, unless asked
    time = np.arange(100) / 100
    time[50:] += 1.0
    rates = np.zeros((100, 3))
    rates[50] = 1.0
    assert shisei.mean_rate(gyro_rad_s=rates, time_s=time).gyro_rad_s[0] < 0.02
    whole = shisei.mean_rate(gyro_rad_s=rates, time_s=time, weights="as-measured")
    assert whole.gyro_rad_s[0] > 0.4 and whole.long_steps == 1 and whole.acc_m_s2 is None
    for bad, error in (({"gyro_rad_s": gyro * np.nan}, shisei.DomainError),
                       ({"gyro_rad_s": gyro, "acc_m_s2": gyro[:5]}, shisei.ShapeError),
                       ({"gyro_rad_s": gyro[:0]}, (shisei.ShapeError, shisei.ConditionError))):
        with pytest.raises(error):
            shisei.mean_rate(rate_hz=100, **bad)


def test_motion_says_what_it_cannot_know():
    still = np.zeros(300)
    acc, gyro = level(np.concatenate([still, slide(2, 1.0, 100), still]), 100)
    readings = {"acc_m_s2": acc, "gyro_rad_s": gyro, "rate_hz": 100}
    open_end = shisei.rest_to_rest(**readings)
    off = 6 * open_end.sigma_position_m[-1][0]
    with pytest.warns(UserWarning, match="standard deviations"):
        shisei.rest_to_rest(**readings, end_m=open_end.position_m[-1] + [off, 0, 0], end_sigma_m=1e-4)
    with pytest.raises(shisei.ConditionError, match="max_end_distance"):
        shisei.rest_to_rest(**readings, end_m=[5, 0, 0])
    keep = np.r_[0:350, 450:len(acc)]
    cut = {"acc_m_s2": acc[keep], "gyro_rad_s": gyro[keep], "time_s": keep / 100}
    with pytest.raises(shisei.ConditionError, match="max_hole_s"):
        shisei.rest_to_rest(**cut)
    bridged = shisei.rest_to_rest(**cut, max_hole_s=math.inf)
    assert len(bridged.holes) == 1 and bridged.holes[0][0] == 350
    assert (np.abs(bridged.position_m[-1] - [1, 0, 0]) < 3 * bridged.sigma_position_m[-1]).all()
    wild = acc.copy()
    wild[400, 0] = 1e6
    with pytest.warns(UserWarning, match="pass over"):
        passed = shisei.rest_to_rest(**{**readings, "acc_m_s2": wild})
    assert passed.passed_over == 1 and np.linalg.norm(passed.position_m[-1] - [1, 0, 0]) < 0.1
    with pytest.raises(shisei.DomainError):
        shisei.rest_to_rest(**readings, max_hole_s=math.nan)
