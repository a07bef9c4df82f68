"""What a hurried user gives: other kinds of numbers, other units, other shapes. It works, or one sentence says what
was wrong, in the language in use; it is never wrong in silence."""
import pathlib
import warnings

import numpy as np
import pandas as pd
import polars as pl
import pytest
import shisei
from scipy.spatial.transform import Rotation

ROOT = pathlib.Path(__file__).resolve().parents[3]
TIME = np.arange(2000) / 100


def swing(factor=1.0):
    """A slow swing of ±0.8 rad about x after a rest of 5 s, with a little noise; rates times ``factor``."""
    rng = np.random.default_rng(1)
    moving = np.clip(TIME - 5, 0, None)
    angle, rate = 0.8 * np.sin(1.5 * moving), np.where(TIME > 5, 1.2 * np.cos(1.5 * moving), 0)
    acc = 9.80665 * np.column_stack([np.zeros_like(angle), np.sin(angle), np.cos(angle)])
    gyro = np.column_stack([rate, 0 * rate, 0 * rate])
    return acc + rng.normal(0, 0.01, acc.shape), (gyro + rng.normal(0, 1e-3, gyro.shape)) * factor


ACC, GYRO = swing()
GIVEN = {"acc_m_s2": ACC, "gyro_rad_s": GYRO}
TAKE = shisei.OpticalTake(TIME, np.zeros((2000, 3)), np.tile([1.0, 0, 0, 0], (2000, 1)))


def finished(late):
    late.finish()
    return late


@pytest.mark.parametrize("language", ["en", "ja"])
@pytest.mark.parametrize("error, words, call", [
    (shisei.ShapeError, "acc_m_s2", lambda: shisei.estimate(acc_m_s2=ACC + 1j, gyro_rad_s=GYRO, rate_hz=100)),
    (shisei.ShapeError, "acc_m_s2", lambda: shisei.estimate(acc_m_s2=None, gyro_rad_s=GYRO, rate_hz=100)),
    (shisei.ShapeError, "(3, 2000)", lambda: shisei.mahony(acc_m_s2=ACC.T, gyro_rad_s=GYRO, rate_hz=100)),
    (shisei.ShapeError, "rate_hz", lambda: shisei.mahony(**GIVEN, rate_hz="fast")),
    (shisei.DomainError, "rate_hz", lambda: shisei.mahony(**GIVEN, rate_hz=np.inf)),
    (shisei.DomainError, "time_s", lambda: shisei.mahony(**GIVEN, time_s=TIME[::-1])),
    (shisei.DomainError, "rest", lambda: shisei.estimate(**GIVEN, rate_hz=100, rest=(0, 99999))),
    (shisei.DomainError, "rest", lambda: shisei.orient(**GIVEN, rate_hz=100, rest=(-5, 100))),
    (ValueError, "rest", lambda: shisei.orient(**GIVEN, rate_hz=100, rest="always")),
    (ValueError, "filter", lambda: shisei.orient(**GIVEN, rate_hz=100, filter="kalman")),
    (ValueError, "kp", lambda: shisei.orient(**GIVEN, rate_hz=100, kp=2)),
    (ValueError, "forward", lambda: shisei.estimate(**GIVEN, rate_hz=100, forward="up")),
    (ValueError, "relative", lambda: shisei.orient(**GIVEN, rate_hz=100).ypr_rad("north")),
    (ValueError, "scheme", lambda: shisei.dead_reckon(**GIVEN, rate_hz=100, start=[1, 0, 0, 0], scheme="x")),
    (TypeError, "Calibration.load", lambda: shisei.estimate(**GIVEN, rate_hz=100, calibration="cal.json")),
    (TypeError, "rate_hz", lambda: shisei.estimate(**GIVEN)),
    (shisei.ShapeError, "dt_s", lambda: shisei.Estimator().update_all(**GIVEN, dt_s=np.full((2000, 2), 0.01))),
    (shisei.ShapeError, "dt_s", lambda: shisei.Estimator().update_all(**GIVEN, dt_s="a")),
    (shisei.ShapeError, "acc_m_s2", lambda: shisei.Estimator().update(acc_m_s2=[1, 2], gyro_rad_s=[0, 0, 0], dt_s=0.01)),
    (shisei.ShapeError, "gyro_rad_s", lambda: shisei.Mahony().update(None, [0, 0, 9.8], 0.01)),
    (shisei.DomainError, "t:", lambda: shisei.slerp([1, 0, 0, 0], [0, 1, 0, 0], [0.5, np.nan])),
    (shisei.ShapeError, "matrix", lambda: shisei.from_matrix(np.eye(2))),
    (shisei.DomainError, "kp", lambda: shisei.mahony(**GIVEN, rate_hz=100, kp=np.nan)),
    (shisei.ConditionError, "max_variance", lambda: shisei.six_face(**GIVEN, rate_hz=100)),
    (shisei.DomainError, "window_s", lambda: shisei.six_face(**GIVEN, rate_hz=100, window_s=0)),
    (shisei.ShapeError, "window_s", lambda: shisei.six_face(**GIVEN, rate_hz=100, window_s="3")),
    (shisei.ShapeError, "kp", lambda: shisei.mahony(**GIVEN, rate_hz=100, kp="2")),
    (TypeError, "AdaptiveGain", lambda: shisei.mahony_adaptive(**GIVEN, rate_hz=100, gain={"kp_max": 2})),
    (shisei.ShapeError, "gravity_m_s2", lambda: shisei.estimate(**GIVEN, rate_hz=100, gravity_m_s2=None)),
    (shisei.DomainError, "gravity_m_s2", lambda: shisei.estimate(**GIVEN, rate_hz=100, gravity_m_s2=-1)),
    (ValueError, "finish()", lambda: finished(shisei.FixedLag()).finish()),
    (shisei.ShapeError, "lag_s", lambda: shisei.FixedLag("1")),
    (shisei.DomainError, "lag_s", lambda: shisei.FixedLag(11)),
    (shisei.ShapeError, "dt_s", lambda: shisei.Estimator().update(acc_m_s2=ACC[0], gyro_rad_s=GYRO[0], dt_s=None)),
    (shisei.ShapeError, "dt_s", lambda: shisei.Mahony().update(GYRO[0], ACC[0], None)),
    (shisei.DomainError, "dt_s", lambda: shisei.mahony(**GIVEN, dt_s=np.where(np.arange(2000) == 7, 0, 0.01))),
    (shisei.ShapeError, "(2000,)", lambda: shisei.mahony(**GIVEN, dt_s=np.full(1999, 0.01))),
    (shisei.ShapeError, "time_s", lambda: shisei.mahony(**GIVEN, time_s=TIME.astype("m8[M]"))),
    (shisei.DomainError, "frozen", lambda: shisei.read_motive("take.csv", frozen=-1)),
    (TypeError, "body", lambda: shisei.read_motive("take.csv", body=5)),
    (TypeError, "", lambda: shisei.read_recording()),
    (TypeError, "['a.csv']", lambda: shisei.read_recording(["a.csv"])),
    (TypeError, "units", lambda: shisei.read_recording("a.csv", units=5)),
    (shisei.ShapeError, "time_s", lambda: shisei.fuse(TAKE, GIVEN)),
    (TypeError, "OpticalTake", lambda: shisei.fuse(None, None)),
    (shisei.DomainError, "start", lambda: shisei.mahony(**GIVEN, rate_hz=100, start=[np.nan, 0, 0, 0])),
    (shisei.DomainError, "start", lambda: shisei.relative([1, 0, 0, 0], [0, 0, 0, 0])),
    (shisei.ShapeError, "start", lambda: shisei.relative([1, 0, 0, 0], None)),
    (shisei.DomainError, "normalize", lambda: shisei.normalize([0] * 4)),
    (shisei.DomainError, "to_ypr", lambda: shisei.to_ypr([0] * 4)),
    (shisei.DomainError, "angle_rad", lambda: shisei.from_axis_angle([0, 0, 1], np.nan)),
    (shisei.DomainError, "from_axis_angle", lambda: shisei.from_axis_angle([0, 0, 0], 1)),
    (shisei.DomainError, "initial_attitude: max_variance", lambda: shisei.initial_attitude(ACC, max_variance=-1)),
    (shisei.DomainError, "forward", lambda: shisei.orient(**GIVEN, rate_hz=100, forward=[0, 0, np.inf])),
    (shisei.DomainError, "latitude_rad", lambda: shisei.earth_rate(gyro_rad_s=GYRO[:5], latitude_rad=35.7)),
    (shisei.DomainError, "sigma_rad_s", lambda: shisei.earth_rate(gyro_rad_s=GYRO[:5], sigma_rad_s=-abs(GYRO[:5]))),
    (shisei.ConditionError, "max_without_rest_s",
     lambda: shisei.rest_to_rest(**GIVEN, rate_hz=100, max_without_rest_s=1)),
    (shisei.DomainError, "max_without_rest_s",
     lambda: shisei.rest_to_rest(**GIVEN, rate_hz=100, max_without_rest_s=np.nan)),
    (shisei.DomainError, "max_without_rest_s",
     lambda: shisei.foot_motion(**GIVEN, rate_hz=100, max_without_rest_s=-1)),
    (shisei.ConditionError, "allan_deviation", lambda: shisei.allan_deviation(np.ones(100), rate_hz=100)),
    (shisei.DomainError, "1.01", lambda: shisei.allan_deviation(ACC[:, 0], time_s=TIME + (TIME > 3))),
    (shisei.ConditionError, "parts", lambda: shisei.known_turns(**GIVEN, rate_hz=100)),
    (shisei.ShapeError, "acc_matrix", lambda: shisei.Calibration(acc_matrix=[[1, 0], [0, 1]])),
    (shisei.DomainError, "gyroscope.matrix", lambda: shisei.Estimator(calibration=shisei.Calibration(gyro_matrix=np.zeros((3, 3))))),
    (shisei.ShapeError, "threads", lambda: shisei.many(shisei.mahony, [], threads="2")),
    (ValueError, "'fr'", lambda: shisei.set_language("fr")),
])
def test_each_refusal_is_a_sentence_that_names_the_argument(error, words, call, language):
    shisei.set_language(language)
    try:
        with pytest.raises(error) as caught:
            call()
    finally:
        shisei.set_language("en")
    sentence = str(caught.value)
    assert words in sentence
    assert any("\u3040" < c < "\u9fff" for c in sentence) == (language == "ja"), sentence


def test_what_is_masked_or_missing_is_no_number():
    def refused(acc):
        with pytest.raises(shisei.DomainError, match="row 8"):
            shisei.mahony(acc_m_s2=acc, gyro_rad_s=GYRO, rate_hz=100)

    mask = np.zeros(ACC.shape, bool)
    mask[7, 1] = True
    refused(np.ma.MaskedArray(ACC, mask))
    refused([np.ma.MaskedArray(*row) for row in zip(ACC, mask)])
    refused(pd.DataFrame(ACC).mask(mask))
    refused(pd.DataFrame(ACC).astype("Float64").mask(mask))
    refused(pl.DataFrame(ACC).with_columns(column_1=pl.Series([None if m else a for a, m in zip(ACC[:, 1], mask[:, 1])])))
    refused([[None if m else a for a, m in zip(*rows)] for rows in zip(ACC.tolist(), mask.tolist())])


def test_dates_are_times():
    expected = shisei.mahony(**GIVEN, time_s=TIME)
    dates = pd.Timestamp("2026-11-29 12:00", tz="Asia/Tokyo") + pd.to_timedelta(TIME, unit="s")
    for given in (dates, pd.Series(dates), dates.tz_localize(None).to_numpy(), pd.to_timedelta(TIME, unit="s"),
                  pl.Series(dates.tz_localize(None).to_numpy()), dates.to_pydatetime().tolist()):
        np.testing.assert_allclose(shisei.mahony(**GIVEN, time_s=given), expected, atol=1e-12)


@pytest.mark.parametrize("call", [shisei.estimate, shisei.orient])
def test_units_that_cannot_be_right_bring_a_warning(call):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        call(**GIVEN, rate_hz=100)
    with pytest.warns(UserWarning, match="readings in g") as caught:
        call(acc_m_s2=ACC / 9.80665, gyro_rad_s=GYRO, rate_hz=100)
    assert caught[0].filename == __file__
    with pytest.warns(UserWarning, match="deg/s"):
        call(acc_m_s2=ACC, gyro_rad_s=np.degrees(GYRO), rate_hz=100)
    with pytest.warns(UserWarning, match="gyr_z: the same value throughout"):
        call(acc_m_s2=ACC, gyro_rad_s=GYRO * [1, 1, 0], rate_hz=100)


def test_the_plus_of_an_axis_may_be_left_out():
    assert (shisei.estimate(**GIVEN, rate_hz=100, forward="y").q_wxyz
            == shisei.estimate(**GIVEN, rate_hz=100, forward="+y").q_wxyz).all()
    np.testing.assert_array_equal(shisei.orient(**GIVEN, rate_hz=100, forward="-y").world_from_body,
                                  shisei.orient(**GIVEN, rate_hz=100, forward=(0, -1, 0)).world_from_body)


def test_rotations_agree_with_scipy():
    rng = np.random.default_rng(2)
    q = shisei.normalize(rng.normal(size=(50, 4)))
    peer, v = Rotation.from_quat(q[:, [1, 2, 3, 0]]), rng.normal(size=(50, 3))
    np.testing.assert_allclose(shisei.to_matrix(q), peer.as_matrix(), atol=1e-14)
    np.testing.assert_allclose(shisei.to_rotation_vector(q), peer.as_rotvec(), atol=1e-13)
    np.testing.assert_allclose(shisei.rotate(q, v), peer.apply(v), atol=1e-13)
    np.testing.assert_allclose(shisei.rotate(q[0], v), peer[0].apply(v), atol=1e-13)
    np.testing.assert_allclose(shisei.rotate(q, v[0]), peer.apply(v[0]), atol=1e-13)
    back = shisei.from_matrix(peer.as_matrix())
    np.testing.assert_allclose(back * np.sign(q[:, :1]), q, atol=1e-13)
    assert shisei.to_matrix(q[0]).shape == (3, 3) and shisei.from_matrix(np.eye(3)).shape == (4,)
    assert shisei.rotate(q[0], v[0]).shape == (3,) and shisei.to_rotation_vector(q[0]).shape == (3,)
    with pytest.raises(shisei.DomainError):
        shisei.from_matrix(2 * np.eye(3))
    with pytest.raises(shisei.DomainError, match="row 2"):
        shisei.to_matrix([[1, 0, 0, 0], [0, 0, 0, 0]])


def test_a_damaged_calibration_file_is_named(tmp_path):
    path = tmp_path / "cal.json"
    for text in ("", "[]", '{"format": "shisei-calibration", "version": 2}', '{"format": "shisei-calibration", "version": 1}'):
        path.write_text(text)
        with pytest.raises(shisei.DomainError, match="cal.json"):
            shisei.Calibration.load(path)
    shisei.Calibration().save(path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert shisei.Calibration.load(path).acc_bias_m_s2 == (0, 0, 0)


def test_a_file_that_is_not_understood_can_be_explained(tmp_path):
    path = tmp_path / "odd.csv"
    path.write_text("t,a,b,c,d,e,f\n" + "".join(f"{k},1,2,3,4,5,6\n" for k in range(100)))
    with pytest.raises(shisei.DomainError, match="with columns") as caught:
        shisei.read_recording(path)
    assert "--" not in str(caught.value)  # no options of the command line
    said = {"columns": "time=t,gyr_x=a,gyr_y=b,gyr_z=c,acc_x=d,acc_y=e,acc_z=f", "units": "acc=g,gyr=deg/s,time=s"}
    with pytest.warns(UserWarning):  # nothing weighs 8 g at rest
        found = shisei.read_recording(path, **said, axes="y,-x,z", rate_hz=50)
    assert np.allclose(found.acc_m_s2[0], np.array([5, -4, 6]) * 9.80665)
    assert np.allclose(found.gyro_rad_s[0], np.radians([2, -1, 3]))
    assert np.allclose(np.diff(found.time_s), 0.02) and found.assumptions == ()  # all was said
    assert shisei.read_recording(ROOT / "examples/pelvis.csv").assumptions
    for wrong in ({"units": "acc=furlong"}, {"columns": "acc_q=a"}, {"rate_hz": -1.0}):
        with pytest.raises(shisei.DomainError):
            shisei.read_recording(path, **{**said, **wrong})
