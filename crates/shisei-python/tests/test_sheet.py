"""Every example of the table, and the exceptions, through shisei.sheet."""
import inspect
import json
import pathlib

import numpy as np
import pytest

import shisei
from shisei import sheet

ROOT = pathlib.Path(__file__).resolve().parents[3]
EXAMPLES = json.loads((ROOT / "fixtures/functions/examples.json").read_text(encoding="utf-8"))
NUMERIC = [e for e in EXAMPLES if e["expected"] is not None]
BY_NAME = {e["name"]: e for e in EXAMPLES}


@pytest.mark.parametrize("e", NUMERIC, ids=lambda e: e["name"])
def test_example(e):
    got = getattr(sheet, e["name"])(*e["args"])
    if isinstance(e["expected"], bool):
        assert got is e["expected"]
    else:
        want = np.array(e["expected"])
        np.testing.assert_allclose(np.reshape(got, want.shape), want, rtol=0, atol=e["tolerance"])


@pytest.mark.parametrize("e", EXAMPLES, ids=lambda e: e["name"])
def test_signature_and_help(e):
    function = getattr(sheet, e["name"])
    assert list(inspect.signature(function).parameters) == e["arg_names"]
    assert all(name in function.__doc__ for name in e["arg_names"])
    with pytest.raises(TypeError):
        function(*[1.0] * (len(e["arg_names"]) + 1))


def test_keywords_and_defaults():
    e = BY_NAME["GetIMUCalib"]
    named = dict(zip(e["arg_names"], e["args"]))
    np.testing.assert_array_equal(sheet.GetIMUCalib(**named), sheet.GetIMUCalib(*e["args"]))
    assert sheet.AdaptiveKp(9.8, 2, 0.05, 10.3, 14.7, 9.3, 4.9) == 2.0
    assert sheet.AdaptiveKp(9.8, 2, 0.05, 10.3, 14.7, 9.3, 4.9, None) == 2.0


def test_exceptions_say_what_and_where():
    with pytest.raises(shisei.ShapeError, match="3×3"):
        sheet.Quats2Yprs(np.eye(3))
    with pytest.raises(shisei.DomainError, match="row 1"):
        sheet.NormalizeQuat([0, 0, 0, 0])
    with pytest.raises(shisei.DomainError, match="row 3"):
        sheet.Vec3Mean([[1, 2, 3], [1, 2, 3], [1, np.nan, 3]])
    with pytest.raises(shisei.ConditionError, match="not at rest"):
        sheet.Accs2InitialQuat([[9.0, 0, 0], [11.0, 0, 0]], 0.01, 9, 11)
    with pytest.raises(shisei.ShapeError, match="number"):
        sheet.Vec3Mean([["a", "b", "c"]])
    with pytest.raises(shisei.ShapeError):
        sheet.UpdateQuatByGyro([1, 0, 0, 0], [0, 0, 1], [0.01, 0.02])
    assert issubclass(shisei.ShapeError, ValueError) and issubclass(shisei.DomainError, ValueError)


def test_sentences_in_japanese():
    shisei.set_language("ja")
    try:
        with pytest.raises(shisei.DomainError, match="クォータニオン"):
            sheet.NormalizeQuat([0, 0, 0, 0])
    finally:
        shisei.set_language("en")
    with pytest.raises(ValueError):
        shisei.set_language("xx")


def test_version():
    assert sheet.ShiseiVersion() == shisei.__version__
    assert shisei.__version__ == json.loads((ROOT / "apps/calc/extension/table.json").read_text("utf-8"))["version"]


def test_columns_of_frames():
    rows = BY_NAME["Vec3Mean"]["args"][0]
    want = sheet.Vec3Mean(rows)
    pd, pl = pytest.importorskip("pandas"), pytest.importorskip("polars")
    for frame in (pd.DataFrame(rows, columns=list("xyz")), pl.DataFrame(rows, schema=list("xyz"), orient="row")):
        np.testing.assert_array_equal(sheet.Vec3Mean(frame), want)
        np.testing.assert_array_equal(sheet.Vec3Mean(frame[["x", "y", "z"]]), want)
        np.testing.assert_array_equal(sheet.Vec3Mean([frame["x"], frame["y"], frame["z"]]), want)
    np.testing.assert_array_equal(sheet.Vec3Mean(np.asfortranarray(rows)), want)
    np.testing.assert_array_equal(sheet.Vec3Mean(np.array(rows)[::-1]), sheet.Vec3Mean(rows[::-1]))
    np.testing.assert_array_equal(sheet.Vec3Mean(np.array(rows, dtype=np.float32)),
                                  sheet.Vec3Mean(np.array(rows, dtype=np.float32).astype(float)))
