// Earth's rotation with a Spresense and its multi-IMU add-on board (CXD5602PWBIMU).
//
// Commands, one letter each, some with a number and a line end (at 115200 baud, or EARTH_RATE_BAUD):
//   r        one of eight directions: start, 3, 2, 1, the reading, finish; after the eighth all means, the rate
//            and the length of the sidereal day
//   t<S>\n   seconds a direction (default 65)
//   b\n      stream every reading as a binary frame; k<K>\n  stream means of K readings; x  stop
//   q<HZ>\n  sampling rate: 15, 30, 60, 120, 240, 480, 960 or 1920 (default 1920)
// Frames are described in frame.h. What the line cannot take is dropped, counted and reported once a second.
#include <Arduino.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <nuttx/config.h>
#include <nuttx/sensors/cxd5602pwbimu.h>
#include <arch/board/cxd56_cxd5602pwbimu.h>
#include "average.h"
#include "frame.h"

#ifndef EARTH_RATE_BAUD
#define EARTH_RATE_BAUD 115200 // 921600 for every reading at 1920 Hz
#endif

static const int BUS = 5; // SPI5
static const int ACCEL_G = 2, GYRO_DPS = 125, FIFO_THRESHOLD = 1;
static const int DIRECTIONS = 8;

enum Mode { IDLE, SAMPLES, BLOCKS };

static int fd = -1;
static int rate_hz = 1920;
static unsigned long seconds_a_direction = 65;
static double means[DIRECTIONS][3];
static int measured = 0;
static Mode mode = IDLE;
static uint16_t sequence = 0;
static uint32_t dropped = 0, missed = 0;
static long block_size = 64;
static uint32_t last_timestamp = 0;
static bool has_last = false;
static unsigned long last_status_ms = 0;

struct Block {
  uint32_t first, last;
  long n;
  double temp, gyro[3], acc[3];
};
static Block block;

static void say(const char *text) { Serial.println(text); }

static int fail(const char *what) {
  char line[96];
  snprintf(line, sizeof(line), "ERROR: %s failed. %d", what, errno);
  say(line);
  if (fd >= 0) close(fd);
  fd = -1;
  return -1;
}

// The driver takes settings only while it is off.
static int configure() {
  cxd5602pwbimu_range_t range;
  range.accel = ACCEL_G;
  range.gyro = GYRO_DPS;
  if (ioctl(fd, SNIOC_SSAMPRATE, rate_hz)) return fail("Set a sampling rate");
  if (ioctl(fd, SNIOC_SDRANGE, (unsigned long)(uintptr_t)&range)) return fail("Set dynamic ranges");
  if (ioctl(fd, SNIOC_SFIFOTHRESH, FIFO_THRESHOLD)) return fail("Set a FIFO threshold");
  if (ioctl(fd, SNIOC_ENABLE, 1)) return fail("Enable");
  return 0;
}

static bool read_one(Reading *out) {
  cxd5602pwbimu_data_t d;
  const int n = read(fd, &d, sizeof(d));
  if (n != (int)sizeof(d)) {
    char line[64];
    snprintf(line, sizeof(line), "ERROR: read size mismatch! %d", n);
    say(line);
    return false;
  }
  *out = {d.timestamp, d.temp, {d.gx, d.gy, d.gz}, {d.ax, d.ay, d.az}};
  return true;
}

// The first 50 ms after the sensor was switched on are not valid.
static bool settle() {
  Reading r;
  for (int k = rate_hz / 20; k > 0; --k)
    if (!read_one(&r)) return false;
  return true;
}

static bool start_imu() {
  if (board_cxd5602pwbimu_initialize(BUS) < 0) return fail("Initialize CXD5602PWBIMU") == 0;
  fd = open("/dev/imu0", O_RDONLY);
  if (fd < 0) return fail("Open") == 0;
  return configure() == 0 && settle();
}

static void stop(const char *text) {
  say(text);
  if (fd >= 0) close(fd);
  fd = -1;
}

static void report() {
  char line[128];
  for (int k = 0; k < DIRECTIONS; ++k) {
    snprintf(line, sizeof(line), "(%e, %e, %e)", means[k][0], means[k][1], means[k][2]);
    say(line);
  }
  const double r = sphere_radius(DIRECTIONS, means);
  if (r <= 0) {
    say("The calculation results are incorrect.");
    return;
  }
  snprintf(line, sizeof(line), "%e rad/s", r);
  say(line);
  snprintf(line, sizeof(line), "A sidereal day is %f hours long.", 2 * PI / r / 3600.0);
  say(line);
}

static void measure() {
  say("start");
  static const char *const countdown[] = {"3", "2", "1"};
  for (const char *n : countdown) {
    say(n);
    delay(1000);
  }
  // what piled up during the countdown is old
  Reading r;
  if (!settle()) return stop("An error occurred during measurement.");
  DirectionMean mean((uint32_t)(TICK_HZ / rate_hz));
  while (mean.seconds() < (double)seconds_a_direction) {
    if (!read_one(&r)) return stop("An error occurred during measurement.");
    mean.add(r);
  }
  say("finish");
  for (int i = 0; i < 3; ++i) means[measured][i] = mean.gyro(i);
  if (++measured == DIRECTIONS) {
    report();
    measured = 0;
  }
}

// A whole frame or none: a frame cut short would cost the one after it too.
static void send(const Payload &p) {
  uint8_t out[MAX_FRAME];
  const size_t n = encode_frame(p.bytes(), p.size(), out);
  if ((size_t)Serial.availableForWrite() >= n) {
    Serial.write(out, n);
  } else {
    ++dropped;
  }
}

static void stream_sample(const Reading &r) {
  Payload p(1, sequence++);
  p.put(r.timestamp);
  p.put(r.temp);
  for (float v : r.gyro) p.put(v);
  for (float v : r.acc) p.put(v);
  send(p);
}

static void stream_block(const Reading &r) {
  if (block.n == 0) block = {r.timestamp, 0, 0, 0, {0, 0, 0}, {0, 0, 0}};
  block.last = r.timestamp;
  ++block.n;
  block.temp += r.temp;
  for (int i = 0; i < 3; ++i) {
    block.gyro[i] += r.gyro[i];
    block.acc[i] += r.acc[i];
  }
  if (block.n < block_size) return;
  Payload p(2, sequence++);
  p.put((uint16_t)block.n);
  p.put(block.first);
  p.put(block.last);
  p.put(dropped);
  p.put((float)(block.temp / block.n));
  for (double v : block.gyro) p.put(v / block.n);
  for (double v : block.acc) p.put((float)(v / block.n));
  send(p);
  block.n = 0;
}

static void stream() {
  Reading r;
  if (!read_one(&r)) {
    mode = IDLE;
    return stop("An error occurred during measurement.");
  }
  const uint32_t usual = (uint32_t)(TICK_HZ / rate_hz);
  if (has_last) {
    const uint32_t step = r.timestamp - last_timestamp;
    if (step > usual + usual / 2) missed += (step + usual / 2) / usual - 1;
  }
  last_timestamp = r.timestamp;
  has_last = true;
  mode == SAMPLES ? stream_sample(r) : stream_block(r);
  const unsigned long now = millis();
  if (now - last_status_ms >= 1000) {
    last_status_ms = now;
    Payload p(3, sequence++);
    p.put(dropped);
    p.put(missed);
    send(p);
  }
}

static void begin_stream(Mode m) {
  Reading r;
  sequence = 0;
  dropped = missed = 0;
  block.n = 0;
  has_last = false;
  last_status_ms = millis();
  for (int k = 0; k < 8; ++k) // what waited in the sensor's memory
    if (!read_one(&r)) return stop("An error occurred during measurement.");
  mode = m;
}

// The number after a letter, up to the line end; -1 when it is none or does not end within a second. A line with
// anything else in it is read to its end, so that its letters are not taken for commands.
static long number() {
  char text[12];
  size_t n = 0;
  bool good = true;
  const unsigned long start = millis();
  while (millis() - start < 1000) {
    if (!Serial.available()) continue;
    const int c = Serial.read();
    if (c == '\r') continue;
    if (c == '\n') {
      text[n] = 0;
      return good && n ? atol(text) : -1;
    }
    good = good && c >= '0' && c <= '9' && n + 1 < sizeof(text);
    if (good) text[n++] = (char)c;
  }
  return -1;
}

static void set_rate(long hz) {
  static const int rates[] = {15, 30, 60, 120, 240, 480, 960, 1920};
  for (int known : rates) {
    if (hz != known) continue;
    if (ioctl(fd, SNIOC_ENABLE, 0)) {
      fail("Disable");
      return;
    }
    rate_hz = known;
    if (configure() == 0 && settle()) say("ok");
    return;
  }
  say("ERROR: no such rate");
}

static void command(int c) {
  if (fd < 0) {
    say("ERROR: the sensor is not running");
    return;
  }
  switch (c) {
  case 'r':
    mode = IDLE;
    measure();
    break;
  case 't': {
    const long s = number();
    if (s > 0 && s <= 3600) {
      seconds_a_direction = (unsigned long)s;
      say("ok");
    } else {
      say("ERROR: seconds from 1 to 3600");
    }
    break;
  }
  case 'q':
    mode = IDLE;
    set_rate(number());
    break;
  case 'b':
    begin_stream(SAMPLES);
    break;
  case 'k': {
    const long k = number();
    if (k >= 1 && k <= 60000) {
      block_size = k;
      begin_stream(BLOCKS);
    } else {
      say("ERROR: readings from 1 to 60000");
    }
    break;
  }
  case 'x':
    mode = IDLE;
    break;
  default: // line ends and noise
    break;
  }
}

void setup() {
  Serial.begin(EARTH_RATE_BAUD);
  if (start_imu()) say("ready");
}

void loop() {
  if (Serial.available()) command(Serial.read());
  if (mode != IDLE && fd >= 0) stream();
}
