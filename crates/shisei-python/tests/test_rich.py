"""The rich API: units, shapes, frames, calibration files, threads."""
import csv
import json
import os
import pathlib
import subprocess
import threading
import time
import warnings

import numpy as np
import pytest

import shisei

ROOT = pathlib.Path(__file__).resolve().parents[3]


def recording(name):
    with open(ROOT / "examples" / name, encoding="utf-8") as f:
        rows = list(csv.reader(f))[1:]
    data = np.array([[float(x) for x in row[1:7]] for row in rows])
    return np.ascontiguousarray(data[:, :3]), np.ascontiguousarray(data[:, 3:])


def lively(n, seed=1):
    rng = np.random.default_rng(seed)
    return rng.normal(0, 1, (n, 3)), rng.normal(0, 1, (n, 3)) + [0, 0, 9.8]


def angle_between(a, b):
    return 2 * np.arccos(np.clip(np.abs(np.sum(a * b, axis=1)), 0, 1))


def test_rotations_against_scipy():
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    q = np.random.default_rng(2).normal(size=(500, 4))
    unit = shisei.normalize(q)
    r = rotation.from_quat(np.roll(unit, -1, axis=1))
    np.testing.assert_allclose(shisei.to_ypr(q), r.as_euler("ZYX"), atol=1e-12)
    np.testing.assert_allclose(shisei.rotate(q, [1, 2, 3]), r.apply([1, 2, 3]), atol=1e-13)
    assert angle_between(shisei.from_ypr(shisei.to_ypr(q)), unit).max() < 1e-7
    product = shisei.multiply(unit, unit[::-1])
    expected = np.roll((r * r[::-1]).as_quat(), 1, axis=1)
    assert angle_between(product, expected).max() < 1e-7
    world = shisei.relative(q, q[0])
    np.testing.assert_allclose(world, shisei.multiply(unit, shisei.conjugate(unit[0])), atol=1e-15)
    np.testing.assert_allclose(world[0], [1, 0, 0, 0], atol=1e-15)
    body = shisei.relative(q, q[0], frame="body")
    np.testing.assert_allclose(body, shisei.multiply(shisei.conjugate(unit[0]), unit), atol=1e-15)
    half = shisei.slerp(unit[0], unit[1], 0.5)
    ends = angle_between(np.array([half, half]), unit[:2])
    assert half.shape == (4,) and abs(ends[0] - ends[1]) < 1e-7
    np.testing.assert_allclose(shisei.from_axis_angle([0, 0, 5], np.pi / 2), [np.sqrt(0.5), 0, 0, np.sqrt(0.5)])


def test_one_row_in_one_row_out():
    q = [0.9, 0.1, -0.3, 0.3]
    assert shisei.to_ypr(q).shape == (3,) and shisei.normalize(q).shape == (4,)
    assert shisei.from_ypr([0.1, 0.2, 0.3]).shape == (4,) and shisei.rotate(q, [1, 0, 0]).shape == (3,)
    assert shisei.multiply(q, q).shape == (4,) and shisei.multiply([q], q).shape == (1, 4)


def test_filters_agree_with_the_sheet_and_with_single_steps():
    gyro, acc = lively(300)
    q0 = shisei.initial_attitude(acc[:20])
    series = shisei.mahony(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100, start=q0, kp=1.5, ki=0.1)
    np.testing.assert_array_equal(series, shisei.sheet.UpdateQuatsByMahony(q0, gyro, acc, 0.01, 1.5, 0.1))
    one = shisei.Mahony(q0, kp=1.5, ki=0.1)
    for k in range(300):
        assert one.update(gyro[k], acc[k], 0.01) == tuple(series[k])
    assert one.world_from_body == tuple(series[-1]) and len(one.gyro_bias_rad_s) == 3
    gain = shisei.AdaptiveGain()
    np.testing.assert_array_equal(
        shisei.mahony_adaptive(gyro_rad_s=gyro, acc_m_s2=acc, dt_s=0.01, start=q0, gain=gain),
        shisei.sheet.UpdateQuatsByMahonyAdaptive(q0, gyro, acc, 0.01, 2, 0.05, 10.3, 14.7, 9.3, 4.9, 0))
    np.testing.assert_array_equal(shisei.complementary(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100, start=q0),
                                  shisei.sheet.UpdateQuatsByComplementary(q0, gyro, acc, 0.01))
    np.testing.assert_array_equal(shisei.integrate_gyro(gyro_rad_s=gyro, rate_hz=100, method="rk4"),
                                  shisei.sheet.UpdateQuatsByGyroRK4([1, 0, 0, 0], gyro, 0.01))
    motion = shisei.dead_reckon(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100, start=q0, scheme="semi-implicit")
    flat = shisei.sheet.DeadReckon(q0, gyro, acc, 0.01)
    np.testing.assert_array_equal(np.hstack([motion.velocity_m_s, motion.position_m]), flat)


def test_time_stamps_give_each_step():
    gyro, acc = lively(100)
    time_s = np.cumsum(np.where(np.arange(100) % 2, 0.01, 0.02))
    by_stamps = shisei.integrate_gyro(gyro_rad_s=gyro, time_s=time_s)
    one = shisei.Mahony(kp=0.0)
    dt = np.diff(time_s, prepend=time_s[0] - np.median(np.diff(time_s)))
    for k in range(100):
        last = one.update(gyro[k], acc[k], dt[k])
    assert angle_between(by_stamps[-1:], np.array([last]))[0] < 1e-7


def test_orient_finds_the_rest_and_the_truth():
    acc, gyro = recording("pelvis.csv")
    with open(ROOT / "examples/pelvis.truth.csv", encoding="utf-8") as f:
        truth = np.array([[float(r[k]) for k in ("yaw_rad", "pitch_rad", "roll_rad")] for r in csv.DictReader(f)])
    for kind in ("mahony", "shisei-online", "shisei"):
        found = shisei.orient(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100, forward=[0, 0, 1], filter=kind)
        assert found.rest is not None and found.world_from_body.shape == (len(acc), 4)
        known = 120 if kind == "shisei-online" else 0  # live the bias is not known before the first rest is found
        error = np.abs(found.ypr_rad() - truth)[known:].max(axis=0)
        assert np.degrees(error).max() < 2.5, (kind, np.degrees(error))
        assert (found.sigma_tilt_rad is None) == (kind == "mahony")
    gyro, acc = lively(500)
    with pytest.raises(shisei.ConditionError):
        shisei.orient(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100, filter="mahony")
    assert shisei.orient(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100).rest is None


def test_orient_is_the_estimator_unless_told_otherwise():
    acc, gyro = (readings[:3000] for readings in recording("pelvis.csv"))
    found = shisei.orient(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100, forward=[0, 0, 1])
    same = shisei.estimate(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100, forward="+z")
    np.testing.assert_array_equal(found.world_from_body, same.q_wxyz)
    np.testing.assert_array_equal(found.sigma_heading_rad, same.sigma_heading_rad)


def test_six_face_and_its_file(tmp_path):
    acc, gyro = recording("six-face.csv")
    result = shisei.six_face(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100)
    truth = json.loads((ROOT / "examples/six-face.truth.json").read_text(encoding="utf-8"))
    np.testing.assert_allclose(result.calibration.acc_bias_m_s2, truth["accelerometer"]["bias_m_s2"], atol=0.005)
    np.testing.assert_allclose(result.calibration.gyro_bias_rad_s, truth["gyroscope"]["bias_rad_s"], atol=0.002)
    assert [f.face for f in result.faces] == ["+x", "-x", "+y", "-y", "+z", "-z"] and all(f.found for f in result.faces)
    assert result.acc_sigma.shape == (6,) and (result.acc_sigma > 0).all()
    np.testing.assert_array_equal(
        np.hstack([result.calibration.apply_acc(acc), result.calibration.apply_gyro(gyro)]),
        shisei.sheet.ApplyIMUCalib(np.hstack([acc, gyro]), shisei.sheet.GetIMUCalib(np.hstack([acc, gyro]), 0.01)))
    path = tmp_path / "cal.json"
    result.calibration.save(path)
    again = shisei.Calibration.load(path)
    np.testing.assert_array_equal(again.apply_acc(acc), result.calibration.apply_acc(acc))
    document = json.loads(path.read_text(encoding="utf-8"))
    document["note"] = "kept"
    path.write_text(json.dumps(document), encoding="utf-8")
    shisei.Calibration.load(path).save(path)
    assert json.loads(path.read_text(encoding="utf-8"))["note"] == "kept"
    for key, value in (("format", "other"), ("version", 2)):
        path.write_text(json.dumps({**document, key: value}), encoding="utf-8")
        with pytest.raises(ValueError, match=key):
            shisei.Calibration.load(path)
    with pytest.raises(shisei.ConditionError, match="up was found") as caught:
        shisei.six_face(acc_m_s2=acc[:3000], gyro_rad_s=gyro[:3000], rate_hz=100)
    assert any(not f.found for f in caught.value.faces)
    assert shisei.ConditionError("another").faces == ()


def test_a_failed_save_leaves_the_file_that_was_there(tmp_path):
    path, link = tmp_path / "cal.json", tmp_path / "link.json"
    shisei.Calibration(acc_bias_m_s2=(0.1, 0.2, 0.3)).save(path)
    link.symlink_to(path)
    before = path.read_bytes()
    for bad, error in (({"other": {"temps": np.arange(3)}}, TypeError), ({"other": {"t": np.nan}}, shisei.DomainError),
                       ({"acc_bias_m_s2": (np.nan, 0, 0)}, shisei.DomainError),
                       ({"gyro_matrix": np.zeros((3, 3))}, shisei.DomainError),
                       ({"other": {"covariance": 5}}, shisei.DomainError)):
        with pytest.raises(error):
            shisei.Calibration(**bad).save(path)
        assert path.read_bytes() == before and sorted(tmp_path.iterdir()) == [path, link]
    shisei.Calibration(acc_bias_m_s2=np.ones(3), acc_matrix=np.eye(3)).save(link)
    assert link.is_symlink() and shisei.Calibration.load(path).acc_bias_m_s2 == (1, 1, 1)
    with pytest.raises(FileNotFoundError, match="absent/cal.json'"):
        shisei.Calibration().save(tmp_path / "absent/cal.json")
    document = json.loads(path.read_text(encoding="utf-8"))
    for covariance in (5, {"order": shisei.estimator.LEARNT_ORDER, "values": [[1]]}):
        path.write_text(json.dumps({**document, "covariance": covariance}), encoding="utf-8")
        with pytest.raises(shisei.DomainError, match="covariance must have"):
            shisei.Calibration.load(path)


def test_stamps_serve_where_the_step_is_one():
    acc, gyro = recording("six-face.csv")
    time_s = np.arange(len(acc)) / 100
    for given in ({"time_s": time_s}, {"dt_s": np.full(len(acc), 0.01)}):
        found = shisei.six_face(acc_m_s2=acc, gyro_rad_s=gyro, **given)
        np.testing.assert_allclose(found.calibration.acc_bias_m_s2,
                                   shisei.six_face(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100).calibration.acc_bias_m_s2,
                                   rtol=1e-9)
    noise = shisei.allan_deviation(gyro[:200, 0], time_s=time_s[:200])
    np.testing.assert_allclose(noise.deviation, shisei.allan_deviation(gyro[:200, 0], rate_hz=100).deviation, rtol=1e-9)
    for function in (shisei.six_face, shisei.multi_pose, shisei.known_turns):
        with pytest.raises(shisei.DomainError, match="without gaps"):
            function(acc_m_s2=acc, gyro_rad_s=gyro, time_s=time_s + (time_s > 5))


def test_refusals():
    gyro, acc = lively(10)
    for bad in ({}, {"rate_hz": 100, "dt_s": 0.01}):
        with pytest.raises(TypeError):
            shisei.mahony(gyro_rad_s=gyro, acc_m_s2=acc, **bad)
    with pytest.raises(shisei.DomainError):
        shisei.mahony(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=0)
    with pytest.raises(shisei.DomainError):
        shisei.mahony(gyro_rad_s=gyro, acc_m_s2=acc, time_s=np.zeros(10))
    with pytest.raises(shisei.ShapeError):
        shisei.mahony(gyro_rad_s=gyro, acc_m_s2=acc[:5], rate_hz=100)
    with pytest.raises(shisei.ShapeError, match=r"\(N, 3\)"):
        shisei.mahony(gyro_rad_s=gyro[:, :2], acc_m_s2=acc, rate_hz=100)
    with pytest.raises(shisei.ShapeError):
        shisei.mahony(gyro_rad_s=gyro, acc_m_s2=acc, time_s=np.arange(9.0))


def test_large_arrays_are_not_copied():
    gyro, acc = lively(1000)
    from shisei._arrays import series
    assert series(gyro, 3, "gyro") is gyro or np.shares_memory(series(gyro, 3, "gyro"), gyro)
    out = shisei.mahony(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100)
    assert out.flags.c_contiguous and out.dtype == np.float64


def test_the_gil_is_released():
    gyro, acc = lively(2_000_000)
    ticks, done = [], threading.Event()

    def work():
        shisei.mahony(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        ticks.append(time.perf_counter())
        time.sleep(0.001)
    thread.join()
    assert len(ticks) > 5, "this thread stood still while the other calculated"


def test_many_recordings_are_each_alone():
    trials = [dict(zip(["gyro_rad_s", "acc_m_s2"], lively(2000 + 100 * k, seed=k))) for k in range(8)]
    q0 = shisei.from_ypr([0.1, 0.2, 0.3])
    alone = [shisei.mahony(**trial, rate_hz=100, start=q0) for trial in trials]
    for threads in [None, 1, 3]:
        together = shisei.many(shisei.mahony, trials, threads=threads, rate_hz=100, start=q0)
        assert all(np.array_equal(a, b) for a, b in zip(alone, together, strict=True))
    q0s = [shisei.from_ypr([0.1 * k, 0.2, 0.3]) for k in range(8)]
    times = [np.cumsum(np.full(len(t["gyro_rad_s"]), 0.01 + 0.001 * k)) for k, t in enumerate(trials)]
    own = [dict(t, start=q, kp=0.1 * k, ki=0.01 * k, time_s=s) for k, (t, q, s) in enumerate(zip(trials, q0s, times))]
    for a, b in zip([shisei.mahony(**t) for t in own], shisei.many(shisei.mahony, own, threads=1), strict=True):
        assert np.array_equal(a, b)
    trials[5]["gyro_rad_s"] = trials[5]["gyro_rad_s"].copy()
    trials[5]["gyro_rad_s"][1234, 1] = np.nan
    with pytest.raises(shisei.DomainError, match="1235|1234"):
        shisei.many(shisei.mahony, trials, threads=1, rate_hz=100)
    trials[3]["acc_m_s2"] = trials[3]["acc_m_s2"][:-1]
    for threads in [None, 1]:
        with pytest.raises(shisei.ShapeError):
            shisei.many(shisei.mahony, trials, threads=threads, rate_hz=100)
    with pytest.raises(ValueError, match="threads"):
        shisei.many(shisei.mahony, [], threads=-1)


@pytest.mark.skipif("SHISEI" not in os.environ, reason="SHISEI names the command to compare with")
@pytest.mark.parametrize("relative", ["world", "body", "none"])
def test_angles_have_the_bits_of_the_command_line(relative, tmp_path):
    out = tmp_path / "out.csv"
    command = [os.environ["SHISEI"], "orient", ROOT / "examples/pelvis.csv", "--no-report", "--json", "-o", out]
    told = subprocess.run([*command, "--relative", relative], check=True, capture_output=True, text=True)
    with open(out, encoding="utf-8") as f:
        rows = np.array([[float(x) for x in row[1:8]] for row in list(csv.reader(f))[1:]])
    q, ypr = np.ascontiguousarray(rows[:, :4]), rows[:, 4:]
    found = shisei.Orientation(q, tuple(json.loads(told.stdout)["start_q_wxyz"]), None, (0.0, 0.0, 0.0))
    assert np.array_equal(found.ypr_rad(relative), ypr)


@pytest.mark.skipif("SHISEI" not in os.environ, reason="SHISEI names the command to compare with")
@pytest.mark.parametrize("kind", ["shisei", "shisei-online", "mahony", "mahony-adaptive", "complementary", "gyro", "gyro-rk4"])
@pytest.mark.parametrize("name, rest", [("examples/pelvis.csv", "auto"), ("fixtures/dialects/euroc/euroc.csv", None)])
def test_a_recording_has_the_bits_of_the_command_line(name, rest, kind, tmp_path):
    out = tmp_path / "out.csv"
    command = [os.environ["SHISEI"], "orient", ROOT / name, "--no-report", "--json", "-o", out, "--filter", kind]
    ran = subprocess.run([*command, "--rest", rest or "none"], check=True, capture_output=True, text=True)
    told = json.loads(ran.stdout)
    with open(out, encoding="utf-8") as f:
        rows = list(csv.DictReader(f))

    def columns(*names):
        return np.array([[float(row[n]) for n in names] for row in rows])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        read = shisei.read_recording(ROOT / name)
        given = {"acc_m_s2": read.acc_m_s2, "gyro_rad_s": read.gyro_rad_s, "dt_s": read.dt_s, "rest": rest}
        found = shisei.orient(**given, filter=kind)
        same = shisei.estimate(**given, online=kind == "shisei-online")
    assert told["rate_hz"] == read.rate_hz and tuple(told["start_q_wxyz"]) == found.start
    assert np.array_equal(found.world_from_body, columns("q_w", "q_x", "q_y", "q_z"))
    assert np.array_equal(found.ypr_rad(), columns("yaw_rad", "pitch_rad", "roll_rad"))
    ends = found.rest and (read.time_s[found.rest[0]], read.time_s[found.rest[1] - 1])
    assert ends == (told["rest"] and (told["rest"]["start_s"], told["rest"]["end_s"]))
    if kind.startswith("shisei"):
        assert np.array_equal(same.q_wxyz, found.world_from_body) and same.rest_rows == found.rest
        assert np.array_equal(same.rest, columns("rest")[:, 0] == 1)
        assert np.array_equal(same.sigma_heading_rad, columns("sigma_heading_rad")[:, 0])


@pytest.mark.skipif("SHISEI" not in os.environ, reason="SHISEI names the command to compare with")
def test_a_calibration_file_gives_the_bits_of_the_command_line(tmp_path):
    read = shisei.read_recording(ROOT / "examples/pelvis.csv")
    given = {"acc_m_s2": read.acc_m_s2, "gyro_rad_s": read.gyro_rad_s, "dt_s": read.dt_s, "forward": "z"}
    plain = shisei.Calibration((0.0123456789012345678, -0.1 / 3, 1e-7 / 3), np.diag([1 + 1e-3 / 3, 0.99123, 1.0]),
                               (1e-3 / 7, 0, 0))
    for k, calibration in enumerate((plain, shisei.estimate(**given).calibration)):
        path, out = tmp_path / f"{k}.json", tmp_path / f"{k}.csv"
        calibration.save(path)
        command = [os.environ["SHISEI"], "orient", ROOT / "examples/pelvis.csv", "--no-report", "--forward", "z"]
        subprocess.run([*command, "--calibration", path, "-o", out], check=True, capture_output=True)
        with open(out, encoding="utf-8") as f:
            rows = np.array([[float(x) for x in row[1:5]] for row in list(csv.reader(f))[1:]])
        found = shisei.estimate(**given, calibration=shisei.Calibration.load(path))
        assert np.array_equal(found.q_wxyz, rows)


def test_a_start_without_a_heading_and_an_odd_gravity_are_said():
    acc, gyro = recording("pelvis.csv")
    for function in (shisei.orient, shisei.estimate):
        with pytest.warns(UserWarning, match="forward -z"):
            function(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100)
        with pytest.warns(UserWarning, match="^gravity_m_s2 8 is not found on the Earth"):
            function(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100, forward="z", gravity_m_s2=8)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            function(gyro_rad_s=gyro, acc_m_s2=acc, rate_hz=100, forward="z")
