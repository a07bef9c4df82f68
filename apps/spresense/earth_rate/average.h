// Means of one direction: no Arduino, no NuttX, so the host's tests compile this file as it is.
//
// Units: counter ticks of 1/19.2 MHz, rad/s, m/s2, degrees Celsius. Sums are in double: a float sum of 125,000
// readings would lose the Earth's rate.
#pragma once
#include <math.h>
#include <stdint.h>

static const double TICK_HZ = 19200000.0;

// One reading as the driver gives it, without its padding.
struct Reading {
  uint32_t timestamp;
  float temp;
  float gyro[3];
  float acc[3];
};

class DirectionMean {
public:
  // A step longer than 1.5 usual ones counts as one usual step, so that a gap gives its one reading no extra
  // weight. usual_ticks = 0 weighs every reading by its own step, as the published program does.
  explicit DirectionMean(uint32_t usual_ticks = 0) : usual_(usual_ticks) {}

  // The first reading only starts the clock. The difference is taken in 32 bits: it survives the counter's wrap
  // every 223.7 s.
  void add(const Reading &r) {
    if (count_ == 0) {
      last_ = r.timestamp;
      ++count_;
      return;
    }
    const uint32_t step = r.timestamp - last_;
    last_ = r.timestamp;
    ++count_;
    span_ += step;
    uint32_t weight = step;
    if (usual_ != 0 && step > usual_ + usual_ / 2) {
      weight = usual_;
      ++long_steps_;
      missed_ += (step + usual_ / 2) / usual_ - 1;
    }
    const double w = weight / TICK_HZ;
    weight_ += w;
    temp_ += r.temp * w;
    for (int i = 0; i < 3; ++i) {
      gyro_[i] += r.gyro[i] * w;
      acc_[i] += r.acc[i] * w;
    }
  }

  uint32_t count() const { return count_; }
  double seconds() const { return static_cast<double>(span_) / TICK_HZ; }
  double weight() const { return weight_; }
  uint32_t long_steps() const { return long_steps_; }
  uint32_t missed() const { return missed_; }
  double gyro(int i) const { return weight_ > 0 ? gyro_[i] / weight_ : 0; }
  double acc(int i) const { return weight_ > 0 ? acc_[i] / weight_ : 0; }
  double temp() const { return weight_ > 0 ? temp_ / weight_ : 0; }

private:
  uint32_t usual_ = 0;
  uint32_t last_ = 0;
  uint32_t count_ = 0;
  uint32_t long_steps_ = 0;
  uint32_t missed_ = 0;
  uint64_t span_ = 0;
  double weight_ = 0;
  double temp_ = 0;
  double gyro_[3] = {0, 0, 0};
  double acc_[3] = {0, 0, 0};
};

// Radius of the least-squares sphere through n points (algebraic: (sum X X^T) C = sum X |X|^2 / 2). Negative when
// the points lie in one plane.
inline double sphere_radius(int n, const double (*p)[3]) {
  double m[3] = {0, 0, 0};
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < 3; ++i) m[i] += p[k][i] / n;
  double s[3][3] = {{0}}, t[3] = {0}, sq = 0;
  for (int k = 0; k < n; ++k) {
    double x[3], q = 0;
    for (int i = 0; i < 3; ++i) {
      x[i] = p[k][i] - m[i];
      q += x[i] * x[i];
    }
    sq += q;
    for (int i = 0; i < 3; ++i) {
      t[i] += 0.5 * x[i] * q;
      for (int j = 0; j < 3; ++j) s[i][j] += x[i] * x[j];
    }
  }
  double c[3], cofactor[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int a = (i + 1) % 3, b = (i + 2) % 3, u = (j + 1) % 3, v = (j + 2) % 3;
      cofactor[i][j] = s[a][u] * s[b][v] - s[a][v] * s[b][u];
    }
  const double det = s[0][0] * cofactor[0][0] + s[0][1] * cofactor[0][1] + s[0][2] * cofactor[0][2];
  const double size = (s[0][0] + s[1][1] + s[2][2]) / 3;
  if (!(fabs(det) > 1e-12 * size * size * size)) return -1;
  double r2 = sq / n;
  for (int j = 0; j < 3; ++j) {
    c[j] = (cofactor[0][j] * t[0] + cofactor[1][j] * t[1] + cofactor[2][j] * t[2]) / det;
    r2 += c[j] * c[j];
  }
  return sqrt(r2);
}
