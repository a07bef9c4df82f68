"""Prints fixtures/mpmath/exponential.csv: cos h and sin(h)/h for x = h^2, to 40 digits rounded to float64.

Run with mpmath installed: python xtask/py/mpmath_exponential.py > fixtures/mpmath/exponential.csv
x runs over the polynomials' range up to the last number below 0.25, where they hand over.
"""

import math

from mpmath import cos, mp, mpf, sin, sqrt

mp.dps = 40
values = [1e-300, 1e-30, 1e-16, 1e-8, 1e-4]
values += [k / 64 for k in range(1, 16)]
values += [0.25 - 2.0**-k for k in range(8, 53, 4)] + [math.nextafter(0.25, 0), 0.2468013579, 0.1234567890123]
print("x,cos,sinc")
for x in sorted(values):
    h = sqrt(mpf(x))
    print(f"{x!r},{float(cos(h))!r},{float(sin(h) / h)!r}")
