// Runs the sketch unchanged on this machine against a fake /dev/imu0 and a fake serial line.
//
// Without arguments: the tests. With "serve": the line is standard input and output, for the tests of the
// command that talks to the board (the sensor then runs as fast as it is read).
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <poll.h>
#include <string>
#include <unistd.h>
#include <vector>
#define open fake_open
#define read fake_read
#define close fake_close
static int fake_open(const char *, int, ...);
static long fake_read(int, void *, size_t);
static int fake_close(int);
#include "../earth_rate/earth_rate.ino"
#undef open
#undef read
#undef close

SerialPort Serial;
static std::string out;
static std::deque<int> in;
static int set_rate_hz, set_accel, set_gyro, fifo, enabled, bus_fails, open_fails, fail_request, short_read_at = -1;
static long reads;
static uint32_t ticks = 0xFFFF0000u; // wraps during the first reading
static bool serving, opened;
static double now_ms;
static long room = 1 << 20;
static int direction = 0;
static int gap_every = 0;

extern "C" int board_cxd5602pwbimu_initialize(int bus) { assert(bus == 5); return bus_fails ? -1 : 0; }
static int fake_open(const char *path, int, ...) {
  assert(!strcmp(path, "/dev/imu0"));
  if (open_fails) { errno = 2; return -1; }
  opened = true;
  return 3;
}
static int fake_close(int) { opened = false; return 0; }
extern "C" int ioctl(int, int request, ...) {
  va_list v;
  va_start(v, request);
  const unsigned long a = va_arg(v, unsigned long);
  va_end(v);
  if (request == fail_request) { errno = 22; return -1; }
  if (enabled && request != SNIOC_ENABLE) { errno = 16; return -1; } // busy: settings only while off
  switch (request) {
  case SNIOC_SSAMPRATE: set_rate_hz = (int)a; break;
  case SNIOC_SDRANGE:
    set_accel = ((cxd5602pwbimu_range_t *)a)->accel;
    set_gyro = ((cxd5602pwbimu_range_t *)a)->gyro;
    break;
  case SNIOC_SFIFOTHRESH: fifo = (int)a; break;
  case SNIOC_ENABLE: enabled = (int)a; break;
  default: assert(false);
  }
  return 0;
}

// A board on the turning Earth, turned by 45 degrees a direction and tilted every other time: bias, known rate.
static const double RATE = 7.292115e-5, BIAS[3] = {1e-3, -2e-3, 5e-4};
static void truth(int k, double g[3]) {
  const double yaw = k * PI / 4, roll = (k % 2) ? PI : 0, lat = 35.7 * PI / 180;
  const double n = RATE * cos(lat), u = RATE * sin(lat);
  const double x = n * cos(yaw), y = -n * sin(yaw), z = u;
  g[0] = x;
  g[1] = y * cos(roll) + z * sin(roll);
  g[2] = -y * sin(roll) + z * cos(roll);
}
static long fake_read(int, void *buffer, size_t n) {
  assert(n == sizeof(cxd5602pwbimu_data_t) && sizeof(cxd5602pwbimu_data_t) == 32);
  ++reads;
  if (short_read_at >= 0 && reads > short_read_at) return 7;
  long steps = 1;
  if (gap_every && reads % gap_every == 0) steps = 5;
  ticks += (uint32_t)(steps * 19200000 / set_rate_hz);
  now_ms += 1000.0 / set_rate_hz;
  if (serving) usleep(20);
  double g[3];
  truth(direction, g);
  const double noise = 1e-3 * ((int)(reads % 7) - 3); // sums to nothing over 7 readings
  auto *d = (cxd5602pwbimu_data_t *)buffer;
  *d = {ticks, 27.5f, (float)(g[0] + BIAS[0] + noise), (float)(g[1] + BIAS[1] - noise), (float)(g[2] + BIAS[2] + noise),
        0.f, 0.f, direction % 2 ? -9.80665f : 9.80665f};
  return (long)n;
}

void delay(unsigned long ms) { now_ms += ms; }
unsigned long millis(void) { return (unsigned long)now_ms; }
void SerialPort::begin(long) {}
void SerialPort::println(const char *text) {
  if (serving) { printf("%s\n", text); fflush(stdout); }
  if (!strcmp(text, "finish")) direction = (direction + 1) % 8;
  out += text;
  out += '\n';
}
size_t SerialPort::write(const uint8_t *bytes, size_t n) {
  if (serving) { fwrite(bytes, 1, n, stdout); fflush(stdout); }
  out.append((const char *)bytes, n);
  room -= (long)n;
  return n;
}
int SerialPort::availableForWrite() { return room > 0 ? (int)(room < 4096 ? room : 4096) : 0; }
int SerialPort::available() {
  if (serving) {
    struct pollfd p = {0, POLLIN, 0};
    if (poll(&p, 1, 0) > 0) {
      unsigned char c;
      if (::read(0, &c, 1) == 1) in.push_back(c); else exit(0);
    }
    now_ms += 0.01;
  } else {
    now_ms += 0.1; // time goes on while the sketch waits for a line
  }
  return (int)in.size();
}
// (the line's read has been renamed with the file's)
int SerialPort::fake_read() {
  const int c = in.front();
  in.pop_front();
  if (serving && c == 'x' && mode == BLOCKS) direction = (direction + 1) % 8; // the user turns the board
  return c;
}

static void type(const char *text) { while (*text) in.push_back(*text++); }
static std::vector<std::vector<uint8_t>> frames(const std::string &bytes) {
  std::vector<std::vector<uint8_t>> found;
  std::vector<uint8_t> part;
  for (unsigned char c : bytes) {
    if (c) { part.push_back(c); continue; }
    std::vector<uint8_t> raw;
    for (size_t i = 0; i < part.size();) {
      const uint8_t code = part[i++];
      for (int k = 1; k < code; ++k) { assert(i < part.size()); raw.push_back(part[i++]); }
      if (code < 0xFF && i < part.size()) raw.push_back(0);
    }
    assert(raw.size() > 2);
    const uint16_t crc = crc16(raw.data(), raw.size() - 2);
    assert(raw[raw.size() - 2] == (crc & 0xFF) && raw[raw.size() - 1] == crc >> 8);
    raw.resize(raw.size() - 2);
    found.push_back(raw);
    part.clear();
  }
  assert(part.empty());
  return found;
}
template <typename T> static T at(const std::vector<uint8_t> &f, size_t i) { T v; memcpy(&v, &f[i], sizeof(v)); return v; }
static void restart() {
  out.clear(); in.clear(); enabled = 0; fd = -1; measured = 0; mode = IDLE; rate_hz = 1920; reads = 0; room = 1 << 20;
  direction = 0; ticks = 0xFFFF0000u; bus_fails = open_fails = fail_request = gap_every = 0; short_read_at = -1; opened = false;
}

static void test_crc() { // the check value of CRC-16/CCITT-FALSE
  assert(crc16((const uint8_t *)"123456789", 9) == 0x29B1);
}
static void test_article() {
  restart();
  setup();
  assert(out == "ready\n" && set_rate_hz == 1920 && set_accel == 2 && set_gyro == 125 && fifo == 1 && enabled == 1);
  type("t7\n");
  loop();
  out.clear();
  for (int k = 0; k < 8; ++k) {
    type("r");
    loop();
    assert(out.find("start\n3\n2\n1\nfinish\n") != std::string::npos);
  }
  double x, y, z, r, day;
  const char *p = strchr(out.c_str(), '(');
  for (int k = 0; k < 8; ++k) {
    assert(p && sscanf(p, "(%le, %le, %le)", &x, &y, &z) == 3);
    double g[3];
    truth(k, g);
    assert(fabs(x - g[0] - BIAS[0]) < 2e-7 && fabs(y - g[1] - BIAS[1]) < 2e-7 && fabs(z - g[2] - BIAS[2]) < 2e-7);
    p = strchr(p, '\n') + 1;
  }
  assert(sscanf(p, "%le rad/s\nA sidereal day is %lf hours long.", &r, &day) == 2);
  assert(fabs(r / RATE - 1) < 0.01 && fabs(day - 23.934) < 0.25);
}
static void test_failures() {
  restart(); bus_fails = 1; setup(); assert(out.find("ERROR: Initialize") == 0 && fd < 0);
  restart(); open_fails = 1; setup(); assert(out.find("ERROR: Open failed. 2") == 0);
  for (int request : {SNIOC_SSAMPRATE, SNIOC_SDRANGE, SNIOC_SFIFOTHRESH, SNIOC_ENABLE}) {
    restart(); fail_request = request; setup();
    assert(out.find("ERROR: ") == 0 && out.find("22") != std::string::npos && !opened);
    type("r"); loop(); // nothing crashes afterwards
    assert(out.find("not running") != std::string::npos);
  }
  restart(); setup(); short_read_at = (int)reads + 500; type("r"); loop();
  assert(out.find("ERROR: read size mismatch! 7\nAn error occurred during measurement.") != std::string::npos && !opened);
  // eight times the same direction: no sphere
  const double same[8][3] = {{0}};
  assert(sphere_radius(8, same) < 0);
}
static void test_gaps() {
  // every 10th step is five long: capped it changes nothing, by its own length its reading would weigh five
  restart(); setup(); gap_every = 10;
  DirectionMean capped(10000), plain(0);
  for (int k = 0; k < 20000; ++k) { Reading r; assert(read_one(&r)); r.gyro[0] = (reads % 10 == 0) ? 5.f : 1.f; capped.add(r); plain.add(r); }
  assert(fabs(capped.gyro(0) - 1.4) < 1e-3 && fabs(plain.gyro(0) - (9 + 25) / 14.0) < 1e-3);
  assert(capped.long_steps() >= 1990 && capped.missed() == 4 * capped.long_steps());
}
static void test_stream() {
  restart(); setup(); out.clear();
  type("b"); loop();
  for (int k = 0; k < 1000; ++k) loop();
  type("x"); loop();
  auto f = frames(out);
  uint16_t next = 0; uint32_t last = 0;
  for (auto &x : f) {
    assert(at<uint16_t>(x, 1) == next++);
    if (x[0] != 1) continue;
    assert(x.size() == 35);
    const uint32_t t = at<uint32_t>(x, 3);
    assert(last == 0 || t - last == 10000);
    last = t;
    assert(fabs(at<float>(x, 7) - 27.5f) < 1e-6 && fabs(at<float>(x, 31) - 9.80665f) < 1e-5);
  }
  assert(next >= 1000);
  // 39 bytes a reading: 1920 Hz need 74,880 bytes/s = 748,800 baud at 10 bits a byte
  assert(out.size() <= next * 39u);
}
static void test_blocks_and_drops() {
  restart(); setup(); out.clear();
  type("k64\n"); loop();
  for (int k = 0; k < 6400; ++k) loop();
  type("x"); loop();
  int blocks = 0;
  for (auto &x : frames(out)) {
    if (x[0] != 2) continue;
    ++blocks;
    assert(x.size() == 57 && at<uint16_t>(x, 3) == 64);
    assert(at<uint32_t>(x, 9) - at<uint32_t>(x, 5) == 63 * 10000u);
    assert(fabs(at<double>(x, 21) - BIAS[0] - RATE * cos(35.7 * PI / 180)) < 1e-4);
  }
  assert(blocks == 100);
  // a line that takes nothing for a while: whole frames are dropped, counted, and the sequence shows it
  restart(); setup(); out.clear(); gap_every = 100;
  type("b"); loop();
  for (int k = 0; k < 4000; ++k) { if (k == 1000) room = 0; if (k == 2000) room = 1 << 20; loop(); }
  type("x"); loop();
  uint16_t previous = 0; uint32_t told = 0, missing = 0, gone = 0;
  for (auto &x : frames(out)) {
    missing += (uint16_t)(at<uint16_t>(x, 1) - previous);
    previous = at<uint16_t>(x, 1) + 1;
    if (x[0] == 3) { told = at<uint32_t>(x, 3); gone = at<uint32_t>(x, 7); }
  }
  assert(told >= 990 && told == missing && gone > 0);
}
static void test_settings() {
  restart(); setup(); out.clear();
  type("q240\n"); loop(); assert(out == "ok\n" && set_rate_hz == 240 && enabled == 1);
  type("q100\n"); loop(); assert(out.find("ERROR: no such rate") != std::string::npos);
  type("t0\n"); loop(); type("tabc\n"); loop(); type("k0\n"); loop();
  assert(out.find("ERROR: seconds") != std::string::npos && out.find("ERROR: readings") != std::string::npos);
  type("~!\x01\xff"); for (int k = 0; k < 8; ++k) loop(); // noise
}

int main(int argc, char **argv) {
  if (argc > 1 && !strcmp(argv[1], "serve")) {
    serving = true;
    setup();
    for (;;) { loop(); if (mode == IDLE) usleep(200); }
  }
  test_crc(); test_article(); test_failures(); test_gaps(); test_stream(); test_blocks_and_drops(); test_settings();
  puts("ok");
}
