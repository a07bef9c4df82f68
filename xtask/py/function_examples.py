"""Writes crates/shisei-functions/src/examples.rs: inputs and results of every worksheet function.

Results come from SciPy (rotations, least squares), NumPy (means, variances) and mpmath at 50 digits (filters,
written out from the equations of the specification), never from shisei. Run it with NumPy, SciPy and mpmath:

    python3 xtask/py/function_examples.py
"""
import pathlib
import textwrap

import mpmath as mp
import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2
from scipy.spatial.transform import Rotation

mp.mp.dps = 50
G = 9.80665
OUT = pathlib.Path(__file__).resolve().parents[2] / "crates/shisei-functions/src/examples.rs"

# --- inputs -----------------------------------------------------------------------------------------------
# Readings of the published example (rows 2, 3, 4, 301, 302, 303: x up, 100 Hz).
ACC = np.array([[9.744401, 0.081403, -0.78051], [9.725247, 0.114922, -0.88107], [9.710882, 0.081403, -0.77572],
                [9.758766, 0.124498, -0.96247], [9.749189, 0.076614, -0.93374], [9.696517, 0.09098, -0.92416]])
GYRO = np.array([[-0.00745, -0.04361, 0.022338], [-0.01064, -0.02766, -0.00638], [0.043612, 0.011701, -0.03085],
                 [0.022338, -0.00106, 0.052121], [0.017019, -0.01596, 0.06914], [-0.00213, -0.06595, 0.04893]])
# A livelier motion, so that every term of a filter is seen.
GYRO_LIVELY = np.array([[0.5, -1.2, 2.0], [0.6, -1.0, 2.2], [0.9, -0.4, 1.8], [-0.3, 0.8, 1.1], [-1.4, 1.6, 0.2]])
ACC_LIVELY = np.array([[0.3, 1.0, 9.7], [0.9, 1.4, 10.6], [2.0, 2.5, 12.1], [-0.5, 0.2, 7.2], [0.0, 0.0, 0.0]])
Q = np.array([0.9, 0.1, -0.3, 0.3])
Q2 = np.array([0.5, 0.5, 0.1, -0.7])
QUATS = np.array([[1.0, 0.0, 0.0, 0.0], [0.9, 0.1, -0.3, 0.3], [2.0, -1.0, 0.5, 0.25], [-0.2, 0.4, 0.6, 0.8]])
YPRS = np.array([[0.3, -0.2, 0.1], [-2.5, 1.2, 3.0], [3.1, -1.5, -0.7]])
VEC = np.array([1.0, -2.0, 0.5])
ADAPTIVE = [2.0, 0.05, 10.3, 14.7, 9.3, 4.9]
# The published calibration and three of its rows.
CALIB = np.array([-0.0272, -0.07121, 0.106377, 0.999356, 0.999585, 0.999567, 0.006784, 0.009346, 0.008648, 1, 1, 1])
RAW6 = np.array([[-0.05267, 0.071826, 9.873688, 0.001064, 0.038293, -0.0819],
                 [0.076614, 0.076614, 9.830592, 0.013828, 0.047866, 0.027656],
                 [0.004788, 0.067038, 9.825804, 0.0, 0.034038, 0.015955]])


def six_faces(shake_last):
    """Six faces of four rows at 2 Hz, bias and scale known, a little deterministic unrest."""
    bias, scale = np.array([0.1, -0.05, 0.2]), np.array([1.02, 0.98, 1.01])
    rows = []
    for face in range(6):
        axis, sign = face // 2, 1 - 2 * (face % 2)
        tilt = np.zeros(3)
        tilt[axis] = sign
        tilt[(axis + 1) % 3] = 0.04 * (face + 1)
        up = tilt / np.linalg.norm(tilt)
        for k in range(4):
            unrest = 0.01 * np.array([(-1) ** k, (-1) ** (k // 2), (-1) ** (k + face)])
            if shake_last and face == 5:
                unrest = 40 * unrest
            acc = up * G / scale + bias + unrest
            gyro = np.array([0.01, -0.02, 0.005]) + 0.001 * unrest
            rows.append(np.round(np.concatenate([acc, gyro]), 4))
    return np.array(rows)


# --- independent results ----------------------------------------------------------------------------------
def rot(q):
    q = np.asarray(q, float)
    return Rotation.from_quat(np.roll(q, -1, axis=-1))


def wxyz(r, like=None):
    """w, x, y, z; the sign continues that of the Hamilton product where `like` is given."""
    q = np.roll(r.as_quat(), 1, axis=-1)
    if like is not None:
        sign = np.sign(np.sum(q * like, axis=-1, keepdims=True))
        q = q * np.where(sign == 0, 1, sign)
    return q


def unit(q):
    q = np.asarray(q, float)
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def ypr(r):
    return r.as_euler("ZYX")


def hamilton(a, b):
    return [a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]]


def mp_unit(q):
    n = mp.sqrt(sum(x * x for x in q))
    return [x / n for x in q]


def mp_vec(v):
    return [mp.mpf(float(x)) for x in v]


def exact_step(q, w, dt):
    n = mp.sqrt(sum(x * x for x in w))
    half = n * dt / 2
    s = dt / 2 if n == 0 else mp.sin(half) / n
    return mp_unit(hamilton(q, [mp.cos(half)] + [x * s for x in w]))


def rk4_step(q, w, dt):
    def slope(p):
        return [x / 2 for x in hamilton(p, [mp.mpf(0)] + w)]

    def plus(p, k, h):
        return [a + h * b for a, b in zip(p, k)]

    k1 = slope(q)
    k2 = slope(plus(q, k1, dt / 2))
    k3 = slope(plus(q, k2, dt / 2))
    k4 = slope(plus(q, k3, dt))
    return mp_unit([a + dt / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(q, k1, k2, k3, k4)])


def gyro_series(q, gyro, dt, step):
    q, dt, out = mp_unit(mp_vec(q)), mp.mpf(dt), []
    for w in gyro:
        q = step(q, mp_vec(w), dt)
        out.append([float(x) for x in q])
    return np.array(out)


def up_body(q):
    w, x, y, z = q
    return [2 * (x * z - w * y), 2 * (w * x + y * z), w * w - x * x - y * y + z * z]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def adaptive_kp(n, kp_max, kp_min, upper_start, upper_end, lower_start, lower_end, gravity=G):
    n = n * mp.mpf(G) / mp.mpf(gravity)
    if n > upper_start:
        share = min(mp.mpf(1), (n - upper_start) / (mp.mpf(upper_end) - upper_start))
    elif n < lower_start:
        share = min(mp.mpf(1), (mp.mpf(lower_start) - n) / (mp.mpf(lower_start) - lower_end))
    else:
        share = mp.mpf(0)
    return kp_max + share * (mp.mpf(kp_min) - kp_max)


def mahony(q, gyro, acc, dt, gain, ki):
    """gain(|a|) gives kp."""
    q, dt, integral, out = mp_unit(mp_vec(q)), mp.mpf(dt), [mp.mpf(0)] * 3, []
    for w, a in zip(gyro, acc):
        w, a = mp_vec(w), mp_vec(a)
        n = mp.sqrt(sum(x * x for x in a))
        e = cross([x / n for x in a], up_body(q)) if n != 0 else [mp.mpf(0)] * 3  # no direction: no error
        integral = [i + mp.mpf(ki) * x * dt for i, x in zip(integral, e)]
        w = [x + gain(n) * y + i for x, y, i in zip(w, e, integral)]
        q = exact_step(q, w, dt)
        out.append([float(x) for x in q])
    return np.array(out)


def complementary(q, gyro, acc, dt, alpha, gravity):
    q, dt, out = mp_unit(mp_vec(q)), mp.mpf(dt), []
    for w, a in zip(gyro, acc):
        q = exact_step(q, mp_vec(w), dt)
        ax, ay, az = mp_vec(a)
        n = mp.sqrt(ax * ax + ay * ay + az * az) / mp.mpf(gravity)
        if 0.5 < n < 1.5:
            roll, pitch = mp.atan2(ay, az), mp.atan2(-ax, mp.sqrt(ay * ay + az * az))
            w_, x, y, z = q
            yaw = mp.atan2(2 * (x * y + w_ * z), w_ * w_ + x * x - y * y - z * z)

            def about(axis, angle):
                v = [mp.cos(angle / 2), 0, 0, 0]
                v[axis] = mp.sin(angle / 2)
                return v

            q_acc = hamilton(hamilton(about(3, yaw), about(2, pitch)), about(1, roll))
            if sum(s * t for s, t in zip(q, q_acc)) < 0:
                q_acc = [-x for x in q_acc]
            t = 1 - mp.mpf(alpha)
            q = mp_unit([(1 - t) * s + t * u for s, u in zip(q, q_acc)])
        out.append([float(x) for x in q])
    return np.array(out)


def dead_reckon(q, gyro, acc, dt, gravity):
    q, dt = mp_unit(mp_vec(q)), mp.mpf(dt)
    v, p, out = [mp.mpf(0)] * 3, [mp.mpf(0)] * 3, []
    for w, a in zip(gyro, acc):
        q = rk4_step(q, mp_vec(w), dt)
        conjugate = [q[0], -q[1], -q[2], -q[3]]
        world = hamilton(hamilton(q, [mp.mpf(0)] + mp_vec(a)), conjugate)[1:]
        world[2] -= mp.mpf(gravity)
        v = [s + x * dt for s, x in zip(v, world)]
        p = [s + x * dt for s, x in zip(p, v)]
        out.append([float(x) for x in v + p])
    return np.array(out)


def tilt_quat(acc):
    ax, ay, az = np.mean(acc, axis=0)
    return wxyz(Rotation.from_euler("ZYX", [0, np.arctan2(-ax, np.hypot(ay, az)), np.arctan2(ay, az)]))


def windows(data, rows, step):
    return [(s, data[s:s + rows]) for s in range(0, len(data) - rows + 1, step)]


def faces(data, rows, step, max_tilt, threshold, dt):
    """Per face +x, −x, +y, −y, +z, −z: found, start, worst variance, tilt, |a|. A window belongs to the face
    its mean is nearest to. Of a face's windows the steadiest still one within the tilt is taken; without one,
    the steadiest within the tilt; without one, the still one of least tilt."""
    out = []
    for face in range(6):
        seen = []
        for start, w in windows(data[:, :3], rows, step):
            m, var = w.mean(axis=0), w.var(axis=0)
            axis = int(np.argmax(np.abs(m)))
            tilt = np.arccos(np.abs(m[axis]) / np.linalg.norm(m))
            if 2 * axis + (m[axis] < 0) == face:
                seen.append((start * dt, var.max(), tilt, np.linalg.norm(m), var.sum()))
        near = [s for s in seen if s[2] <= max_tilt]
        still = [s for s in near if s[1] <= threshold]
        tilted = [s for s in seen if s[1] <= threshold]
        best = (min(still, key=lambda s: s[4]) if still else min(near, key=lambda s: s[1]) if near
                else min(tilted, key=lambda s: s[2]))
        out.append([float(bool(still)), *best[:4]])
    return np.array(out)


def six_face_fit(data, rows):
    means = np.array([data[s:s + rows, :3].mean(axis=0) for s in range(0, len(data), rows)])
    bias_gyro = np.mean([data[s:s + rows, 3:].mean(axis=0) for s in range(0, len(data), rows)], axis=0)
    fit = least_squares(lambda p: np.linalg.norm(p[3:] * (means - p[:3]), axis=1) - G, [0, 0, 0, 1, 1, 1], method="lm",
                        xtol=1e-15, ftol=1e-15, gtol=1e-15)
    assert fit.cost < 1e-20, fit.cost
    return np.concatenate([fit.x, bias_gyro])


def allan(y, tau0, factors):
    """Overlapping Allan deviation from its definition, averages side by side at every start, and the 68.27 %
    interval with the degrees of freedom of white noise (NIST SP 1065, table 5)."""
    out = []
    for m in factors:
        means = np.convolve(y, np.ones(m) / m, mode="valid")
        deviation = np.sqrt(np.mean((means[m:] - means[:-m]) ** 2) / 2)
        n = len(y) + 1
        edf = (3 * (n - 1) / (2 * m) - 2 * (n - 2) / n) * 4 * m**2 / (4 * m**2 + 5)
        tail = 0.5 * (1 - 0.6826894921370859)
        low, high = (deviation * np.sqrt(edf / chi2.ppf(p, edf)) for p in (1 - tail, tail))
        out.append([m * tau0, deviation, low, high])
    return np.array(out)


def lag1(y):
    d = y - y.mean()
    return (d[1:] @ d[:-1]) / (d @ d)


def turning_earth(latitude, rate, bias):
    """Mean accelerations and rates of a sensor with x up, x down, y up and z up, at several headings."""
    up, north = np.array([0, 0, 1.0]), np.array([0, 1.0, 0])
    earth = rate * (np.sin(latitude) * up + np.cos(latitude) * north)
    rows = []
    for pose, heading in (("y", 90), ("y", -90), ("x", 90), ("x", -90), ("x", 0), ("x", 180), ("y", 0)):
        for turn in (0, 80, 200):
            r = Rotation.from_euler("z", turn, degrees=True) * Rotation.from_euler(pose, heading, degrees=True)
            rows.append(np.concatenate([r.inv().apply(G * up), r.inv().apply(earth) + bias]))
    return np.array(rows)


# --- writing ----------------------------------------------------------------------------------------------
ENTRIES = []


def literal(x):
    x = float(x)
    text = repr(x + 0.0)
    return text if ("." in text or "e" in text) else text + ".0"


def numbers(a):
    return "&[" + ", ".join(literal(x) for x in np.asarray(a, float).ravel()) + "]"


def argument(a):
    if np.ndim(a) == 0:
        return f"Number({literal(a)})"
    a = np.atleast_2d(a)
    return f"Range {{ data: {numbers(a)}, cols: {a.shape[1]} }}"


def example(name, args, expected, source, tolerance=1e-13):
    if expected is None:
        e = "Expected::Sentence"
    elif isinstance(expected, bool):
        e = f"Expected::Truth({str(expected).lower()})"
    else:
        a = np.atleast_2d(np.asarray(expected, float))
        e = f"Expected::Numbers {{ data: {numbers(a)}, cols: {a.shape[1]}, tolerance: {tolerance!r} }}"
    ENTRIES.append(f"pub(crate) const {name}: Example = Example {{ args: &[{', '.join(argument(a) for a in args)}], "
                   f"expected: {e}, source: \"{source}\" }};\n")


def main():
    np_, sp, mpm = "NumPy", "SciPy Rotation", "mpmath, 50 digits"
    example("VEC3_MEAN", [ACC], ACC.mean(axis=0), np_)
    example("VEC3_VARIANCE", [ACC], ACC.var(axis=0), np_)
    example("MEAN_NORM", [ACC], np.linalg.norm(ACC, axis=1).mean(), np_)
    data = six_faces(False)
    nine = six_face_fit(data, 4)
    calib_args = [data, 0.5, 2.0, 0.5, 0.3, 0.01, G, 0.9, 1.1]
    example("GET_BIAS_CALIB", calib_args, nine, "SciPy least_squares", 1e-9)
    example("GET_IMU_CALIB", calib_args, np.concatenate([nine, [1, 1, 1]]), "SciPy least_squares", 1e-9)
    applied = np.concatenate([(RAW6[:, :3] - CALIB[:3]) * CALIB[3:6], (RAW6[:, 3:] - CALIB[6:9]) * CALIB[9:]], axis=1)
    example("APPLY_IMU_CALIB", [RAW6, CALIB], applied, "NumPy, on published rows")
    example("IDENTITY_QUAT", [], [1, 0, 0, 0], "definition", 0.0)
    example("NORMALIZE_QUAT", [Q * 3], unit(Q), np_)
    example("CONJUGATE_QUAT", [Q], Q * [1, -1, -1, -1], "definition", 0.0)
    example("QUAT_ROTATE_VEC3", [Q, VEC], rot(Q).apply(VEC), sp)
    example("QUATS_ROTATE_VEC3", [QUATS, VEC], rot(QUATS).apply(VEC), sp)
    example("QUAT2YPR", [Q], ypr(rot(Q)), sp)
    example("QUATS2YPRS", [QUATS], ypr(rot(QUATS)), sp)
    e = Rotation.from_euler("ZYX", YPRS)
    example("YPR2QUAT", [YPRS[0]], wxyz(e[0], [1, 0, 0, 0]), sp)
    likes = np.array([[float(x) for x in hamilton(hamilton(*[[np.cos(v / 2)] + [np.sin(v / 2) * (i == k) for i in range(3)]
                                                             for v, k in ((a, 2), (b, 1))]),
                                                  [np.cos(c / 2), np.sin(c / 2), 0, 0])] for a, b, c in YPRS])
    example("YPRS2QUATS", [YPRS], wxyz(e, likes), sp)
    example("AXIS_ANGLE2QUAT", [0.0, 3.0, 4.0, 1.2], wxyz(Rotation.from_rotvec(np.array([0, 0.6, 0.8]) * 1.2), [1, 0, 0, 0]), sp)
    example("GRAVITY_BODY", [Q], rot(Q).inv().apply([0, 0, 1]), sp)
    example("ACCS2INITIAL_QUAT", [ACC, 0.02, 9.6, 10.0], tilt_quat(ACC), sp)
    body, world = rot(Q2).inv() * rot(QUATS), rot(QUATS) * rot(Q2).inv()
    conj = unit(Q2) * [1, -1, -1, -1]
    body_q = wxyz(body, np.array([hamilton(conj, q) for q in unit(QUATS)]))
    world_q = wxyz(world, np.array([hamilton(q, conj) for q in unit(QUATS)]))
    for name, quats, yprs in (("BODY", body_q, ypr(body)), ("WORLD", world_q, ypr(world))):
        example(f"QUAT2{name}_QUAT", [QUATS[1], Q2], quats[1], sp)
        example(f"QUAT2{name}_YPR", [QUATS[1], Q2], yprs[1], sp)
        example(f"QUATS2{name}_QUATS", [QUATS, Q2], quats, sp)
        example(f"QUATS2{name}_YPRS", [QUATS, Q2], yprs, sp)
    dt = 0.05
    for suffix, step in (("", exact_step), ("_RK4", rk4_step)):
        series = gyro_series(Q, GYRO_LIVELY, dt, step)
        example(f"UPDATE_QUAT_BY_GYRO{suffix}", [Q, GYRO_LIVELY[0], dt], series[0], mpm)
        example(f"UPDATE_QUATS_BY_GYRO{suffix}", [Q, GYRO_LIVELY, dt], series, mpm)
        example(f"UPDATE_YPRS_BY_GYRO{suffix}", [Q, GYRO_LIVELY, dt], ypr(rot(series)), f"{mpm}; {sp}")
    plain = mahony(Q, GYRO_LIVELY, ACC_LIVELY, dt, lambda n: mp.mpf(2), 0.3)
    first = mahony(Q, GYRO_LIVELY[:1], ACC_LIVELY[:1], dt, lambda n: mp.mpf(2), 0)
    example("UPDATE_QUAT_BY_MAHONY", [Q, GYRO_LIVELY[0], ACC_LIVELY[0], dt, 2.0, G], first[0], mpm)
    example("UPDATE_YPR_BY_MAHONY", [Q, GYRO_LIVELY[0], ACC_LIVELY[0], dt, 2.0], ypr(rot(first))[0], f"{mpm}; {sp}")
    example("UPDATE_QUATS_BY_MAHONY", [Q, GYRO_LIVELY, ACC_LIVELY, dt, 2.0, 0.3, G], plain, mpm)
    example("UPDATE_YPRS_BY_MAHONY", [Q, GYRO_LIVELY, ACC_LIVELY, dt, 2.0, 0.3], ypr(rot(plain)), f"{mpm}; {sp}")
    gain = lambda n: adaptive_kp(n, *ADAPTIVE)  # noqa: E731
    adaptive = mahony(Q, GYRO_LIVELY, ACC_LIVELY, dt, gain, 0.3)
    third = mahony(Q, GYRO_LIVELY[2:3], ACC_LIVELY[2:3], dt, gain, 0.3)
    one = [Q, GYRO_LIVELY[2], ACC_LIVELY[2], dt, *ADAPTIVE, 0.3]
    example("UPDATE_QUAT_BY_MAHONY_ADAPTIVE", [*one, G], third[0], mpm)
    example("UPDATE_YPR_BY_MAHONY_ADAPTIVE", one, ypr(rot(third))[0], f"{mpm}; {sp}")
    many = [Q, GYRO_LIVELY, ACC_LIVELY, dt, *ADAPTIVE, 0.3]
    example("UPDATE_QUATS_BY_MAHONY_ADAPTIVE", [*many, G], adaptive, mpm)
    example("UPDATE_YPRS_BY_MAHONY_ADAPTIVE", many, ypr(rot(adaptive)), f"{mpm}; {sp}")
    example("ADAPTIVE_KP", [12.0, *ADAPTIVE, G], float(adaptive_kp(mp.mpf(12), *ADAPTIVE)), mpm)
    example("IS_ACC_STABLE", [ACC, 0.02, 9.6, 10.0], True, np_)
    assert ACC.var(axis=0).max() <= 0.02 and 9.6 <= np.linalg.norm(ACC, axis=1).mean() <= 10
    example("IS_FINITE_QUAT", [Q], True, "definition")
    example("IS_FINITE_VEC3", [VEC], True, "definition")
    shaken = six_faces(True)
    example("CALIB_FACES", [shaken, 0.5, 2.0, 0.5, 0.3, 0.01], faces(shaken, 4, 1, 0.3, 0.01, 0.5), np_, 1e-12)
    example("SHISEI_LAST_ERROR", [], None, "the door")
    example("SHISEI_VERSION", [], None, "the door")
    example("UPDATE_QUATS_BY_COMPLEMENTARY", [Q, GYRO_LIVELY, ACC_LIVELY, dt, 0.98, G],
            complementary(Q, GYRO_LIVELY, ACC_LIVELY, dt, 0.98, G), mpm)
    example("DEAD_RECKON", [Q, GYRO_LIVELY, ACC_LIVELY, dt, G], dead_reckon(Q, GYRO_LIVELY, ACC_LIVELY, dt, G), mpm, 1e-12)
    # level, at rest for 1 s, then turning about z: the truth is known; an estimator comes near it
    rate = np.where(np.arange(20) < 10, 0.0, 0.5)
    gyro, acc = np.outer(rate, [0, 0, 1]), np.tile([0, 0, G], (20, 1))
    yaw = np.cumsum(rate * 0.1)
    truth = Rotation.from_rotvec(np.outer(yaw, [0, 0, 1]))
    example("ESTIMATE_QUATS", [gyro, acc, 0.1], wxyz(truth, [1, 0, 0, 0]), "truth of the motion", 0.03)
    example("ESTIMATE_YPRS", [gyro, acc, 0.1], ypr(truth), "truth of the motion", 0.06)
    directions = np.array([[1, 0, 0], [-1, 0.1, 0], [0, 1, 0.2], [0.3, -1, 0], [0, 0.1, 1], [0.1, 0, -1.0]])
    points = np.round([0.1, -0.2, 0.3] + 1.5 * unit(directions) + 0.01 * np.array([[1, -1, 1], [0, 1, 0]] * 3), 4)
    centred = points - points.mean(axis=0)
    centre = np.linalg.solve(centred.T @ centred, 0.5 * centred.T @ np.sum(centred**2, axis=1))
    radius = np.sqrt(centre @ centre + np.mean(np.sum(centred**2, axis=1)))
    example("FIT_SPHERE", [points], [*(centre + points.mean(axis=0)), radius], "NumPy linalg.solve", 1e-12)
    n, noise = 1234567890, []  # the generator of NIST SP 1065, section 12.4
    for _ in range(60):
        noise.append(round(n / 2147483647, 4))
        n = n * 16807 % 2147483647
    noise = np.array(noise)
    for m in (1, 2):  # white, as the degrees of freedom take it
        assert abs(lag1(noise[:60 // m * m].reshape(-1, m).mean(axis=1))) < 0.2
    factors = sorted({int(np.floor(10 ** (k / 10) + 0.5)) for k in range(14)})
    example("ALLAN_DEV", [noise.reshape(-1, 1), 0.5], allan(noise, 0.5, factors), "NumPy, SciPy chi2", 1e-9)
    latitude, rate = 0.62, 7.292115e-5
    means = turning_earth(latitude, rate, np.array([2e-4, -1e-4, 5e-5]))
    example("EARTH_RATE", [means], [[rate, 0], [rate * np.cos(latitude), 0], [latitude, 0], [2 * np.pi / rate / 3600, 0]],
            "truth of the motion", 1e-9)
    head = ("// @generated by xtask/py/function_examples.py (SciPy, NumPy, mpmath). Do not edit.\n"
            "#![allow(clippy::approx_constant, clippy::excessive_precision)] // measured numbers\n\n"
            "use crate::example::{Example, ExampleArg::{Number, Range}, Expected};\n\n")
    OUT.write_text(head + "\n".join(textwrap.fill(e, 108, break_long_words=False, break_on_hyphens=False,
                                                  subsequent_indent="    ") + "\n" for e in ENTRIES))


if __name__ == "__main__":
    main()
