"""The estimator: a recording, sample by sample, what is refused, what a calibration does."""
import csv
import pathlib
import threading
import time

import numpy as np
import pytest

import shisei

ROOT = pathlib.Path(__file__).resolve().parents[3]


def read(name, columns):
    with open(ROOT / "examples" / name, encoding="utf-8") as f:
        return np.array([[float(row[c]) for c in columns] for row in csv.DictReader(f)])


def pelvis():
    with open(ROOT / "examples/pelvis.csv", encoding="utf-8") as f:
        data = np.array([[float(x) for x in row[1:7]] for row in list(csv.reader(f))[1:]])
    return np.ascontiguousarray(data[:, :3]), np.ascontiguousarray(data[:, 3:])


def turning(seconds=20.0, rate_hz=100.0, bias=(0.01, -0.02, 0.015)):
    """Level at rest for 5 s, then turning about z at 0.5 rad/s: readings and yaw."""
    n = int(seconds * rate_hz)
    rng = np.random.default_rng(5)
    rate = np.where(np.arange(n) / rate_hz < 5, 0.0, 0.5)
    gyro = np.outer(rate, [0, 0, 1]) + bias + rng.normal(0, 0.002, (n, 3))
    acc = np.tile([0, 0, 9.80665], (n, 1)) + rng.normal(0, 0.02, (n, 3))
    return acc, gyro, np.cumsum(rate) / rate_hz


def difference(a, b):
    return np.abs((a - b + np.pi) % (2 * np.pi) - np.pi)


@pytest.mark.parametrize("online", [False, True])
def test_the_truth_of_the_example_within_a_few_degrees(online):
    acc, gyro = pelvis()
    truth = read("pelvis.truth.csv", ("yaw_rad", "pitch_rad", "roll_rad"))
    found = shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, online=online, forward="+z")
    n = len(acc)
    assert found.q_wxyz.shape == (n, 4) and found.ypr_rad.shape == (n, 3) and found.gyro_bias_rad_s.shape == (3,)
    assert found.sigma_tilt_rad.shape == found.sigma_heading_rad.shape == found.rest.shape == (n,)
    assert found.rest.dtype == np.bool_ and found.rest.any() and not found.rest.all()
    assert found.rest_rows is not None and found.sigma_tilt_rad.min() > 0
    np.testing.assert_allclose(np.linalg.norm(found.q_wxyz, axis=1), 1, atol=1e-12)
    known = 120 if online else 0  # live the bias is not known before the first rest is found
    error = difference(found.relative_ypr_rad(), truth)[known:].max(axis=0)
    assert np.degrees(error).max() < 2.5, np.degrees(error)


@pytest.mark.parametrize("online", [False, True])
def test_bias_and_turn_are_found(online):
    acc, gyro, yaw = turning()
    time_s = np.arange(len(acc)) / 100
    found = shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, time_s=time_s, online=online)
    np.testing.assert_allclose(found.gyro_bias_rad_s, [0.01, -0.02, 0.015], atol=2e-3)
    assert difference(found.ypr_rad[:, 0], yaw)[-1] < 0.03 and np.abs(found.ypr_rad[:, 1:]).max() < 0.02
    assert found.rest[300] and not found.rest[-1]
    np.testing.assert_allclose(found.calibration.gyro_bias_rad_s, found.gyro_bias_rad_s)


def test_forward_says_where_the_world_points():
    acc, gyro, _ = turning()
    plain = shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100)
    for forward, heading in (("+x", 0.0), ("+y", -np.pi / 2), ("-x", np.pi), ([0, 1, 0], -np.pi / 2)):
        found = shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, forward=forward)
        assert difference(found.ypr_rad[:, 0] - plain.ypr_rad[:, 0], heading).max() < 1e-2
    with pytest.raises(shisei.ConditionError, match="vertical"):
        shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, forward="-z")
    with pytest.raises(ValueError, match="forward"):
        shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, forward="up")


def test_live_one_by_one_and_by_stretches_are_the_same_bits():
    acc, gyro, yaw = turning()
    one, many = shisei.Estimator(), shisei.Estimator()
    single = [one.update(acc_m_s2=a, gyro_rad_s=g, dt_s=0.01) for a, g in zip(acc, gyro)]
    parts = [many.update_all(acc_m_s2=acc[k:k + 700], gyro_rad_s=gyro[k:k + 700], dt_s=0.01)
             for k in range(0, len(acc), 700)]
    for name in shisei.EstimatorStates._fields:
        np.testing.assert_array_equal(np.concatenate([getattr(p, name) for p in parts]),
                                      np.array([getattr(s, name) for s in single]), err_msg=name)
    assert one.state == single[-1] and one.state == many.state
    assert difference(shisei.to_ypr(one.state.q_wxyz)[0], yaw[-1]) < 0.03
    np.testing.assert_allclose(one.state.rate_rad_s, [0, 0, 0.5], atol=0.02)
    np.testing.assert_allclose(one.calibration.gyro_bias_rad_s, [0.01, -0.02, 0.015], atol=2e-3)
    steps = np.full(10, 0.01)
    assert many.update_all(acc_m_s2=acc[:10], gyro_rad_s=gyro[:10], dt_s=steps).q_wxyz.shape == (10, 4)


def test_a_delay_gives_every_state_once_in_order():
    acc, gyro = pelvis()
    truth = read("pelvis.truth.csv", ("yaw_rad", "pitch_rad", "roll_rad"))
    one, many = shisei.FixedLag(1.0), shisei.FixedLag(1.0)
    single, longest = [], 0
    for k in range(len(acc)):
        single += one.update(acc_m_s2=acc[k], gyro_rad_s=gyro[k], dt_s=0.01)
        longest = max(longest, k + 1 - len(single)) if k > 300 else 0  # the start is levelled for half a second more
    assert 100 <= longest <= 130, longest
    parts = [many.update_all(acc_m_s2=acc[k:k + 700], gyro_rad_s=gyro[k:k + 700], dt_s=0.01)
             for k in range(0, len(acc), 700)]
    rest, again = many.finish(), one.finish()
    q = np.concatenate([*(p.q_wxyz for p in parts), rest.q_wxyz])
    assert len(q) == len(acc) and len(single) + len(again.q_wxyz) == len(acc)
    np.testing.assert_array_equal(q[:len(single)], [s.q_wxyz for s in single])
    np.testing.assert_array_equal(again.q_wxyz, rest.q_wxyz)


    def lean(turn):  # of the vertical since the start: the same for every heading of the world
        return 2 * np.arcsin(np.sqrt(turn[:, 1] ** 2 + turn[:, 2] ** 2))

    error = np.abs(lean(shisei.relative(q, q[200])) - lean(shisei.from_ypr(truth)))[300:].max()
    assert np.degrees(error) < 2.5, np.degrees(error)
    for call in (many.finish, lambda: many.update(acc_m_s2=acc[0], gyro_rad_s=gyro[0], dt_s=0.01)):
        with pytest.raises(ValueError, match="finish"):
            call()
    for lag_s in (-1.0, 11.0, np.nan):
        with pytest.raises(shisei.DomainError):
            shisei.FixedLag(lag_s)


def test_garbage_is_bridged_live_and_refused_in_a_recording():
    acc, gyro, _ = turning()
    live = shisei.Estimator()
    for k in range(600):
        live.update(acc_m_s2=acc[k], gyro_rad_s=gyro[k], dt_s=0.01)
    sure = live.state.sigma_tilt_rad
    for bad in (np.nan, np.inf, 1e30, -1e300):
        state = live.update(acc_m_s2=[bad, 0, 0], gyro_rad_s=[0, bad, 0], dt_s=0.01)
        assert np.isfinite(state.q_wxyz).all() and np.isfinite(state.covariance_rad2).all()
    assert live.update(acc_m_s2=acc[0], gyro_rad_s=gyro[0], dt_s=np.nan) == state
    assert live.state.sigma_tilt_rad >= 0.5 * sure
    spoilt = gyro.copy()
    spoilt[7, 1] = np.nan
    with pytest.raises(shisei.DomainError, match="row 8"):
        shisei.estimate(acc_m_s2=acc, gyro_rad_s=spoilt, rate_hz=100)


def test_refusals():
    acc, gyro, _ = turning(seconds=2)
    with pytest.raises(TypeError):
        shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro)
    with pytest.raises(shisei.ShapeError):
        shisei.estimate(acc_m_s2=acc[:9], gyro_rad_s=gyro, rate_hz=100)
    with pytest.raises(shisei.ShapeError, match=r"\(N, 3\)"):
        shisei.estimate(acc_m_s2=acc[:, :2], gyro_rad_s=gyro, rate_hz=100)
    for gravity in (0.0, -9.8, np.nan):
        with pytest.raises(shisei.DomainError):
            shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, gravity_m_s2=gravity)
        with pytest.raises(shisei.DomainError):
            shisei.Estimator(gravity_m_s2=gravity)
    with pytest.raises(shisei.ConditionError):
        shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100, rest=(0, 3))
    live = shisei.Estimator()
    for bad in ({"dt_s": np.full(3, 0.01)}, {"acc_m_s2": acc[:5], "dt_s": 0.01}):
        with pytest.raises(shisei.ShapeError):
            live.update_all(**{"acc_m_s2": acc, "gyro_rad_s": gyro, **bad})


def test_a_calibration_corrects_and_what_is_learnt_goes_round(tmp_path):
    acc, gyro, yaw = turning()
    bias = np.array([0.3, -0.2, 0.1])
    matrix = np.diag([1.01, 0.99, 1.02])
    raw = acc @ np.linalg.inv(matrix).T + bias
    known = shisei.Calibration(tuple(bias), matrix.tolist(), (0.5, 0.0, -0.4))
    found = shisei.estimate(acc_m_s2=raw, gyro_rad_s=gyro + [0.5, 0, -0.4], rate_hz=100, calibration=known)
    plain = shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100)
    np.testing.assert_allclose(found.q_wxyz, plain.q_wxyz, atol=1e-9)
    # what was learnt is of the raw readings: it corrects them as the two one after the other do
    np.testing.assert_allclose(found.calibration.apply_gyro(gyro + [0.5, 0, -0.4]), plain.calibration.apply_gyro(gyro),
                               atol=1e-9)
    np.testing.assert_allclose(found.calibration.apply_acc(raw), plain.calibration.apply_acc(acc), atol=1e-9)
    path = tmp_path / "learnt.json"
    found.calibration.save(path)
    again = shisei.Calibration.load(path)
    for online in (False, True):
        second = shisei.estimate(acc_m_s2=raw, gyro_rad_s=gyro + [0.5, 0, -0.4], rate_hz=100, calibration=again,
                                 online=online)
        assert difference(second.ypr_rad[-1, 0], yaw[-1]) < 0.03
    live = shisei.Estimator(calibration=known)
    live.update_all(acc_m_s2=raw, gyro_rad_s=gyro + [0.5, 0, -0.4], dt_s=0.01)
    assert difference(shisei.to_ypr(live.state.q_wxyz)[0], yaw[-1]) < 0.03
    np.testing.assert_allclose(live.calibration.gyro_bias_rad_s, [0.51, -0.02, -0.385], atol=2e-3)
    with pytest.raises(shisei.DomainError):
        shisei.Estimator(calibration=shisei.Calibration((np.nan, 0, 0)))


def test_results_are_compared_as_themselves():
    acc, gyro, _ = turning(seconds=3)
    one, other = (shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100) for _ in range(2))
    assert one == one and one != other and len({one, other}) == 2


def test_threads_take_turns_at_one_estimator():
    acc, gyro, _ = turning(seconds=30)
    live, late, mahony = shisei.Estimator(), shisei.FixedLag(0.5), shisei.Mahony()
    given, failed = [], []

    def work(k):
        try:
            live.update_all(acc_m_s2=acc, gyro_rad_s=gyro, dt_s=0.01)
            given.append(len(late.update_all(acc_m_s2=acc, gyro_rad_s=gyro, dt_s=0.01).rest))
            for a, g in zip(acc[:300], gyro[:300]):
                live.update(acc_m_s2=a, gyro_rad_s=g, dt_s=0.01)
                given.append(len(late.update(acc_m_s2=a, gyro_rad_s=g, dt_s=0.01)))
                mahony.update(g, a, 0.01)
                assert np.isfinite(live.state.q_wxyz).all() and np.isfinite(mahony.world_from_body).all()
        except BaseException as error:
            failed.append(error)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed, failed
    assert sum(given) + len(late.finish().rest) == 4 * (len(acc) + 300)


def test_the_gil_is_released():
    acc, gyro, _ = turning(seconds=300)
    ticks, done = [], threading.Event()

    def work():
        shisei.Estimator().update_all(acc_m_s2=acc, gyro_rad_s=gyro, dt_s=0.01)
        shisei.estimate(acc_m_s2=acc, gyro_rad_s=gyro, rate_hz=100)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        ticks.append(time.perf_counter())
        time.sleep(0.001)
    thread.join()
    assert len(ticks) > 5, "this thread stood still while the other calculated"
